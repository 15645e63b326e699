#include "paper/sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PAPER_LOAD = 1000, PUBLISHED = 15 };

const ob_paper_setup ob_paper_setups[OB_PAPER_SCENARIOS] = {
	[OB_PAPER_COMMON] = { "common", "common", "one simulator: one ODE world that holds all objects", true, false,
			      false, 0 },
	[OB_PAPER_COMMON_LOAD] = { "common_load", "common, load",
				   "the same, and 1 to 1000 added up in each test of two boxes", true, false, false,
				   PAPER_LOAD },
	[OB_PAPER_OBS] = { "obs", "OBS", "a simulator for each object, each a process of its own", false, true, false,
			   0 },
	[OB_PAPER_OBS_LOAD] = { "obs_load", "OBS, load", "the same, and 1 to 1000 added up in each test of two boxes",
				false, true, false, PAPER_LOAD },
	[OB_PAPER_OBS_OBB] = { "obs_obb", "OBS, OBB", "OBS, and objects touch where their true, turned shapes do",
			       false, true, true, 0 },
	[OB_PAPER_COMMON_OBB] = { "common_obb", "common, OBB",
				  "one ODE world, and objects touch where their true shapes do", true, false, true, 0 },
	[OB_PAPER_POOL] = { "pool", "OBS, pool", "a simulator for each object, all of them run by one thread per core",
			    false, false, false, 0 },
};

ob_paper_sample ob_paper_sample_unmeasured(void)
{
	return (ob_paper_sample){
		.step_s = NAN,
		.total_s = NAN,
		.one_s = NAN,
		.busiest_s = NAN,
		.cpu = NAN,
		.demand = NAN,
		.pace = NAN,
		.fps = NAN,
		.viewer_cpu = NAN,
		.box_tests = NAN,
		.memory_bytes = NAN,
	};
}

bool ob_paper_results_add(ob_paper_results *r, const ob_paper_sample *s)
{
	if (r->count == r->room) {
		size_t room = r->room ? 2 * r->room : 64;
		ob_paper_sample *more = realloc(r->sample, room * sizeof *more);
		if (!more)
			return false;
		r->sample = more;
		r->room = room;
	}
	r->sample[r->count++] = *s;
	return true;
}

void ob_paper_results_finish(ob_paper_results *r)
{
	free(r->sample);
	r->sample = NULL;
	r->count = r->room = 0;
}

// Tables 1 to 5 of the paper: runtime (s), frame rate (1/s), CPU usage (%)
static const struct {
	ob_paper_scenario scenario;
	double row[PUBLISHED][3];
} published[] = {
	{ OB_PAPER_COMMON,
	  { { .008, 240, 49.52 },
	    { .009, 240, 49.65 },
	    { .008, 230, 50.01 },
	    { .010, 240, 49.3 },
	    { .006, 230, 49.8 },
	    { .005, 230, 50.57 },
	    { .008, 240, 49.45 },
	    { .005, 230, 49.7 },
	    { .005, 230, 50.2 },
	    { .006, 230, 50.8 },
	    { .008, 240, 50.33 },
	    { .005, 230, 50.47 },
	    { .005, 230, 51.3 },
	    { .006, 230, 51.76 },
	    { .005, 230, 51.38 } } },
	{ OB_PAPER_COMMON_LOAD,
	  { { .040, 150, 53.22 },
	    { .040, 150, 51.95 },
	    { .050, 160, 53.38 },
	    { .048, 160, 50.89 },
	    { .050, 155, 51.14 },
	    { .060, 160, 52.73 },
	    { .050, 160, 52.64 },
	    { .043, 150, 50.32 },
	    { .040, 150, 51.87 },
	    { .040, 150, 52.36 },
	    { .050, 150, 53.29 },
	    { .050, 150, 52.96 },
	    { .040, 150, 52.78 },
	    { .040, 155, 52.83 },
	    { .040, 150, 52.62 } } },
	{ OB_PAPER_OBS,
	  { { .001, 240, 20.58 },
	    { .001, 240, 20.23 },
	    { .001, 240, 20.92 },
	    { .002, 240, 21.18 },
	    { .001, 236, 20.20 },
	    { .001, 240, 20.84 },
	    { .001, 240, 20.65 },
	    { .001, 236, 21.72 },
	    { .001, 240, 21.49 },
	    { .001, 240, 20.96 },
	    { .001, 240, 21.10 },
	    { .001, 240, 20.32 },
	    { .001, 240, 20.80 },
	    { .001, 240, 21.38 },
	    { .001, 240, 21.75 } } },
};

ob_paper_results ob_paper_published(void)
{
	ob_paper_results r = { .experiments = PUBLISHED };
	for (size_t i = 0; i < sizeof published / sizeof *published; i++) {
		for (uint32_t k = 0; k < PUBLISHED; k++) {
			ob_paper_sample s = ob_paper_sample_unmeasured();
			s.scenario = published[i].scenario;
			s.experiment = k;
			s.step_s = published[i].row[k][0];
			s.fps = published[i].row[k][1];
			s.cpu = published[i].row[k][2] / 100;
			if (!ob_paper_results_add(&r, &s))
				return r;
		}
	}
	return r;
}

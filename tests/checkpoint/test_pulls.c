// Changes by requests that last are part of a checkpoint: a run that is dragged, turned and pushed, and in which requests have
// ended a path and given another, ends in the same bits whether it goes on by itself or from the file, in any configuration.
#include "asking.h"
#include "check.h"

#include <stdlib.h>

#include "checkpoint/saved_run.h"
#include "measure/measure.h"

static const char text[] =
	"scene { duration = 2, step = .01 }\nground {}\n"
	"for i = 1, 5 do box { size = { .3, .2, .4 }, at = { .2 * i, .1 * (i % 2), .4 * i } } end\n"
	"for i = 1, 3 do box { size = { 1, 1, .1 }, at = { 3, 3 * i, 1 }, kind = 'kinematic', path = { kind = 'sine', "
	"amplitude = { 0, 0, .2 }, frequency = 1 } } end\n";
enum { SAVED = 60, END = 150, PATHS = 6, GIVEN = 8 };

static ob_host *start(const ob_scene *s, const ob_run_settings *run, ob_isolation isolation, const ob_saved_host *from)
{
	ob_error e = { "" };
	const ob_host_config c = { .isolation = isolation, .workers = 2, .run = *run, .from = from };
	ob_host *h = ob_host_start(s, &c, &e);
	CHECK(h);
	return h;
}

static void go(ob_host *h, uint64_t step)
{
	ob_error e = { "" };
	ob_host_go(h, step);
	CHECK(ob_host_wait(h, &e));
}

static uint64_t end_of(ob_host *h)
{
	ob_snapshot s = { 0 };
	go(h, END);
	CHECK(ob_snapshot_take(&s, ob_host_universe(h), 0, NULL));
	const uint64_t hash = ob_measure_hash(&s);
	ob_snapshot_finish(&s);
	ob_host_stop(h);
	return hash;
}

int main(void)
{
	ob_error e = { "" };
	ob_checkpoint_file f = { 0 }, copy = { 0 };
	ob_saved_run r = { .scene = "pulls.lua", .text = text, .text_size = sizeof text - 1, .duration = 2 }, opened;
	ob_scene *s = ob_scene_load_text(r.scene, text, sizeof text - 1, &r.options, &e);
	CHECK(s && ob_run_settings_resolve(&s->run, NULL, &e));
	r.settings = s->run;
	ob_host *h = start(s, &r.settings, OB_ISOLATION_THREAD, NULL);
	go(h, 20);
	ask(h,
	    (ob_request){
		    .kind = OB_REQUEST_DRAG, .id = 1, .target = { 0, 0, 2 }, .point = { .1, 0, 0 }, .frequency = 3 });
	ask(h, (ob_request){ .kind = OB_REQUEST_TORQUE, .id = 2, .twist = { 0, 0, 9 } });
	ask(h, (ob_request){ .kind = OB_REQUEST_PUSH, .id = 3, .force = { 90, 0, 0 }, .point = { 0, 0, .1 } });
	ask(h, (ob_request){ .kind = OB_REQUEST_FRICTION, .id = 0, .friction = .1 });
	ask(h, (ob_request){ .kind = OB_REQUEST_STATE,
			     .id = PATHS,
			     .state = { { { 3, 0, 2 }, { .w = NAN } }, { 0 }, { .x = NAN } } });
	ask(h, (ob_request){ .kind = OB_REQUEST_PATH,
			     .id = GIVEN,
			     .path = { .points = 2,
				       .turns = 1,
				       .point = { { .2, { 3, 9, 2 }, { 1, 0, 0, 0 } },
						  { .9, { 3, 8, 1 }, { .8, .6, 0, 0 } } } } });
	go(h, SAVED);
	CHECK(ob_saved_run_make(&r, &f, h, "test", &e));
	ob_checkpoint_seal(&f);
	const uint64_t hash = end_of(h);
	for (int i = 0; i < 2; i++) {
		CHECK(ob_saved_run_parse(&opened, &copy, f.bytes, f.size, "file", &e));
		CHECK(opened.host.population.pulls == 3 && opened.host.population.slot[PATHS].unplanned == 1 &&
		      opened.host.population.slot[PATHS + 1].unplanned == 0 && opened.host.population.paths == 1 &&
		      opened.host.population.points == 3);
		CHECK(end_of(start(s, &opened.settings, (ob_isolation)i, &opened.host)) == hash);
		ob_saved_run_close(&opened, &copy);
	}
	ob_checkpoint_finish(&f);
	ob_scene_free(s);
	return check_end();
}

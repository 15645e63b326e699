// Runs of a comparison: each in a fresh process of its own, so that none warms another's caches or memory. A sample is
// two runs: one undisturbed, for cost and latency; one with clocks in the simulators, for where the time goes.
#include "cli/compare_run.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/child.h"

enum { ARGUMENTS_MAX = 2 * OB_OPTIONS + 24 };

static bool is_monolith(const ob_way *w)
{
	return strcmp(w->arch, "monolith") == 0;
}

// Options that a child of this kind understands and that are not compare's own
static bool passes_on(const ob_way *w, int id)
{
	if (!(ob_option_table[id].commands & OB_COMMAND_COMPARE) || !ob_option_table[id].argument)
		return false;
	switch (id) {
	case OB_OPTION_DEFINE:
	case OB_OPTION_WORKERS:
	case OB_OPTION_JSON:
	case OB_OPTION_NARROW:
	case OB_OPTION_VARY:
	case OB_OPTION_REPEATS:
	case OB_OPTION_OUT:
		return false;
	case OB_OPTION_TOLERANCE:
	case OB_OPTION_SOLVER:
	case OB_OPTION_LAG:
	case OB_OPTION_INTEGRATOR:
		return !is_monolith(w);
	default:
		return true;
	}
}

// The child's command line, each string and the array malloc'd; NULL when memory is out
static char **make_arguments(const ob_crew_run *p, const ob_section *s, const ob_way *w, uint32_t workers,
			     const char *measure)
{
	const ob_arguments *a = p->arguments;
	char **argv = calloc(ARGUMENTS_MAX + a->defines, sizeof *argv);
	size_t n = 0;
	bool fine = argv != NULL;
#define ADD(...) (fine = fine && asprintf(&argv[n++], __VA_ARGS__) >= 0)
	ADD("obsim");
	ADD("run");
	ADD("--json=-");
	ADD("--arch=%s", w->arch);
	ADD("--isolation=%s", w->isolation);
	ADD("--narrow=%s", w->other_narrow ? p->comparison->other : p->comparison->narrow);
	ADD("--measure=%s", strcmp(measure, "frames") == 0 ? "end" : measure);
	if (strcmp(measure, "frames") == 0) {
		ADD("--raw=/dev/null");
		ADD("--size=640x480");
		ADD("--samples=1");
	}
	if (w->crowd == OB_CROWD_EACH)
		ADD("--workers=objects");
	else if (!is_monolith(w))
		ADD("--workers=%" PRIu32, workers);
	for (int i = 0; i < OB_OPTIONS; i++) {
		if (passes_on(w, i) && a->value[i])
			ADD("--%s=%s", ob_option_table[i].name, a->value[i]);
	}
	for (uint32_t i = 0; i < a->defines; i++)
		ADD("-D%s", a->define[i]);
	if (*s->define)
		ADD("-D%s", s->define);
	ADD("--");
	ADD("%s", a->operand);
#undef ADD
	return argv;
}

static void free_arguments(char **argv)
{
	for (char **at = argv; at && *at; at++)
		free(*at);
	free(argv);
}

static void announce(ob_crew_run *p, const ob_section *s, const ob_way *w, const char *measure)
{
	p->runs++;
	if (isatty(STDERR_FILENO))
		fprintf(stderr, "\r\033[K%d of %d: %s %s, %s", p->runs, p->runs_planned, s->define, w->title, measure);
}

// false and why, if it did not end well
static bool run_child(ob_crew_run *p, const ob_section *s, ob_way_id id, const char *measure, ob_report *out,
		      char why[256])
{
	const ob_way *w = &ob_way_table[id];
	ob_child_result child = { 0 };
	ob_error e;
	announce(p, s, w, measure);
	char **argv = make_arguments(p, s, w, s->cell[id].workers, measure);
	bool started = argv && ob_child_run(argv, &child, &e), fine = false;
	if (!argv)
		ob_fail(&e, "out of memory");
	if (!started)
		snprintf(why, 256, "%.250s", e.text);
	else if (child.code != 0)
		snprintf(why, 256, "%.250s", *child.complaint ? child.complaint : "it died without a word");
	else if (!ob_report_read_json(out, child.out))
		snprintf(why, 256, "its report cannot be read");
	else
		fine = true;
	ob_child_finish(&child);
	free_arguments(argv);
	return fine;
}

static void take_parts(ob_report *to, const ob_report *from)
{
	to->critical_s = from->critical_s;
	to->work_s = from->work_s;
	to->held_s = from->held_s;
	to->gate_s = from->gate_s;
	to->gate_cpu_s = from->gate_cpu_s;
	to->idle_s = from->idle_s;
	to->elapsed_s = from->elapsed_s;
}

bool ob_crew_run_sample(ob_crew_run *p, ob_section *s, ob_way_id id)
{
	ob_cell *c = &s->cell[id];
	ob_report *r = &c->sample[c->samples], *parts = calloc(1, sizeof *parts);
	bool fine = parts && run_child(p, s, id, "end", r, c->why) && run_child(p, s, id, "profile", parts, c->why);
	if (fine) {
		take_parts(r, parts);
		r->renderer_cpu_s = r->fps = NAN; // nothing was drawn
		c->samples++;
	}
	c->state = fine ? OB_WAY_DONE : OB_WAY_FAILED;
	free(parts);
	return fine;
}

static void take_errors(ob_report *to, const ob_report *from)
{
	to->energy_gain_max = from->energy_gain_max;
	to->momentum_error = from->momentum_error;
	to->worst_penetration_m = from->worst_penetration_m;
	to->worst_penetration_time_s = from->worst_penetration_time_s;
}

// What is measured along one run holds for all that end in the same bits: one is enough for all object simulators.
void ob_crew_run_measured(ob_crew_run *p, ob_section *s, ob_way_id first, ob_way_id last)
{
	ob_report *measured = calloc(1, sizeof *measured);
	char why[256];
	ob_way_id way = first;
	while (way < last && !ob_cell_is_done(s, way))
		way++;
	if (measured && ob_cell_is_done(s, way) && run_child(p, s, way, "step", measured, why)) {
		for (ob_way_id w = first; w <= last; w++)
			for (uint32_t i = 0; i < s->cell[w].samples; i++) {
				ob_report *r = &s->cell[w].sample[i];
				if (strcmp(r->state_hash, measured->state_hash) == 0)
					take_errors(r, measured);
				else
					s->measured_differs = true;
			}
	}
	free(measured);
}

void ob_crew_run_drawn(ob_crew_run *p, ob_section *s, ob_way_id way)
{
	ob_report *drawn = calloc(1, sizeof *drawn);
	char why[256];
	if (drawn && run_child(p, s, way, "frames", drawn, why)) {
		s->cell[way].sample[0].fps = drawn->fps;
		s->cell[way].sample[0].renderer_cpu_s = drawn->renderer_cpu_s;
	}
	free(drawn);
}

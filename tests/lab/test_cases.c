// Cases are measuring instruments: each must read nearly zero for the exact motion, and must reject an engine that
// stands still, has no contacts, or diverges.
#include <string.h>

#include "check.h"
#include "exact.h"
#include "fake_engine.h"
#include "lab/case.h"
#include "lab/scene.h"
#include "measure/measure.h"

static void test_metadata(const ob_case *c)
{
	CHECK(c->row >= 1 && c->row <= 56);
	CHECK(c->name && *c->name && c->name[strspn(c->name, "abcdefghijklmnopqrstuvwxyz0123456789-")] == 0);
	CHECK(ob_case_find(c->name) == c);
	CHECK(strlen(c->title) > 4 && strlen(c->title) < 40);
	CHECK(strlen(c->setup) > 20 && (!c->others || strlen(c->others) > 5));
	CHECK(c->duration > 0);
	CHECK(c->figures >= 1 && c->figures <= OB_FIGURES);
	CHECK(c->text);
	int promised = 0;
	for (uint32_t i = 0; i < c->figures; i++) {
		const ob_figure_def *f = &c->figure[i];
		CHECK(f->name && *f->name && f->unit && *f->unit && f->reference && *f->reference);
		CHECK(f->target >= 0 || isnan(f->target));
		promised += !isnan(f->target);
	}
	CHECK(promised >= 1);
	for (const ob_case *const *other = ob_cases; *other != c; other++) {
		CHECK(strcmp((*other)->name, c->name) && strcmp((*other)->title, c->title));
		CHECK((*other)->row <= c->row);
	}
}

static ob_case_result outcome(const ob_case *c, const ob_engine_kind *kind)
{
	ob_case_result out;
	ob_error e = { "" };
	ob_run_settings s = { .step_length = ob_case_step, .substeps = 1, .iterations = 1 };
	CHECK(ob_case_run(c, kind, &s, &out, &e));
	return out;
}

// True if all promised figures are within their targets.
static bool met(const ob_case *c, const ob_case_result *out)
{
	for (uint32_t i = 0; i < c->figures; i++)
		if (!isnan(c->figure[i].target) && !(out->figure[i] <= c->figure[i].target))
			return false;
	return !*out->failed;
}

static void print(const ob_case *c, const ob_engine_kind *kind, const ob_case_result *out)
{
	fprintf(stderr, "%s, %s:", c->name, kind->name);
	for (uint32_t i = 0; i < c->figures; i++)
		fprintf(stderr, " %.3g %s,", out->figure[i], c->figure[i].unit);
	fprintf(stderr, " %s\n", *out->failed ? out->failed : "did not fail");
}

// Input of each case: its exact motion, and the broken engines that are right there: one if nothing shall move, or one
// without contacts if there are none.
typedef struct expectation {
	const char *name;
	exact_motion motion; // NULL: no closed form known
	enum { ALL_WRONG, FROZEN_IS_RIGHT, BLIND_IS_RIGHT } broken;
} expectation;

static const expectation expected[] = {
	{ "projectile", exact_flight, BLIND_IS_RIGHT },
	{ "head-on", exact_meeting, ALL_WRONG },
	{ "cradle-1", exact_cradle, ALL_WRONG },
	{ "cradle-2", exact_cradle, ALL_WRONG },
	{ "bounce", exact_bounces, ALL_WRONG },
	{ "apexes", exact_bounces, ALL_WRONG },
	{ "bouncing-49", exact_bounces, ALL_WRONG },
	{ "666", NULL, ALL_WRONG },
	{ "elastic-666", NULL, ALL_WRONG },
	{ "rolling-diagonal", exact_push, ALL_WRONG },
	{ "rolling-y", exact_push, ALL_WRONG },
	{ "incline-stick", exact_rest, FROZEN_IS_RIGHT },
	{ "incline-slide", exact_slide, ALL_WRONG },
	{ "sliding", exact_stop, ALL_WRONG },
	{ "slip-to-roll", exact_slip, ALL_WRONG },
	{ "sphere-incline-roll", exact_slide, ALL_WRONG },
	{ "sphere-incline-slip", exact_slide, ALL_WRONG },
	{ "stack-10", exact_rest, FROZEN_IS_RIGHT },
	{ "stack-20", exact_rest, FROZEN_IS_RIGHT },
	{ "stack-40", exact_rest, FROZEN_IS_RIGHT },
	{ "heavy-100", exact_rest, FROZEN_IS_RIGHT },
	{ "heavy-1000", exact_rest, FROZEN_IS_RIGHT },
	{ "heavy-on-stack", exact_rest, FROZEN_IS_RIGHT },
	{ "pyramid-10", exact_rest, FROZEN_IS_RIGHT },
	{ "pyramid-15", exact_rest, FROZEN_IS_RIGHT },
	{ "pile", NULL, ALL_WRONG },
	{ "pile-elastic", NULL, ALL_WRONG },
	{ "falling-100", NULL, ALL_WRONG },
	{ "thin-wall", exact_halt, ALL_WRONG },
	{ "bullets", exact_halt, ALL_WRONG },
	{ "spin", exact_flight, BLIND_IS_RIGHT },
	{ "overhang", exact_rest, FROZEN_IS_RIGHT },
	{ "overhang-over", NULL, ALL_WRONG },
	{ "a-frame-stands", exact_rest, FROZEN_IS_RIGHT },
	{ "a-frame-slides", NULL, ALL_WRONG },
	{ "far-stack", exact_rest, FROZEN_IS_RIGHT },
	{ "far-head-on", exact_meeting, ALL_WRONG },
	{ "lag", exact_meeting, ALL_WRONG },
	{ "hit-wall", NULL, ALL_WRONG },
	{ "plates-plane", exact_plate, ALL_WRONG },
	{ "plates-box", exact_plate, ALL_WRONG },
	{ "discs-plane", exact_plate, ALL_WRONG },
	{ "discs-box", exact_plate, ALL_WRONG },
	{ "drops-plane", exact_drop, ALL_WRONG },
	{ "drops-box", exact_drop, ALL_WRONG },
	{ "drops-round", exact_drop, ALL_WRONG },
	{ "break-smooth", NULL, ALL_WRONG },
	{ "break-rough", NULL, ALL_WRONG },
	{ "oblique", NULL, ALL_WRONG },
	{ "rocking-blocks", NULL, ALL_WRONG },
	{ "rocking-cylinders", NULL, ALL_WRONG },
	{ "rolling-disk", exact_disk, ALL_WRONG },
	{ "near-spin", exact_flight, BLIND_IS_RIGHT },
	{ "spinning-rods", NULL, ALL_WRONG },
	{ "seams-slide", exact_stop, ALL_WRONG },
	{ "seams-roll", exact_roll, ALL_WRONG },
	{ "crib-tower", exact_rest, FROZEN_IS_RIGHT },
	{ "touching-pyramid", exact_rest, FROZEN_IS_RIGHT },
	{ "unbalanced-pull", exact_pull, ALL_WRONG },
	{ "unbalanced-incline", exact_slide, ALL_WRONG },
	{ "unbalanced-brick", NULL, ALL_WRONG },
	{ "round-rest", exact_rest, FROZEN_IS_RIGHT },
	{ "cylinder-stack", exact_rest, FROZEN_IS_RIGHT },
	{ "round-incline", exact_round, ALL_WRONG },
	{ "mixed-pile", NULL, ALL_WRONG },
	{ "random-heaps", NULL, ALL_WRONG },
	{ "shaking-tables", exact_shaken, ALL_WRONG },
	{ "belts", exact_belt, ALL_WRONG },
	{ "turntables", exact_turntable, ALL_WRONG },
	{ "shaken-stack", exact_ridden, ALL_WRONG },
	{ "shaken-pile", NULL, ALL_WRONG },
	{ "arch-stands", exact_rest, FROZEN_IS_RIGHT },
	{ "arch-falls", NULL, ALL_WRONG },
	{ "pendulum-90", NULL, ALL_WRONG },
	{ "pendulum-179", NULL, ALL_WRONG },
	{ "double-pendulum", NULL, ALL_WRONG },
	{ "spherical-pendulum", NULL, ALL_WRONG },
	{ "top", NULL, ALL_WRONG },
	{ "chain-100", NULL, ALL_WRONG },
	{ "four-bar", NULL, ALL_WRONG },
	{ "slider-crank", NULL, ALL_WRONG },
	{ "furuta", NULL, ALL_WRONG },
	{ "bricard", NULL, ALL_WRONG },
	{ "breaking-door", NULL, ALL_WRONG },
	{ "plank-bridge", NULL, ALL_WRONG },
	{ "ragdoll", NULL, ALL_WRONG },
	{ "car", NULL, ALL_WRONG },
};

// No case begins with penetrations: an engine is not responsible for its input. (In SimBenchmark's rolling scene all
// are .02 mm deep in their supports.)
static void test_start(const ob_case *c)
{
	double deepest = 0; // m, over all runs
	for (uint32_t run = 0; run < ob_case_runs(c); run++) {
		ob_world w;
		ob_snapshot start = { 0 };
		ob_penetration p;
		ob_scene *scene = ob_lab_scene_load(c, run, &w, &(ob_error){ "" });
		CHECK(scene && ob_lab_snapshot_begin(&start, &w));
		ob_lab_snapshot_take(&start, 0, w.state);
		ob_measure_penetration(&start, &p);
		ob_figure_keep(&deepest, p.max_m);
		ob_lab_snapshot_end(&start);
		ob_world_finish(&w);
		ob_scene_free(scene);
	}
	if (!(deepest <= 50e-6))
		fprintf(stderr, "%s begins %g m deep\n", c->name, deepest);
	CHECK(deepest <= 50e-6);
}

static void test_exact(const ob_case *c, const expectation *x)
{
	ob_case_result out = outcome(c, &exact_engine);
	if (x->motion && !met(c, &out))
		print(c, &exact_engine, &out);
	CHECK(!x->motion || met(c, &out));
	CHECK(out.body_seconds >= c->duration * .99 && out.cpu_s >= 0 && out.wall_s >= 0);
}

static void test_broken(const ob_case *c, const ob_engine_kind *kind, bool is_right)
{
	ob_case_result out = outcome(c, kind);
	if (met(c, &out) != is_right)
		print(c, kind, &out);
	CHECK(met(c, &out) == is_right);
}

// A broken engine is reported, and no figure looks good.
static void test_mad(const ob_case *c, const ob_engine_kind *kind, const char *why)
{
	ob_case_result out = outcome(c, kind);
	CHECK(!strncmp(out.failed, why, strlen(why)));
	for (uint32_t i = 0; i < c->figures; i++)
		CHECK(isinf(out.figure[i]));
	CHECK(out.body_seconds > 0);
}

// ---- calibration: errors of a known size must be measured as such

static ob_state one_millimetre_off(const ob_world *w, uint32_t id, double t)
{
	ob_state s = exact_flight(w, id, t);
	s.pose.p.y += 1e-3;
	return s;
}

// Body i sinks by i times .2 mm, so that each touches the one below, and moves aside by 30 um.
static ob_state sunk(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	s.pose.p.z -= .2e-3 * id;
	s.pose.p.y += 30e-6;
	return s;
}

static ob_state pushed_too_fast(const ob_world *w, uint32_t id, double t)
{
	ob_state s = exact_push(w, id, t);
	s.v.z += .01;
	return s;
}

static ob_state turned(const ob_world *w, uint32_t id, double t)
{
	ob_state s = exact_flight(w, id, t);
	s.pose.q = ob_quat_turn(s.pose.q, ob_v3(0, 1e-3, 0));
	return s;
}

static ob_state creeping(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	s.pose.p.y += id * 1e-6 * t;
	return s;
}

static ob_state stopping_late(const ob_world *w, uint32_t id, double t)
{
	ob_state s = exact_stop(w, id, t / 1.002);
	s.v = ob_scale(s.v, 1 / 1.002);
	return s;
}

static ob_state stopping_farther(const ob_world *w, uint32_t id, double t)
{
	ob_state s = exact_stop(w, id, t);
	s.pose.p = ob_madd(s.pose.p, .002, ob_sub(s.pose.p, w->state[id].pose.p));
	return s;
}

static ob_state bouncing_high(const ob_world *w, uint32_t id, double t)
{
	ob_state s = exact_bounces(w, id, t);
	s.pose.p.z += id ? .01 : 0;
	return s;
}

static const struct calibration {
	const char *name;
	uint32_t figure;
	double expected; // in the unit of the figure
	exact_motion motion;
} calibrations[] = {
	{ "projectile", 0, 1e-3, one_millimetre_off },
	{ "stack-10", 0, .2, sunk },
	{ "stack-10", 1, .03, sunk },
	{ "stack-10", 3, .2 * 1200 / 1201, sunk }, // the start counts
	{ "far-stack", 1, 11 * .2e-3, sunk },
	{ "rolling-y", 0, 2e-4, pushed_too_fast },
	{ "spin", 2, 1e-3, turned },
	{ "incline-stick", 0, .01, creeping },
	{ "sliding", 0, 2e-3, stopping_farther },
	{ "sliding", 1, 2e-3, stopping_late },
	{ "apexes", 0, .01, bouncing_high },
	{ "bouncing-49", 0, 49 * 9.81 * 49 * 9.81 * .01, bouncing_high },
};

static void test_calibration(const struct calibration *k)
{
	const ob_case *c = ob_case_find(k->name);
	exact_engine_use(k->motion);
	ob_case_result out = outcome(c, &exact_engine);
	CHECK_NEAR(out.figure[k->figure] / k->expected, 1, 1e-6);
}

// The names on the command line are those that run as tests.
static void test_quick_list(int argc, char **argv)
{
	int quick = 0;
	for (const ob_case *const *c = ob_cases; *c; c++)
		quick += !(*c)->slow;
	CHECK(argc - 1 == quick);
	for (int i = 1; i < argc; i++) {
		const ob_case *c = ob_case_find(argv[i]);
		CHECK(c && !c->slow);
		for (int k = 1; k < i; k++)
			CHECK(strcmp(argv[i], argv[k]));
	}
}

int main(int argc, char **argv)
{
	CHECK(ob_cases_open(NULL, 0, &(ob_error){ "" }));
	test_quick_list(argc, argv);
	for (const ob_case *const *c = ob_cases; *c; c++) {
		const expectation *x = NULL;
		for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
			if (!strcmp(expected[i].name, (*c)->name))
				x = &expected[i];
		CHECK(x);
		test_metadata(*c);
		if (!x)
			continue;
		exact_engine_use(x->motion ? x->motion : exact_rest);
		test_start(*c);
		test_exact(*c, x);
		test_broken(*c, &frozen_engine, x->broken == FROZEN_IS_RIGHT);
		test_broken(*c, &blind_engine, x->broken == BLIND_IS_RIGHT);
		test_mad(*c, &drunk_engine, "became not a number");
		test_mad(*c, &bursting_engine, "exploded");
		test_mad(*c, &dying_engine, "the engine gave up");
	}
	for (size_t i = 0; i < sizeof calibrations / sizeof *calibrations; i++)
		test_calibration(&calibrations[i]);
	CHECK(!ob_case_find("no-such-case"));
	return check_end();
}

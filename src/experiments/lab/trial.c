#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "lab/scene.h"

// m/s and rad/s: faster than any motion in any case, including endless falls within its time.
static const double absurd = 1e5;

static double cpu_of(const ob_engine_kind *kind, const ob_engine *engine)
{
	return ob_clock_thread_cpu() + (kind->cpu ? kind->cpu(engine) : 0);
}

// State of one run of a case with one engine.
typedef struct trial {
	uint64_t frame; // completed frames: 0 before the first step
	ob_world world; // as the run begins
	ob_snapshot now;
	double figure[OB_FIGURES]; // in the case's units
	const char *failed; // reason for which the run counts as failed: "fell", "passed through"; NULL = success
	ob_run_settings settings;
	ob_scene *scene;
	ob_error wrong; // a function of the scene failed; "" = none
} trial;

void ob_figure_keep(double *figure, double value)
{
	if (!(value <= *figure) && !isnan(*figure))
		*figure = value;
}

static const char *insane(const trial *t)
{
	for (uint32_t id = 0; id < t->world.objects; id++) {
		const ob_motion *m = &t->now.motion[id];
		if (!ob_is_finite(m->p) || !ob_is_finite(m->v) || !ob_is_finite(m->w) ||
		    !isfinite(m->q.w + m->q.x + m->q.y + m->q.z))
			return "became not a number";
		if (ob_norm(m->v) > absurd || ob_norm(m->w) > absurd)
			return "exploded";
	}
	return NULL;
}

// Takes the snapshot of an engine without a universe: states at this very time.
static void take(trial *t, ob_state *state)
{
	t->now.step = t->frame;
	ob_lab_snapshot_take(&t->now, t->frame * t->settings.step_length, state);
}

static void observe(trial *t)
{
	ob_expected *x = t->scene->expected;
	if (!ob_expected_look(x, &t->now, &t->settings, &t->wrong))
		t->failed = t->wrong.text;
	else if (*x->failed)
		t->failed = x->failed;
}

static void judge(trial *t)
{
	ob_expected *x = t->scene->expected;
	if (!*t->wrong.text && !ob_expected_end(x, &t->now, &t->settings, &t->wrong))
		t->failed = t->wrong.text;
	for (uint32_t i = 0; i < x->count; i++)
		t->figure[i] = x->expectation[i].value;
	if (*x->failed)
		t->failed = x->failed;
}

// False and e: the engine lacks a feature of the world.
static bool takes(const ob_engine_kind *kind, const ob_world *w, ob_error *e)
{
	if (kind->drives < ob_world_drives(w))
		return ob_fail(e, "takes no bodies that move as they are told");
	if (w->hulls && !kind->hulls)
		return ob_fail(e, "takes no hulls");
	if (w->joints && !kind->takes_joints)
		return ob_fail(e, "takes no joints");
	return !w->joints || kind->takes_joints(w, e);
}

// Runs to the end or to the first failure, by the case's judgement or an invalid state. Only stepping is timed. e: why there
// is no engine.
static void watch(trial *t, const ob_case *c, ob_engine *engine, const ob_engine_kind *kind, ob_state *state,
		  ob_case_result *out, ob_error *e)
{
	uint64_t frames = (uint64_t)lround(c->duration / t->settings.step_length);
	t->failed = engine ? NULL : e->text;
	bool broken = t->failed;
	ob_conservation conserved = ob_conservation_begin(&t->world);
	take(t, t->world.state);
	ob_conservation_look(&conserved, &t->now, 0);
	if (!broken)
		observe(t);
	while (!t->failed && t->frame < frames) {
		double cpu = cpu_of(kind, engine), wall = ob_clock_wall();
		bool on = kind->step(engine, e);
		out->cpu_s += cpu_of(kind, engine) - cpu;
		out->wall_s += ob_clock_wall() - wall;
		t->frame++;
		kind->get(engine, state);
		take(t, state);
		t->failed = on ? insane(t) : e->text;
		broken = t->failed;
		if (!broken)
			ob_conservation_look(&conserved, &t->now, kind->recovered ? kind->recovered(engine) : 0);
		if (!broken)
			observe(t);
	}
	if (!broken)
		judge(t);
	for (uint32_t i = 0; broken && i < c->figures; i++)
		t->figure[i] = INFINITY;
	for (int i = 0; broken && i < OB_CONSERVED; i++)
		conserved.worst[i] = INFINITY;
	ob_conservation_keep(out->conserved, conserved.worst);
}

static double body_seconds(const trial *t)
{
	uint32_t bodies = 0;
	for (uint32_t id = 0; id < t->world.objects; id++)
		bodies += !(t->world.passport[id].flags & OB_OBJECT_PRESCRIBED);
	return bodies * t->now.time;
}

// Adds the worst over the runs, or their mean.
static void add_figures(const ob_case *c, double *sum, const double *figure)
{
	for (uint32_t i = 0; i < c->figures; i++) {
		if (c->averaged >> i & 1)
			sum[i] += figure[i] / ob_case_runs(c);
		else
			ob_figure_keep(&sum[i], figure[i]);
	}
}

typedef struct tally {
	uint32_t failed; // runs
	char why[96]; // the first reason
} tally;

static bool run(const ob_case *c, uint32_t number, const ob_engine_kind *kind, const ob_run_settings *s,
		ob_case_result *out, tally *failures, ob_error *e)
{
	trial t = { .settings = *s };
	t.scene = ob_lab_scene_load(c, number, &t.world, e);
	if (!t.scene)
		return false;
	t.settings.step_length = s->step_length > 0 ? s->step_length : ob_case_step;
	t.settings.sleeping |= c->sleeps;
	ob_state *state = calloc(t.world.objects, sizeof *state);
	ob_engine *engine = NULL;
	bool made = ob_lab_snapshot_begin(&t.now, &t.world) && state;
	ob_error broke = { "" };
	if (!made) {
		ob_fail(e, "no memory for a world of %u bodies", t.world.objects);
	} else if (takes(kind, &t.world, &broke)) {
		engine = kind->create(&t.world, &t.settings, e);
		made = engine;
	}
	if (made) {
		watch(&t, c, engine, kind, state, out, &broke);
		kind->destroy(engine);
		add_figures(c, out->figure, t.figure);
		out->body_seconds += body_seconds(&t);
		if (t.failed && !failures->failed++)
			snprintf(failures->why, sizeof failures->why, "%s", t.failed);
	}
	if (*t.wrong.text) {
		made = false;
		*e = t.wrong;
	}
	free(state);
	ob_lab_snapshot_end(&t.now);
	ob_scene_free(t.scene);
	ob_world_finish(&t.world);
	return made;
}

bool ob_case_run(const ob_case *c, const ob_engine_kind *kind, const ob_run_settings *s, ob_case_result *out,
		 ob_error *e)
{
	tally failures = { 0 };
	*out = (ob_case_result){ 0 };
	for (int i = 0; i < OB_CONSERVED; i++)
		out->conserved[i] = NAN;
	for (uint32_t i = 0; i < ob_case_runs(c); i++)
		if (!run(c, i, kind, s, out, &failures, e))
			return false;
	if (failures.failed && c->runs > 1)
		snprintf(out->failed, sizeof out->failed, "%.58s (%u of %u runs)", failures.why, failures.failed,
			 c->runs);
	else
		snprintf(out->failed, sizeof out->failed, "%s", failures.why);
	return true;
}

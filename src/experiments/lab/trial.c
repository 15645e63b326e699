#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "lab/look.h"
#include "world/world.h"

// m/s and rad/s: faster than any motion in any case, including endless falls within its time.
static const double absurd = 1e5;

static double cpu_of(const ob_engine_kind *kind, const ob_engine *engine)
{
	return ob_clock_thread_cpu() + (kind->cpu ? kind->cpu(engine) : 0);
}

static const char *insane(const ob_case_run_state *t)
{
	for (uint32_t id = 0; id < t->world->objects; id++) {
		ob_state s = ob_look_at(t, id);
		ob_quat q = s.pose.q;
		if (!ob_is_finite(s.pose.p) || !ob_is_finite(s.v) || !ob_is_finite(s.w) ||
		    !isfinite(q.w + q.x + q.y + q.z))
			return "became not a number";
		if (ob_norm(s.v) > absurd || ob_norm(s.w) > absurd)
			return "exploded";
	}
	return NULL;
}

// Takes the snapshot of an engine without a universe: states at this very time.
static void take(ob_case_run_state *t, ob_state *state)
{
	t->now.state = state;
	t->now.step = t->frame;
	t->now.time = t->time;
	for (uint32_t id = 0; id < t->world->objects; id++) {
		const ob_state *s = &state[id];
		t->now.motion[id] =
			(ob_motion){ .t0 = t->time, .valid_until = INFINITY, .p = s->pose.p, .q = s->pose.q };
		t->now.motion[id].v = s->v;
		t->now.motion[id].w = s->w;
	}
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
static void watch(ob_case_run_state *t, ob_engine *engine, const ob_engine_kind *kind, ob_state *state,
		  ob_case_result *out, ob_error *e)
{
	const ob_case *c = t->of;
	uint64_t frames = (uint64_t)lround(c->duration / t->settings.step_length);
	t->failed = engine ? NULL : e->text;
	bool broken = t->failed;
	ob_conservation conserved = ob_conservation_begin(t->world);
	take(t, t->world->state);
	ob_conservation_look(&conserved, &t->now, 0);
	if (c->observe && !broken)
		c->observe(t);
	while (!t->failed && t->frame < frames) {
		double cpu = cpu_of(kind, engine), wall = ob_clock_wall();
		bool on = kind->step(engine, e);
		out->cpu_s += cpu_of(kind, engine) - cpu;
		out->wall_s += ob_clock_wall() - wall;
		t->frame++;
		t->time = t->frame * t->settings.step_length;
		kind->get(engine, state);
		take(t, state);
		t->failed = on ? insane(t) : e->text;
		broken = t->failed;
		if (!broken)
			ob_conservation_look(&conserved, &t->now, kind->recovered ? kind->recovered(engine) : 0);
		if (!broken && c->observe)
			c->observe(t);
	}
	if (!broken)
		c->judge(t);
	for (uint32_t i = 0; broken && i < c->figures; i++)
		t->figure[i] = INFINITY;
	for (int i = 0; broken && i < OB_CONSERVED; i++)
		conserved.worst[i] = INFINITY;
	ob_conservation_keep(out->conserved, conserved.worst);
}

static double body_seconds(const ob_case_run_state *t)
{
	uint32_t bodies = 0;
	for (uint32_t id = 0; id < t->world->objects; id++)
		bodies += ob_look_moves(t, id);
	return bodies * t->time;
}

// Adds the worst over the runs, or their mean.
static void add_figures(const ob_case *c, double *sum, const double *figure)
{
	for (uint32_t i = 0; i < c->figures; i++) {
		if (c->averaged >> i & 1)
			sum[i] += figure[i] / ob_case_runs(c);
		else
			ob_look_keep(&sum[i], figure[i]);
	}
}

typedef struct tally {
	uint32_t failed; // runs
	char why[96]; // the first reason
} tally;

static bool run(const ob_case *c, uint32_t number, const ob_engine_kind *kind, const ob_run_settings *s,
		ob_case_result *out, tally *failures, ob_error *e)
{
	ob_world w;
	ob_case_run_state t = { .of = c, .run = number, .world = &w, .settings = *s };
	if (!ob_case_build(c, number, &w, &t.scene, e))
		return false;
	t.settings.step_length = s->step_length > 0 ? s->step_length : ob_case_step;
	t.settings.sleeping |= c->sleeps;
	t.now = (ob_snapshot){
		.count = w.objects, .passport = w.passport, .hulls = w.hulls, .joint = w.joint, .joints = w.joints
	};
	t.now.motion = calloc(w.objects, sizeof *t.now.motion);
	t.now.hull = calloc(w.hulls + 1, sizeof(ob_hull *));
	for (uint32_t i = 0; i < w.hulls && t.now.hull; i++)
		t.now.hull[i] = &w.hull[i];
	ob_state *state = calloc(w.objects, sizeof *state);
	ob_engine *engine = NULL;
	bool made = t.now.motion && t.now.hull && state;
	ob_error broke = { "" };
	if (!made) {
		ob_fail(e, "no memory for a world of %u bodies", w.objects);
	} else if (takes(kind, &w, &broke)) {
		engine = kind->create(&w, &t.settings, e);
		made = engine;
	}
	if (made) {
		watch(&t, engine, kind, state, out, &broke);
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
	ob_scene_free(t.scene);
	free(t.now.motion);
	free(t.now.hull);
	free(state);
	ob_world_finish(&w);
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

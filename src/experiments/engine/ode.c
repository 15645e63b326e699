// ODE with the setup of most of its users: one world that holds everything (ode/ode_world.h). Three engines use its
// defaults: QuickStep, the same with a hash space, and dWorldStep.
//
// "ode-advised" is QuickStep as ODE's manual ("World", "Concepts") and its demonstration of box stacks
// (demo_boxstack.cpp) set it up against jitter and near-singular systems:
// - dWorldSetContactSurfaceLayer .001: the manual's own figure "to prevent jittering problems due to contacts being
//   repeatedly made and broken";
// - dWorldSetContactMaxCorrectingVel .1, as in the demonstration, against "popping" of deeply embedded bodies;
// - dWorldSetCFM 1e-5 per kg of the lightest body. The demonstration's 1e-5 is for bodies of about a kilogram;
//   under a tonne it would give way by centimetres;
// - ERP .2, twenty iterations with an over-relaxation of 1.3, gyroscopic torques, and auto-disabling if sleeping is
//   requested: these recommendations of the manual are the defaults already.
//
// Recommendations that dissipate energy are left out: damping, and a soft contact. Its warm start is a compile-time
// option, and not set.
#include <math.h>
#include <stdlib.h>

#include "ode/ode_body.h"
#include "ode/ode_world.h"
#include "engine/world.h"
#include "engine/engines.h"

static _Thread_local unsigned users;

void ob_engine_ode_enter(void)
{
	if (users++ == 0)
		ob_ode_thread_init();
}

void ob_engine_ode_leave(void)
{
	if (--users == 0)
		ob_ode_thread_finish();
}

struct ob_engine {
	ob_ode_world *world;
	ob_drive drive;
	uint64_t steps; // substeps, so far
	double substep; // s
	uint32_t substeps, objects, joints;
	ob_joint_passport *joint; // [joints]
	uint32_t *first, *next; // [objects], [2 joints]: lists of ends of joints, 1 + 2 joint + side
};

static void destroy(ob_engine *p)
{
	if (!p)
		return;
	ob_ode_world_destroy(p->world);
	ob_drive_finish(&p->drive);
	free(p->joint);
	free(p->first);
	free(p->next);
	free(p);
	ob_engine_ode_leave();
}

// Objects that a joint holds do not touch each other, unless it says so.
static bool may_touch(const void *engine, uint32_t a, uint32_t b)
{
	const ob_engine *p = engine;
	for (uint32_t i = p->first[a]; i; i = p->next[i - 1]) {
		const ob_joint_passport *j = &p->joint[(i - 1) / 2];
		if (j->object[i % 2] == b && !(j->flags & OB_JOINT_COLLIDES))
			return false;
	}
	return true;
}

static bool join(ob_engine *p, const ob_world *w)
{
	p->joint = calloc(w->joints + 1, sizeof *p->joint);
	p->first = calloc(w->objects + 1, sizeof *p->first);
	p->next = calloc(w->joints + 1, 2 * sizeof *p->next);
	if (!p->joint || !p->first || !p->next)
		return false;
	for (uint32_t i = 0; i < w->joints; i++) {
		const ob_joint_passport *j = &w->joint[i];
		p->joint[p->joints++] = *j;
		for (uint32_t end = 2 * i; end < 2 * i + 2; end++) {
			if (j->object[end % 2] == OB_JOINT_WORLD)
				continue;
			p->next[end] = p->first[j->object[end % 2]];
			p->first[j->object[end % 2]] = end + 1;
		}
		if (j->kind != OB_JOINT_APART && !ob_ode_world_join(p->world, i, j))
			return false;
	}
	return true;
}

// setup: differences between the kinds. Its iterations are QuickStep's; 0 = dWorldStep
static ob_engine *create(const ob_world *w, const ob_run_settings *s, ob_ode_world_setup setup, ob_error *e)
{
	if (!(s->step_length > 0) || !s->substeps) {
		ob_fail(e, "%u substeps of a step of %g s: ODE must be told what to do", s->substeps, s->step_length);
		return NULL;
	}
	if (w->hulls > 0) { // ODE has convex geometries, but no contacts between them and boxes
		ob_fail(e, "there are hulls, which ODE's world does not have here");
		return NULL;
	}
	ob_engine *p = calloc(1, sizeof *p);
	if (!p) {
		ob_fail(e, "no memory for an engine");
		return NULL;
	}
	ob_engine_ode_enter();
	*p = (ob_engine){ .substep = s->step_length / s->substeps, .substeps = s->substeps, .objects = w->objects };
	setup.gravity = w->gravity;
	setup.objects = w->objects;
	setup.sleeping = s->sleeping;
	setup.joints = w->joints;
	setup.may_touch = w->joints ? may_touch : NULL;
	setup.of = p;
	p->world = ob_ode_world_create(&setup);
	if (!p->world || !ob_drive_init(&p->drive, w)) {
		ob_fail(e, "no memory for a world of %u bodies", w->objects);
		destroy(p);
		return NULL;
	}
	for (uint32_t i = 0; i < w->objects; i++)
		ob_ode_world_add(p->world, &w->passport[i], &w->state[i]);
	if (join(p, w))
		return p;
	ob_fail(e, "no memory for %u joints", w->joints);
	destroy(p);
	return NULL;
}

static ob_engine *create_iterating(const ob_world *w, const ob_run_settings *s, ob_ode_world_setup setup, ob_error *e)
{
	setup.iterations = s->iterations;
	if (s->iterations)
		return create(w, s, setup, e);
	ob_fail(e, "QuickStep without iterations: at least one is needed");
	return NULL;
}

static ob_engine *create_quick(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create_iterating(w, s, (ob_ode_world_setup){ 0 }, e);
}

static ob_engine *create_hashed(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create_iterating(w, s, (ob_ode_world_setup){ .hashed = true }, e);
}

static ob_engine *create_advised(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	ob_ode_world_setup advised = { .surface_layer = 1e-3, .correcting_speed = .1 };
	double lightest = INFINITY; // kg
	for (uint32_t i = 0; i < w->objects; i++)
		if (w->passport[i].mass > 0)
			lightest = fmin(lightest, w->passport[i].mass);
	advised.softness = 1e-5 / lightest;
	return create_iterating(w, s, advised, e);
}

static ob_engine *create_world(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create(w, s, (ob_ode_world_setup){ 0 }, e);
}

static bool step(ob_engine *p, ob_error *e)
{
	for (uint32_t i = 0; i < p->substeps; i++, p->steps++) {
		for (uint32_t k = 0; k < p->drive.count; k++) {
			ob_state s = ob_drive_step(&p->drive, k, (double)p->steps * p->substep, p->substep);
			ob_ode_world_drive(p->world, p->drive.body[k].id, &s);
		}
		for (uint32_t k = 0; k < p->joints; k++)
			ob_ode_world_drive_joint(p->world, k, &p->joint[k].axis, p->substep);
		if (!ob_ode_world_step(p->world, p->substep)) {
			bool full;
			uint32_t culprit = ob_ode_world_culprit(p->world, &full);
			return ob_fail(e,
				       full ? "no memory for the contacts; body %u has most" : "ODE gave up at body %u",
				       culprit);
		}
	}
	return true;
}

static void get(const ob_engine *p, ob_state *state)
{
	bool asleep, touching;
	for (uint32_t i = 0; i < p->objects; i++)
		ob_ode_world_get(p->world, i, &state[i], &asleep, &touching);
}

static bool takes_joints(const ob_world *w, ob_error *e)
{
	for (uint32_t i = 0; i < w->joints; i++) {
		const ob_joint_passport *j = &w->joint[i];
		if (!ob_ode_has_joint(j))
			return ob_fail(e, "its joints do not have what acts along %s", j->name);
		if (!ob_engine_joint_lasts(j, e))
			return false;
	}
	return true;
}

#define THE_REST \
	.version = OB_ODE_VERSION, .step = step, .get = get, .destroy = destroy, .drives = OB_WORLD_DRIVES_SURFACES, \
	.takes_joints = takes_joints
#define QUICK \
	.usual = { .step_length = OB_DEFAULT_STEP, .substeps = 1, .iterations = OB_DEFAULT_MONOLITH_ITERATIONS }, \
	.iteration_choice = { 5, 10, 20, 50, 100, 200, 500 }

const ob_engine_kind ob_engine_ode_quick = {
	.name = "ode-quick",
	.title = "ODE QuickStep",
	.create = create_quick,
	QUICK,
	THE_REST,
};

const ob_engine_kind ob_engine_ode_advised = {
	.name = "ode-advised",
	.title = "ODE QuickStep, as advised",
	.create = create_advised,
	QUICK,
	THE_REST,
};

const ob_engine_kind ob_engine_ode_hash = {
	.name = "ode-hash",
	.title = "ODE QuickStep, hash space",
	.create = create_hashed,
	QUICK,
	THE_REST,
};

const ob_engine_kind ob_engine_ode_world = {
	.name = "ode-world",
	.title = "ODE dWorldStep",
	.usual = { .step_length = OB_DEFAULT_STEP, .substeps = 1 },
	.create = create_world,
	THE_REST,
};

// An island solved from a literal: no universe, shared memory or worker.
#include "solver/solver.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"

enum { CUBES = 10, PLANE = CUBES, STEPS = 60 };

static const double side = 1, mass = 2, step_length = 1. / 60;

// State of an island that its caller keeps from step to step.
typedef struct tower {
	ob_passport passport[CUBES + 1];
	ob_motion motion[CUBES + 1];
	ob_found_contact contact[CUBES]; // cube k against what is below it
	ob_solver solver;
	uint32_t reported; // motions of the step
} tower;

static bool spend(void *with, uint64_t work)
{
	return false;
}

static void begin_attempt(void *with) {}

static void touch(void *with, uint32_t a, uint32_t b, double impulse, ob_vec3 point)
{
	CHECK(false); // none was asked for
}

static void fail(void *with, uint32_t object)
{
	CHECK(false);
}

static void keep_contact(void *with, const ob_found_contact *c)
{
	((tower *)with)->contact[c->pair] = *c;
}

static void keep_motion(void *with, const ob_island_object *object, ob_motion *m, bool free)
{
	tower *t = with;
	CHECK(object->id < CUBES);
	t->motion[object->id] = *m;
	t->reported++;
}

static tower *create(double gravity)
{
	tower *t = calloc(1, sizeof *t);
	static ob_run_settings run;
	run = ob_run_settings_default();
	run.gravity = ob_v3(0, 0, -gravity);
	run.step_length = step_length;
	for (int k = 0; k < CUBES; k++) {
		const double inertia = mass * side * side / 6;
		t->passport[k] = (ob_passport){ .id = (uint32_t)k,
						.flags = OB_OBJECT_PRESENT,
						.shape = OB_SHAPE_BOX,
						.size = ob_v3(side / 2, side / 2, side / 2),
						.mass = mass,
						.inertia = ob_v3(inertia, inertia, inertia),
						.friction = .5 };
		t->motion[k] = (ob_motion){ .p = ob_v3(0, 0, side * (k + .5)), .q = { 1, 0, 0, 0 } };
		t->contact[k].limit = -INFINITY;
	}
	t->passport[PLANE] = (ob_passport){
		.id = PLANE, .flags = OB_OBJECT_PRESENT | OB_OBJECT_STATIC, .shape = OB_SHAPE_PLANE, .friction = .5
	};
	t->motion[PLANE] = (ob_motion){ .q = { 1, 0, 0, 0 } };
	const ob_island_calls calls = { t, spend, NULL, begin_attempt, touch, fail, keep_contact, NULL, keep_motion };
	if (!ob_solver_create(&t->solver, &run, &calls, CUBES))
		abort();
	return t;
}

static void destroy(tower *t)
{
	ob_solver_finish(&t->solver);
	free(t);
}

// Moves the cubes through a step. With the ground, the first stands on the plane; without, they are alone.
static void step(tower *t, uint64_t steps, bool ground)
{
	ob_island_object object[CUBES + 1];
	ob_island_pair pair[CUBES];
	ob_found_contact before[CUBES];
	uint32_t pairs = 0;
	memcpy(before, t->contact, sizeof before);
	for (uint32_t k = 0; k <= CUBES; k++) {
		const ob_motion *m = &t->motion[k];
		object[k] = (ob_island_object){ .id = k,
						.passport = &t->passport[k],
						.motion = m,
						.now = { { m->p, m->q }, m->v, m->w },
						.path = m->path };
	}
	for (uint32_t k = ground ? 0 : 1; k < CUBES; k++)
		pair[pairs++] = (ob_island_pair){ .pair = k,
						  .a = k ? k - 1 : 0,
						  .b = k ? k : PLANE,
						  .fixed = k ? OB_NO_FIXED : PLANE,
						  .limit = before[k].limit,
						  .kept = before[k].kept,
						  .newest = before[k].kept,
						  .before = before[k].kept ? &before[k].state : NULL };
	const ob_island_input in = { .step = steps,
				     .members = CUBES,
				     .objects = ground ? CUBES + 1 : CUBES,
				     .pairs = pairs,
				     .object = object,
				     .pair = pair };
	t->reported = 0;
	ob_island_solve(&t->solver, &in);
	CHECK(t->reported == CUBES);
}

// The tower stands, and the ground carries its weight.
static void test_weight(void)
{
	tower *t = create(9.81);
	for (uint64_t i = 0; i < STEPS; i++)
		step(t, i, true);
	for (int k = 0; k < CUBES; k++)
		CHECK_NEAR(t->motion[k].p.z, side * (k + .5), 1e-3);
	const ob_pair_state *ground = &t->contact[0].state;
	double force = 0;
	for (int j = 0; j < ground->points; j++)
		force += ground->impulse[j] / ground->substep;
	CHECK(t->contact[0].active);
	CHECK_NEAR(force, CUBES * mass * 9.81, 1e-3 * CUBES * mass * 9.81);
	destroy(t);
}

static void shoot_first(tower *t)
{
	t->motion[0].v = ob_v3(.3, -.2, 3);
	t->motion[0].w = ob_v3(.1, .2, -.1);
}

// Without ground and gravity, momentum stays whatever the cubes do to each other.
static void test_momentum(void)
{
	tower *t = create(0);
	shoot_first(t);
	for (uint64_t i = 0; i < STEPS; i++)
		step(t, i, false);
	ob_vec3 sum = { 0, 0, 0 };
	for (int k = 0; k < CUBES; k++)
		sum = ob_add(sum, t->motion[k].v);
	CHECK_NEAR(sum.x, .3, 1e-12);
	CHECK_NEAR(sum.y, -.2, 1e-12);
	CHECK_NEAR(sum.z, 3, 1e-12);
	CHECK(t->motion[CUBES - 1].v.z > .01); // the last one has been hit, too
	destroy(t);
}

// A solver that has solved other islands finds the same bits as a new one.
static void test_memory(void)
{
	tower *used = create(9.81), *fresh = create(9.81);
	shoot_first(used);
	for (uint64_t i = 0; i < STEPS; i++)
		step(used, i, true);
	memcpy(used->motion, fresh->motion, sizeof used->motion);
	memcpy(used->contact, fresh->contact, sizeof used->contact);
	for (uint64_t i = 0; i < STEPS; i++) {
		step(used, i, true);
		step(fresh, i, true);
	}
	CHECK(memcmp(used->motion, fresh->motion, sizeof used->motion) == 0);
	CHECK(memcmp(used->contact, fresh->contact, sizeof used->contact) == 0);
	destroy(used);
	destroy(fresh);
}

int main(void)
{
	test_weight();
	test_momentum();
	test_memory();
	return check_end();
}

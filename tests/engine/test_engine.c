// All engines simulate the given world alike. The bounds are wide enough for the crudest of them at its usual
// iterations. They are narrow enough to detect another friction, restitution, size, mass or force.
//
// test_engine NAME    77 (skipped): not built in
#include <stdlib.h>
#include <string.h>

#include "little_world.h"

#include "../check.h"
#include "world/builders.h"

static const ob_engine_kind *kind;

static bool is(const char *name)
{
	return strcmp(kind->name, name) == 0;
}

// Each has its lowest point .1 m above the ground; stable ones come to rest upright.
static void rest(void)
{
	little_world *l = little_world_new();
	little_ground(l);
	uint32_t cube = little_cube(l, 1000, .5, ob_v3(0, 0, .6));
	uint32_t ball = little_sphere(l, 1, .3, ob_v3(5, 0, .4));
	uint32_t drum = little_add(l, OB_SHAPE_CYLINDER, ob_v3(.4, .25, 0), 10, ob_v3(10, 0, .35));
	uint32_t pill = little_add(l, OB_SHAPE_CAPSULE, ob_v3(.2, .5, 0), 10, ob_v3(15, 0, .3));
	l->world.state[pill].pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, asin(1), 0));
	uint32_t shelf = little_cube(l, 0, .5, ob_v3(20, 0, 3));
	uint32_t top = little_cube(l, 2, .2, ob_v3(20, 0, 3.8));
	little_run(kind, l, 4, 3);
	double height[] = { [0] = 0, .5, .3, .25, .2, 3, 3.7 };
	uint32_t id[] = { 0, cube, ball, drum, pill, shelf, top };
	for (int i = 1; i < 7; i++) {
		CHECK_NEAR(l->now[id[i]].pose.p.z, height[i], .01);
		CHECK(ob_norm(l->now[id[i]].v) < .02);
	}
	CHECK(memcmp(&l->now[shelf], &l->world.state[shelf], sizeof(ob_state)) == 0);
	CHECK_NEAR(l->now[top].pose.p.x, 20, .01);
	little_world_free(l);
}

// A capsule that stands on its end for a moment, and a ball that slips at first. The ball ends up rolling with 5/7 of
// its speed, which tests its inertia.
static void upright_and_rolling(void)
{
	little_world *l = little_world_new();
	little_ground(l);
	uint32_t pill = little_add(l, OB_SHAPE_CAPSULE, ob_v3(.2, .5, 0), 10, ob_v3(0, 0, .7));
	uint32_t ball = little_sphere(l, 3, .2, ob_v3(5, 0, .2));
	l->world.state[ball].v.x = 2;
	little_run(kind, l, 4, .2);
	CHECK_NEAR(l->now[pill].pose.p.z, .7, .01);
	CHECK_NEAR(l->now[ball].v.x, 2 * 5. / 7, .03);
	CHECK_NEAR(l->now[ball].w.y, 2 * 5. / 7 / .2, .15);
	little_world_free(l);
}

// Two equal spheres and e = 1: they exchange their velocities, or at least conserve the total.
static void meeting(void)
{
	little_world *l = little_world_new();
	l->world.gravity = ob_v3(0, 0, 0);
	uint32_t a = little_sphere(l, 2, .5, ob_v3(0, 0, 0)), b = little_sphere(l, 2, .5, ob_v3(1.51, 0, 0));
	l->world.passport[a].restitution = 1;
	l->world.state[a].v.x = 3;
	little_run(kind, l, 0, 1);
	double sum = l->now[a].v.x + l->now[b].v.x;
	if (!is("obsim-lag")) // each computes its own impulse, from its view of the other
		CHECK_NEAR(sum, 3, 1e-5);
	if (is("obsim-ghost")) { // each treats the other as infinitely heavy
		CHECK_NEAR(l->now[a].v.x, -3, .1);
		CHECK_NEAR(l->now[b].v.x, 6, .1);
	} else if (!is("obsim-lag")) {
		CHECK_NEAR(l->now[b].v.x, 3, .1);
	}
	CHECK(l->now[b].v.x > 1);
	CHECK(l->now[b].pose.p.x - l->now[a].pose.p.x > 1);
	little_world_free(l);
}

// Force and mass; and a frame's result does not depend on its substeps.
static void force(uint32_t substeps)
{
	little_world *l = little_world_new();
	l->world.gravity = ob_v3(0, -2, 0);
	uint32_t pushed = little_sphere(l, 2, .5, ob_v3(0, 0, 0)), fallen = little_cube(l, 2, .5, ob_v3(9, 0, 0));
	l->world.passport[pushed].force = ob_v3(6, 0, 0);
	l->world.state[pushed].w = ob_v3(0, 0, 1);
	little_run(kind, l, substeps, 1);
	ob_state s = l->now[pushed], f = l->now[fallen];
	CHECK_NEAR(s.v.x, 3, 1e-4);
	CHECK_NEAR(s.pose.p.x, 1.5, 1.5 / 60 + 1e-4); // the error of a first-order step is up to h a t / 2
	CHECK_NEAR(s.v.y, -2, 1e-4);
	CHECK_NEAR(f.v.x, 0, 1e-6);
	CHECK_NEAR(f.v.y, -2, 1e-4);
	CHECK_NEAR(s.w.z, 1, 1e-4);
	CHECK_NEAR(2 * atan2(s.pose.q.z, s.pose.q.w), 1, 1e-3);
	little_world_free(l);
}

// The pair's friction is sqrt(.16) = .4: the product would be .16, the mean .58.
static void friction(void)
{
	little_world *l = little_world_new();
	uint32_t ground = little_ground(l);
	uint32_t box = little_add(l, OB_SHAPE_BOX, ob_v3(.5, .5, .1), 5, ob_v3(0, 0, .1));
	l->world.passport[ground].friction = .16;
	l->world.passport[box].friction = 1;
	l->world.state[box].v.x = 3;
	little_run(kind, l, 4, 2);
	double far = 9 / (2 * .4 * 9.81);
	CHECK_NEAR(l->now[box].pose.p.x, far, .05 * far);
	CHECK_NEAR(l->now[box].pose.p.y, 0, .01);
	CHECK(ob_norm(l->now[box].v) < .01);
	little_world_free(l);
}

// The larger of 0 and .8: back to .64 of the height, over the time around the apex.
static void bounce(void)
{
	little_world *l = little_world_new();
	little_ground(l);
	uint32_t ball = little_sphere(l, 1, .1, ob_v3(0, 0, 1.1));
	l->world.passport[ball].restitution = .8;
	ob_engine *p = little_make(kind, l, 16);
	double apex = 0;
	little_step(kind, p, l, .6);
	for (int i = 0; i < 30; i++) {
		little_step(kind, p, l, 1. / 60);
		apex = fmax(apex, l->now[ball].pose.p.z - .1);
	}
	kind->destroy(p);
	CHECK_NEAR(apex, .64, .06);
	little_world_free(l);
}

// A plane lies at its pose: a wall at x = 2 that faces back, and a floor at z = 1 with a slope below the angle of
// friction.
static void planes(void)
{
	little_world *l = little_world_new();
	uint32_t wall = little_add(l, OB_SHAPE_PLANE, ob_v3(0, 0, 0), 0, ob_v3(2, 0, 0));
	l->world.state[wall].pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, -asin(1), 0));
	uint32_t floor = little_add(l, OB_SHAPE_PLANE, ob_v3(0, 0, 0), 0, ob_v3(0, 0, 1));
	l->world.state[floor].pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(.2, 0, 0));
	uint32_t ball = little_sphere(l, 1, .25, ob_v3(0, 0, 5));
	l->world.passport[ball].restitution = 1;
	l->world.state[ball].v = ob_v3(8, 0, 2);
	ob_vec3 up = ob_v3(0, -sin(.2), cos(.2));
	uint32_t box = little_cube(l, 1, .25, ob_madd(ob_v3(-20, 0, 1), .25, up));
	l->world.state[box].pose.q = l->world.state[floor].pose.q;
	little_run(kind, l, 8, .5);
	CHECK_NEAR(l->now[ball].v.x, -8, .3);
	CHECK_NEAR(l->now[ball].pose.p.x, 1.75 - 8 * (.5 - 1.75 / 8), .2);
	ob_vec3 creep = ob_sub(l->now[box].pose.p, l->world.state[box].pose.p);
	CHECK(ob_norm(creep) < .01);
	little_world_free(l);
}

// Two at once, in one thread; and a failed creation gives a reason.
static void life(void)
{
	little_world *l = little_world_new();
	little_ground(l);
	little_cube(l, 1, .5, ob_v3(0, 0, .5));
	little_cube(l, 1, .5, ob_v3(0, 0, 1.5));
	ob_engine *one = little_make(kind, l, 0), *other = little_make(kind, l, 0);
	little_step(kind, one, l, .1);
	kind->destroy(one);
	little_step(kind, other, l, .1);
	kind->destroy(other);
	CHECK_NEAR(l->now[2].pose.p.z, 1.5, .02);
	kind->destroy(NULL);
	ob_run_settings s = kind->usual;
	s.substeps = 0;
	s.tolerance = 0;
	ob_error e = { "" };
	CHECK(!kind->create(&l->world, &s, &e) && e.text[0]);
	s = kind->usual;
	s.step_length = 0;
	e.text[0] = 0;
	CHECK(!kind->create(&l->world, &s, &e) && e.text[0]);
	little_world_free(l);
}

// Substeps by a tolerance, which only obsim supports: a stack may sag by that much.
static void tolerance(void)
{
	little_world *l = little_world_new();
	little_ground(l);
	for (int i = 0; i < 5; i++)
		little_cube(l, 1000, .5, ob_v3(.01 * i, 0, .5 + i));
	ob_run_settings s = kind->usual;
	s.substeps = 0;
	s.tolerance = 1e-4;
	ob_error e = { "" };
	ob_engine *p = kind->create(&l->world, &s, &e);
	bool can = strncmp(kind->name, "obsim", 5) == 0;
	CHECK(can == (p != NULL));
	CHECK(can || e.text[0]);
	if (p) {
		little_step(kind, p, l, 1);
		if (is("obsim"))
			CHECK_NEAR(l->now[5].pose.p.z, 4.5, 5e-4);
	}
	kind->destroy(p);
	little_world_free(l);
}

// A tumbling heap, twice: the same bits, whatever ran before in the process.
static void again(void)
{
	little_world *l = little_world_new();
	little_ground(l);
	for (int i = 0; i < 20; i++) {
		uint32_t id = little_cube(l, 1, .25, ob_v3(.2 * (i % 3), .15 * (i % 2), .5 + .6 * i));
		l->world.state[id].pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(i, .3 * i, 1));
	}
	little_run(kind, l, 0, 2);
	ob_state first[LITTLE_MOST];
	memcpy(first, l->now, sizeof first);
	little_run(kind, l, 0, 2);
	CHECK(kind->free || memcmp(first, l->now, sizeof first) == 0);
	little_world_free(l);
}

// A body at rest with sleeping enabled: the same state to the last bit, frame after frame.
static void sleep_on(void)
{
	if (strncmp(kind->name, "mujoco", 6) == 0 || kind->free) // has no sleeping
		return;
	little_world *l = little_world_new();
	little_ground(l);
	uint32_t cube = little_cube(l, 1, .5, ob_v3(0, 0, .5));
	ob_run_settings s = kind->usual;
	s.sleeping = true;
	ob_error e;
	ob_engine *p = kind->create(&l->world, &s, &e);
	CHECK(p);
	little_step(kind, p, l, 4);
	ob_state before = l->now[cube];
	little_step(kind, p, l, 1);
	CHECK(memcmp(&before, &l->now[cube], sizeof before) == 0);
	CHECK(ob_norm(before.v) == 0);
	kind->destroy(p);
	little_world_free(l);
}

// Two tables follow their prescribed motions under any load, one swinging and one turning as it rises; cubes ride along
// by friction.
static void driven(void)
{
	if (kind->drives < OB_WORLD_DRIVES_BODIES)
		return;
	enum { SWINGS = 0, TURNS = 1 };
	static const double f = 2, rate = .5, climb = .2; // rad/s, rad/s, m/s
	const ob_vec3 half = ob_v3(1, 1, .1), swing = ob_v3(.3, 0, 0);
	little_world *l = little_world_new();
	ob_world_swing(&l->world, ob_world_box(&l->world, 0, half, ob_v3(0, 0, -.1)), swing, f, acos(0));
	ob_world_body up = ob_world_box(&l->world, 0, half, ob_v3(5, 0, -.1));
	ob_world_kinematic(up);
	up.state->v.z = climb;
	up.state->w.z = rate;
	uint32_t rider = little_cube(l, 2, .25, ob_v3(.3, 0, .25)), turned = little_cube(l, 2, .25, ob_v3(5.2, 0, .25));
	l->world.state[turned].v = ob_v3(0, .2 * rate, climb);
	l->world.state[turned].w.z = rate;
	little_run(kind, l, 32, 2);
	const ob_state *table = l->now;
	const double exact = .3 * cos(2 * f);
	CHECK_NEAR(table[SWINGS].pose.p.x, exact, 1e-5); // single precision
	CHECK_NEAR(table[TURNS].pose.p.z, -.1 + 2 * climb, 1e-5);
	CHECK_NEAR(table[TURNS].pose.q.z, sin(rate), 1e-5);
	if (!is("obsim-ghost")) { // it treats each contact alone
		CHECK_NEAR(l->now[rider].pose.p.x, exact, .02);
		CHECK_NEAR(l->now[rider].v.x, -.3 * f * sin(2 * f), .05);
		CHECK_NEAR(l->now[turned].pose.p.x, 5 + .2 * cos(2 * rate), .02);
		CHECK_NEAR(l->now[turned].pose.p.y, .2 * sin(2 * rate), .02);
		CHECK_NEAR(l->now[turned].pose.p.z, .25 + 2 * climb, .01);
	}
	little_world_free(l);
}

int main(int argc, char **argv)
{
	kind = ob_engine_find(argv[1]);
	if (!kind)
		return 77;
	rest();
	upright_and_rolling();
	meeting();
	force(1);
	force(7);
	friction();
	bounce();
	planes();
	life();
	tolerance();
	again();
	sleep_on();
	driven();
	return check_end();
}

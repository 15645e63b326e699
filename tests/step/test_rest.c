// Coming to rest, asleep or awake, by either kind of solver and either integrator; waking, removal, addition.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static bool all_asleep(const little_universe *l)
{
	for (uint32_t i = 0; i < l->now.count; i++)
		if (l->now.passport[i].flags == OB_OBJECT_PRESENT && !little_asleep(l, i))
			return false;
	return true;
}

static uint32_t awake(const little_universe *l)
{
	ob_universe_info info;
	ob_universe_get_info(l->u, &info);
	return info.awake;
}

// A stack of five falls asleep, sleeps on without moving by a bit, and wakes as a whole when a box hits its top.
static void test_sleep(ob_solver_kind solver)
{
	little_scene *s = little_scene_new();
	s->run.sleeping = 1;
	s->run.solver = solver;
	ob_world_ground(&s->world);
	ob_world_stack(&s->world, 5, ob_v3(0, 0, 0), 3);
	ob_world_body thrown = ob_world_box(&s->world, 500, ob_v3(.3, .3, .3), ob_v3(-20, 0, 4.8));
	thrown.state->v = ob_v3(5, 0, 19.62); // comes down on the top after 4 s
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 3);
	CHECK(awake(&l) == 1);
	ob_state top = little_state(&l, 5);
	for (uint32_t i = 1; i <= 5; i++)
		CHECK(little_asleep(&l, i));
	CHECK(ob_norm(top.v) == 0 && ob_norm(top.w) == 0);
	CHECK_NEAR(top.pose.p.z, 4.5, .002);
	little_run_to(&l, 3.5);
	CHECK(little_state(&l, 5).pose.p.z == top.pose.p.z);
	bool woke = false;
	for (int step = 0; step < 120 && !woke; step++) {
		little_run(&l, 1);
		woke = awake(&l) == 6;
	}
	CHECK(woke);
	little_run_to(&l, 6);
	CHECK(ob_norm(ob_sub(little_state(&l, 5).pose.p, top.pose.p)) > .005); // it was hit: 18 mm with 512 substeps
	if (solver == OB_SOLVER_COLOURED) { // with Jacobi iterations a stack that was hit sways for long
		little_run_to(&l, 20);
		CHECK(all_asleep(&l));
		CHECK(awake(&l) == 0);
	}
	little_close(&l);
	free(s);
}

// Sleeping must be enabled.
static void test_no_sleep(void)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_stack(&s->world, 3, ob_v3(0, 0, 0), 4);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 5);
	CHECK(awake(&l) == 3);
	little_close(&l);
	free(s);
}

// A body in equilibrium costs nothing, though nothing may sleep, and goes on as soon as it is touched.
static void test_still(void)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	for (int i = 0; i < 4; i++)
		ob_world_box(&s->world, 1, ob_v3(.5, .5, .5), ob_v3(3 * i, 0, .5));
	ob_world_sphere(&s->world, 1, .2, ob_v3(-1, 0, .5)).state->v = ob_v3(.2, 0, 0); // at the first box after 1.5 s
	s->world.passport[5].friction = 0;
	s->world.state[5].pose.p.z = .2;
	little_universe l;
	ob_counters before, after;
	little_open(&l, s);
	little_run_to(&l, 1);
	CHECK(awake(&l) == 5 && !all_asleep(&l));
	CHECK(l.now.motion[1].flags & OB_MOTION_EQUILIBRIUM && !(l.now.motion[5].flags & OB_MOTION_EQUILIBRIUM));
	ob_universe_count(l.u, &before);
	little_run(&l, 20);
	ob_universe_count(l.u, &after);
	CHECK(after.body_steps - before.body_steps == 20); // the ball's
	little_run_to(&l, 3);
	double p = l.now.passport[1].mass * little_state(&l, 1).v.x;
	CHECK(p > -1e-15 && p < .2 && little_state(&l, 5).v.x < .15); // the box has stopped it, or friction the box
	CHECK(l.now.motion[4].flags & OB_MOTION_EQUILIBRIUM);
	little_close(&l);
	free(s);
}

// Ten cubes on top of each other, with sleeping disabled, come to equilibrium, each of them, at the run's usual
// substeps.
static void test_still_stack(void)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_stack(&s->world, 10, ob_v3(0, 0, 0), 4);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 3);
	for (uint32_t i = 1; i <= 10; i++)
		CHECK(l.now.motion[i].flags & OB_MOTION_EQUILIBRIUM);
	little_close(&l);
	free(s);
}

// Cubes that rest on several others need no solving in equilibrium either: a pyramid stands where it was built.
static void test_still_pyramid(uint32_t substeps)
{
	little_scene *s = little_scene_new();
	s->run.substeps = substeps;
	ob_world_ground(&s->world);
	for (int row = 0; row < 8; row++)
		for (int i = 0; i < 8 - row; i++)
			ob_world_box(&s->world, 1000, ob_v3(.5, .5, .5),
				     ob_v3(0, 1.05 * (i - .5 * (7 - row)), .5 + row));
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 3);
	for (uint32_t i = 1; i <= 36; i++) {
		CHECK(l.now.motion[i].flags & OB_MOTION_EQUILIBRIUM);
		CHECK(ob_norm(ob_sub(little_state(&l, i).pose.p, s->world.state[i].pose.p)) < 2e-5);
	}
	little_close(&l);
	free(s);
}

// The lowest of three cubes is removed: the others fall at once, freely, by its height, asleep or not.
static void test_support_removed(bool sleeping)
{
	little_scene *s = little_scene_new();
	s->run.sleeping = sleeping;
	ob_world_ground(&s->world);
	ob_world_stack(&s->world, 3, ob_v3(0, 0, 0), 5);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 3);
	CHECK(little_asleep(&l, 3) == sleeping);
	double before = little_state(&l, 3).pose.p.z;
	little_take_away(&l, 1);
	little_run(&l, 0);
	CHECK(!little_asleep(&l, 2)); // those that touched it wake at once
	little_run(&l, 6);
	double t = .1;
	CHECK_NEAR(little_state(&l, 2).v.z, -9.81 * t, 1e-3);
	CHECK_NEAR(before - little_state(&l, 3).pose.p.z, .5 * 9.81 * t * t, 1e-3);
	CHECK(!(l.now.passport[1].flags & OB_OBJECT_PRESENT));
	little_run_to(&l, 8);
	CHECK_NEAR(little_state(&l, 2).pose.p.z, .5, .002);
	CHECK_NEAR(little_state(&l, 3).pose.p.z, 1.5, .002);
	little_close(&l);
	free(s);
}

// A free slot is filled while the universe pauses, emptied, and filled again by another object.
static void test_added(void)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_stack(&s->world, 2, ob_v3(0, 0, 0), 6);
	s->capacity = 5;
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 1);
	ob_world_body o = ob_world_box(&s->world, 1000, ob_v3(.5, .5, .5), ob_v3(0, 0, 3));
	little_put(&l, 3);
	little_run_to(&l, 2);
	CHECK(l.now.passport[3].flags & OB_OBJECT_PRESENT);
	CHECK_NEAR(little_state(&l, 3).pose.p.z, 2.5, .002);
	CHECK_NEAR(little_state(&l, 2).pose.p.z, 1.5, .002);
	little_take_away(&l, 3);
	little_run_to(&l, 3);
	o.passport->generation++;
	o.passport->shape = OB_SHAPE_SPHERE;
	o.state->pose.p = ob_v3(1.5, 0, 2);
	little_put(&l, 3);
	little_run_to(&l, 5);
	CHECK_NEAR(little_state(&l, 3).pose.p.z, .5, .002);
	CHECK_NEAR(little_state(&l, 2).pose.p.z, 1.5, .002);
	little_close(&l);
	free(s);
}

// ---- rest is a balance of forces: a body just short of it goes on, however slowly; one just within it rests

// Steps until all moving bodies of the scene rest; 0: they do not within "seconds".
static uint64_t steps_to_rest(little_scene *s, double seconds)
{
	little_universe l;
	little_open(&l, s);
	uint64_t rested = 0;
	for (uint64_t step = 1; step <= (uint64_t)lround(60 * seconds) && !rested; step++) {
		little_run(&l, 1);
		bool all = true;
		for (uint32_t i = 0; i < s->world.objects; i++)
			all &= !(s->world.passport[i].mass > 0) || l.now.motion[i].flags & OB_MOTION_RESTS;
		rested = all ? step : 0;
	}
	little_close(&l);
	free(s);
	return rested;
}

static little_scene *resting_scene(bool sleeping)
{
	little_scene *s = little_scene_new();
	s->run.sleeping = sleeping;
	return s;
}

// A block on a plane, pulled by "share" of the friction limit.
static little_scene *pulled(double share, double friction, bool sleeping)
{
	little_scene *s = resting_scene(sleeping);
	ob_world_ground(&s->world);
	ob_world_body block = ob_world_box(&s->world, 7, ob_v3(.5, .3, .2), ob_v3(0, 0, .2));
	const double force = share * friction * block.passport->mass * OB_WORLD_GRAVITY;
	block.passport->force = ob_v3(.6 * force, .8 * force, 0);
	ob_world_material(&s->world, friction, 0);
	return s;
}

// The same on an incline.
static little_scene *inclined(double share, double friction, bool sleeping)
{
	little_scene *s = resting_scene(sleeping);
	const double angle = atan(share * friction);
	ob_world_slope(&s->world, angle);
	ob_quat q = ob_quat_turn(ob_quat_identity(), ob_v3(0, angle, 0));
	ob_mat3 r = ob_quat_matrix(q);
	ob_world_box(&s->world, 7, ob_v3(.5, .3, .1), ob_rotate(&r, ob_v3(0, 0, .1))).state->pose.q = q;
	ob_world_material(&s->world, friction, 0);
	return s;
}

// A block with "share" of one half beyond an edge.
static little_scene *overhanging(double share, bool sleeping)
{
	little_scene *s = resting_scene(sleeping);
	ob_world_box(&s->world, 0, ob_v3(1, 1, .5), ob_v3(-1, 0, .5));
	ob_world_box(&s->world, 10, ob_v3(.5, .4, .2), ob_v3(.5 * (share - 1), 0, 1.2));
	return s;
}

// A rod on its lower edge, its centre beyond it or short of it by a thousandth of its width.
static little_scene *leaning(double share, bool sleeping)
{
	little_scene *s = resting_scene(sleeping);
	const double half = .02, tall = .5, lean = atan(half / tall) - (1 - share) * half / tall;
	ob_quat q = ob_quat_turn(ob_quat_identity(), ob_v3(0, lean, 0));
	ob_mat3 r = ob_quat_matrix(q);
	ob_world_ground(&s->world);
	ob_world_box(&s->world, 1, ob_v3(half, half, tall), ob_rotate(&r, ob_v3(-half, 0, tall))).state->pose.q = q;
	s->world.state[1].pose.p.x += half;
	return s;
}

static void test_balance(bool sleeping)
{
	const double over = 1.001, under = .999, watched = 1.5; // s
	for (double friction = .05; friction < 2; friction *= 3) {
		CHECK(!steps_to_rest(pulled(over, friction, sleeping), watched));
		CHECK(steps_to_rest(pulled(under, friction, sleeping), 1));
		CHECK(!steps_to_rest(inclined(over, friction, sleeping), watched));
		CHECK(steps_to_rest(inclined(under, friction, sleeping), 1));
	}
	CHECK(!steps_to_rest(overhanging(over, sleeping), 1));
	CHECK(steps_to_rest(overhanging(under, sleeping), 1));
	CHECK(!steps_to_rest(leaning(over, sleeping), .5));
	CHECK(!steps_to_rest(leaning(under, sleeping), .5)); // back, onto its foot
}

// A rolling ball without resistance goes on, at any speed.
static void test_slow_roll(void)
{
	little_scene *s = resting_scene(true);
	ob_world_ground(&s->world);
	ob_world_sphere(&s->world, 1, .2, ob_v3(0, 0, .2)).state->v = ob_v3(.01, 0, 0);
	CHECK(!steps_to_rest(s, 3));
}

// Heaps fall asleep, soon after they are slow.
static void test_heap_sleeps(uint64_t seed)
{
	little_scene *s = resting_scene(true);
	s->run.tolerance = 1e-3;
	ob_world_falling(&s->world, 24, seed);
	CHECK(steps_to_rest(s, 10));
}

// Capsules and cylinders, lying and standing, settle on the plane in the attitude of their shape.
static void test_round_shapes(void)
{
	static const struct {
		ob_shape shape;
		double tilt, rest; // rad from the vertical; m, height of the centre
	} lies[] = {
		{ OB_SHAPE_CAPSULE, M_PI / 2, .3 }, { OB_SHAPE_CAPSULE, 1.2, .3 }, { OB_SHAPE_CYLINDER, M_PI / 2, .3 },
		{ OB_SHAPE_CYLINDER, 0, .5 },       { OB_SHAPE_CYLINDER, .1, .5 }, { OB_SHAPE_CYLINDER, 1.3, .3 },
	};
	enum { BODIES = sizeof lies / sizeof lies[0] };
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	for (int i = 0; i < BODIES; i++) {
		ob_world_body o = ob_world_add(&s->world, lies[i].shape, ob_v3(.3, .5, 0), 100, ob_v3(0, 4 * i, 1));
		o.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(lies[i].tilt, 0, 0));
	}
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 20);
	for (uint32_t i = 0; i < BODIES; i++) {
		ob_state at = little_state(&l, 1 + i);
		CHECK_NEAR(at.pose.p.z, lies[i].rest, .001);
		CHECK_NEAR(at.v.z, 0, .001);
	}
	CHECK(little_penetration(&l).max_m < 5e-4);
	little_close(&l);
	free(s);
}

static void check_stack(ob_solver_kind solver, ob_integrator integrator, double deepest)
{
	little_scene *s = little_scene_new();
	s->run.solver = solver;
	s->run.integrator = integrator;
	ob_world_ground(&s->world);
	ob_world_stack(&s->world, 5, ob_v3(0, 0, 0), 8);
	little_universe l;
	little_open(&l, s);
	double deep = 0;
	for (int step = 0; step < 600; step++) {
		little_run(&l, 1);
		deep = fmax(deep, little_penetration(&l).max_m);
	}
	ob_vec3 moved = ob_sub(little_state(&l, 5).pose.p, s->world.state[5].pose.p);
	CHECK(ob_norm(moved) < .005);
	CHECK(deep < deepest);
	if (!(deep < deepest))
		printf("solver %d, integrator %d: deepest %.3f mm\n", solver, integrator, 1e3 * deep);
	little_close(&l);
	free(s);
}

int main(void)
{
	test_sleep(OB_SOLVER_COLOURED);
	test_sleep(OB_SOLVER_JACOBI);
	test_no_sleep();
	test_still();
	test_still_stack();
	test_still_pyramid(1);
	test_still_pyramid(8);
	test_balance(true);
	test_balance(false);
	test_slow_roll();
	for (uint64_t seed = 1; seed <= 4; seed++)
		test_heap_sleeps(seed);
	test_support_removed(false);
	test_support_removed(true);
	test_added();
	test_round_shapes();
	check_stack(OB_SOLVER_COLOURED, OB_INTEGRATOR_EXACT, 5e-4);
	check_stack(OB_SOLVER_COLOURED, OB_INTEGRATOR_ODE, 5e-4);
	check_stack(OB_SOLVER_JACOBI, OB_INTEGRATOR_EXACT, 2e-3);
	return check_end();
}

// Islands with joints that come to rest, and what wakes them.
#include <stdlib.h>

#include "check.h"
#include "elementary/elementary.h"
#include "little_universe.h"

static little_scene *sleepy_scene(void)
{
	little_scene *s = little_scene_new();
	s->run.sleeping = 1;
	s->run.tolerance = .001;
	s->checked = true;
	return s;
}

static void finish(little_universe *l, little_scene *s)
{
	little_close(l);
	free(s->world.joint);
	free(s);
}

static bool all_asleep(const little_universe *l)
{
	for (uint32_t i = 0; i < l->now.count; i++)
		if (l->now.passport[i].flags == OB_OBJECT_PRESENT && !little_asleep(l, i))
			return false;
	return true;
}

static ob_joint_axis *drive(ob_joint_passport *j)
{
	j->flags |= OB_JOINT_DRIVEN;
	return &j->axis;
}

static const ob_quat z_axis = { 1, 0, 0, 0 }, y_axis = { M_SQRT1_2, -M_SQRT1_2, 0, 0 };

// ---- a ragdoll

// Ragdolls that fall come to rest and sleep, none of their joints apart or beyond its limit; a ball that hits one wakes it.
static void test_ragdoll(double height, double lean)
{
	little_scene *s = sleepy_scene();
	little_universe l;
	ob_world_ragdoll(&s->world, ob_v3(0, 0, height), lean);
	ob_world_ground(&s->world);
	little_open(&l, s);
	double asleep = 0;
	for (double t = 1; t <= 12 && !asleep; t += .5) {
		little_run_to(&l, t);
		asleep = all_asleep(&l) ? t : 0;
	}
	const double energy = little_energy(&l);
	double apart = 0;
	for (uint32_t i = 0; i < s->world.joints; i++) {
		const ob_joint_passport *j = &s->world.joint[i];
		ob_vec3 at[2];
		for (int side = 0; side < 2; side++) {
			const ob_pose p = little_state(&l, j->object[side]).pose;
			const ob_mat3 r = ob_quat_matrix(p.q);
			at[side] = ob_add(p.p, ob_rotate(&r, j->frame[side].p));
		}
		double value, rate;
		CHECK(ob_universe_get_joint_value(l.u, i, &value, &rate));
		CHECK(value < j->axis.high + 1e-6 && value > j->axis.low - 1e-6 && rate == 0);
		apart = fmax(apart, ob_norm(ob_sub(at[0], at[1])));
	}
	printf("ragdoll from %g m, %g rad: asleep at %g s, %.3g m apart, %.3g m deep\n", height, lean, asleep, apart,
	       little_penetration(&l).max_m);
	CHECK(asleep > 0);
	CHECK(apart < 1e-10);
	CHECK(little_penetration(&l).max_m < 1e-3);
	little_run(&l, 60);
	CHECK(all_asleep(&l) && little_energy(&l) == energy);
	finish(&l, s);
}

// A load of a joint that sleeps is the last one. A push at one end wakes all, and so does an object that comes down on it.
static void test_waking(void)
{
	enum { LINKS = 4 };
	little_scene *s = sleepy_scene();
	little_universe l;
	for (uint32_t i = 0; i < LINKS; i++) {
		ob_world_capsule(&s->world, 1, .05, .2, ob_v3(0, 0, 3 - .5 * i));
		ob_joint_axis *a = drive(ob_world_join(&s->world, OB_JOINT_HINGE, i, i ? i - 1 : OB_JOINT_WORLD,
						       (ob_pose){ { 0, 0, 3.25 - .5 * i }, y_axis }));
		a->damping = 1, a->friction = .05;
	}
	ob_world_sphere(&s->world, .2, .1, ob_v3(4, 0, 1.5)).state->v = ob_v3(-2, 0, 9.81); // hits the last link at 2 s
	ob_world_material(&s->world, .5, 0);
	little_open(&l, s);
	little_run_to(&l, 1.5);
	for (uint32_t i = 0; i < LINKS; i++)
		CHECK(little_asleep(&l, i));
	ob_joint_load load;
	CHECK(ob_universe_get_joint_load(l.u, 1, &load));
	CHECK_NEAR(load.force.z, 3 * 9.81, 1e-6);
	double moved = 0;
	for (double t = 1.8; t < 3; t += .1) {
		little_run_to(&l, t);
		moved = fmax(moved, ob_norm(little_state(&l, 0).w));
	}
	printf("hit chain: the first link turns by up to %.3g rad/s\n", moved);
	CHECK(moved > .01);
	little_run_to(&l, 20);
	for (uint32_t i = 0; i < LINKS; i++)
		CHECK(little_asleep(&l, i));
	ob_sim_push(l.u, LINKS - 1, ob_v3(5, 0, 0), true);
	little_run(&l, 30);
	for (uint32_t i = 0; i < LINKS; i++)
		CHECK(!little_asleep(&l, i));
	CHECK(ob_norm(little_state(&l, 0).w) > .01);
	finish(&l, s);
}

// A door that friction holds half open sleeps; a constant motor against its stop, too; without what holds them they fall.
static void test_held(void)
{
	little_scene *s = sleepy_scene();
	little_universe l;
	ob_world_box(&s->world, 2, ob_v3(.5, .05, .05), ob_v3(.5, 0, 2));
	drive(ob_world_join(&s->world, OB_JOINT_HINGE, 0, OB_JOINT_WORLD, (ob_pose){ { 0, 0, 2 }, y_axis }))->friction =
		12;
	ob_world_box(&s->world, 2, ob_v3(.5, .05, .05), ob_v3(.5, 3, 2));
	ob_joint_axis *a =
		drive(ob_world_join(&s->world, OB_JOINT_HINGE, 1, OB_JOINT_WORLD, (ob_pose){ { 0, 3, 2 }, y_axis }));
	a->motor = OB_MOTOR_RATE, a->target = -1, a->most = 30, a->low = -.3;
	const uint32_t post = s->world.objects; // a frame that is taken away
	ob_world_box(&s->world, 0, ob_v3(.1, .1, .1), ob_v3(0, 6, 2));
	ob_world_box(&s->world, 2, ob_v3(.5, .05, .05), ob_v3(.7, 6, 2));
	ob_world_join(&s->world, OB_JOINT_FIXED, post + 1, post, (ob_pose){ { .1, 6, 2 }, z_axis });
	little_open(&l, s);
	little_run_to(&l, 3);
	CHECK(all_asleep(&l));
	CHECK_NEAR(little_state(&l, 0).pose.p.z, 2, 1e-12);
	CHECK_NEAR(little_state(&l, 1).pose.p.z, 2 + .5 * sin(.3), 1e-9);
	CHECK_NEAR(little_state(&l, post + 1).pose.p.z, 2, 1e-12);
	little_take_away(&l, post);
	little_run(&l, 30);
	CHECK_NEAR(little_state(&l, post + 1).pose.p.z, 2 - .5 * 9.81 * .25, 1e-6);
	CHECK(little_asleep(&l, 0) && little_asleep(&l, 1));
	finish(&l, s);
}

// A body does not sleep while a joint ties it to one that moves.
static void test_carried(void)
{
	little_scene *s = sleepy_scene();
	little_universe l;
	ob_world_body b = ob_world_box(&s->world, 0, ob_v3(.1, .1, .1), ob_v3(0, 0, 2));
	b.passport->flags = (b.passport->flags & ~(uint32_t)OB_OBJECT_STATIC) | OB_OBJECT_KINEMATIC;
	b.state->v = ob_v3(0, .01, 0);
	ob_world_box(&s->world, 2, ob_v3(.3, .1, .1), ob_v3(.5, 0, 2));
	ob_world_join(&s->world, OB_JOINT_FIXED, 1, 0, (ob_pose){ { .2, 0, 2 }, z_axis });
	little_open(&l, s);
	little_run_to(&l, 3);
	CHECK(!little_asleep(&l, 1));
	CHECK_NEAR(little_state(&l, 1).pose.p.y, .03, 1e-9);
	finish(&l, s);
}

int main(void)
{
	test_ragdoll(.8, .8);
	test_ragdoll(.8, 1.2);
	test_ragdoll(2.2, 2.8);
	test_waking();
	test_held();
	test_carried();
	return check_end();
}

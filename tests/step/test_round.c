// Cylinders and capsules on planes: they bounce to the right height, roll off an edge and fall, and a cylinder that
// stands on a slope tips over where its rim no longer carries it.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static const double g = 9.81; // m/s^2

static ob_quat about(double x, double y, double z)
{
	return ob_quat_turn(ob_quat_identity(), ob_v3(x, y, z));
}

// Dropped flat, on an end or on the side, without friction: the apex after the bounce is e^2 of the drop, and nothing
// turns.
static void test_bounces(ob_shape shape, bool lies)
{
	const double drop = 1, e = .6;
	const ob_vec3 size = ob_v3(.2, .3, 0);
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	const double low = lies ? size.x : shape == OB_SHAPE_CAPSULE ? size.x + size.y : size.y;
	ob_world_body o = ob_world_add(&s->world, shape, size, 2, ob_v3(0, 0, low + drop));
	o.state->pose.q = lies ? about(0, M_PI / 2, 0) : ob_quat_identity();
	const uint32_t id = o.passport->id;
	ob_world_material(&s->world, .3, e);
	little_universe u;
	little_open(&u, s);
	double apex = 0, fall = sqrt(2 * drop / g);
	for (double t = 0; t < fall * (1 + 1.8 * e); t += s->run.step_length) {
		little_run(&u, 1);
		ob_state now = little_state(&u, id);
		if (t > fall * 1.05)
			apex = fmax(apex, now.pose.p.z - low + .5 * now.v.z * now.v.z / g);
	}
	ob_state end = little_state(&u, id);
	CHECK_NEAR(apex, e * e * drop, 1e-6);
	CHECK(ob_norm(end.w) < 1e-9 && hypot(end.v.x, end.v.y) < 1e-9);
	little_close(&u);
	free(s);
}

// Rolls off the edge of a block: at its speed up to there, and then down.
static void test_rolls_off(ob_shape shape)
{
	const double r = .1, speed = 1;
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_box(&s->world, 0, ob_v3(1, 1, .5), ob_v3(0, 0, .5));
	ob_world_body o = ob_world_add(&s->world, shape, ob_v3(r, .2, 0), 2, ob_v3(0, 0, 1 + r));
	o.state->pose.q = about(M_PI / 2, 0, 0);
	o.state->v = ob_v3(speed, 0, 0), o.state->w = ob_v3(0, speed / r, 0);
	const uint32_t id = o.passport->id;
	ob_world_material(&s->world, .5, 0);
	little_universe u;
	little_open(&u, s);
	little_run(&u, 54); // .9 s
	ob_state on = little_state(&u, id);
	CHECK_NEAR(on.pose.p.x, .9 * speed, 1e-9);
	CHECK_NEAR(on.pose.p.z, 1 + r, 1e-6);
	little_run(&u, 60);
	CHECK(little_state(&u, id).pose.p.x > 1 + r);
	CHECK(little_state(&u, id).pose.p.z < .5);
	little_close(&u);
	free(s);
}

// Spins about the vertical without a brake, for a point has no arm: spinning moves no surface, and is no rest.
static void test_spins_on(ob_shape shape, double mu, double spin)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	const double low = shape == OB_SHAPE_CAPSULE ? .5 : shape == OB_SHAPE_CYLINDER ? .3 : .2;
	ob_world_body o =
		ob_world_add(&s->world, shape, ob_v3(.2, shape == OB_SHAPE_SPHERE ? 0 : .3, 0), 2, ob_v3(0, 0, low));
	o.state->w = ob_v3(0, 0, spin);
	const uint32_t id = o.passport->id;
	ob_world_material(&s->world, mu, 0);
	s->run.sleeping = spin > .01; // slower bodies may sleep
	little_universe u;
	little_open(&u, s);
	little_run(&u, 120);
	CHECK_NEAR(little_state(&u, id).w.z, spin, 1e-12);
	little_close(&u);
	free(s);
}

// rad, by which the axis of a cylinder that stands on a slope has turned after two seconds; turn: the
// cylinder's, about its axis.
static double tips(double slope, double turn)
{
	const ob_quat q = about(0, slope, 0);
	const double r = .2, h = .5; // it tips where the slope's tangent is r / h
	const ob_mat3 m = ob_quat_matrix(q);
	little_scene *s = little_scene_new();
	ob_world_body o = ob_world_ground(&s->world);
	o.state->pose.q = q;
	o = ob_world_add(&s->world, OB_SHAPE_CYLINDER, ob_v3(r, h, 0), 2, ob_scale(ob_column(&m, 2), h));
	o.state->pose.q = ob_quat_mul(q, about(0, 0, turn));
	const uint32_t id = o.passport->id;
	ob_world_material(&s->world, 1, 0);
	little_universe u;
	little_open(&u, s);
	little_run(&u, 120);
	const ob_mat3 end = ob_quat_matrix(little_state(&u, id).pose.q);
	double cosine = ob_dot(ob_column(&end, 2), ob_column(&m, 2));
	little_close(&u);
	free(s);
	return acos(fmin(1, cosine));
}

int main(void)
{
	test_bounces(OB_SHAPE_CYLINDER, false);
	test_bounces(OB_SHAPE_CYLINDER, true);
	test_bounces(OB_SHAPE_CAPSULE, false);
	test_bounces(OB_SHAPE_CAPSULE, true);
	test_rolls_off(OB_SHAPE_CYLINDER);
	test_rolls_off(OB_SHAPE_CAPSULE);
	for (double spin = 1e-3; spin < 20; spin *= 20) {
		test_spins_on(OB_SHAPE_CYLINDER, 0, spin);
		test_spins_on(OB_SHAPE_CAPSULE, 0, spin);
		test_spins_on(OB_SHAPE_CAPSULE, .6, spin);
		test_spins_on(OB_SHAPE_SPHERE, 0, spin);
		test_spins_on(OB_SHAPE_SPHERE, .6, spin);
	}
	const double critical = atan(.4);
	for (double turn = 0; turn < 1.5; turn += .35) { // for any rotation of the cylinder
		CHECK(tips(.995 * critical, turn) < 1e-6);
		CHECK(tips(1.02 * critical, turn) > .1);
	}
	return check_end();
}

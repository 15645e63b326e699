// Objects without contacts: the closed form, and ODE's own stepper with its error of the first order.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "little_universe.h"
#include "motion/random.h"
#include "step/rotation_cache.h"

static const double g = 9.81; // m/s^2

static little_scene *thrown_box(ob_integrator integrator, uint32_t substeps)
{
	little_scene *s = little_scene_new();
	s->run.integrator = integrator;
	s->run.substeps = substeps;
	ob_world_body o = ob_world_box(&s->world, 48, ob_v3(.3, .2, .1), ob_v3(1, 2, 50));
	o.state->v = ob_v3(3, -2, 4);
	o.state->w = ob_v3(1, 5, .2);
	return s;
}

// m, after 2 s
static double error_at_two_seconds(ob_integrator integrator, uint32_t substeps)
{
	little_scene *s = thrown_box(integrator, substeps);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 2);
	ob_vec3 exact = ob_v3(7, -2, 50 + 8 - .5 * g * 4);
	double error = ob_norm(ob_sub(little_state(&l, 0).pose.p, exact));
	little_close(&l);
	free(s);
	return error;
}

// Position, velocity, energy and angular momentum, and the attitude by the motion's closed form in one evaluation.
static void test_exact(void)
{
	little_scene *s = thrown_box(OB_INTEGRATOR_EXACT, 8);
	little_universe l;
	little_open(&l, s);
	ob_motion thrown = l.now.motion[0];
	ob_vec3 spin = ob_measure_angular_momentum(&l.now);
	double energy = little_energy(&l);
	CHECK(thrown.flags & OB_MOTION_FREE);
	little_run_to(&l, 2);
	ob_state at = little_state(&l, 0), closed = ob_motion_at(&thrown, s->world.passport[0].inertia, 2);
	CHECK_NEAR(ob_norm(ob_sub(at.pose.p, closed.pose.p)), 0, 1e-12);
	CHECK_NEAR(ob_norm(ob_sub(at.v, ob_v3(3, -2, 4 - 2 * g))), 0, 1e-12);
	ob_quat p = at.pose.q, q = closed.pose.q;
	CHECK_NEAR(fabs(p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z), 1, 1e-12);
	CHECK_NEAR(ob_norm(ob_sub(at.w, closed.w)), 0, 1e-10);
	CHECK_NEAR(little_energy(&l) / energy, 1, 1e-12);
	// about the falling centre
	ob_vec3 centre = at.pose.p, m = ob_scale(at.v, 48);
	ob_vec3 own = ob_sub(ob_measure_angular_momentum(&l.now), ob_cross(centre, m));
	ob_vec3 own_before = ob_sub(spin, ob_cross(thrown.p, ob_scale(thrown.v, 48)));
	CHECK_NEAR(ob_norm(ob_sub(own, own_before)) / ob_norm(own_before), 0, 1e-12);
	CHECK(l.now.motion[0].flags & OB_MOTION_FREE);
	little_close(&l);
	free(s);
}

// Semi-implicit Euler with step k falls short by g t k / 2.
static void test_by_ode(void)
{
	for (uint32_t substeps = 1; substeps <= 16; substeps *= 4) {
		double step = 1. / 60 / substeps;
		CHECK_NEAR(error_at_two_seconds(OB_INTEGRATOR_ODE, substeps) / (.5 * g * 2 * step), 1, .01);
	}
	CHECK(error_at_two_seconds(OB_INTEGRATOR_EXACT, 1) < 1e-12);
}

// Other objects far away change no bit of an object without contacts.
static void test_alone_or_not(void)
{
	little_scene *s = thrown_box(OB_INTEGRATOR_EXACT, 8);
	little_universe l;
	ob_state end[2];
	for (int k = 0; k < 2; k++) {
		little_open(&l, s);
		little_run_to(&l, 2);
		end[k] = little_state(&l, 0);
		little_close(&l);
		ob_world_ground(&s->world).state->pose.p.z = -100;
		for (int i = 0; i < 30; i++)
			ob_world_sphere(&s->world, 1, .5, ob_v3(20 + .9 * i, 0, -99.5));
	}
	CHECK(end[0].pose.p.x == end[1].pose.p.x && end[0].pose.p.z == end[1].pose.p.z);
	CHECK(end[0].pose.q.w == end[1].pose.q.w && end[0].w.x == end[1].w.x);
	free(s);
}

// A flight ends when the host puts the object elsewhere, in whichever step, or when an impact turns it round: the next
// flight starts from there.
static void test_new_flights(void)
{
	for (uint64_t steps = 0; steps < 4; steps++) {
		little_scene *s = thrown_box(OB_INTEGRATOR_EXACT, 8);
		little_universe l;
		little_open(&l, s);
		little_run(&l, steps);
		s->world.state[0].v = ob_v3(-1, 1, 9);
		s->world.state[0].w = ob_v3(0, 0, 2);
		little_put(&l, 0);
		little_run(&l, 60);
		ob_state at = little_state(&l, 0);
		CHECK_NEAR(ob_norm(ob_sub(at.pose.p, ob_v3(0, 3, 59 - .5 * g))), 0, 1e-12);
		CHECK_NEAR(fabs(at.pose.q.z), sin(1), 1e-14);
		little_close(&l);
		free(s);
	}
}

// Ten minutes in weightlessness: the published motion still follows the first throw.
static void test_long(void)
{
	little_scene *s = thrown_box(OB_INTEGRATOR_EXACT, 8);
	s->run.gravity = ob_v3(0, 0, 0);
	little_universe l;
	little_open(&l, s);
	ob_motion thrown = l.now.motion[0];
	little_run_to(&l, 600);
	ob_state at = little_state(&l, 0), closed = ob_motion_at(&thrown, s->world.passport[0].inertia, 600);
	CHECK_NEAR(ob_norm(ob_sub(at.pose.p, closed.pose.p)), 0, 0);
	CHECK(at.pose.q.w == closed.pose.q.w && at.pose.q.x == closed.pose.q.x && at.w.y == closed.w.y);
	little_close(&l);
	free(s);
}

// A cached rotation, one that another object has replaced, and one whose object starts anew give the bits of a fresh
// one.
static void test_kept_plans(void)
{
	enum { OBJECTS = 5, STARTS = 3 };
	uint64_t seed = 17;
	ob_rotation_cache plans;
	CHECK(ob_rotation_cache_create(&plans, 2));
	ob_quat q[STARTS];
	ob_vec3 w[STARTS], inertia[OBJECTS];
	for (int i = 0; i < STARTS; i++)
		q[i] = random_attitude(&seed), w[i] = random_vector(&seed, 5);
	for (int i = 0; i < OBJECTS; i++)
		inertia[i] = random_inertia(&seed);
	for (int k = 0; k < 1000; k++) {
		uint32_t id = (uint32_t)within(&seed, 0, OBJECTS);
		int i = (int)within(&seed, 0, STARTS);
		double t = within(&seed, .01, 9);
		ob_quat kept, fresh;
		ob_vec3 kept_w, fresh_w;
		ob_spin_at(ob_rotation_cache_get(&plans, id, q[i], w[i], inertia[id]), t, &kept, &kept_w);
		ob_rotate_free(q[i], w[i], inertia[id], t, &fresh, &fresh_w);
		CHECK(!memcmp(&kept, &fresh, sizeof kept) && !memcmp(&kept_w, &fresh_w, sizeof kept_w));
	}
	ob_rotation_cache_finish(&plans);
}

int main(void)
{
	test_exact();
	test_by_ode();
	test_alone_or_not();
	test_new_flights();
	test_long();
	test_kept_plans();
	return check_end();
}

// A force on an object: constant, in flight, in contact, in both architectures, and while asleep; and time-dependent,
// as set by the host.
#include <stdlib.h>

#include "check.h"
#include "motion/force.h"
#include "little_universe.h"

static const double g = 9.81; // m/s^2

// m, deviation from s = (v + a t / 2) t after 2 s in flight
static double flight_error(ob_integrator integrator, uint32_t monolith)
{
	little_scene *s = little_scene_new();
	s->run.integrator = integrator;
	s->run.monolith = monolith;
	if (monolith)
		s->run.iterations = OB_DEFAULT_MONOLITH_ITERATIONS;
	ob_world_body o = ob_world_box(&s->world, 4, ob_v3(.3, .2, .1), ob_v3(0, 0, 100));
	o.passport->force = ob_v3(6, -2, 4 * g + 8);
	o.state->v = ob_v3(1, 0, 0);
	little_universe l;
	little_open(&l, s);
	double energy = little_energy(&l);
	little_run_to(&l, 2);
	ob_vec3 exact = ob_v3(2 + 1.5 * 2, -.5 * 2, 100 + 2 * 2);
	double error = ob_norm(ob_sub(little_state(&l, 0).pose.p, exact));
	if (integrator == OB_INTEGRATOR_EXACT && !monolith) {
		CHECK_NEAR(ob_norm(ob_sub(little_state(&l, 0).v, ob_v3(4, -1, 4))), 0, 1e-12);
		CHECK_NEAR(little_energy(&l) / energy, 1, 1e-13);
	}
	little_close(&l);
	free(s);
	return error;
}

// Semi-implicit Euler errs by a t h / 2 = 2.69 / 2 * 2 h.
static void test_flight(void)
{
	double a = sqrt(1.5 * 1.5 + .5 * .5 + 2 * 2);
	CHECK(flight_error(OB_INTEGRATOR_EXACT, 0) < 1e-12);
	CHECK_NEAR(flight_error(OB_INTEGRATOR_ODE, 0) / (a / 60 / 8), 1, .01);
	CHECK_NEAR(flight_error(OB_INTEGRATOR_EXACT, 1) / (a / 60 / 8), 1, .01);
}

// A box of 2 kg on the ground with mu = .5, pushed along (3, 4) / 5: x, y, z after 2 s and whether it sleeps
static ob_state pushed(double force, ob_integrator integrator, uint32_t monolith, bool *asleep)
{
	little_scene *s = little_scene_new();
	s->run.integrator = integrator;
	s->run.monolith = monolith;
	if (monolith)
		s->run.iterations = OB_DEFAULT_MONOLITH_ITERATIONS;
	s->run.sleeping = 1;
	ob_world_ground(&s->world);
	ob_world_box(&s->world, 2, ob_v3(.5, .5, .25), ob_v3(0, 0, .25)).passport->force =
		ob_v3(.6 * force, .8 * force, 0);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 2);
	ob_state end = little_state(&l, 1);
	*asleep = little_asleep(&l, 1);
	little_close(&l);
	free(s);
	return end;
}

// Coulomb (1785): a body pushed by less than mu m g stays, and may sleep; by more, a = F / m - mu g.
static void test_friction(void)
{
	bool asleep;
	double limit = .5 * 2 * g;
	ob_state held = pushed(.98 * limit, OB_INTEGRATOR_EXACT, 0, &asleep);
	CHECK(asleep);
	CHECK(hypot(held.pose.p.x, held.pose.p.y) < 1e-5);
	for (int integrator = OB_INTEGRATOR_EXACT; integrator <= OB_INTEGRATOR_ODE; integrator++) {
		ob_state moved = pushed(1.5 * limit, (ob_integrator)integrator, 0, &asleep);
		double way = .5 * (.5 * limit / 2) * 4;
		CHECK(!asleep);
		CHECK_NEAR(moved.pose.p.x / (.6 * way), 1, integrator == OB_INTEGRATOR_EXACT ? .003 : .01);
		CHECK_NEAR(moved.pose.p.y / (.8 * way), 1, integrator == OB_INTEGRATOR_EXACT ? .003 : .01);
	}
	// ODE's friction is a pyramid along x and y: stronger along the diagonal, equal along an axis
	CHECK(ob_norm(pushed(2 * limit, OB_INTEGRATOR_EXACT, 1, &asleep).v) > 1);
}

// A force that lifts a body off the ground, and one that presses it against a ceiling without gravity.
static void test_against_gravity(void)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.sleeping = 1;
	ob_world_box(&s->world, 0, ob_v3(5, 5, .5), ob_v3(0, 0, 2));
	ob_world_box(&s->world, 1, ob_v3(.25, .25, .25), ob_v3(0, 0, 0)).passport->force = ob_v3(0, 0, 50);
	little_universe l;
	little_open(&l, s);
	double energy = little_energy(&l);
	little_run_to(&l, 3);
	CHECK_NEAR(little_state(&l, 1).pose.p.z, 1.25, 1e-3);
	CHECK(little_asleep(&l, 1));
	// it has lost the energy of the force's work on the way, and gained none
	CHECK_NEAR(little_energy(&l) - energy, -50 * 1.25, .05);
	little_close(&l);
	free(s);
}

// ---- forces that change in time

static const ob_vec3 none = { 0, 0, 0 };

// Runs a number of steps, and sets the force before each, as the host does.
static void run_under(little_universe *l, uint32_t id, const ob_force *f, double h, uint64_t steps)
{
	for (uint64_t i = 0; i < steps; i++) {
		const uint64_t step = ob_step_count(l->u);
		const ob_vec3 now = ob_force_mean(f, h, step), before = step ? ob_force_mean(f, h, step - 1) : none;
		ob_sim_push(l->u, id, now, ob_norm2(ob_sub(now, before)) > 0);
		little_run(l, 1);
	}
}

// m, how far a body of m = 2 kg is behind A (w t - sin w t) / (m w^2) under A sin w t, at t = 5 s. sliding: on a plane
// without friction
static double shaken_error(double h, bool sliding, double *speed_error)
{
	const ob_force f = { .kind = OB_FORCE_SINE, .force = { 6, 0, 0 }, .frequency = 2.5 };
	const double m = 2, w = f.frequency, t = 5;
	little_scene *s = little_scene_new();
	s->run.step_length = h;
	s->run.sleeping = 1;
	if (sliding)
		ob_world_ground(&s->world);
	else
		s->run.gravity = none;
	ob_world_box(&s->world, m, ob_v3(.2, .2, .1), ob_v3(0, 0, .1));
	ob_world_material(&s->world, 0, 0);
	const uint32_t id = sliding ? 1 : 0;
	little_universe l;
	little_open(&l, s);
	run_under(&l, id, &f, h, (uint64_t)lround(t / h));
	const ob_state end = little_state(&l, id);
	*speed_error = end.v.x - f.force.x * (1 - cos(w * t)) / (m * w);
	const double error = end.pose.p.x - f.force.x * (w * t - sin(w * t)) / (m * w * w);
	little_close(&l);
	free(s);
	return error;
}

// The mean of each step gives its impulse, so the velocity has no error; the position's is h^2 / 12 (F(t) - F(0)) / m.
static void test_sine(void)
{
	static const double h[] = { .1, .05, .025 };
	for (int i = 0; i < 3; i++) {
		double v, sliding_v;
		const double flying = shaken_error(h[i], false, &v), sliding = shaken_error(h[i], true, &sliding_v);
		const double told = h[i] * h[i] / 12 * 6 * sin(2.5 * 5) / 2;
		printf("sine, h = %g s: off by %.3g m in flight, where %.3g is expected, %.3g m on a plane; %.2g, %.2g "
		       "m/s\n",
		       h[i], flying, told, sliding, v, sliding_v);
		CHECK(fabs(v) < 1e-12);
		CHECK_NEAR(flying / told, 1, .02);
		CHECK(fabs(sliding_v) < 1e-9);
		CHECK(fabs(sliding) < h[i] * h[i]);
	}
}

// A sleeping body wakes when a force begins, moves off with J / m, and rests again when friction stops it.
static void test_pulse(void)
{
	const double h = 1. / 60, m = 2, mu = .5;
	const ob_force f = { .kind = OB_FORCE_PULSE, .force = { 40, 0, 0 }, .from = 3.003, .until = 3.307 };
	for (int rough = 0; rough < 2; rough++) {
		little_scene *s = little_scene_new();
		s->run.sleeping = 1;
		ob_world_ground(&s->world);
		ob_world_box(&s->world, m, ob_v3(.5, .5, .25), ob_v3(0, 0, .25));
		ob_world_material(&s->world, rough ? mu : 0, 0);
		little_universe l;
		little_open(&l, s);
		run_under(&l, 1, &f, h, 180);
		CHECK(little_asleep(&l, 1));
		run_under(&l, 1, &f, h, 1);
		CHECK(!little_asleep(&l, 1));
		run_under(&l, 1, &f, h, 19);
		const double during = f.until - f.from, after = 200 * h - f.until, a = rough ? mu * g : 0,
			     speed = (f.force.x / m - a) * during - a * after;
		const double v = little_state(&l, 1).v.x;
		printf("pulse, mu = %g: %.9g m/s, expected %.9g\n", rough ? mu : 0, v, speed);
		CHECK_NEAR(v / speed, 1, rough ? .01 : 1e-9);
		run_under(&l, 1, &f, h, 200);
		CHECK(little_asleep(&l, 1) == rough);
		little_close(&l);
		free(s);
	}
}

// In the one world of ODE, whose semi-implicit Euler keeps the impulse, too
static void test_pulse_of_ode(void)
{
	const double h = 1. / 60;
	const ob_force f = { .kind = OB_FORCE_PULSE, .force = { 40, 0, 0 }, .from = 3.003, .until = 3.307 };
	little_scene *s = little_scene_new();
	s->run.monolith = 1;
	s->run.sleeping = 1;
	s->run.iterations = OB_DEFAULT_MONOLITH_ITERATIONS;
	ob_world_ground(&s->world);
	ob_world_box(&s->world, 2, ob_v3(.5, .5, .25), ob_v3(0, 0, .25));
	ob_world_material(&s->world, 0, 0);
	little_universe l;
	little_open(&l, s);
	run_under(&l, 1, &f, h, 180);
	CHECK(little_asleep(&l, 1));
	run_under(&l, 1, &f, h, 60);
	CHECK_NEAR(little_state(&l, 1).v.x, 20 * (f.until - f.from), 1e-9);
	little_close(&l);
	free(s);
}

int main(void)
{
	test_sine();
	test_pulse();
	test_pulse_of_ode();
	test_flight();
	test_friction();
	test_against_gravity();
	return check_end();
}

// A constant force of an object's own: in flight, in contact, in both architectures, and while asleep.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static const double g = 9.81; // m/s^2

// m, from where s = (v + a t / 2) t says, after 2 s in flight
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
	ob_world_box(&s->world, 2, ob_v3(.5, .5, .25), ob_v3(0, 0, .25)).passport->force = ob_v3(.6 * force, .8 * force, 0);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 2);
	ob_state end = little_state(&l, 1);
	*asleep = little_asleep(&l, 1);
	little_close(&l);
	free(s);
	return end;
}

// Coulomb (1785): what is pushed by less than mu m g stays, and may sleep; by more, a = F / m - mu g.
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
	// ODE's friction is a pyramid along x and y: along the diagonal it holds more, along an axis as much
	CHECK(ob_norm(pushed(2 * limit, OB_INTEGRATOR_EXACT, 1, &asleep).v) > 1);
}

// A force that lifts what lies on the ground, and one that presses it against a ceiling without gravity.
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
	// it has lost what the force put in on the way, and no energy came from nowhere
	CHECK_NEAR(little_energy(&l) - energy, -50 * 1.25, .05);
	little_close(&l);
	free(s);
}

int main(void)
{
	test_flight();
	test_friction();
	test_against_gravity();
	return check_end();
}

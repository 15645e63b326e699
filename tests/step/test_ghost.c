// The two deliberately inexact solvers, compared with the right ones: neighbours as ghosts, and read late.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

typedef struct outcome {
	double momentum, energy, velocity; // relative errors, with the closed form for the velocities
} outcome;

// A box or sphere of mass 1 at 1 m/s hits one of mass "ratio" at rest.
static outcome hit(uint32_t solver, uint32_t lag, bool boxes, double ratio, double e)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.solver = solver;
	s->run.lag = lag;
	for (int i = 0; i < 2; i++) {
		ob_vec3 at = ob_v3(1.537 * i, 0, 0);
		double mass = i ? ratio : 1;
		ob_world_body o = boxes ? ob_world_box(&s->world, mass, ob_v3(.5, .5, .5), at)
					: ob_world_sphere(&s->world, mass, .5, at);
		o.passport->restitution = e;
	}
	s->world.state[0].v = ob_v3(1, 0, 0);
	little_universe l;
	little_open(&l, s);
	little_run(&l, 0);
	double before = little_energy(&l);
	little_run(&l, 90);
	double u = little_state(&l, 0).v.x, v = little_state(&l, 1).v.x;
	outcome o = { fabs(u + ratio * v - 1), little_energy(&l) / before - 1,
		      fmax(fabs(u - (1 - e * ratio) / (1 + ratio)), fabs(v - (1 + e) / (1 + ratio))) };
	little_close(&l);
	free(s);
	return o;
}

static void in_time_is_exact(void)
{
	const double elasticity[] = { 0, .5, 1 };
	for (int boxes = 0; boxes < 2; boxes++)
		for (int i = 0; i < 3; i++)
			for (double ratio = 1; ratio < 2000; ratio *= 1000) {
				outcome o = hit(OB_SOLVER_LAGGED, 0, boxes, ratio, elasticity[i]);
				CHECK_NEAR(o.momentum, 0, 1e-15 * ratio);
				CHECK_NEAR(o.velocity, 0, i ? 1e-12 : 1e-8);
			}
}

static void late_is_wrong(void)
{
	double before = 0;
	for (uint32_t lag = 1; lag <= 8; lag *= 2) {
		outcome o = hit(OB_SOLVER_LAGGED, lag, false, 3, .5);
		printf("lag %u: momentum %g, energy %g, velocity %g\n", lag, o.momentum, o.energy, o.velocity);
		CHECK(o.velocity > .05 && o.momentum > .05);
		CHECK(o.velocity >= before);
		before = o.velocity;
	}
}

static void ghosts_are_wrong(void)
{
	outcome o = hit(OB_SOLVER_GHOST, 0, false, 1, 1);
	printf("ghosts: momentum %g, energy %g, velocity %g\n", o.momentum, o.energy, o.velocity);
	CHECK(o.energy > .1 && o.velocity > .1);
	o = hit(OB_SOLVER_GHOST, 0, true, 1000, 0);
	printf("ghosts 1:1000: momentum %g, energy %g, velocity %g\n", o.momentum, o.energy, o.velocity);
	CHECK(o.velocity > .1);
}

// Both sides are right against a fixed body: a reason why the mistake stays unseen for long.
static void grounds_are_ghosts(void)
{
	for (uint32_t solver = OB_SOLVER_GHOST; solver <= OB_SOLVER_LAGGED; solver++) {
		little_scene *s = little_scene_new();
		s->run.solver = solver;
		ob_world_ground(&s->world);
		ob_world_box(&s->world, 1, ob_v3(.5, .5, .5), ob_v3(0, 0, .5));
		little_universe l;
		little_open(&l, s);
		little_run(&l, 60);
		CHECK(fabs(little_state(&l, 1).pose.p.z - .5) < 1e-6);
		little_close(&l);
		free(s);
	}
}

// A stack over many steps: each side must keep its own warm-start impulses.
static void stacks_run_on(void)
{
	for (uint32_t solver = OB_SOLVER_GHOST; solver <= OB_SOLVER_LAGGED; solver++) {
		little_scene *s = little_scene_new();
		s->run.solver = solver;
		ob_world_ground(&s->world);
		ob_world_stack(&s->world, 3, ob_v3(0, 0, 0), 1);
		little_universe l;
		little_open(&l, s);
		little_run(&l, 120);
		double worst = little_penetration(&l).max_m;
		printf("solver %u: stack of 3 after 2 s: %g mm deep, top at %g m\n", solver, worst * 1e3,
		       little_state(&l, 3).pose.p.z);
		CHECK(isfinite(worst));
		little_close(&l);
		free(s);
	}
}

int main(void)
{
	in_time_is_exact();
	late_is_wrong();
	ghosts_are_wrong();
	grounds_are_ghosts();
	stacks_run_on();
	return check_end();
}

// One platform under a hundred boxes: a body with more partners than there are colours.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "solver/island.h"

enum { SIDE = 10, BOXES = SIDE * SIDE };
static_assert(BOXES > (int)OB_COLOURS, "more partners than colours");

// platform_mass 0: static.
// limit: m, of the depth at any moment. Jacobi iterations, with their split masses, stop a landing late.
static void stand(ob_solver_kind solver, double platform_mass, double limit)
{
	little_scene *s = little_scene_new();
	s->run.solver = solver;
	ob_world_ground(&s->world);
	ob_world_box(&s->world, platform_mass, ob_v3(6, 6, .5), ob_v3(0, 0, .5));
	for (int i = 0; i < BOXES; i++)
		ob_world_box(&s->world, 100, ob_v3(.4, .4, .4),
			     ob_v3(i % SIDE - 4.5, i / SIDE - 4.5, 1.45 + .01 * (i % 7)));
	little_universe l;
	little_open(&l, s);
	double deepest = 0;
	uint32_t most = 0,
		 landed = 0; // islands, at any moment; after all have landed, before any equilibrium
	for (int step = 0; step < 300; step++) {
		little_run(&l, 1);
		uint32_t islands = ob_universe_step_data(l.u)->count->islands;
		most = islands > most ? islands : most;
		if (step == 9)
			landed = islands;
		deepest = fmax(deepest, little_penetration(&l).max_m);
	}
	double off = 0, speed = 0;
	for (uint32_t i = 2; i < 2 + BOXES; i++) {
		ob_state at = little_state(&l, i);
		ob_vec3 start = s->world.state[i].pose.p;
		off = fmax(off, ob_norm(ob_sub(at.pose.p, ob_v3(start.x, start.y, 1.4))));
		speed = fmax(speed, ob_norm(at.v));
	}
	printf("solver %d, platform %g kg: deepest %.3f mm, boxes off by %.3f mm, at most %.1e m/s\n", solver,
	       platform_mass, 1e3 * deepest, 1e3 * off, speed);
	CHECK(deepest < limit);
	CHECK(off < 1e-3);
	CHECK(speed < 1e-3);
	CHECK(platform_mass > 0 ? landed == 1 : most == BOXES);
	little_close(&l);
	free(s);
}

int main(void)
{
	stand(OB_SOLVER_COLOURED, 0, .2e-3);
	stand(OB_SOLVER_COLOURED, 5000, .2e-3);
	stand(OB_SOLVER_JACOBI, 0, .2e-3);
	stand(OB_SOLVER_JACOBI, 5000, 5e-3);
	return check_end();
}

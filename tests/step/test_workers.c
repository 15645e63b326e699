// The bits do not depend on the workers: one, two, three, or one for each object, in threads.
#include <pthread.h>
#include <stdlib.h>

#include "base/sanitizer.h"
#include "check.h"
#include "little_universe.h"
#include "ode/ode_body.h"
#include "step/island_builder.h"

#include "motion/random.h"

enum { LONG = OB_SANITIZED ? 80 : 240 }; // steps; the heap lands within 60

typedef struct worker {
	ob_universe *u;
	uint32_t number;
	pthread_t thread;
} worker;

static void *live(void *arg)
{
	const worker *w = arg;
	ob_error e;
	ob_ode_thread_init();
	ob_sim *s = ob_sim_create(w->u, w->number, &e);
	if (!s) {
		fprintf(stderr, "worker %u: %s\n", w->number, e.text);
		exit(1);
	}
	ob_sim_run(s);
	ob_sim_destroy(s);
	ob_ode_thread_finish();
	return NULL;
}

static bool arranged_together; // in the last step of the last run, all workers built islands

// The state's hash after a number of steps; halfway they pause, and the last object is removed.
static uint64_t run(const little_scene *s, uint32_t workers, uint64_t steps)
{
	ob_universe *u = little_populate(s, workers);
	ob_snapshot now = { 0 };
	ob_error e;
	worker *crowd = calloc(workers, sizeof *crowd);
	for (uint32_t i = 0; i < workers; i++) {
		crowd[i] = (worker){ .u = u, .number = i };
		CHECK(pthread_create(&crowd[i].thread, NULL, live, &crowd[i]) == 0);
	}
	ob_gate_set_pause_step(u, steps / 2);
	ob_sim_resume(u);
	CHECK(ob_gate_host_wait(u, 60));
	CHECK(ob_step_count(u) == steps / 2);
	ob_sim_remove(u, s->world.objects - 1);
	ob_gate_set_pause_step(u, steps);
	ob_sim_resume(u);
	CHECK(ob_gate_host_wait(u, 60));
	CHECK(ob_step_count(u) == steps);
	CHECK(ob_sim_failure(u) == NULL);
	CHECK(ob_snapshot_take(&now, u, 0, &e));
	uint64_t hash = ob_measure_hash(&now);
	arranged_together = ob_universe_step_data(u)->count->rooted;
	ob_gate_stop(u);
	for (uint32_t i = 0; i < workers; i++)
		pthread_join(crowd[i].thread, NULL);
	ob_snapshot_finish(&now);
	ob_universe_destroy(u, true);
	free(crowd);
	return hash;
}

// Boxes, spheres, a capsule and a cylinder that fall on each other and on a fixed box, some with restitution.
static little_scene *heap(ob_solver_kind solver, ob_integrator integrator)
{
	uint64_t seed = 1;
	little_scene *s = little_scene_new();
	s->run.solver = solver;
	s->run.integrator = integrator;
	s->run.sleeping = 1;
	ob_world_ground(&s->world);
	ob_world_box(&s->world, 0, ob_v3(1, 1, .3), ob_v3(0, 0, .3));
	for (int i = 0; i < 40; i++) {
		ob_vec3 p = random_vector(&seed, .1), half = random_vector(&seed, .1);
		p = ob_add(p, ob_v3(i % 4 * 1.1 - 1.6, i / 4 % 4 * 1.1 - 1.6, 1.2 + i / 16 * 1.1));
		ob_world_body o = i % 5 == 0 ? ob_world_sphere(&s->world, 10, .3, p)
					     : ob_world_box(&s->world, 20, ob_add(ob_v3(.3, .3, .3), half), p);
		o.passport->restitution = i % 3 ? 0 : .5;
		o.state->pose.q = random_attitude(&seed);
	}
	ob_world_add(&s->world, OB_SHAPE_CAPSULE, ob_v3(.2, .3, 0), 10, ob_v3(0, 0, 5));
	ob_world_add(&s->world, OB_SHAPE_CYLINDER, ob_v3(.3, .2, 0), 10, ob_v3(.2, .1, 6));
	return s;
}

static void compare(ob_solver_kind solver, ob_integrator integrator, double tolerance, uint64_t steps)
{
	little_scene *s = heap(solver, integrator);
	s->run.tolerance = tolerance;
	s->run.substeps = tolerance > 0 ? 1 : s->run.substeps;
	uint64_t one = run(s, 1, steps);
	CHECK(run(s, 1, steps) == one);
	for (uint32_t workers = 2; workers <= 3; workers++)
		CHECK(run(s, workers, steps) == one);
	s->run.one_per_object = 1;
	CHECK(run(s, s->world.objects, steps) == one);
	s->run.one_per_object = 0;
	s->world.state[5].v.x += 1e-15; // a hash that ignores this would be useless
	s->world.state[5].pose.p.x += 1e-15;
	CHECK(run(s, 1, steps) != one);
	free(s);
}

// Many balls that fall on each other in one step, with late contacts, so that all workers build the islands.
static little_scene *crowd_of_balls(void)
{
	uint64_t seed = 2;
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	for (int i = 0; i < 2 * OB_ISLANDS_MANY; i++) {
		ob_vec3 p = ob_v3(i % 16 * .41, i / 16 % 16 * .41, .25 + i / 256 * .41);
		ob_world_sphere(&s->world, 10, .2, ob_add(p, random_vector(&seed, .02))).state->v =
			random_vector(&seed, 3);
	}
	return s;
}

static void test_many(void)
{
	enum { STEPS = 6 };
	little_scene *s = crowd_of_balls();
	s->run.substeps = 1;
	s->run.iterations = 4;
	const uint64_t one = run(s, 1, STEPS);
	CHECK(arranged_together);
	for (uint32_t workers = 2; workers <= 5; workers += 3)
		CHECK(run(s, workers, STEPS) == one);
	free(s);
}

int main(void)
{
	test_many();
	compare(OB_SOLVER_COLOURED, OB_INTEGRATOR_EXACT, 0, LONG);
	compare(OB_SOLVER_JACOBI, OB_INTEGRATOR_EXACT, 0, LONG);
	compare(OB_SOLVER_COLOURED, OB_INTEGRATOR_ODE, 0, 60);
	compare(OB_SOLVER_COLOURED, OB_INTEGRATOR_EXACT, .5e-3, LONG / 2);
	compare(OB_SOLVER_COLOURED, OB_INTEGRATOR_ODE, .5e-3, 60);
	return check_end();
}

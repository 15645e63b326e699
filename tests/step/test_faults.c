// Faults that are known and not mended: each of these tests fails today, and is marked so in meson.build. Mending one makes
// meson say so: the mark goes, and the test moves to its topic.
//   faults cribs       a crib tower of 150 layers, set down with gaps, lands within the budget of its steps
//   faults ragdoll     a ragdoll that has fallen is at rest
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "check.h"
#include "little_universe.h"
#include "step/budget.h"

// Runs until so many steps are complete. false: one has failed.
static bool run_to(little_universe *l, uint64_t step)
{
	ob_gate_set_pause_step(l->u, step);
	ob_sim_resume(l->u);
	while (!ob_gate_host_wait(l->u, 0))
		ob_step(l->sim);
	return ob_step_failed(l->u, NULL) == OB_STEP_OK;
}

static void test_cribs(void)
{
	enum { LAYERS = 150 };
	const double thick = .08, gap = .0005;
	uint64_t seed = 1;
	little_scene *s = little_scene_new();
	s->run.tolerance = .001;
	ob_world_ground(&s->world);
	for (int i = 0; i < 2 * LAYERS; i++) {
		const bool along = i / 2 % 2;
		const double side = i % 2 ? .2 : -.2;
		const ob_vec3 off = ob_splitmix_vector(&seed, gap);
		ob_world_box(&s->world, 10, along ? ob_v3(.25, .025, .5 * thick) : ob_v3(.025, .25, .5 * thick),
			     ob_v3((along ? 0 : side) + off.x, (along ? side : 0) + off.y,
				   (i / 2 + .5) * thick + (i / 2 + 1) * gap));
	}
	little_universe l;
	little_open(&l, s);
	const bool lands = run_to(&l, 60);
	CHECK(lands);
	if (!lands)
		fprintf(stderr, "%s\n", ob_sim_failure(l.u));
	little_close(&l);
	free(s);
}

static void test_ragdoll(void)
{
	little_scene *s = little_scene_new();
	s->run.tolerance = .001;
	ob_world_ragdoll(&s->world, ob_v3(0, 0, .3), 1.2);
	ob_world_ground(&s->world);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 6);
	double fastest = 0;
	for (uint32_t i = 0; i < l.now.count; i++)
		fastest = fmax(fastest, ob_norm(little_state(&l, i).v));
	printf("a ragdoll after 6 s: %.3g m/s\n", fastest);
	CHECK(fastest <= 1e-6);
	little_close(&l);
	free(s->world.joint);
	free(s);
}

int main(int argc, char **argv)
{
	if (argc > 1 && strcmp(argv[1], "ragdoll") == 0)
		test_ragdoll();
	else
		test_cribs();
	return check_end();
}

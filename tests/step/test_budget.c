// A step has a budget of work: when it is spent the run fails, nothing of the step is published, and the failure
// names the bodies that spent it. Divergence ends a run in the same way, and so does a failure of ODE.
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "check.h"
#include "little_universe.h"
#include "solver/narrowphase.h"
#include "step/budget.h"
#include "terrain/terrain.h"

// Checks the failure's message; the state of the previous step stands.
static void expect_failure(little_universe *l, ob_step_failure why, uint32_t object, const char *saying)
{
	uint64_t before = ob_step_count(l->u);
	ob_motion motion = *ob_newest_motion(l->u, object);
	ob_gate_set_pause_step(l->u, before + 1);
	ob_sim_resume(l->u);
	while (!ob_gate_host_wait(l->u, 0))
		ob_step(l->sim);
	uint32_t blamed = UINT32_MAX;
	CHECK(ob_step_failed(l->u, &blamed) == why && blamed == object);
	CHECK(ob_step_count(l->u) == before);
	CHECK(memcmp(&motion, ob_newest_motion(l->u, object), sizeof motion) == 0);
	const char *text = ob_sim_failure(l->u);
	bool said = text && strstr(text, saying);
	CHECK(said);
	if (!said)
		fprintf(stderr, "%s\n", text ? text : "no failure");
}

// A few bodies are solved for a last grain of work, as if the rest of the step had spent all the others.
static void test_spent(void)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	for (int i = 0; i < 40; i++) {
		ob_world_body b = ob_world_box(&s->world, 500, ob_v3(.5, .5, .5), ob_v3(.1 * (i % 2), 0, .5 + .9 * i));
		snprintf(b.passport->name, OB_NAME_MAX, "brick %d", i);
	}
	little_universe l;
	little_open(&l, s);
	ob_step_work_add(l.u, UINT64_C(1) << 40);
	expect_failure(&l, OB_STEP_OVERWORKED, 1, "step 1 takes more work than a step may: object 1 (brick 0)");
	little_close(&l);
	free(s);
}

// The last grain of work is spent by a lone flight: past many planes, or in many substeps of ODE's stepper.
static void test_spent_in_flight(void)
{
	for (int by_ode = 0; by_ode < 2; by_ode++) {
		little_scene *s = little_scene_new();
		if (by_ode) {
			s->run.integrator = OB_INTEGRATOR_ODE;
			s->run.tolerance = 0;
			s->run.substeps = 1000;
		}
		ob_world_sphere(&s->world, 500, .5, ob_v3(0, 0, 9));
		for (int i = 0; i < (by_ode ? 1 : 200); i++)
			ob_world_ground(&s->world);
		little_universe l;
		little_open(&l, s);
		ob_step_work_add(l.u, UINT64_C(1) << 40);
		expect_failure(&l, OB_STEP_OVERWORKED, 0, "step 1 takes more work than a step may: object 0");
		little_close(&l);
		free(s);
	}
}

// Each share drops its remainder below a grain: the number of flights beside each other on a worker adds nothing to the
// sum.
static void test_small_shares(void)
{
	little_scene *s = little_scene_new();
	for (int i = 0; i < 32; i++)
		ob_world_sphere(&s->world, 500, .5, ob_v3(9 * i, 0, 9));
	for (int i = 0; i < 20; i++)
		ob_world_ground(&s->world);
	little_universe l;
	little_open(&l, s);
	ob_step_work_add(l.u, UINT64_C(1) << 40);
	ob_gate_set_pause_step(l.u, 1);
	ob_sim_resume(l.u);
	while (!ob_gate_host_wait(l.u, 0))
		ob_step(l.sim);
	CHECK(ob_step_failed(l.u, NULL) == OB_STEP_OK && ob_step_count(l.u) == 1);
	little_close(&l);
	free(s);
}

// Work of a step in which a ball is pushed out of so many static boxes, far from any force.
static uint64_t work_of_push(int boxes)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.tolerance = 0;
	s->run.substeps = 8;
	ob_world_sphere(&s->world, 500, .5, ob_v3(0, 0, .99));
	for (int i = 0; i < boxes; i++)
		ob_world_box(&s->world, 500, ob_v3(.5, .5, .5), ob_v3(.001 * i, 0, 0)).passport->flags |=
			OB_OBJECT_STATIC;
	little_universe l;
	little_open(&l, s);
	const uint64_t before = l.sim->solver.budget.noted;
	little_run(&l, 1);
	const uint64_t work = l.sim->solver.budget.noted - before;
	little_close(&l);
	free(s);
	return work;
}

// A push moves a body, and finds the gaps of all its contacts anew: pushes out of each of n cost n^2.
static void test_pushes(void)
{
	const uint64_t few = work_of_push(20), many = work_of_push(160);
	printf("pushed out of 20 boxes: %llu units of work, out of 160: %llu\n", (unsigned long long)few,
	       (unsigned long long)many);
	CHECK(many > 16 * few);
}

// Runs blocks that slide on each other until a step is estimated: returns its number. From step "blind" on nothing is.
// work: of the last step.
static uint64_t run_estimated(uint64_t blind, uint64_t *work)
{
	little_scene *s = little_scene_new();
	s->run.tolerance = OB_DEFAULT_TOLERANCE;
	ob_world_ground(&s->world);
	for (int i = 0; i < 60; i++)
		ob_world_box(&s->world, 500, ob_v3(.5, .5, .5), ob_v3(.3 * (i % 2), 0, .5 + i)).state->v.x = 1 + i % 2;
	little_universe l;
	little_open(&l, s);
	ob_solver *solver = &l.sim->solver;
	struct ob_probe *const probe = solver->estimate.probe;
	ob_counters count = { .estimates = 0 };
	while (count.estimates == 0 && ob_step_count(l.u) < blind) {
		const uint64_t before = ob_budget_work(solver);
		solver->estimate.probe = ob_step_count(l.u) + 1 < blind ? probe : NULL;
		little_run(&l, 1);
		*work = ob_budget_work(solver) - before;
		ob_universe_count(l.u, &count);
	}
	const uint64_t step = ob_step_count(l.u);
	solver->estimate.probe = probe;
	little_close(&l);
	free(s);
	return step;
}

// An estimate solves the step beside its solution: its work counts for the step, too.
static void test_estimates(void)
{
	uint64_t with = 0, without = 0;
	const uint64_t step = run_estimated(60, &with);
	CHECK(run_estimated(step, &without) == step);
	printf("step %llu: %llu units of work with its estimate, %llu without\n", (unsigned long long)step,
	       (unsigned long long)with, (unsigned long long)without);
	CHECK(4 * with >= 5 * without);
}

// Each triangle of a terrain that is tested counts, whether the body touches there or not: a cylinder that others hold off a
// ridge is compared with all of it.
static void test_terrain(void)
{
	static const double height[9] = { 0, 1, 0, 0, 1, 0, 0, 1, 0 };
	const ob_quat level = ob_quat_identity();
	little_scene *s = little_scene_new();
	ob_world_sphere(&s->world, 500, .5, ob_v3(0, 0, 9));
	little_universe l;
	little_open(&l, s);
	ob_error e;
	ob_terrain *t = ob_terrain_of_heights(height, (uint32_t[2]){ 2, 2 }, (double[2]){ 2, 2 }, &e);
	const ob_manifold_finder finder = ob_narrowphase_finder(&l.sim->solver);
	ob_budget_begin_share(l.sim, 0);
	for (uint32_t i = 0; i < t->regions; i++) {
		ob_terrain_part part;
		ob_terrain_take(t, i, &part);
		const ob_placed ground = { .shape = OB_SHAPE_TERRAIN,
					   .size = ob_terrain_size(t),
					   .r = ob_quat_matrix(level),
					   .hull = &part.hull },
				cylinder = { .shape = OB_SHAPE_CYLINDER,
					     .size = { .5, .5, 0 },
					     .p = { .1, .1, .3 },
					     .r = ob_quat_matrix(level) };
		ob_manifold m;
		const uint64_t before = l.sim->solver.budget.noted;
		finder.find(finder.with, &cylinder, &ground, .1, &m);
		CHECK(m.pieces > 0);
		CHECK(l.sim->solver.budget.noted - before >= 2000 * m.pieces);
	}
	free(t);
	little_close(&l);
	free(s);
}

// Dearer tests count for more. Once the budget is spent no two bodies touch any more, so that a loop over many pairs
// ends.
static void test_collision_tests(void)
{
	little_scene *s = little_scene_new();
	ob_world_sphere(&s->world, 500, .5, ob_v3(0, 0, 9));
	little_universe l;
	little_open(&l, s);
	const ob_placed sphere = { .shape = OB_SHAPE_SPHERE,
				   .size = { .5, 0, 0 },
				   .r = ob_quat_matrix(ob_quat_identity()) };
	ob_placed box = sphere, cylinder = sphere;
	box.shape = OB_SHAPE_BOX, box.size = ob_v3(.5, .5, .5), box.p = ob_v3(.3, .2, .1);
	cylinder.shape = OB_SHAPE_CYLINDER, cylinder.size = ob_v3(.5, .5, 0);
	const ob_manifold_finder finder = ob_narrowphase_finder(&l.sim->solver);
	ob_manifold m;
	uint64_t noted[2];
	ob_budget_begin_share(l.sim, 0);
	for (int i = 0; i < 2; i++) {
		const uint64_t before = l.sim->solver.budget.noted;
		finder.find(finder.with, i ? &cylinder : &sphere, &box, .1, &m);
		noted[i] = l.sim->solver.budget.noted - before;
		CHECK(m.points > 0);
	}
	CHECK(noted[0] > 0 && noted[1] > 20 * noted[0]);
	ob_step_work_add(l.u, UINT64_C(1) << 40);
	ob_budget_note(&l.sim->solver, 1 << 20);
	finder.find(finder.with, &sphere, &box, .1, &m);
	CHECK(m.points == 0 && m.separation > 0);
	little_close(&l);
	free(s);
}

// A finder that counts its calls.
typedef struct counted {
	ob_manifold_finder finder;
	uint64_t calls;
} counted;

static void count(void *with, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	counted *c = with;
	c->calls++;
	c->finder.find(c->finder.with, a, b, margin, out);
}

// Looks for an impact of two shapes, of "size" (m) and thin, that turn at "spin" (rad/s) beside each other. Returns the
// number of advances.
static uint64_t search(ob_sim *s, ob_shape shape, double size, double slenderness, double spin, bool nearing)
{
	const double thin = size / slenderness, speed = 2 * spin * size + 1;
	ob_placed x[2];
	ob_manifold m = { .valid_path = INFINITY };
	counted c = { .finder = ob_narrowphase_follower(&s->solver) };
	double apart;
	for (int i = 0; i < 2; i++)
		x[i] = (ob_placed){ .shape = shape,
				    .size = shape == OB_SHAPE_BOX ? ob_v3(size, thin, thin) : ob_v3(thin, size, 0),
				    .p = ob_v3(0, 8 * thin * i, 0),
				    .r = ob_quat_matrix(ob_quat_identity()),
				    .v = ob_v3(0, -.1 * i, 0),
				    .w = shape == OB_SHAPE_BOX ? ob_v3(0, spin, .1 * spin)
							       : ob_v3(.1 * spin, 0, spin) };
	if (nearing)
		ob_time_of_nearing(&x[0], &x[1], speed, .1, .1, .1 * thin, (ob_manifold_finder){ count, &c, false },
				   &apart);
	else
		ob_time_of_impact(&x[0], &x[1], speed, 1. / 60, .1 * thin, .1 * thin,
				  (ob_manifold_finder){ count, &c, false }, &m);
	return c.calls;
}

// Each advance of a search costs as much as two dozen pairs in an iteration, however thin and fast the shapes are. Once
// the budget is spent a search ends after its first test.
static void test_searches(void)
{
	static const ob_shape shapes[] = { OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER };
	enum { LEAST = 24 };
	little_scene *scene = little_scene_new();
	ob_world_sphere(&scene->world, 500, .5, ob_v3(0, 0, 9));
	little_universe l;
	little_open(&l, scene);
	for (int spent = 0; spent < 2; spent++) {
		uint64_t most = 0;
		ob_budget_begin_share(l.sim, 0);
		if (spent)
			ob_step_work_add(l.u, UINT64_C(1) << 40);
		for (int i = 0; i < 3 * 3 * 3 * 3 * 2; i++) {
			const double size = (double[]){ 1e-6, 1, 1e6 }[i % 3],
				     slenderness = (double[]){ 1, 100, 1e4 }[i / 3 % 3];
			const double fastest = ob_min(1e4, 1e5 / size),
				     spin = fastest * (double[]){ 0, .01, 1 }[i / 9 % 3];
			const uint64_t before = l.sim->solver.budget.noted;
			if (spent)
				ob_budget_note(&l.sim->solver, 1 << 20);
			const uint64_t n = search(l.sim, shapes[i / 27 % 3], size, slenderness, spin, i / 81);
			CHECK(l.sim->solver.budget.noted - before >= LEAST * n);
			most = n > most ? n : most;
		}
		CHECK(spent ? most == 1 : most > 100);
	}
	little_close(&l);
	free(scene);
}

// A box that lies on this many triangles of a skin, all equal or apart by a hair.
static little_scene *on_triangles(uint32_t n, double hair)
{
	const uint32_t cells[2] = { 8, 8 };
	ob_vec3 *vertex = malloc(3 * n * sizeof *vertex);
	uint32_t(*corner)[3] = malloc(n * sizeof *corner);
	uint64_t seed = 5;
	ob_error e;
	for (uint32_t i = 0; i < 3 * n; i++) {
		static const ob_vec3 at[] = { { -5, -5, 0 }, { 5, -5, 0 }, { 0, 5, 0 } };
		vertex[i] = ob_madd(at[i % 3], hair, ob_splitmix_vector(&seed, 1));
		corner[i / 3][i % 3] = i;
	}
	little_scene *s = little_scene_new();
	snprintf(ob_world_box(&s->world, 500, ob_v3(.2, .2, .2), ob_v3(0, 0, .2)).passport->name, OB_NAME_MAX, "crate");
	ob_world_terrain(&s->world, ob_terrain_build(vertex, 3 * n, (const uint32_t(*)[3])corner, n, cells, false, &e),
			 ob_v3(0, 0, 0));
	free(vertex);
	free(corner);
	return s;
}

static void test_surfaces(void)
{
	static const double hair[] = { 0, 1e-4 };
	for (int i = 0; i < 2; i++) {
		little_scene *few = on_triangles(1000, hair[i]), *many = on_triangles(20000, hair[i]);
		little_universe l;
		little_open(&l, few);
		little_run(&l, 3);
		CHECK_NEAR(little_state(&l, 0).pose.p.z, .2, 1e-3);
		little_close(&l);
		little_open(&l, many);
		expect_failure(&l, OB_STEP_SURFACES_FULL, 0, "object 0 (crate) is near more surfaces of terrain");
		little_close(&l);
		free(few->world.terrains), free(many->world.terrains);
		free(few), free(many);
	}
}

static void test_diverged(void)
{
	little_scene *s = little_scene_new();
	ob_world_sphere(&s->world, 1, .5, ob_v3(0, 0, 0));
	ob_world_body wild = ob_world_sphere(&s->world, 1e-9, .5, ob_v3(9, 0, 0));
	wild.passport->force = ob_v3(0, 1e15, 0);
	snprintf(wild.passport->name, OB_NAME_MAX, "wild");
	little_universe l;
	little_open(&l, s);
	expect_failure(&l, OB_STEP_DIVERGED, 1, "object 1 (wild) diverged in step 1");
	little_close(&l);
	free(s);
}

// A body with so little inertia becomes NaN, and ODE's stepper rejects it.
static void test_engine(void)
{
	little_scene *s = little_scene_new();
	s->run.integrator = OB_INTEGRATOR_ODE;
	s->run.step_length = 1;
	s->run.tolerance = 0;
	s->run.substeps = 8;
	ob_world_box(&s->world, 1, ob_v3(.5, .5, .5), ob_v3(0, 0, .5)).passport->inertia.x = 1e-310;
	ob_world_ground(&s->world);
	little_universe l;
	little_open(&l, s);
	expect_failure(&l, OB_STEP_ENGINE, 0, "the solver gave up in step 1 at object 0");
	little_close(&l);
	free(s);
}

int main(void)
{
	test_spent();
	test_spent_in_flight();
	test_small_shares();
	test_collision_tests();
	test_pushes();
	test_estimates();
	test_terrain();
	test_searches();
	test_surfaces();
	test_diverged();
	test_engine();
	return check_end();
}

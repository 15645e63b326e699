// Heaps of frictionless spheres: SimBenchmark's 666 tests.
#include "base/random.h"
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "world/world.h"

enum { SIDE = 6 };
static const double radius = .1; // m

enum { LIFT, RESTITUTION }; // variant: m, above their place in the heap

static void build_spheres(ob_world *w, uint32_t run, const double *variant)
{
	uint64_t seed = 666;
	ob_world_ground(w);
	for (int n = 0; n < SIDE * SIDE * SIDE; n++) {
		ob_vec3 p = ob_v3(n / SIDE / SIDE, n / SIDE % SIDE, n % SIDE);
		double x = ob_splitmix_real(&seed), y = ob_splitmix_real(&seed), z = ob_splitmix_real(&seed);
		p = ob_add(ob_scale(p, .21), ob_scale(ob_v3(x, y, z), .001));
		ob_world_sphere(w, 10, radius, ob_add(p, ob_v3(0, 0, variant[LIFT])));
	}
	ob_world_material(w, 0, variant[RESTITUTION]);
}

static double squared_overlap(double distance, double reach)
{
	return distance < reach ? (reach - distance) * (reach - distance) : 0;
}

// m^2, over all pairs; body 0 is the ground.
static double squared_penetration(const ob_case_run_state *t)
{
	double sum = 0;
	for (uint32_t a = 1; a < t->now.count; a++) {
		ob_vec3 p = t->now.motion[a].p;
		sum += squared_overlap(p.z, radius);
		for (uint32_t b = a + 1; b < t->now.count; b++)
			sum += squared_overlap(ob_norm(ob_sub(p, t->now.motion[b].p)), 2 * radius);
	}
	return sum;
}

static void judge_spheres(ob_case_run_state *t)
{
	if (ob_look_farthest(t) < .05)
		t->failed = "nothing moved";
}

static void observe_666(ob_case_run_state *t)
{
	if (t->frame)
		t->figure[0] += (squared_penetration(t) - t->figure[0]) / t->frame; // mean over the frames
	ob_look_penetration(t, &t->figure[1]);
	ob_look_fail_below(t);
}

const ob_case ob_case_666 = {
	.row = 7,
	.name = "666",
	.title = "SimBenchmark's 666 test",
	.setup = "6 x 6 x 6 spheres of radius .1 m and 10 kg in a grid of .21 m, displaced by up to 1 mm, collapse "
		 "on the ground without friction or restitution; 10 s.",
	.others = "at 60 Hz 7e-4 m^2 (Jolt, Bullet)",
	.compared = true,
	.duration = 10,
	.figures = 2,
	.figure = { { "mean sum of squared penetrations", "m^2", 1e-5, "no penetration (Kang and Hwangbo 2018)" },
		    { "worst penetration", "mm", NAN, "no penetration" } },
	.build = build_spheres,
	.variant = { .101, 0 },
	.observe = observe_666,
	.judge = judge_spheres,
};

static void observe_elastic_666(ob_case_run_state *t)
{
	double energy = ob_look_energy(t);
	if (!t->frame)
		t->memory[0] = energy;
	double error = energy - t->memory[0];
	if (t->frame)
		t->figure[1] += (error * error - t->figure[1]) / t->frame;
	t->figure[0] = sqrt(t->figure[1]) / t->memory[0];
	ob_look_fail_below(t);
}

const ob_case ob_case_elastic_666 = {
	.row = 8,
	.name = "elastic-666",
	.title = "SimBenchmark's elastic 666 test",
	.setup = "The spheres of the 666 test, 1 m higher and with restitution 1; 10 s.",
	.others = "60 Hz 4 to 47 %; ODE at 1 kHz .03 %; RaiSim 8.4 J^2 at 1 ms",
	.duration = 10,
	.figures = 2,
	.figure = { { "rms error of energy", "1", 1e-3, "energy at the start" },
		    { "mean squared error of energy", "J^2", NAN, "energy at the start (Kang and Hwangbo 2018)" } },
	.build = build_spheres,
	.variant = { 1.101, 1 },
	.observe = observe_elastic_666,
	.judge = judge_spheres,
};

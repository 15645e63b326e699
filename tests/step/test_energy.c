// Frictional contact never adds energy, except for the potential energy of penetrations pushed apart, which is counted.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

#include "motion/random.h"

typedef struct growth {
	double gross, net; // over the start, relative to a scale; net of what recovery has raised
	double since; // net, over the least so far
	double recovered; // J
} growth;

static growth watch(little_scene *s, double seconds, double scale)
{
	growth g = { 0 };
	little_universe l;
	ob_counters count;
	little_open(&l, s);
	double energy = little_energy(&l), least = 0;
	for (int step = 0; step < lround(60 * seconds); step++) {
		little_run(&l, 1);
		ob_universe_count(l.u, &count);
		double gained = little_energy(&l) - energy;
		g.gross = fmax(g.gross, gained / scale);
		g.net = fmax(g.net, (gained - count.recovered) / scale);
		least = fmin(least, gained - count.recovered);
		g.since = fmax(g.since, (gained - count.recovered - least) / scale);
	}
	g.recovered = count.recovered;
	little_close(&l);
	free(s);
	return g;
}

// Boxes that begin 5 mm deep in the ground and in each other
static void test_recovery(void)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	for (int i = 0; i < 5; i++)
		ob_world_box(&s->world, 1000, ob_v3(.5, .5, .5), ob_v3(0, 0, .495 + .995 * i));
	double deep = .005 - .0001, raised = 1000 * 9.81 * deep * (1 + 2 + 3 + 4 + 5);
	growth g = watch(s, 2, 1000 * 9.81 * 12.5);
	printf("recovery: %.1f J of %.1f J, net growth %.1e\n", g.recovered, raised, g.net);
	CHECK_NEAR(g.recovered / raised, 1, 1e-3);
	CHECK(g.gross > 1e-3);
	// A contact that closes again within a substep pushes while it still opens: the trapezoid rule of the
	// positions.
	CHECK(g.net <= 1e-5);
}

static little_scene *stack(int n, double ratio, uint32_t substeps)
{
	little_scene *s = little_scene_new();
	s->run.substeps = substeps;
	ob_world_ground(&s->world);
	ob_world_stack(&s->world, n, ob_v3(0, 0, 0), 7);
	if (ratio > 0)
		ob_world_box(&s->world, 1000 * ratio, ob_v3(.5, .5, .5), ob_v3(.005, .005, n + .5));
	return s;
}

static little_scene *pyramid(int rows, uint32_t substeps)
{
	little_scene *s = little_scene_new();
	s->run.substeps = substeps;
	ob_world_ground(&s->world);
	for (int row = 0; row < rows; row++)
		for (int i = 0; i < rows - row; i++)
			ob_world_box(&s->world, 1000, ob_v3(.5, .5, .5),
				     ob_v3(0, 1.05 * (i - .5 * (rows - row - 1)), .5 + row));
	return s;
}

static void report(const char *what, uint32_t substeps, growth g)
{
	printf("%s, %u substeps: growth %.1e gross, %.1e net, %.1e since the least\n", what, substeps, g.gross, g.net,
	       g.since);
	CHECK(g.gross <= 1e-5);
	CHECK(g.net <= 1e-9);
}

// A body that goes over an edge turns about it, opens again, or leaves: in any order, the edge's push does no work.
static void test_edges(double friction)
{
	double most = 0;
	for (uint64_t seed = 1; seed <= 20; seed++) {
		little_scene *s = little_scene_new();
		uint64_t at = seed;
		ob_world_box(&s->world, 0, ob_v3(.4, .4, .2), ob_v3(0, 0, -.2));
		const double x = within(&at, .35, .45), y = within(&at, .35, .45), z = within(&at, .1, .3);
		ob_world_body o = ob_world_sphere(&s->world, 1, .1, ob_v3(x, y, z));
		o.state->v = ob_v3(within(&at, -.3, .3), within(&at, -.3, .3), 0);
		ob_world_material(&s->world, friction, 0);
		most = fmax(most, watch(s, 1, 9.81 * .5).since);
	}
	printf("spheres over an edge, friction %g: %.1e since the least\n", friction, most);
	CHECK(most <= 1e-9);
}

// m, of the corners: the second lowest's height over the lowest's
static double between_lowest(const ob_state *x, ob_vec3 half, double *lowest)
{
	const ob_mat3 r = ob_quat_matrix(x->pose.q);
	double second = *lowest = INFINITY;
	for (int i = 0; i < 8; i++) {
		const ob_vec3 c = ob_v3(i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z);
		const double z = x->pose.p.z + ob_rotate(&r, c).z;
		second = fmin(second, fmax(z, *lowest));
		*lowest = fmin(*lowest, z);
	}
	return second - *lowest;
}

// A box falls from one corner, which slides over smooth ground: until another one hits, energy does not grow.
static void test_smooth_corner(void)
{
	double most = 0;
	for (uint64_t seed = 1; seed <= 20; seed++) {
		little_scene *s = little_scene_new();
		little_universe l;
		uint64_t at = seed;
		double lowest;
		ob_world_ground(&s->world);
		const ob_vec3 half = ob_v3(within(&at, .2, .5), within(&at, .2, .5), within(&at, .2, .5));
		ob_world_body o = ob_world_box(&s->world, 10, half, ob_v3(0, 0, 0));
		o.state->pose.q = random_attitude(&at);
		between_lowest(o.state, half, &lowest);
		o.state->pose.p.z = -lowest;
		ob_world_material(&s->world, 0, 0);
		little_open(&l, s);
		double least = little_energy(&l);
		ob_state now = little_state(&l, 1);
		for (int step = 0; step < 60 && between_lowest(&now, half, &lowest) > .1; step++) {
			little_run(&l, 1);
			now = little_state(&l, 1);
			most = fmax(most, (little_energy(&l) - least) / (10 * 9.81 * .5));
			least = fmin(least, little_energy(&l));
		}
		little_close(&l);
		free(s);
	}
	printf("boxes that fall from a corner on smooth ground: %.1e since the least\n", most);
	CHECK(most <= 1e-9);
}

int main(void)
{
	test_recovery();
	test_edges(0);
	test_edges(.5);
	test_smooth_corner();
	for (uint32_t substeps = 4; substeps <= 8; substeps *= 2) {
		report("stack of 10", substeps, watch(stack(10, 0, substeps), 10, 1000 * 9.81 * 50));
		report("stack of 40", substeps, watch(stack(40, 0, substeps), 10, 1000 * 9.81 * 800));
		report("1000:1", substeps, watch(stack(1, 1000, substeps), 10, 1000 * 9.81 * 1500));
		report("pyramid of 10", substeps, watch(pyramid(10, substeps), 10, 1000 * 9.81 * 192));
	}
	return check_end();
}

// Frictional contact never adds energy, but for what pushing penetrations apart raises, and that is counted.
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
			ob_world_box(&s->world, 1000, ob_v3(.5, .5, .5), ob_v3(0, 1.05 * (i - .5 * (rows - row - 1)), .5 + row));
	return s;
}

static void report(const char *what, uint32_t substeps, growth g)
{
	printf("%s, %u substeps: growth %.1e gross, %.1e net, %.1e since the least\n", what, substeps, g.gross, g.net,
	       g.since);
	CHECK(g.gross <= 1e-5);
	CHECK(g.net <= 1e-9);
}

int main(void)
{
	test_recovery();
	for (uint32_t substeps = 4; substeps <= 8; substeps *= 2) {
		report("stack of 10", substeps, watch(stack(10, 0, substeps), 10, 1000 * 9.81 * 50));
		report("stack of 40", substeps, watch(stack(40, 0, substeps), 10, 1000 * 9.81 * 800));
		report("1000:1", substeps, watch(stack(1, 1000, substeps), 10, 1000 * 9.81 * 1500));
		report("pyramid of 10", substeps, watch(pyramid(10, substeps), 10, 1000 * 9.81 * 192));
	}
	return check_end();
}

// Every engine at its usual settings on the same three scenes: what a body costs per frame of 1/60 s (CPU of stepping
// alone, the least of three runs), how deep bodies are in each other at the worst moment and in the last second
// (mean over touching pairs), and where the lowest centre ends: what fell through the ground shows there.
//
// bench_peers [ENGINE...]    all of them when none is named
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "little_world.h"
#include "measure/measure.h"

typedef struct figures {
	double cost; // us per dynamic body and frame
	double worst, resting; // mm
	double lowest; // m
	char failed[120]; // "" = it did not
} figures;

typedef struct scene {
	const char *name;
	double duration; // s
	void (*build)(little_world *l);
} scene;

// splitmix64 (Steele, Lea and Flood 2014), in [0, 1)
static double uniform(uint64_t *seed)
{
	uint64_t z = *seed += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static void build_stack(little_world *l)
{
	uint64_t seed = 1;
	little_ground(l);
	for (int i = 0; i < 10; i++) {
		double x = .02 * uniform(&seed) - .01, y = .02 * uniform(&seed) - .01;
		little_cube(l, 1000, .5, ob_v3(x, y, .5 + i));
	}
}

// Columns of four boxes of all sizes, 1.8 m apart
static void build_falling_boxes(little_world *l)
{
	uint64_t seed = 1;
	little_ground(l);
	for (int column = 0; column < 25; column++) {
		double z = 1;
		for (int i = 0; i < 4; i++) {
			z += 1.8 + uniform(&seed);
			double a = .1 + .4 * uniform(&seed), b = .1 + .4 * uniform(&seed), c = .1 + .4 * uniform(&seed);
			ob_vec3 p = ob_v3(1.8 * (column % 5 - 2), 1.8 * (column / 5 - 2), z);
			uint32_t id = little_add(l, OB_SHAPE_BOX, ob_v3(a, b, c), 8000 * a * b * c, p);
			double w = 2 * uniform(&seed) - 1, x = 2 * uniform(&seed) - 1, y = 2 * uniform(&seed) - 1;
			l->state[id].pose.q = ob_quat_normalize((ob_quat){ w, x, y, 2 * uniform(&seed) - 1 });
		}
	}
}

// Kang and Hwangbo 2018 (SimBenchmark), test 666
static void build_666(little_world *l)
{
	uint64_t seed = 1;
	little_ground(l);
	for (int i = 0; i < 216; i++) {
		double x = .001 * uniform(&seed), y = .001 * uniform(&seed), z = .001 * uniform(&seed);
		ob_vec3 p = ob_v3(.21 * (i / 36) + x, .21 * (i / 6 % 6) + y, .21 * (i % 6) + z + .101);
		little_sphere(l, 10, .1, p);
	}
	for (uint32_t i = 0; i < l->world.objects; i++)
		l->passport[i].friction = 0;
}

static const scene scenes[] = {
	{ "stack of 10", 20, build_stack },
	{ "falling boxes 100", 10, build_falling_boxes },
	{ "666", 10, build_666 },
};

static ob_penetration depth(const little_world *l)
{
	static ob_motion motion[LITTLE_MOST];
	for (uint32_t i = 0; i < l->world.objects; i++)
		motion[i] = (ob_motion){ .p = l->now[i].pose.p, .q = l->now[i].pose.q };
	ob_snapshot now = { .count = l->world.objects, .motion = motion, .passport = l->world.passport };
	ob_penetration p;
	ob_measure_penetration(&now, &p);
	return p;
}

static double lowest(const little_world *l)
{
	double z = INFINITY;
	for (uint32_t i = 1; i < l->world.objects; i++)
		z = fmin(z, l->now[i].pose.p.z);
	return z;
}

static figures run(const ob_peer_kind *kind, const scene *s)
{
	little_world *l = little_world_new();
	s->build(l);
	ob_peer *p = little_make(kind, l, 0);
	figures f = { 0 };
	ob_error e;
	double cpu = 0;
	long frames = lround(s->duration * 60), last = 0;
	for (long i = 0; i < frames; i++) {
		double before = ob_clock_thread_cpu();
		if (!kind->step(p, &e)) {
			snprintf(f.failed, sizeof f.failed, "%.1f s: %.100s", i / 60., e.text);
			frames = i + 1;
		}
		cpu += ob_clock_thread_cpu() - before;
		kind->get(p, l->now);
		ob_penetration now = depth(l);
		f.worst = fmax(f.worst, 1e3 * now.max_m);
		if (frames - i <= 60) {
			f.resting += 1e3 * now.mean_m;
			last++;
		}
	}
	kind->destroy(p);
	f.resting /= last;
	f.lowest = lowest(l);
	f.cost = 1e6 * cpu / (frames * (l->world.objects - 1));
	free(l);
	return f;
}

static void print_engine(const ob_peer_kind *kind)
{
	for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
		figures best = run(kind, &scenes[i]);
		for (int again = 0; again < 2; again++)
			best.cost = fmin(best.cost, run(kind, &scenes[i]).cost);
		printf("%-18s %-14s %10.2f %10.2f %10.3f %10.3f %s\n", scenes[i].name, kind->name, best.cost,
		       best.worst, best.resting, best.lowest, best.failed);
		fflush(stdout);
	}
}

int main(int argc, char **argv)
{
	printf("%-18s %-14s %10s %10s %10s %10s\n", "scene", "engine", "us/body", "worst mm", "resting mm", "lowest m");
	for (int i = 1; i < argc; i++) {
		const ob_peer_kind *kind = ob_peer_find(argv[i]);
		if (!kind) {
			fprintf(stderr, "no engine \"%s\"\n", argv[i]);
			return 1;
		}
		print_engine(kind);
	}
	for (const ob_peer_kind *const *k = ob_peer_kinds; argc < 2 && *k; k++)
		print_engine(*k);
	return 0;
}

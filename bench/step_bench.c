// Cost of the parts of a step by themselves: an exchange of a pair's impulses, a plan of a motion, the broad phase per
// publication; and the machine's best rates, as a lower bound of all that. The best of many short batches of CPU time,
// so that other load hardly counts.
//
// Lines: what<TAB>unit<TAB>value
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "contact/kernel.h"
#include "motion/flight.h"
#include "motion/spin.h"
#include "step/broadphase.h"
#include "table/table.h"

#include "../tests/contact/scene.h"

enum { BATCHES = 60 };

static volatile double sink; // keeps results from being optimised away

static void print(const char *what, const char *unit, double value)
{
	printf("%s\t%s\t%.4g\n", what, unit, value);
	fflush(stdout);
}

// ---- the machine

typedef double wide __attribute__((vector_size(32)));

// Eight independent chains of a multiplication and an addition: more than any solver has.
#ifdef __x86_64__
#define FOR_WIDE __attribute__((target("avx2")))
#else
#define FOR_WIDE
#endif
FOR_WIDE static double multiply(int rounds)
{
	wide a = { 1, 2, 3, 4 }, b = a + 1., c = a + 2., d = a + 3., e = a + 4., f = a + 5., g = a + 6., h = a + 7.;
	for (int r = 0; r < rounds; r++) {
		a = a * .999 + 1e-3;
		b = b * .999 + 1e-3;
		c = c * .999 + 1e-3;
		d = d * .999 + 1e-3;
		e = e * .999 + 1e-3;
		f = f * .999 + 1e-3;
		g = g * .999 + 1e-3;
		h = h * .999 + 1e-3;
	}
	wide sum = a + b + c + d + e + f + g + h;
	return sum[0] + sum[1] + sum[2] + sum[3];
}

// Rate (B/s) of a copy within so many bytes, read and written once each.
static double copy_rate(size_t bytes)
{
	size_t half = bytes / 2;
	char *memory = aligned_alloc(64, bytes);
	memset(memory, 1, bytes);
	int rounds = (int)(16e6 / (double)half) + 1;
	double best = 1e9;
	for (int b = 0; b < BATCHES; b++) {
		double start = ob_clock_thread_cpu();
		for (int r = 0; r < rounds; r++) {
			memcpy(memory + half, memory, half);
			__asm__ volatile("" ::: "memory");
		}
		best = fmin(best, ob_clock_thread_cpu() - start);
	}
	sink += memory[bytes - 1];
	free(memory);
	return (double)bytes * rounds / best;
}

static void bench_machine(void)
{
	enum { ROUNDS = 100000 };
	double best = 1e9;
	for (int b = 0; b < BATCHES; b++) {
		double start = ob_clock_thread_cpu();
		sink += multiply(ROUNDS);
		best = fmin(best, ob_clock_thread_cpu() - start);
	}
	print("machine: arithmetic, four lanes of doubles", "Gflop/s", 1e-9 * 64. * ROUNDS / best);
	print("machine: copy within 24 kB", "GB/s", 1e-9 * copy_rate(24 << 10));
	print("machine: copy within 256 kB", "GB/s", 1e-9 * copy_rate(256 << 10));
	print("machine: copy within 64 MB", "GB/s", 1e-9 * copy_rate(64 << 20));
}

// ---- the pair kernel

// Four pairs, at velocities that the last iteration has not seen: every sweep has work.
static void bench_kernel(const char *what, const ob_kernel *k, ob_batch_kind kind)
{
	enum { SCENES = 8, ROUNDS = 500 };
	static scene s[SCENES];
	uint64_t seed = 1;
	double best = 1e9;
	for (int i = 0; i < SCENES; i++)
		random_scene_of(&s[i], &seed, .1, kind);
	for (int b = 0; b < BATCHES; b++) {
		double start = ob_clock_thread_cpu();
		for (int r = 0; r < ROUNDS; r++)
			for (int i = 0; i < SCENES; i++) {
				ob_solver_iteration iteration = iteration_on(&s[i], false);
				memcpy(s[i].u, s[i].v, sizeof s[i].u);
				k->solve(&s[i].batch, &iteration, s[i].u, s[i].v, s[i].d, s[i].delta);
				s[i].v[1 + r % 8][r % 3] += r % 2 ? 1e-2 : -1e-2;
			}
		best = fmin(best, ob_clock_thread_cpu() - start);
	}
	print(what, "ns", 1e9 * best / (ROUNDS * SCENES * OB_LANES));
}

// ---- plans of motions

// A box of half extents up to 1 m, thrown up from about 5 m, with a random spin.
static ob_flier random_flier(uint64_t *seed, ob_spin *spin)
{
	ob_flier f = { .shape = OB_SHAPE_BOX, .a = ob_v3(0, 0, -9.81), .q = random_attitude(seed), .spin = spin };
	f.size = ob_v3(within(seed, .1, 1), within(seed, .1, 1), within(seed, .1, 1));
	f.inertia = random_inertia(seed);
	f.p = ob_v3(0, 0, within(seed, 4, 6));
	f.v = ob_v3(1, 0, within(seed, 0, 4));
	f.w = random_vector(seed, 2);
	ob_spin_plan(spin, f.q, f.w, f.inertia);
	return f;
}

static void bench_plans(void)
{
	enum { BODIES = 64 };
	static ob_spin spin[BODIES];
	static ob_flier flier[BODIES];
	uint64_t seed = 1;
	ob_half_space ground = { .normal = ob_v3(0, 0, 1) };
	double spins = 1e9, landings = 1e9, time = 0;
	for (int i = 0; i < BODIES; i++)
		flier[i] = random_flier(&seed, &spin[i]);
	for (int b = 0; b < BATCHES; b++) {
		double start = ob_clock_thread_cpu();
		for (int i = 0; i < BODIES; i++) {
			ob_quat q;
			ob_vec3 w;
			ob_spin_plan(&spin[i], flier[i].q, flier[i].w, flier[i].inertia);
			ob_spin_at(&spin[i], 1, &q, &w); // a long turn, to force the plan
		}
		double between = ob_clock_thread_cpu();
		for (int i = 0; i < BODIES; i++)
			time += ob_landing_time(&flier[i], &ground, 0, 10);
		landings = fmin(landings, ob_clock_thread_cpu() - between);
		spins = fmin(spins, between - start);
	}
	sink += time;
	print("plan of a motion: how a body turns, three moments", "ns", 1e9 * spins / BODIES);
	print("plan of a motion: when a box lands on a plane", "ns", 1e9 * landings / BODIES);
}

// ---- the broad phase

// n spheres in a square; each moves by a fifth of its size and queries its neighbours.
static void bench_index(uint32_t n)
{
	ob_error e;
	ob_universe_setup setup = { .capacity = n, .workers = 1, .isolation = "thread" };
	ob_universe *u = ob_universe_create(&setup, &e);
	if (!u) {
		fprintf(stderr, "%s\n", e.text);
		exit(1);
	}
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t side = (uint32_t)ceil(sqrt(n)), out[16];
	uint64_t tests = 0;
	double best = 1e9, found = 0;
	for (int b = 0; b < BATCHES / 6; b++) {
		double start = ob_clock_thread_cpu();
		for (uint32_t i = 0; i < n; i++) {
			if (b == 0) {
				ob_passport p = { .id = i, .flags = OB_OBJECT_PRESENT, .shape = OB_SHAPE_SPHERE };
				ob_write_passport(u, i, &p);
			}
			float x = (float)(1.1 * (i % side) + .2 * b), y = (float)(1.1 * (i / side));
			memcpy(ex->bounds[i], (float[6]){ x, y, 0, x + 1, y + 1, 1 }, sizeof ex->bounds[i]);
			ob_index_put(u, i);
		}
		for (uint32_t i = 0; i < n; i++)
			found += ob_index_query(u, i, out, 16, &tests);
		if (b)
			best = fmin(best, ob_clock_thread_cpu() - start);
	}
	char what[64];
	snprintf(what, sizeof what, "broad phase of a publication, %u objects", n);
	print(what, "ns", 1e9 * best / n);
	sink += found;
	ob_universe_destroy(u, true);
}

int main(void)
{
	bench_machine();
	bench_kernel("exchange of a pair, portable", &ob_kernel_portable, OB_KIND_FULL);
	bench_kernel("exchange of a pair", ob_kernel_best(), OB_KIND_FULL);
	bench_kernel("exchange of a pair, one point", ob_kernel_best(), OB_KIND_POINT);
	bench_kernel("exchange of a pair, one point without friction", ob_kernel_best(), OB_KIND_FRICTIONLESS_POINT);
	bench_plans();
	bench_index(1000);
	bench_index(100000);
	return 0;
}

// Torque-free rotation against a Taylor series in long double, independent of elliptic functions.
#include "reference/spin.h"

#include "check.h"
#include "motion/random.h"
#include "motion/reference.h"

static double worst;

// The series makes five steps a radian, with errors of some 1e-18 in each. Near the separatrix they grow like an equal
// change of the start.
static void check_at(ob_quat q0, ob_vec3 w0, ob_vec3 inertia, double t)
{
	ob_reference_spin spin;
	ob_quat q;
	ob_vec3 w;
	long_rotation exact = long_of(q0, w0), moved = exact;
	for (int i = 0; i < 3; i++)
		moved.w[i] += 1e-13L * (i - 1.1L);
	long_advance(&exact, inertia, t);
	long_advance(&moved, inertia, t);
	ob_quat other = { (double)moved.q[0], (double)moved.q[1], (double)moved.q[2], (double)moved.q[3] };
	ob_reference_spin_plan(&spin, q0, w0, inertia);
	ob_reference_spin_at(&spin, t, &q, &w);
	double error = attitude_error(&exact, q), energy = energy_of(q0, w0, inertia);
	double most = fmax(inertia.x, fmax(inertia.y, inertia.z)) * ob_norm(w0);
	worst = fmax(worst, error);
	double own = 1e-18 * (1 + 5 * fabs(t) * ob_norm(w0));
	CHECK_NEAR(error, 0, 1e-15 + own / 1e-13 * attitude_error(&exact, other));
	CHECK_NEAR(energy_of(q, w, inertia), energy, 2e-15 * energy);
	CHECK_NEAR(ob_norm(ob_sub(momentum_of(q, w, inertia), momentum_of(q0, w0, inertia))), 0, 3e-15 * most);
}

static void test_orders_of_axes(void)
{
	const ob_vec3 order[6] = { { 1, 2, 3 }, { 1, 3, 2 }, { 2, 1, 3 }, { 2, 3, 1 }, { 3, 1, 2 }, { 3, 2, 1 } };
	worst = 0;
	for (int k = 0; k < 6; k++) {
		check_at(ob_quat_identity(), ob_v3(.05, 5, .02), order[k], 300);
		check_at(ob_quat_identity(), ob_v3(.05, 5, .02), order[k], -20);
		check_at(ob_quat_identity(), ob_v3(.05, 5, .02), order[k], 0);
	}
	printf("five minutes: within %.1e rad\n", worst);
	CHECK(worst < 1e-11);
}

static void test_random_bodies(void)
{
	uint64_t seed = 5;
	worst = 0;
	for (int k = 0; k < 60; k++) {
		ob_vec3 inertia = random_inertia(&seed), w0 = random_vector(&seed, 8);
		ob_quat q0 = random_attitude(&seed);
		check_at(q0, w0, inertia, within(&seed, -5, 5));
	}
	printf("random bodies: within %.1e rad\n", worst);
	CHECK(worst < 1e-14);
}

// Symmetric tops, spin about each axis, spheres, flat and thin bodies, and rest.
static void test_limits(void)
{
	const ob_vec3 inertia[] = { { 2, 2, 3 },         { 2, 2, 1 }, { 1, 2, 2 },        { 3, 2, 2 },
				    { 2, 3, 2 },         { 2, 2, 2 }, { 1, 2, 3 },        { .001, 2, 2.0005 },
				    { 2, 2.0000001, 3 }, { 1, 1, 2 }, { 1, 2, 2.9999999 } };
	const ob_vec3 w[] = { { 3, 0, 0 },    { 0, 3, 0 },        { 0, 0, 3 }, { 0, 0, -3 }, { 1, -2, 3 },
			      { 1e-9, 0, 3 }, { 3, 1e-9, 1e-12 }, { 0, 0, 0 }, { 1, 1, 0 },  { 0, 1, -1 } };
	ob_quat q = ob_quat_normalize((ob_quat){ .5, -.1, .7, .2 });
	for (unsigned i = 0; i < sizeof inertia / sizeof *inertia; i++) {
		for (unsigned k = 0; k < sizeof w / sizeof *w; k++)
			check_at(q, w[k], inertia[i], 3);
		ob_mat3 r = ob_quat_matrix(q); // along the body's axes, to rounding
		check_at(q, ob_rotate(&r, ob_v3(0, 0, 4)), inertia[i], 3);
		check_at(q, ob_rotate(&r, ob_v3(4, 0, 0)), inertia[i], 3);
	}
}

static void test_turn_between(void)
{
	ob_quat a = ob_quat_normalize((ob_quat){ .1, .2, .3, -.4 }), minus = { -a.w, -a.x, -a.y, -a.z };
	CHECK(ob_reference_turn_between(a, a) == 0 && ob_reference_turn_between(a, minus) < 1e-15);
	for (double angle = 1e-12; angle < 3; angle *= 3) {
		ob_quat b = ob_quat_turn(a, ob_scale(ob_v3(.48, .6, .64), angle));
		CHECK_NEAR(ob_reference_turn_between(a, b), angle, 1e-15 + 1e-14 * angle);
	}
	CHECK_NEAR(ob_reference_turn_between(a, ob_quat_turn(a, ob_v3(0, 4, 0))), 2 * M_PI - 4, 1e-14);
}

int main(void)
{
	test_orders_of_axes();
	test_random_bodies();
	test_limits();
	test_turn_between();
	return check_end();
}

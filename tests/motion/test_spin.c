// Torque-free rotation against a long double Taylor series, and conserved quantities.
#include <string.h>

#include <ob/motion.h>

#include "check.h"
#include "motion/spin.h"
#include "random.h"
#include "reference.h"

static const ob_vec3 ORDERS[6] = { { 1, 2, 3 }, { 1, 3, 2 }, { 2, 1, 3 }, { 2, 3, 1 }, { 3, 1, 2 }, { 3, 2, 1 } };

static void check_conserved(ob_quat q0, ob_vec3 w0, ob_quat q, ob_vec3 w, ob_vec3 inertia)
{
	double e = energy_of(q0, w0, inertia);
	ob_vec3 l = momentum_of(q0, w0, inertia);
	CHECK_NEAR(energy_of(q, w, inertia), e, 1e-13 * e);
	CHECK_NEAR(ob_norm(ob_sub(momentum_of(q, w, inertia), l)), 0, 1e-12 * ob_norm(l));
	CHECK_NEAR(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z, 1, 1e-15);
}

// Five minutes, forward and back, for each order of the axes: two of them turn about the intermediate one.
static void test_five_minutes(void)
{
	ob_quat start = ob_quat_identity(), q;
	ob_vec3 w0 = ob_v3(.05, 5, .02), w;
	double worst = 0, worst_rate = 0;
	for (int k = 0; k < 12; k++) {
		double s = k < 6 ? 300 : -300;
		long_rotation exact = long_of(start, w0);
		long_advance(&exact, ORDERS[k % 6], s);
		ob_rotate_free(start, w0, ORDERS[k % 6], s, &q, &w);
		ob_mat3 r = ob_quat_matrix(q);
		ob_vec3 b = ob_rotate_back(&r, w);
		double rate = fabs(b.x - (double)exact.w[0]) + fabs(b.y - (double)exact.w[1]) +
			      fabs(b.z - (double)exact.w[2]);
		worst = fmax(worst, attitude_error(&exact, q));
		worst_rate = fmax(worst_rate, rate);
		check_conserved(start, w0, q, w, ORDERS[k % 6]);
	}
	printf("after 300 s: attitude within %.2g rad, rate within %.2g rad/s\n", worst, worst_rate);
	CHECK_NEAR(worst, 0, 1e-10);
	CHECK_NEAR(worst_rate, 0, 1e-10);
}

// Random bodies. Near the separatrix any initial error grows exponentially. So the bound follows from the change of the
// reference itself when its start moves by a few units of the last digit.
static void test_random_against_reference(void)
{
	uint64_t seed = 1;
	double worst = 0;
	for (int k = 0; k < 400; k++) {
		ob_vec3 inertia = random_inertia(&seed), w0 = random_vector(&seed, 8), w;
		ob_quat start = random_attitude(&seed), q;
		double s = within(&seed, -5, 5);
		long_rotation exact = long_of(start, w0), moved = exact;
		for (int i = 0; i < 3; i++)
			moved.w[i] += 1e-13 * (i - 1.1);
		long_advance(&exact, inertia, s);
		long_advance(&moved, inertia, s);
		ob_rotate_free(start, w0, inertia, s, &q, &w);
		ob_quat other = { (double)moved.q[0], (double)moved.q[1], (double)moved.q[2], (double)moved.q[3] };
		double error = attitude_error(&exact, q), growth = attitude_error(&exact, other) / 1e-13;
		worst = fmax(worst, error);
		CHECK_NEAR(error, 0, 1e-12 + 1e-14 * growth);
		check_conserved(start, w0, q, w, inertia);
	}
	printf("random bodies: attitude within %.2g rad\n", worst);
}

static void test_composition(void)
{
	uint64_t seed = 2;
	for (int k = 0; k < 2000; k++) {
		ob_vec3 inertia = random_inertia(&seed), w0 = random_vector(&seed, 8), w1, w2, w3;
		ob_quat start = random_attitude(&seed), q1, q2, q3;
		double s1 = within(&seed, -1, 1), s2 = within(&seed, -1, 1);
		ob_rotate_free(start, w0, inertia, s1, &q1, &w1);
		ob_rotate_free(q1, w1, inertia, s2, &q2, &w2);
		ob_rotate_free(start, w0, inertia, s1 + s2, &q3, &w3);
		long_rotation direct = long_of(q3, w3);
		CHECK_NEAR(attitude_error(&direct, q2), 0, 1e-9);
		CHECK_NEAR(ob_norm(ob_sub(w2, w3)), 0, 1e-9);
	}
}

// Ten minutes at 60 Hz by repeated short turns: rounding errors must not accumulate in the energy.
static void test_many_short_steps(void)
{
	ob_vec3 inertia = ob_v3(1, 2, 3), w0 = ob_v3(.05, 5, .02), w = w0;
	ob_quat start = ob_quat_identity(), q = start;
	for (int k = 0; k < 36000; k++)
		ob_rotate_free(q, w, inertia, 1. / 60, &q, &w);
	double e = energy_of(start, w0, inertia);
	ob_vec3 l = momentum_of(start, w0, inertia);
	CHECK_NEAR(energy_of(q, w, inertia), e, 1e-12 * e);
	CHECK_NEAR(ob_norm(ob_sub(momentum_of(q, w, inertia), l)), 0, 1e-12 * ob_norm(l));
}

// Same bits from every call, planned once or each time; nothing moves at s = 0.
static void test_same_bits(void)
{
	uint64_t seed = 3;
	for (int k = 0; k < 500; k++) {
		ob_vec3 inertia = random_inertia(&seed), w0 = random_vector(&seed, 8), w1, w2;
		ob_quat start = random_attitude(&seed), q1, q2;
		double s = within(&seed, -9, 9);
		ob_spin spin;
		ob_spin_plan(&spin, start, w0, inertia);
		ob_spin_at(&spin, s, &q1, &w1);
		ob_rotate_free(start, w0, inertia, s, &q2, &w2);
		CHECK(q1.w == q2.w && q1.x == q2.x && q1.y == q2.y && q1.z == q2.z);
		CHECK(w1.x == w2.x && w1.y == w2.y && w1.z == w2.z);
		ob_rotate_free(start, w0, inertia, 0, &q2, &w2);
		CHECK(start.w == q2.w && start.x == q2.x && start.y == q2.y && start.z == q2.z);
		CHECK(w0.x == w2.x && w0.y == w2.y && w0.z == w2.z);
		ob_spin_at(&spin, 0, &q1, &w1);
		long_rotation at_start = long_of(start, w0);
		CHECK_NEAR(attitude_error(&at_start, q1), 0, 1e-14);
		CHECK_NEAR(ob_norm(ob_sub(w1, w0)), 0, 1e-11);
	}
}

// On either side of the limit of the closed form.
static void test_short_turns(void)
{
	uint64_t seed = 4;
	double worst = 0;
	for (int k = 0; k < 2000; k++) {
		ob_vec3 inertia = random_inertia(&seed), w0 = random_vector(&seed, 8), w;
		ob_quat start = random_attitude(&seed), q;
		const double s = within(&seed, -.06, .06) / ob_norm(w0);
		long_rotation exact = long_of(start, w0);
		long_advance(&exact, inertia, s);
		ob_rotate_free(start, w0, inertia, s, &q, &w);
		worst = fmax(worst, attitude_error(&exact, q));
		check_conserved(start, w0, q, w, inertia);
	}
	printf("short turns: attitude within %.2g rad\n", worst);
	CHECK_NEAR(worst, 0, 3e-15);
}

// Earlier evaluations change nothing.
static void test_any_order(void)
{
	enum { TIMES = 6 };
	static const double turn[TIMES] = { .01, 2, .01, 0, -2, .025 };
	uint64_t seed = 5;
	for (int k = 0; k < 200; k++) {
		ob_vec3 inertia = random_inertia(&seed), w0 = random_vector(&seed, 8), w1, w2;
		ob_quat start = random_attitude(&seed), q1, q2;
		ob_spin spin;
		ob_spin_plan(&spin, start, w0, inertia);
		for (int i = 0; i < TIMES; i++) {
			const double s = turn[i] / ob_norm(w0);
			ob_spin_at(&spin, s, &q1, &w1);
			ob_rotate_free(start, w0, inertia, s, &q2, &w2);
			CHECK(q1.w == q2.w && q1.x == q2.x && q1.y == q2.y && q1.z == q2.z);
			CHECK(w1.x == w2.x && w1.y == w2.y && w1.z == w2.z);
		}
	}
}

// Any body: some do not turn, some have equal moments, some turn about an axis, some nearly about the middle one.
static void random_rotation(uint64_t *seed, ob_spin *spin)
{
	const double kind = uniform(seed);
	ob_vec3 inertia = random_inertia(seed), w = random_vector(seed, 8);
	const ob_quat q = random_attitude(seed);
	const ob_mat3 r = ob_quat_matrix(q);
	if (kind < .05)
		inertia.y = inertia.x;
	else if (kind < .1)
		w = ob_scale(ob_column(&r, 1), 5);
	else if (kind < .15)
		w = ob_v3(0, 0, 0);
	else if (kind < .3)
		w = ob_madd(ob_scale(random_vector(seed, 1), pow(10, within(seed, -15, -1))), 5,
			    ob_column(&r, kind < .2));
	ob_spin_plan(spin, q, w, inertia);
}

// A body has the same bits beside any others as alone.
static void test_side_by_side(void)
{
	enum { MOST = 11 };
	uint64_t seed = 6;
	for (int k = 0; k < 3000; k++) {
		const int n = 1 + (int)(MOST * uniform(&seed));
		ob_spin spin[MOST], alone[MOST], *of[MOST];
		double s[MOST];
		for (int i = 0; i < n; i++) {
			const double kind = uniform(&seed), far = pow(10, within(&seed, -4, 7));
			random_rotation(&seed, &spin[i]);
			s[i] = kind < .1 ? 0 : kind < .8 ? within(&seed, -2, 9) : kind < .9 ? far : -far;
			alone[i] = spin[i];
			of[i] = &spin[i];
		}
		ob_spin_prepare(of, s, n);
		for (int again = 0; again < 2; again++)
			for (int i = 0; i < n; i++) {
				ob_quat q[2];
				ob_vec3 w[2];
				ob_spin_at(&spin[i], s[i] + again, &q[0], &w[0]);
				ob_spin_at(&alone[i], s[i] + again, &q[1], &w[1]);
				CHECK(memcmp(&q[0], &q[1], sizeof *q) == 0 && memcmp(&w[0], &w[1], sizeof *w) == 0);
			}
	}
}

int main(void)
{
	test_short_turns();
	test_any_order();
	test_five_minutes();
	test_random_against_reference();
	test_composition();
	test_many_short_steps();
	test_same_bits();
	test_side_by_side();
	return check_end();
}

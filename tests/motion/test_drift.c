// Drift against the closed form, and over many steps against conserved quantities.
#include "check.h"
#include "motion/drift.h"
#include "motion/spin.h"
#include "random.h"
#include "reference.h"

static double apart(ob_quat a, ob_quat b)
{
	double s = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z < 0 ? -1 : 1;
	return fabs(a.w - s * b.w) + fabs(a.x - s * b.x) + fabs(a.y - s * b.y) + fabs(a.z - s * b.z);
}

// Moments of homogeneous bodies: none exceeds the sum of the other two.
static ob_vec3 random_moments(uint64_t *seed, int kind)
{
	double x = pow(10, within(seed, -2, 1)), y = kind > 0 ? x : pow(10, within(seed, -2, 1));
	double z = kind > 1 ? x : pow(10, within(seed, -2, 1));
	return ob_v3(y + z, z + x, x + y);
}

static void check_against_closed_form(void)
{
	uint64_t seed = 1;
	double attitude = 0, rate = 0, beyond = 0;
	for (int i = 0; i < 3000; i++) {
		ob_vec3 j = random_moments(&seed, i % 3), w = random_vector(&seed, pow(10, within(&seed, -3, 2)));
		ob_quat q = random_attitude(&seed), q1, q2;
		double s = within(&seed, -.02, .02), least = fmin(j.x, fmin(j.y, j.z));
		ob_vec3 w1, w2;
		ob_spin spin;
		ob_spin_plan(&spin, q, w, j);
		ob_spin_at(&spin, s, &q1, &w1);
		ob_drift(q, w, j, s, &q2, &w2);
		attitude = fmax(attitude, apart(q1, q2));
		rate = fmax(rate, ob_norm(ob_sub(w1, w2)) / ob_norm(momentum_of(q, w, j)) * least);
		ob_mat3 r = ob_quat_matrix(q);
		double bound = ob_drift_bound(ob_rotate_back(&r, w), j, fabs(s));
		beyond = fmax(beyond, ob_norm(w2) / bound - 1);
	}
	printf("attitude to %.1e, rate to %.1e\n", attitude, rate);
	CHECK(attitude <= 1e-13);
	CHECK(rate <= 1e-13);
	CHECK(beyond <= 1e-14);
}

// The cheaper version for turns of up to .2 rad: its error is at most a fiftieth of their fifth power.
static void check_short_turns(void)
{
	uint64_t seed = 3;
	for (int i = 0; i < 3000; i++) {
		ob_vec3 j = random_moments(&seed, i % 3), w = random_vector(&seed, pow(10, within(&seed, -3, 2)));
		double turn = within(&seed, 0, .2), s = turn / ob_norm(w);
		ob_quat exact = ob_drift_turn(w, j, s), other = ob_drift_short_turn(w, j, s);
		CHECK(ob_norm(ob_small_turn(exact, other)) <= .02 * pow(turn, 5) + 1e-15);
	}
}

// Drift of held bodies: the attitude error is at most 1e-11, and momentum is conserved as exactly.
static void check_held(void)
{
	uint64_t seed = 4;
	double attitude = 0, momentum = 0;
	for (int i = 0; i < 3000; i++) {
		ob_vec3 j = random_moments(&seed, i % 3), w = random_vector(&seed, pow(10, within(&seed, -3, 2)));
		ob_quat q = random_attitude(&seed), exact, held;
		double s = within(&seed, -.05, .05) / ob_norm(w);
		ob_vec3 exact_rate, rate, before = momentum_of(q, w, j);
		ob_drift(q, w, j, s, &exact, &exact_rate);
		ob_drift_held(q, w, j, s, &held, &rate);
		attitude = fmax(attitude, apart(exact, held));
		momentum = fmax(momentum, ob_norm(ob_sub(momentum_of(held, rate, j), before)) / ob_norm(before));
	}
	printf("held: attitude to %.1e, momentum to %.1e\n", attitude, momentum);
	CHECK(attitude <= 1e-11);
	CHECK(momentum <= 1e-14);
}

// 10^5 steps of up to .15 rad.
static void check_conservation(void)
{
	uint64_t seed = 2;
	for (int i = 0; i < 6; i++) {
		ob_vec3 j = random_moments(&seed, i % 2), w = random_vector(&seed, 60);
		ob_quat q = random_attitude(&seed);
		ob_vec3 before = momentum_of(q, w, j);
		double energy = ob_dot(before, w);
		for (int k = 0; k < 100000; k++)
			ob_drift(q, w, j, 1. / 480, &q, &w);
		ob_vec3 after = momentum_of(q, w, j);
		CHECK_NEAR(ob_norm(ob_sub(after, before)) / ob_norm(before), 0, 1e-12);
		CHECK_NEAR(ob_dot(after, w) / energy, 1, 1e-12);
	}
}

int main(void)
{
	check_against_closed_form();
	check_short_turns();
	check_held();
	check_conservation();
	return check_end();
}

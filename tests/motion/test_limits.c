// Degenerate cases of the general rotation: equal moments, principal axes, the separatrix, rest, nonsense.
#include <ob/motion.h>

#include "check.h"
#include "random.h"
#include "reference.h"

static double turn_error(ob_quat start, ob_vec3 w0, ob_vec3 inertia, double s)
{
	ob_quat q;
	ob_vec3 w;
	long_rotation exact = long_of(start, w0);
	long_advance(&exact, inertia, s);
	ob_rotate_free(start, w0, inertia, s, &q, &w);
	double e = energy_of(start, w0, inertia);
	ob_vec3 l = momentum_of(start, w0, inertia);
	CHECK_NEAR(energy_of(q, w, inertia), e, 1e-13 * e);
	CHECK_NEAR(ob_norm(ob_sub(momentum_of(q, w, inertia), l)), 0, 1e-12 * ob_norm(l));
	return attitude_error(&exact, q);
}

static ob_vec3 permuted(double a, double b, double c, int k)
{
	double v[3] = { a, b, c };
	return ob_v3(v[k % 3], v[(k + 1) % 3], v[(k + 2) % 3]);
}

// Two moments equal, and then less and less apart: one formula must pass into the other.
static void test_symmetric(void)
{
	uint64_t seed = 4;
	double worst = 0;
	for (int k = 0; k < 6 * 20; k++) {
		double apart = k < 6 ? 0 : pow(10, -k / 6), pair = k % 6 < 3 ? 2 : .7; // flat and long bodies
		ob_vec3 inertia = permuted(pair, pair * (1 + apart), 1, k);
		double error = turn_error(random_attitude(&seed), random_vector(&seed, 5), inertia, 20);
		worst = fmax(worst, error);
	}
	printf("symmetric and nearly so: within %.2g rad\n", worst);
	CHECK_NEAR(worst, 0, 1e-11);
}

static void test_spherical(void)
{
	uint64_t seed = 5;
	double worst = 0;
	for (int k = 0; k < 17; k++) {
		double a = k ? pow(10, -k) : 0;
		ob_vec3 inertia = permuted(.4, .4 * (1 + a), .4 * (1 - 2 * a), k);
		worst = fmax(worst, turn_error(random_attitude(&seed), random_vector(&seed, 5), inertia, 20));
	}
	printf("spherical and nearly so: within %.2g rad\n", worst);
	CHECK_NEAR(worst, 0, 1e-11);
	ob_quat q;
	ob_vec3 w0 = ob_v3(1, -2, 3), w;
	ob_rotate_free(random_attitude(&seed), w0, ob_v3(.4, .4, .4), 1e3, &q, &w);
	CHECK_NEAR(ob_norm(ob_sub(w, w0)), 0, 1e-15);
}

// Exactly along an axis the rotation is steady, even about the intermediate one.
static void test_principal_axes(void)
{
	for (int k = 0; k < 9; k++) {
		ob_vec3 inertia = permuted(1, 2, 3, k / 3), w0 = permuted(4, 0, 0, k), w;
		ob_quat q, start = ob_quat_identity(), there = ob_quat_turn(start, ob_scale(w0, 100));
		ob_rotate_free(start, w0, inertia, 100, &q, &w);
		CHECK(w.x == w0.x && w.y == w0.y && w.z == w0.z);
		CHECK_NEAR(q.w * there.w + q.x * there.x + q.y * there.y + q.z * there.z, 1, 1e-15);
		CHECK_NEAR(fabs(q.w - there.w) + fabs(q.x - there.x) + fabs(q.y - there.y) + fabs(q.z - there.z), 0,
			   1e-15);
	}
}

// Closer and closer to an axis. The stable axes stay exact for long. The intermediate one is left after a time that
// grows like the logarithm; the turn must be right until the reference's own digits are used up.
static void test_near_axes(void)
{
	double worst = 0, flips = 0;
	for (int axis = 0; axis < 3; axis++)
		for (int k = 1; k < 18; k++) {
			double off = pow(10, -k), s = axis == 1 ? k < 16 ? 2 * k + 3 : 12 : 100;
			ob_vec3 inertia = ob_v3(1, 2, 3);
			ob_vec3 w0 = permuted(2, off, .3 * off, 3 - axis), w;
			ob_quat q;
			double error = turn_error(ob_quat_identity(), w0, inertia, s);
			worst = fmax(worst, error);
			ob_rotate_free(ob_quat_identity(), w0, inertia, s, &q, &w);
			ob_mat3 r = ob_quat_matrix(q);
			flips += axis == 1 && ob_rotate_back(&r, w).y < 0;
		}
	printf("near the axes: within %.2g rad, %g flips\n", worst, flips);
	CHECK_NEAR(worst, 0, 1e-9);
	CHECK(flips == 15);
}

// On the separatrix and near it: L^2 = 2 E I2, then less and less off to either side, for a time in which an initial
// error grows a thousand times at most.
static void test_separatrix(void)
{
	double worst = 0;
	for (int k = 0; k < 6 * 18; k++) {
		double off = k < 6 ? 0 : pow(10, -k / 6) * (k & 1 ? 1 : -1);
		double i[3] = { 1, 2, 3 }, wx = 1.5, wy = k % 4 < 2 ? 2 : -2;
		double wz = wx * sqrt(i[0] * (i[1] - i[0]) / (i[2] * (i[2] - i[1]))) * (1 + off) * (k % 6 < 3 ? 1 : -1);
		double v[3] = { wx, wy, wz };
		int j = k % 3;
		ob_vec3 inertia = permuted(i[0], i[1], i[2], j), w0 = permuted(v[0], v[1], v[2], j);
		worst = fmax(worst, turn_error(ob_quat_identity(), w0, inertia, k % 5 ? 3 : -3));
	}
	printf("separatrix: within %.2g rad\n", worst);
	CHECK_NEAR(worst, 0, 1e-10);
}

// The momentum circles the largest of two nearly equal moments: close by the axis the azimuth swings round at once.
static void test_sliver(void)
{
	double worst = 0;
	for (int k = 12; k < 14 * 6; k++) {
		double apart = pow(10, -k / 6), off = sqrt(apart) * .4;
		ob_vec3 inertia = permuted(1, 3, 3 * (1 + apart), k), w0 = permuted(off, -off * (k % 6), 3, k);
		worst = fmax(worst, turn_error(ob_quat_identity(), w0, inertia, 20));
	}
	printf("sliver: within %.2g rad\n", worst);
	CHECK_NEAR(worst, 0, 1e-12);
}

static void test_slow_and_fast(void)
{
	ob_quat start = ob_quat_normalize((ob_quat){ .3, .5, -.4, .2 }), q;
	ob_vec3 inertia = ob_v3(1, 2, 3), w;
	double worst = 0;
	for (int k = -130; k <= 130; k += 10) {
		ob_vec3 w0 = ob_scale(ob_v3(.3, 1, -.2), pow(10, k));
		worst = fmax(worst, turn_error(start, w0, inertia, 2 * pow(10, -k)));
		worst = fmax(worst, turn_error(start, w0, ob_scale(inertia, pow(10, -k)), 2 * pow(10, -k)));
	}
	CHECK_NEAR(worst, 0, 1e-14);
	for (int k = -330; k <= -150; k += 10) { // squares of such rates underflow
		ob_vec3 w0 = ob_scale(ob_v3(.3, 1, -.2), pow(10, k));
		ob_rotate_free(start, w0, inertia, 1e9, &q, &w);
		CHECK(w.x == w0.x && w.y == w0.y && w.z == w0.z);
		CHECK_NEAR(q.w * start.w + q.x * start.x + q.y * start.y + q.z * start.z, 1, 1e-15);
	}
}

// A reader may read any bytes: the call returns, with any result.
static void test_nonsense(void)
{
	const double odd[] = { 0, -1, NAN, INFINITY, 1e308, 5e-324, 1 };
	enum { N = sizeof odd / sizeof *odd };
	ob_quat q;
	ob_vec3 w = { 0 };
	int returned = 0;
	for (int k = 0; k < N * N * N * N; k++) {
		double a = odd[k % N], b = odd[k / N % N], c = odd[k / N / N % N], d = odd[k / N / N / N];
		ob_rotate_free((ob_quat){ d, a, 1, 0 }, ob_v3(a, b, 1), ob_v3(c, d, 2), b, &q, &w);
		returned++;
	}
	CHECK(returned == N * N * N * N);
	ob_rotate_free(ob_quat_identity(), ob_v3(1, 2, 3), ob_v3(0, 0, 0), 1, &q, &w);
	CHECK(w.x == 1 && w.y == 2 && w.z == 3);
}

int main(void)
{
	test_symmetric();
	test_spherical();
	test_principal_axes();
	test_near_axes();
	test_separatrix();
	test_sliver();
	test_slow_and_fast();
	test_nonsense();
	return check_end();
}

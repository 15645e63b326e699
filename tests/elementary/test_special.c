// Exact results, and the rules of annex F of C17 for zeros, infinities and NaN.
#include <float.h>
#include <stdbool.h>

#include "check.h"
#include "elementary/elementary.h"
#include "motion/random.h"

// True for the same number, with the same sign if it is 0.
static bool is(double a, double b)
{
	return isnan(b) ? isnan(a) : a == b && signbit(a) == signbit(b);
}

static void check_odd_functions(void)
{
	double (*const odd[])(double) = { ob_sin, ob_tan, ob_asin, ob_expm1, ob_sinh, ob_tanh };
	for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
		CHECK(is(odd[i](0), 0) && is(odd[i](-0.), -0.));
		CHECK(is(odd[i](DBL_MIN), DBL_MIN) && is(odd[i](-DBL_MIN), -DBL_MIN));
		CHECK(is(odd[i](DBL_TRUE_MIN), DBL_TRUE_MIN) && is(odd[i](-1e-300), -1e-300));
		CHECK(isnan(odd[i](NAN)));
	}
	double sine, cosine;
	ob_sincos(-0., &sine, &cosine);
	CHECK(is(sine, -0.) && cosine == 1);
}

// Two at once have the bits of each.
static void check_two_angles(void)
{
	static const double special[] = { 0,      -0.,  1e-300,   -1e-9,  1e-8, M_PI_4,   -M_PI_4,
					  M_PI_2, M_PI, 524287.9, 524288, 1e22, INFINITY, NAN };
	enum { SPECIAL = sizeof special / sizeof *special };
	uint64_t seed = 5;
	for (int i = 0; i < 200000; i++) {
		double x[2], sine[2], cosine[2];
		for (int k = 0; k < 2; k++)
			x[k] = i < SPECIAL * SPECIAL ? special[k ? i % SPECIAL : i / SPECIAL]
						     : ldexp(within(&seed, -1, 1), (int)within(&seed, -30, 22));
		ob_sincos_of_two(x, sine, cosine);
		for (int k = 0; k < 2; k++) {
			double s, c;
			ob_sincos(x[k], &s, &c);
			CHECK(is(sine[k], s) && is(cosine[k], c));
		}
	}
}

static void check_domains(void)
{
	CHECK(isnan(ob_sin(INFINITY)) && isnan(ob_cos(-INFINITY)) && isnan(ob_tan(INFINITY)) && isnan(ob_cos(NAN)));
	CHECK(isnan(ob_asin(1 + DBL_EPSILON)) && isnan(ob_acos(-1 - DBL_EPSILON)) && isnan(ob_acos(NAN)));
	CHECK(is(ob_acos(1), 0) && ob_acos(-1) == M_PI && ob_asin(1) == M_PI_2 && ob_acos(0) == M_PI_2);
	CHECK(isnan(ob_log(-1)) && isnan(ob_log2(-INFINITY)) && isnan(ob_log10(NAN)));
	CHECK(ob_log(0) == -INFINITY && ob_log2(-0.) == -INFINITY && ob_log10(INFINITY) == INFINITY);
	CHECK(is(ob_log(1), 0) && is(ob_log2(1), 0) && is(ob_log10(1), 0));
	CHECK(ob_exp(0) == 1 && ob_exp(-INFINITY) == 0 && ob_exp(INFINITY) == INFINITY && isnan(ob_exp(NAN)));
	CHECK(ob_exp(709.78) < INFINITY && ob_exp(709.79) == INFINITY && ob_exp(-745) > 0 && ob_exp(-746) == 0);
	CHECK(ob_expm1(INFINITY) == INFINITY && ob_expm1(-INFINITY) == -1 && ob_cosh(0) == 1);
	CHECK(ob_sinh(-INFINITY) == -INFINITY && ob_cosh(-INFINITY) == INFINITY && ob_tanh(-INFINITY) == -1);
	CHECK(ob_sinh(710) < INFINITY && ob_cosh(-711) == INFINITY && isnan(ob_cosh(NAN)) && isnan(ob_sinh(NAN)));
}

static void check_whole_powers(void)
{
	for (int n = -1074; n < 1024; n++) {
		const double p = ldexp(1, n);
		CHECK(ob_log2(p) == n && ob_pow(2, n) == p);
	}
	double ten = 1;
	for (int n = 0; n < 23; n++, ten *= 10)
		CHECK(ob_log10(ten) == n && ob_pow(10, n) == ten);
	CHECK(ob_pow(-3, 3) == -27 && ob_pow(-3, 2) == 9 && ob_pow(9, .5) == 3 && isnan(ob_pow(-9, .5)));
}

static void check_hypot(void)
{
	CHECK(ob_hypot(-3, 4) == 5 && ob_hypot(0x1p1000 * 3, 0x1p1000 * 4) == 0x1p1000 * 5 &&
	      is(ob_hypot(-0., -0.), 0));
	CHECK(ob_hypot(-3 * DBL_TRUE_MIN, 4 * DBL_TRUE_MIN) == 5 * DBL_TRUE_MIN && ob_hypot(DBL_MAX, 1) == DBL_MAX);
	CHECK(ob_hypot(NAN, -INFINITY) == INFINITY && isnan(ob_hypot(NAN, 1)) &&
	      ob_hypot(DBL_MAX, DBL_MAX) == INFINITY);
}

static void check_atan2(void)
{
	CHECK(is(ob_atan2(0, 1), 0) && is(ob_atan2(-0., 1), -0.) && is(ob_atan2(0, 0), 0) && is(ob_atan2(-0., 0), -0.));
	CHECK(ob_atan2(0, -0.) == M_PI && ob_atan2(-0., -0.) == -M_PI && ob_atan2(-0., -1) == -M_PI);
	CHECK(ob_atan2(1, 0) == M_PI_2 && ob_atan2(-1, -0.) == -M_PI_2 && ob_atan2(1, 1) == M_PI_4);
	CHECK(ob_atan2(INFINITY, 1) == M_PI_2 && ob_atan2(-INFINITY, -1e300) == -M_PI_2);
	CHECK(is(ob_atan2(1, INFINITY), 0) && is(ob_atan2(-1, INFINITY), -0.) && ob_atan2(1, -INFINITY) == M_PI);
	CHECK(ob_atan2(INFINITY, INFINITY) == M_PI_4 && ob_atan2(-INFINITY, INFINITY) == -M_PI_4);
	CHECK(ob_atan2(INFINITY, -INFINITY) == 3 * M_PI_4 && ob_atan2(-INFINITY, -INFINITY) == -3 * M_PI_4);
	CHECK(isnan(ob_atan2(NAN, 1)) && isnan(ob_atan2(0, NAN)));
	CHECK(ob_atan2(DBL_TRUE_MIN, DBL_TRUE_MIN) == M_PI_4 && ob_atan2(-DBL_MAX, DBL_MAX) == -M_PI_4);
	CHECK(ob_atan2(DBL_TRUE_MIN, 1) == DBL_TRUE_MIN && is(ob_atan2(DBL_TRUE_MIN, 4), 0));
	CHECK(ob_atan2(1e-300, -1) == M_PI && ob_atan2(1, -1e-300) == M_PI_2);
}

static void check_pow(void)
{
	CHECK(ob_pow(NAN, 0) == 1 && ob_pow(1, NAN) == 1 && isnan(ob_pow(NAN, 1)) && isnan(ob_pow(2, NAN)));
	CHECK(is(ob_pow(-0., 3), -0.) && is(ob_pow(-0., 2), 0) && ob_pow(0, -1) == INFINITY);
	CHECK(ob_pow(-0., -3) == -INFINITY && ob_pow(-0., -2) == INFINITY && is(ob_pow(-0., .5), 0));
	CHECK(ob_pow(-1, INFINITY) == 1 && ob_pow(.5, INFINITY) == 0 && ob_pow(2, INFINITY) == INFINITY);
	CHECK(ob_pow(.5, -INFINITY) == INFINITY && ob_pow(-2, -INFINITY) == 0);
	CHECK(ob_pow(-INFINITY, 3) == -INFINITY && ob_pow(-INFINITY, 2) == INFINITY &&
	      ob_pow(INFINITY, .5) == INFINITY);
	CHECK(is(ob_pow(-INFINITY, -3), -0.) && is(ob_pow(-INFINITY, -2), 0) && is(ob_pow(INFINITY, -1), 0));
	CHECK(ob_pow(10, 400) == INFINITY && is(ob_pow(-10, -401), -0.) && ob_pow(-10, 401) == -INFINITY);
	CHECK(ob_pow(1 + DBL_EPSILON, 1e300) == INFINITY && ob_pow(.5, 1e300) == 0 && ob_pow(2, 1e-300) == 1);
}

int main(void)
{
	check_odd_functions();
	check_two_angles();
	check_domains();
	check_whole_powers();
	check_atan2();
	check_hypot();
	check_pow();
	return check_end();
}

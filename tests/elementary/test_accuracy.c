// Errors of the functions against MPFR with 200 bits, in units in the last place of the nearest double. They must stay
// within the bounds of elementary.h, over the usual ranges and over all doubles.
#include <float.h>
#include <mpfr.h>
#include <stdint.h>
#include <string.h>

#include "base/random.h"
#include "check.h"
#include "elementary/elementary.h"

enum { DRAWS = 10000, BITS = 200 };

static uint64_t seed = 1;

// Any double in [low, high], all exponents alike.
static double any_double(double low, double high)
{
	double x;
	do {
		const uint64_t bits = ob_splitmix(&seed);
		memcpy(&x, &bits, sizeof x);
	} while (!(x >= low && x <= high));
	return x;
}

static double drawn(double low, double high, int k)
{
	return k % 2 && isfinite(low) && isfinite(high) ? ob_splitmix_within(&seed, low, high) : any_double(low, high);
}

// Units in the last place between the result and the exact value. A value that rounds to an infinity must give that, or
// the largest double.
static double error_of(double got, const mpfr_t right)
{
	const double nearest = mpfr_get_d(right, MPFR_RNDN);
	int exponent;
	mpfr_t difference;
	if (isnan(nearest) || isnan(got))
		return isnan(nearest) && isnan(got) ? 0 : INFINITY;
	if (isinf(nearest) || isinf(got))
		return got == nearest || fabs(got) == DBL_MAX || fabs(nearest) == DBL_MAX ? 0 : INFINITY;
	frexp(nearest, &exponent);
	mpfr_init2(difference, BITS);
	mpfr_sub_d(difference, right, got, MPFR_RNDN);
	const double error = fabs(mpfr_get_d(difference, MPFR_RNDN));
	mpfr_clear(difference);
	return ldexp(error, DBL_MANT_DIG - (exponent > DBL_MIN_EXP ? exponent : DBL_MIN_EXP));
}

typedef int mpfr_function(mpfr_t, const mpfr_t, mpfr_rnd_t);
typedef int mpfr_function_of_two(mpfr_t, const mpfr_t, const mpfr_t, mpfr_rnd_t);

static const struct {
	const char *name;
	double (*ours)(double);
	mpfr_function *theirs;
	double low, high, bound;
} OF_ONE[] = {
	{ "sin", ob_sin, mpfr_sin, -.8, .8, .8 },
	{ "sin", ob_sin, mpfr_sin, -10, 10, .8 },
	{ "sin", ob_sin, mpfr_sin, -1e6, 1e6, .8 },
	{ "sin", ob_sin, mpfr_sin, -INFINITY, INFINITY, .8 },
	{ "cos", ob_cos, mpfr_cos, -.8, .8, .8 },
	{ "cos", ob_cos, mpfr_cos, -10, 10, .8 },
	{ "cos", ob_cos, mpfr_cos, -1e6, 1e6, .8 },
	{ "cos", ob_cos, mpfr_cos, -INFINITY, INFINITY, .8 },
	{ "tan", ob_tan, mpfr_tan, -.8, .8, .9 },
	{ "tan", ob_tan, mpfr_tan, -10, 10, .9 },
	{ "tan", ob_tan, mpfr_tan, -INFINITY, INFINITY, .9 },
	{ "asin", ob_asin, mpfr_asin, -1, 1, .51 },
	{ "acos", ob_acos, mpfr_acos, -1, 1, .51 },
	{ "exp", ob_exp, mpfr_exp, -1, 1, .55 },
	{ "exp", ob_exp, mpfr_exp, -708, 712, .55 },
	{ "exp", ob_exp, mpfr_exp, -750, -708, 1.05 },
	{ "exp", ob_exp, mpfr_exp, -INFINITY, INFINITY, 1.05 },
	{ "expm1", ob_expm1, mpfr_expm1, -.1, .1, 1.7 },
	{ "expm1", ob_expm1, mpfr_expm1, -1, 1, 1.7 },
	{ "expm1", ob_expm1, mpfr_expm1, -50, 712, 1.7 },
	{ "expm1", ob_expm1, mpfr_expm1, -INFINITY, INFINITY, 1.7 },
	{ "sinh", ob_sinh, mpfr_sinh, -1, 1, 2.5 },
	{ "sinh", ob_sinh, mpfr_sinh, -712, 712, 2.5 },
	{ "cosh", ob_cosh, mpfr_cosh, -1, 1, 2.5 },
	{ "cosh", ob_cosh, mpfr_cosh, -712, 712, 2.5 },
	{ "tanh", ob_tanh, mpfr_tanh, -1, 1, 2.5 },
	{ "tanh", ob_tanh, mpfr_tanh, -25, 25, 2.5 },
	{ "log", ob_log, mpfr_log, .9, 1.1, .51 },
	{ "log", ob_log, mpfr_log, 0, INFINITY, .51 },
	{ "log2", ob_log2, mpfr_log2, .9, 1.1, .51 },
	{ "log2", ob_log2, mpfr_log2, 0, INFINITY, .51 },
	{ "log10", ob_log10, mpfr_log10, .9, 1.1, .51 },
	{ "log10", ob_log10, mpfr_log10, 0, INFINITY, .51 },
};

static double error_at(double (*ours)(double), mpfr_function *theirs, double x)
{
	mpfr_t argument, right;
	mpfr_inits2(BITS, argument, right, (mpfr_ptr)0);
	mpfr_set_d(argument, x, MPFR_RNDN);
	theirs(right, argument, MPFR_RNDN);
	const double error = error_of(ours(x), right);
	mpfr_clears(argument, right, (mpfr_ptr)0);
	return error;
}

static double error_at_two(double (*ours)(double, double), mpfr_function_of_two *theirs, double a, double b)
{
	mpfr_t first, second, right;
	mpfr_inits2(BITS, first, second, right, (mpfr_ptr)0);
	mpfr_set_d(first, a, MPFR_RNDN);
	mpfr_set_d(second, b, MPFR_RNDN);
	theirs(right, first, second, MPFR_RNDN);
	const double error = error_of(ours(a, b), right);
	mpfr_clears(first, second, right, (mpfr_ptr)0);
	return error;
}

static void check_worst(const char *name, double worst, double bound)
{
	printf("%-6s %.4f of %.2f\n", name, worst, bound);
	CHECK(worst <= bound);
}

static void check_functions_of_one(void)
{
	for (size_t i = 0; i < sizeof OF_ONE / sizeof *OF_ONE; i++) {
		double worst = 0;
		for (int k = 0; k < DRAWS; k++) {
			const double x = drawn(OF_ONE[i].low, OF_ONE[i].high, k);
			worst = fmax(worst, error_at(OF_ONE[i].ours, OF_ONE[i].theirs, x));
		}
		check_worst(OF_ONE[i].name, worst, OF_ONE[i].bound);
	}
}

// Doubles next to multiples of pi / 2, where the reduction loses most; the last is the nearest of all, 2^-61 off
// (Muller, "Elementary Functions", section 11.3.2).
static void check_near_quarters(void)
{
	double worst = 0;
	for (int k = 1; k < 4000; k++)
		for (int off = -1; off <= 1; off++) {
			const double x = (k * (k < 2000 ? 1 : 1e4)) * M_PI_2 * (1 + off * DBL_EPSILON);
			worst = fmax(worst, error_at(ob_sin, mpfr_sin, x));
			worst = fmax(worst, error_at(ob_cos, mpfr_cos, x));
			worst = fmax(worst, error_at(ob_tan, mpfr_tan, x));
		}
	const double nearest = ldexp(6381956970095103, 797);
	worst = fmax(worst, error_at(ob_cos, mpfr_cos, nearest));
	worst = fmax(worst, error_at(ob_tan, mpfr_tan, nearest));
	worst = fmax(worst, error_at(ob_sin, mpfr_sin, DBL_MAX));
	check_worst("near", worst, .9);
}

static void check_pairs(const char *name, double (*ours)(double, double), mpfr_function_of_two *theirs, double bound)
{
	double worst = 0;
	for (int k = 0; k < DRAWS; k++) {
		const double y = drawn(-1, 1, 1), x = drawn(-1, 1, 1), wide = any_double(-DBL_MAX, DBL_MAX),
			     near = wide * exp(drawn(-45, 45, 1));
		worst = fmax(worst, error_at_two(ours, theirs, y, x));
		worst = fmax(worst, error_at_two(ours, theirs, wide, any_double(-DBL_MAX, DBL_MAX)));
		worst = fmax(worst, error_at_two(ours, theirs, isfinite(near) ? near : wide, wide));
	}
	check_worst(name, worst, bound);
}

static void check_pow(void)
{
	double worst = 0, subnormal = 0;
	for (int k = 0; k < DRAWS; k++) {
		const double x = drawn(0, 10, 1), wide = any_double(0, DBL_MAX), y = drawn(-745, 709, 1) / log(wide);
		worst = fmax(worst, error_at_two(ob_pow, mpfr_pow, x, drawn(-10, 10, 1)));
		worst = fmax(worst, error_at_two(ob_pow, mpfr_pow, -x, (double)(k % 41 - 20)));
		worst = fmax(worst, error_at_two(ob_pow, mpfr_pow, wide, any_double(-1, 1)));
		double *of = fabs(ob_pow(wide, y)) < DBL_MIN ? &subnormal : &worst;
		*of = fmax(*of, error_at_two(ob_pow, mpfr_pow, wide, y));
	}
	check_worst("pow", worst, .55);
	check_worst("pow", subnormal, 1.05);
}

// One reduction for both gives the bits of each alone.
static void check_sincos(void)
{
	int other = 0;
	for (int k = 0; k < DRAWS; k++) {
		const double x = drawn(k % 3 ? -10 : -INFINITY, k % 3 ? 10 : INFINITY, k);
		double sine, cosine;
		ob_sincos(x, &sine, &cosine);
		other += isfinite(x) && (sine != ob_sin(x) || cosine != ob_cos(x));
	}
	CHECK(other == 0);
}

int main(void)
{
	check_functions_of_one();
	check_near_quarters();
	check_pairs("atan2", ob_atan2, mpfr_atan2, .51);
	check_pairs("hypot", ob_hypot, mpfr_hypot, 1);
	check_pow();
	check_sincos();
	mpfr_free_cache();
	return check_end();
}

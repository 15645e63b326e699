// A number as the sum of two doubles, h + l with |l| at most half a unit in the last place of h: 106 bits (Dekker 1971;
// Knuth, "The Art of Computer Programming", vol. 2, 4.2.2). Products are exact from 1e-290 to 1e290. Pure functions.
#ifndef OB_ELEMENTARY_DOUBLE2_H
#define OB_ELEMENTARY_DOUBLE2_H

#include <float.h>

_Static_assert(FLT_EVAL_METHOD == 0, "a double is computed as a double: the sums below rely on its rounding");

typedef struct ob_double2 {
	double h, l;
} ob_double2;

// a + b, exactly
static inline ob_double2 ob_double2_sum(double a, double b)
{
	const double s = a + b, t = s - a;
	return (ob_double2){ s, (a - (s - t)) + (b - t) };
}

// Same for |a| >= |b|, or a = 0.
static inline ob_double2 ob_double2_quick_sum(double a, double b)
{
	const double s = a + b;
	return (ob_double2){ s, b - (s - a) };
}

// Upper 26 bits of a.
static inline double ob_double2_upper(double a)
{
	const double t = 134217729 * a; // 2^27 + 1
	return t - (t - a);
}

// a b, exactly
static inline ob_double2 ob_double2_product(double a, double b)
{
	const double p = a * b, ah = ob_double2_upper(a), bh = ob_double2_upper(b), al = a - ah, bl = b - bh;
	return (ob_double2){ p, ((ah * bh - p) + ah * bl + al * bh) + al * bl };
}

// a^2, exactly
static inline ob_double2 ob_double2_square(double a)
{
	const double p = a * a, h = ob_double2_upper(a), l = a - h;
	return (ob_double2){ p, ((h * h - p) + 2 * h * l) + l * l };
}

// a b, to a relative 2^-102
static inline ob_double2 ob_double2_times(ob_double2 a, ob_double2 b)
{
	const ob_double2 p = ob_double2_product(a.h, b.h);
	return ob_double2_quick_sum(p.h, p.l + (a.h * b.l + a.l * b.h));
}

#endif

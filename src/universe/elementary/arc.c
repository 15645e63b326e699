// atan2, asin, acos: subtracts the angle of the nearest of 16 directions, then evaluates a short polynomial.
#include <math.h>
#include <stdbool.h>

#include "elementary/directions.h"
#include "elementary/double2.h"
#include "elementary/elementary.h"

static const ob_double2 HALF_TURN = { 0x1.921fb54442d18p1, 0x1.1a62633145c07p-53 }; // pi

// atan(a / b), 0 <= a <= b, both from 1e-150 to 1e150, or a = 0
static ob_double2 angle_below(ob_double2 a, ob_double2 b)
{
	const int k = (int)(16 * (a.h / b.h) + .5);
	const double c = .0625 * k;
	// atan(a / b) - atan(c) = atan((a - c b) / (b + c a))
	const ob_double2 cb = ob_double2_product(c, b.h), ca = ob_double2_product(c, a.h);
	const ob_double2 n = ob_double2_sum(a.h, -cb.h), d = ob_double2_quick_sum(b.h, ca.h);
	const double nl = n.l + ((a.l - c * b.l) - cb.l), dl = d.l + ((b.l + c * a.l) + ca.l);
	const double u = n.h / d.h, inverse = 1 / d.h;
	const ob_double2 back = ob_double2_product(u, d.h);
	const double rest = (((n.h - back.h) - back.l) + (nl - u * dl)) * inverse;
	const double z = u * u;
	const double p = -0x1.5555555555555p-2 +
			 z * (0x1.99999999982edp-3 +
			      z * (-0x1.24924913dea21p-3 + z * (0x1.c71bc387bcap-4 - z * 0x1.72cba59826084p-4)));
	// |u| <= 1 / 32, and k is 0 or DIRECTION is larger
	const ob_double2 s = ob_double2_quick_sum(DIRECTION[k].h, u);
	return ob_double2_quick_sum(s.h, s.l + (DIRECTION[k].l + (u * z * p + rest * (1 - z))));
}

static ob_double2 less(ob_double2 a, ob_double2 b)
{
	const ob_double2 s = ob_double2_quick_sum(a.h, -b.h); // a is larger in all calls
	return ob_double2_quick_sum(s.h, s.l + (a.l - b.l));
}

// Angle of the point (x, y) in [0, pi]; x of any sign, y >= 0.
static double angle_of(ob_double2 y, ob_double2 x)
{
	const bool left = x.h < 0;
	if (left)
		x = (ob_double2){ -x.h, -x.l };
	const bool steep = y.h > x.h || (y.h == x.h && y.l > x.l);
	ob_double2 angle = steep ? less(QUARTER_TURN, angle_below(x, y)) : angle_below(y, x);
	if (left)
		angle = less(HALF_TURN, angle);
	return angle.h;
}

// Same for doubles of any size, neither NaN, not both zero.
static double angle_of_any(double y, double x)
{
	const double most = fabs(x) > y ? fabs(x) : y;
	double least = fabs(x) > y ? y : fabs(x);
	if (isinf(most))
		return angle_of((ob_double2){ isinf(y), 0 }, (ob_double2){ copysign(isinf(x) != 0, x), 0 });
	// an axis to the last digit, or so near the first that the angle equals its tangent
	if (least < 0x1p-120 * most) {
		if (y == least && x > 0)
			return y / x;
		return y == least ? HALF_TURN.h : QUARTER_TURN.h;
	}
	const double scale = most > 0x1p300 ? 0x1p-600 : most < 0x1p-300 ? 0x1p600 : 1;
	return angle_of((ob_double2){ y * scale, 0 }, (ob_double2){ x * scale, 0 });
}

double ob_atan2(double y, double x)
{
	if (isnan(x) || isnan(y))
		return NAN;
	if (y == 0)
		return copysign(signbit(x) ? HALF_TURN.h : 0, y);
	return copysign(angle_of_any(fabs(y), x), y);
}

// sqrt(1 - x^2), the other leg of a triangle with hypotenuse 1; |x| <= 1
static ob_double2 other_leg(double x)
{
	const ob_double2 up = ob_double2_sum(1, x), down = ob_double2_sum(1, -x), p = ob_double2_times(up, down);
	const double root = sqrt(p.h);
	if (root == 0)
		return (ob_double2){ 0, 0 };
	const ob_double2 square = ob_double2_square(root);
	return ob_double2_quick_sum(root, (((p.h - square.h) - square.l) + p.l) / (2 * root));
}

double ob_asin(double x)
{
	if (!(fabs(x) <= 1))
		return NAN;
	if (fabs(x) < 0x1p-27)
		return x;
	return copysign(angle_of((ob_double2){ fabs(x), 0 }, other_leg(x)), x);
}

double ob_acos(double x)
{
	if (!(fabs(x) <= 1))
		return NAN;
	return angle_of(other_leg(x), (ob_double2){ x, 0 });
}

// Hypotenuse of legs that can be squared: the root, corrected by the error of its square.
static double corrected_root(double longer, double shorter)
{
	const double root = sqrt(longer * longer + shorter * shorter);
	double excess; // of the root's square
	if (root <= 2 * shorter) {
		const double over = root - shorter;
		excess = longer * (2 * over - longer) + (over - 2 * (longer - shorter)) * over;
	} else {
		const double over = root - longer;
		excess = 2 * over * (longer - 2 * shorter) + ((4 * over - shorter) * shorter + over * over);
	}
	return root - excess / (2 * root);
}

double ob_hypot(double x, double y)
{
	const double longer = fmax(fabs(x), fabs(y)), shorter = fmin(fabs(x), fabs(y));
	if (isinf(longer))
		return INFINITY;
	if (isnan(x) || isnan(y))
		return NAN;
	if (shorter * 0x1p54 <= longer)
		return longer + shorter;
	const double scale = longer > 0x1p511 ? 0x1p-600 : shorter < 0x1p-459 ? 0x1p600 : 1;
	return corrected_root(longer * scale, shorter * scale) / scale;
}

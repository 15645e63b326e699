// Angles of several points side by side, by the operations of ob_atan2 in the same order: each lane has the bits of
// ob_atan2.
//
// Text for vectors of one width. The including file first names the vector type, the type of a comparison, and the
// width: typedef double wide, typedef int64_t wide_mask, enum { WIDTH }.
#ifndef OB_ELEMENTARY_ARC_WIDE_H
#define OB_ELEMENTARY_ARC_WIDE_H

#include "elementary/directions.h"

typedef struct wide2 {
	wide h, l;
} wide2;

static inline wide wide_chosen(wide_mask m, wide yes, wide no)
{
	return (wide)((m & (wide_mask)yes) | (~m & (wide_mask)no));
}

static inline wide2 wide2_quick_sum(wide a, wide b)
{
	const wide s = a + b;
	return (wide2){ s, b - (s - a) };
}

static inline wide wide_upper(wide a)
{
	const wide t = 134217729 * a;
	return t - (t - a);
}

static inline wide2 wide2_product(wide a, wide b)
{
	const wide p = a * b, ah = wide_upper(a), bh = wide_upper(b), al = a - ah, bl = b - bh;
	return (wide2){ p, ((ah * bh - p) + ah * bl + al * bh) + al * bl };
}

static inline wide2 wide2_less(wide2 a, wide2 b)
{
	const wide2 s = wide2_quick_sum(a.h, -b.h);
	return wide2_quick_sum(s.h, s.l + (a.l - b.l));
}

// atan(a / b), 0 < a <= b
static inline wide2 angle_below_wide(wide a, wide b)
{
	const wide nearest = 16 * (a / b) + .5;
	wide c, h, l;
	for (int i = 0; i < WIDTH; i++) {
		const int k = (int)nearest[i];
		c[i] = .0625 * k;
		h[i] = DIRECTION[k].h, l[i] = DIRECTION[k].l;
	}
	const wide2 cb = wide2_product(c, b), ca = wide2_product(c, a);
	wide n_rest;
	const wide n = wide_sum(a, -cb.h, &n_rest);
	const wide2 d = wide2_quick_sum(b, ca.h);
	const wide nl = n_rest + (0 - cb.l), dl = d.l + (0 + ca.l);
	const wide u = n / d.h, inverse = 1 / d.h;
	const wide2 back = wide2_product(u, d.h);
	const wide rest = (((n - back.h) - back.l) + (nl - u * dl)) * inverse;
	const wide z = u * u;
	const wide p = wide_of(-0x1.5555555555555p-2) +
		       z * (wide_of(0x1.99999999982edp-3) +
			    z * (wide_of(-0x1.24924913dea21p-3) +
				 z * (wide_of(0x1.c71bc387bcap-4) - z * 0x1.72cba59826084p-4)));
	const wide2 s = wide2_quick_sum(h, u);
	return wide2_quick_sum(s.h, s.l + (l + (u * z * p + rest * (1 - z))));
}

// Angles of points (x, y). Both coordinates are positive and not extreme; neither is below 2^-120 of the other.
static inline wide angle_wide(wide y, wide x)
{
	const wide_mask steep = y > x;
	const wide2 below = angle_below_wide(wide_chosen(steep, x, y), wide_chosen(steep, y, x));
	const wide2 quarter = { wide_of(QUARTER_TURN.h), wide_of(QUARTER_TURN.l) };
	return wide_chosen(steep, wide2_less(quarter, below).h, below.h);
}

#endif

// Integrals along the border of a patch (contact/patch.h), of four edges side by side: one edge of each of four patches,
// or four edges of one.
#ifndef OB_CONTACT_BORDER_H
#define OB_CONTACT_BORDER_H

#include "elementary/lanes.h"

typedef struct border_sums {
	lanes force[2], power, weight; // integrals of p u/|u|, p |u|, p/|u|
} border_sums;

// ln((s + d) / (s - d)), with s - d as "down". Without libm: the same bits everywhere.
static inline lanes border_log(lanes d, lanes s, lanes down)
{
	typedef uint64_t words __attribute__((vector_size(32)));
	const double at_two_to_52 = 0x1p52 + 1023; // makes the exponent, as the low bits of a number, a number
	lanes y = (s + d) / down;
	words bits = (words)y;
	lanes m = (lanes)((bits & 0xfffffffffffff) | 0x3ff0000000000000);
	lanes e = (lanes)((bits >> 52) | 0x4330000000000000) - at_two_to_52;
	lane_mask high = m > 1.4142135623730951, near = d < .1715 * s;
	m = lanes_select(high, .5 * m, m);
	e = lanes_where(~near, lanes_select(high, e + 1, e));
	lanes f = lanes_select(near, d, m - 1) / lanes_select(near, s, m + 1), f2 = f * f, sum = lanes_of(1. / 19);
	for (int k = 17; k > 0; k -= 2)
		sum = sum * f2 + 1. / k;
	return 2 * f * sum + e * 0.69314718055994531;
}

// Adds the edge from the corner u1 to u2, at distances r1 and r2 from the centre of rotation. at: relative pressure at
// that centre; slope: its gradient in u.
static inline void border_add_edge(const lanes *u1, lanes r1, const lanes *u2, lanes r2, lanes at, const lanes *slope,
				   border_sums *o)
{
	lanes dx = u2[0] - u1[0], dy = u2[1] - u1[1], length = lanes_sqrt(dx * dx + dy * dy);
	lanes inverse = 1 / (length + 1e-300), ex = dx * inverse, ey = dy * inverse; // edge; (ey, -ex) points outwards
	lanes h = u1[0] * ey - u1[1] * ex, s1 = u1[0] * ex + u1[1] * ey, s2 = u2[0] * ex + u2[1] * ey, h2 = h * h;
	lanes sum = r1 + r2 + 1e-30, down = lanes_max(sum - length, 1e-16 * sum);
	lanes i0 = border_log(length, sum, down), i1 = r2 - r1;
	lanes span = s2 * r2 - s1 * r1, i2 = .5 * (span - h2 * i0), j0 = .5 * (span + h2 * i0);
	lanes j1 = (r2 * r2 * r2 - r1 * r1 * r1) * (1. / 3);
	lanes along = slope[0] * ex + slope[1] * ey, out = h * (slope[0] * ey - slope[1] * ex);
	lanes a0 = .5 * at + out * (1. / 3), a1 = along * (1. / 3);
	lanes fe = h * (a0 * i1 + a1 * i2), fn = h2 * (a0 * i0 + a1 * i1);
	o->force[0] += fe * ex + fn * ey;
	o->force[1] += fe * ey - fn * ex;
	o->power += h * ((at * (1. / 3) + .25 * out) * j0 + .25 * along * j1);
	lanes c0 = at + .5 * out, c1 = .5 * along;
	o->weight += h * (c0 * i0 + c1 * i1);
}

#endif

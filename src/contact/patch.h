// Friction of a patch: force and twist between two bodies that touch over an area.
//
// Every surface element has its own cone of friction. So force and torque share one limit: the wrench (f1, f2, twist)
// about the patch's centroid lies in the convex set
//
//      C = { lambda : lambda u <= D(u) for all u },    D(u) = mu * integral of p |u(x)| dA,
//
// whose border is the limit surface (Goyal, Ruina, Papadopoulos 1991). D is the power lost at the slip u. A patch that
// slides does so with the largest loss of power: lambda = -grad D(u). Within C it sticks.
//
// Pressure p: rigid bodies determine its resultant and its centre alone, which are those of the normal impulses. It is
// taken as the simplest one without tension: linear over the patch while the centre of pressure lies in its kern.
// Beyond that it is linear over a part that shrinks towards the loaded edge, corner or rim; contacts of an edge and of
// a corner are its limits.
//
// D and its derivatives are exact for a parallelogram. With u as the coordinate, F = u/|u| and |u| are homogeneous
// about the centre of rotation, u = 0. So the integrals over the area are integrals along its border (theorems of Euler
// and Gauss). Along an edge at the distance H from u = 0 they follow from
//
//      integral of ds/r = ln((r1 + r2 + L)/(r1 + r2 - L)),   r^2 = s^2 + H^2.
//
// A disc is a regular polygon of twelve corners with the disc's second moment. It is turned so that it looks the same
// along the slip whatever the axes are. For a distant centre of rotation four nodes suffice.
//
// Four lanes at a time; no operation mixes lanes. Unit load: everything here is for mu * (sum of normal impulses) = 1.
// Symmetric matrices: 11 12 13 22 23 33.
#ifndef OB_CONTACT_PATCH_H
#define OB_CONTACT_PATCH_H

#include <string.h>

#include "contact/batch.h"

enum { PATCH_CORNERS = 12 };

typedef struct patch_load {
	lanes pressure[2], edges[2]; // centre of pressure: m from the centroid; in half edges
	lanes centre[2], e1[2], e2[2]; // m: centre of the loaded part, from the centroid; its half edges
	lanes slope[2]; // 1/m: gradient of the relative pressure, which is 1 + slope x, with x from the centre
	lanes radius; // m: radius of a loaded disc; 0: a parallelogram
	lanes spread; // m^2: mean square distance from the centre of pressure
	bool any_disc;
} patch_load;

// D and its gradient at a slip u. bound: matrix with grad D(u) = bound u, the sum of all elements with their weights at
// u. D^2 is nowhere more than D(u) times this quadratic form.
typedef struct patch_slip {
	lanes power, grad[3], bound[6];
} patch_slip;

// ---- arithmetic

static inline lanes patch_dot(const lanes *a, const lanes *b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void patch_mul(const lanes *s, const lanes *x, lanes *o)
{
	o[0] = s[0] * x[0] + s[1] * x[1] + s[2] * x[2];
	o[1] = s[1] * x[0] + s[3] * x[1] + s[4] * x[2];
	o[2] = s[2] * x[0] + s[4] * x[1] + s[5] * x[2];
}

// x = (t a + s)^-1 y, by LDL^T
static inline void patch_solve(lanes t, const lanes *a, const lanes *s, const lanes *y, lanes *x)
{
	lanes m[6];
	for (int i = 0; i < 6; i++)
		m[i] = t * a[i] + s[i];
	lanes i0 = 1 / m[0], l1 = m[1] * i0, l2 = m[2] * i0;
	lanes i1 = 1 / (m[3] - l1 * m[1]), b = m[4] - l1 * m[2], l3 = b * i1;
	lanes i2 = 1 / (m[5] - l2 * m[2] - l3 * b);
	lanes y1 = y[1] - l1 * y[0], y2 = y[2] - l2 * y[0] - l3 * y1;
	x[2] = y2 * i2;
	x[1] = y1 * i1 - l3 * x[2];
	x[0] = y[0] * i0 - l1 * x[1] - l2 * x[2];
}

// ln((s + d) / (s - d)), with s - d as "down". Without libm: the same bits everywhere.
static inline lanes patch_log(lanes d, lanes s, lanes down)
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

// ---- the load

static inline lanes patch_sign(lanes x)
{
	return lanes_select(x < 0, lanes_of(-1), lanes_of(1));
}

// Sets the pressure under the normal impulses x. sum: total of the four.
static inline void patch_load_set(const ob_batch *b, const lanes *x, lanes sum, patch_load *o)
{
	const double thinnest = .01, thin = .05; // width of a loaded part, relative to its length
	const double kern = 1. / 3, disc_kern = .244; // just below 1/4, for the polygon's corners
	const lanes one = lanes_of(1), smallest = lanes_of(.01);
	lanes inverse = 1 / lanes_max(sum, lanes_of(1e-300));
	lanes s = (x[0] * b->patch_s[0] + x[1] * b->patch_s[1] + x[2] * b->patch_s[2] + x[3] * b->patch_s[3]) * inverse;
	lanes t = (x[0] * b->patch_t[0] + x[1] * b->patch_t[1] + x[2] * b->patch_t[2] + x[3] * b->patch_t[3]) * inverse;
	const lanes *e1 = b->patch_e1, *e2 = b->patch_e2;
	o->edges[0] = s, o->edges[1] = t;
	lanes as = lanes_min(lanes_abs(s), one), at = lanes_min(lanes_abs(t), one);
	lanes ks = lanes_min(as, lanes_of(kern)), kt = lanes_min(at, lanes_of(kern));
	lanes within = lanes_min(one, kern / lanes_max(ks + kt, lanes_of(1e-300)));
	ks *= within, kt *= within;
	lanes ls = lanes_max((1 - as) / (1 - ks), smallest), lt = lanes_max((1 - at) / (1 - kt), smallest);
	lanes ratio = lanes_sqrt((e2[0] * e2[0] + e2[1] * e2[1]) / (e1[0] * e1[0] + e1[1] * e1[1]));
	ls = lanes_max(ls, thinnest * ratio * lt), lt = lanes_max(lt, thinnest / ratio * ls);
	// Load is even across a thin part: the pressure is so steep there that rounding would show.
	ks = lanes_where(ls >= thin * ratio * lt, ks * patch_sign(s));
	kt = lanes_where(ratio * lt >= thin * ls, kt * patch_sign(t));
	lanes det = e1[0] * e2[1] - e1[1] * e2[0], slope_s = 3 * ks / (ls * det), slope_t = 3 * kt / (lt * det);
	o->slope[0] = slope_s * e2[1] - slope_t * e1[1];
	o->slope[1] = slope_t * e1[0] - slope_s * e2[0];
	for (int c = 0; c < 2; c++) {
		o->pressure[c] = s * e1[c] + t * e2[c];
		o->e1[c] = ls * e1[c];
		o->e2[c] = lt * e2[c];
		o->centre[c] = o->pressure[c] - ks * o->e1[c] - kt * o->e2[c];
	}
	o->radius = lanes_of(0);
	lane_mask disc = b->disc > 0;
	o->any_disc = lanes_bits(disc);
	if (o->any_disc) {
		lanes r = lanes_max(b->disc, lanes_of(1e-300)), ir = 1 / r;
		lanes off = lanes_sqrt(o->pressure[0] * o->pressure[0] + o->pressure[1] * o->pressure[1]);
		lanes k = lanes_min(off * ir, one), kd = lanes_min(k, lanes_of(disc_kern));
		lanes small = r * lanes_max((1 - k) / (1 - kd), smallest), shrink = small * ir;
		lanes along = 1 / lanes_max(off, 1e-9 * r);
		for (int c = 0; c < 2; c++) {
			lanes direction = o->pressure[c] * along;
			o->slope[c] = lanes_select(disc, 4 * kd / small * direction, o->slope[c]);
			o->e1[c] = lanes_select(disc, shrink * e1[c], o->e1[c]);
			o->e2[c] = lanes_select(disc, shrink * e2[c], o->e2[c]);
			o->centre[c] = lanes_select(disc, o->pressure[c] - kd * small * direction, o->centre[c]);
		}
		ks = lanes_select(disc, lanes_of(disc_kern), ks), kt = lanes_select(disc, lanes_of(disc_kern), kt);
		o->radius = lanes_select(disc, small, lanes_of(0));
	}
	lanes l1 = o->e1[0] * o->e1[0] + o->e1[1] * o->e1[1], l2 = o->e2[0] * o->e2[0] + o->e2[1] * o->e2[1];
	lanes skew = o->e1[0] * o->e2[0] + o->e1[1] * o->e2[1];
	o->spread = l1 * (kern - ks * ks) + l2 * (kern - kt * kt) - 2 * ks * kt * skew;
}

// Computes the centre of pressure, in m from the centroid. Returns its shift since the ellipsoid was made, in half
// edges.
static inline lanes patch_pressure(const ob_batch *b, const lanes *x, lanes sum, const ob_patch_model *m, lanes *at)
{
	lanes inverse = 1 / lanes_max(sum, lanes_of(1e-300));
	lanes s = (x[0] * b->patch_s[0] + x[1] * b->patch_s[1] + x[2] * b->patch_s[2] + x[3] * b->patch_s[3]) * inverse;
	lanes t = (x[0] * b->patch_t[0] + x[1] * b->patch_t[1] + x[2] * b->patch_t[2] + x[3] * b->patch_t[3]) * inverse;
	at[0] = s * b->patch_e1[0] + t * b->patch_e2[0];
	at[1] = s * b->patch_e1[1] + t * b->patch_e2[1];
	return lanes_abs(s - m->pressure[0]) + lanes_abs(t - m->pressure[1]);
}

// Slip that the wrench x would resist if all elements of the patch had the same weight.
static inline void patch_first_slip(const patch_load *p, const lanes *x, lanes *d)
{
	d[2] = (x[2] - p->pressure[0] * x[1] + p->pressure[1] * x[0]) / p->spread;
	d[0] = x[0] + d[2] * p->pressure[1];
	d[1] = x[1] - d[2] * p->pressure[0];
}

// ---- the limit surface, about the centre of the loaded part

typedef struct patch_sums {
	lanes force[2], power, weight; // integrals of p u/|u|, p |u|, p/|u|
} patch_sums;

// Adds the edge from the corner u1 to u2, at distances r1 and r2 from the centre of rotation. at: relative pressure at
// that centre; slope: its gradient in u.
static inline void patch_add_edge(const lanes *u1, lanes r1, const lanes *u2, lanes r2, lanes at, const lanes *slope,
				  patch_sums *o)
{
	lanes dx = u2[0] - u1[0], dy = u2[1] - u1[1], length = lanes_sqrt(dx * dx + dy * dy);
	lanes inverse = 1 / (length + 1e-300), ex = dx * inverse, ey = dy * inverse; // edge; (ey, -ex) points outwards
	lanes h = u1[0] * ey - u1[1] * ex, s1 = u1[0] * ex + u1[1] * ey, s2 = u2[0] * ex + u2[1] * ey, h2 = h * h;
	lanes sum = r1 + r2 + 1e-30, down = lanes_max(sum - length, 1e-16 * sum);
	lanes i0 = patch_log(length, sum, down), i1 = r2 - r1;
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

// Computes the corners, counterclockwise. Returns their number. A disc's first corner is on the left of the slip.
static inline int patch_corners(const patch_load *p, const lanes *v, lanes (*at)[2])
{
	static const double c[PATCH_CORNERS] = { 1,  0.86602540378443865,  .5,  0, -.5, -0.86602540378443865,
						 -1, -0.86602540378443865, -.5, 0, .5,  0.86602540378443865 };
	const double out = 1.0231039; // relative radius of a polygon with the disc's second moment
	for (int k = 0; k < 2; k++) {
		at[0][k] = -p->e1[k] - p->e2[k];
		at[1][k] = p->e1[k] - p->e2[k];
		at[2][k] = p->e1[k] + p->e2[k];
		at[3][k] = p->e2[k] - p->e1[k];
	}
	if (!p->any_disc)
		return 4;
	lanes speed = lanes_sqrt(v[0] * v[0] + v[1] * v[1]);
	lane_mask disc = p->radius > 0, moves = speed > 0;
	lanes f = out * p->radius / lanes_select(moves, speed, lanes_of(1));
	lanes x = -f * v[1], y = lanes_select(moves, f * v[0], out * p->radius);
	for (int i = 0; i < PATCH_CORNERS; i++) {
		const double cos = c[i], sin = c[(i + 9) % PATCH_CORNERS];
		at[i][0] = lanes_select(disc, cos * x - sin * y, at[i < 4 ? i : 3][0]);
		at[i][1] = lanes_select(disc, sin * x + cos * y, at[i < 4 ? i : 3][1]);
	}
	return PATCH_CORNERS;
}

// Computes the slip u at a corner x. Returns its magnitude.
static inline lanes patch_slip_of(const lanes *v, lanes w, const lanes *x, lanes *u)
{
	u[0] = v[0] - w * x[1];
	u[1] = v[1] + w * x[0];
	return lanes_sqrt(u[0] * u[0] + u[1] * u[1]);
}

// Adds the integrals along the border. Returns twice the area.
static inline lanes patch_sum_edges(const lanes (*corner)[2], int corners, const lanes *v, lanes w, lanes at,
				    const lanes *slope, patch_sums *o)
{
	lanes u[PATCH_CORNERS][2], r[PATCH_CORNERS], area = lanes_of(0);
	for (int i = 0; i < corners; i++) {
		const lanes *x = corner[i], *next = corner[i + 1 < corners ? i + 1 : 0];
		r[i] = patch_slip_of(v, w, x, u[i]);
		area += x[0] * next[1] - x[1] * next[0];
	}
	for (int i = 0; i < corners; i++) {
		int next = i + 1 < corners ? i + 1 : 0;
		patch_add_edge(u[i], r[i], u[next], r[next], at, slope, o);
	}
	return area;
}

static inline lanes patch_add_all(lanes sum, lanes x)
{
	return lanes_of(sum[0] + x[0] + x[1] + x[2] + x[3]);
}

// As patch_sum_edges, for lane l alone, with four edges side by side: the same sums in the same order.
static inline lanes patch_sum_edges_of(int l, const lanes (*corner)[2], int corners, const lanes *v, lanes w, lanes at,
				       const lanes *slope, patch_sums *o)
{
	const lanes own_v[2] = { lanes_of(v[0][l]), lanes_of(v[1][l]) }, own_w = lanes_of(w[l]);
	const lanes own_slope[2] = { lanes_of(slope[0][l]), lanes_of(slope[1][l]) };
	lanes area = lanes_of(0);
	for (int i = 0; i < corners; i += OB_LANES) {
		const int end = i + OB_LANES < corners ? i + OB_LANES : 0;
		patch_sums four = { 0 };
		lanes x[2], next[2], u[2], un[2];
		for (int c = 0; c < 2; c++) {
			x[c] = (lanes){ corner[i][c][l], corner[i + 1][c][l], corner[i + 2][c][l],
					corner[i + 3][c][l] };
			next[c] = (lanes){ x[c][1], x[c][2], x[c][3], corner[end][c][l] };
		}
		const lanes r = patch_slip_of(own_v, own_w, x, u), rn = patch_slip_of(own_v, own_w, next, un);
		patch_add_edge(u, r, un, rn, lanes_of(at[l]), own_slope, &four);
		area = patch_add_all(area, x[0] * next[1] - x[1] * next[0]);
		for (int c = 0; c < 2; c++)
			o->force[c] = patch_add_all(o->force[c], four.force[c]);
		o->power = patch_add_all(o->power, four.power);
		o->weight = patch_add_all(o->weight, four.weight);
	}
	return area;
}

// Computes D and its derivatives for a centre of rotation nearby: w is not near 0. asked: lanes to compute.
static inline void patch_slip_near(const patch_load *p, unsigned asked, const lanes *v, lanes w, patch_slip *o)
{
	lanes corner[PATCH_CORNERS][2];
	const int corners = patch_corners(p, v, corner);
	const lanes iw = 1 / w, slope[2] = { -p->slope[1] * iw, p->slope[0] * iw };
	const lanes at = 1 - slope[0] * v[0] - slope[1] * v[1];
	patch_sums sum = { 0 };
	const lanes area = lanes_count(asked) == 1
				   ? patch_sum_edges_of(__builtin_ctz(asked), corner, corners, v, w, at, slope, &sum)
				   : patch_sum_edges(corner, corners, v, w, at, slope, &sum);
	const lanes scale = 2 * iw * iw / area;
	for (int c = 0; c < 2; c++)
		o->grad[c] = scale * sum.force[c];
	o->power = scale * sum.power;
	o->grad[2] = (o->power - o->grad[0] * v[0] - o->grad[1] * v[1]) * iw;
	lanes weight = scale * sum.weight, kx = (o->grad[0] - weight * v[0]) * iw,
	      ky = (o->grad[1] - weight * v[1]) * iw;
	lanes bound[6] = { weight, lanes_of(0), kx, weight, ky, (o->grad[2] - kx * v[0] - ky * v[1]) * iw };
	for (int i = 0; i < 6; i++)
		o->bound[i] = bound[i];
}

// Computes them for a distant centre of rotation, by four nodes: exact for a cubic.
static inline void patch_slip_far(const patch_load *p, const lanes *v, lanes w, patch_slip *o)
{
	const double at = 0.57735026918962576;
	*o = (patch_slip){ 0 };
	for (int i = 0; i < 4; i++) {
		const double s = i & 1 ? at : -at, t = i & 2 ? at : -at;
		lanes x = s * p->e1[0] + t * p->e2[0], y = s * p->e1[1] + t * p->e2[1];
		lanes weight = .25 * (1 + p->slope[0] * x + p->slope[1] * y);
		lanes a = v[0] - w * y, b = v[1] + w * x, inverse = 1 / (lanes_sqrt(a * a + b * b) + 1e-300);
		lanes c = weight * inverse, fa = a * inverse, fb = b * inverse, ft = x * fb - y * fa;
		o->grad[0] += weight * fa;
		o->grad[1] += weight * fb;
		o->grad[2] += weight * ft;
		lanes m[6] = { c, lanes_of(0), -c * y, c, c * x, c * (x * x + y * y) };
		for (int k = 0; k < 6; k++)
			o->bound[k] += m[k];
	}
	o->power = o->grad[0] * v[0] + o->grad[1] * v[1] + o->grad[2] * w;
}

// Moves a matrix from the loaded part's centre to the patch's centroid.
static inline void patch_move(const lanes *centre, lanes *m)
{
	lanes x = -centre[1], y = centre[0];
	m[5] += 2 * (x * m[2] + y * m[4]) + x * x * m[0] + 2 * x * y * m[1] + y * y * m[3];
	m[2] += x * m[0] + y * m[1];
	m[4] += x * m[1] + y * m[3];
}

// Computes D and its derivatives at the slip d in the lanes "asked". Scales d to the order of 1 (D is homogeneous).
static inline void patch_slip_at(const patch_load *p, lane_mask asked, lanes *d, patch_slip *o)
{
	const double far_share = .02; // share of rotation in the slip
	lanes size = lanes_abs(p->e1[0]) + lanes_abs(p->e1[1]) + lanes_abs(p->e2[0]) + lanes_abs(p->e2[1]);
	lanes v[2] = { d[0] - d[2] * p->centre[1], d[1] + d[2] * p->centre[0] };
	lanes moves = lanes_abs(v[0]) + lanes_abs(v[1]), turns = lanes_abs(d[2]) * size,
	      scale = 1 / (moves + turns + 1e-300);
	for (int c = 0; c < 3; c++)
		d[c] *= scale;
	v[0] *= scale, v[1] *= scale;
	lane_mask far = turns < far_share * moves;
	if (lanes_bits(asked & ~far))
		patch_slip_near(p, lanes_bits(asked & ~far), v, lanes_select(far, 1 / size, d[2]), o);
	else
		*o = (patch_slip){ 0 };
	if (lanes_bits(asked & far)) {
		patch_slip at_far;
		patch_slip_far(p, v, d[2], &at_far);
		o->power = lanes_select(far, at_far.power, o->power);
		for (int i = 0; i < 3; i++)
			o->grad[i] = lanes_select(far, at_far.grad[i], o->grad[i]);
		for (int i = 0; i < 6; i++)
			o->bound[i] = lanes_select(far, at_far.bound[i], o->bound[i]);
	}
	o->grad[2] += p->centre[0] * o->grad[1] - p->centre[1] * o->grad[0];
	patch_move(p->centre, o->bound);
}

// ---- friction

// Makes the ellipsoid about the centre of pressure that touches C at the wrench of "slip", with the same normal. It is
// as near to C as a quadratic form comes there (D(u)^2 <= u Q u, equal along the slip). A dense heap can afford the
// integrals once in a substep; in all its sweeps and iterations the ellipsoid takes the place of C. to: lanes to set.
static inline void patch_model_set(const patch_load *p, lane_mask to, const lanes *slip, ob_patch_model *o)
{
	lanes d[3] = { slip[0], slip[1], slip[2] }, q[6], c[6];
	patch_slip at;
	patch_slip_at(p, to, d, &at);
	const lanes from[2] = { -p->pressure[0], -p->pressure[1] };
	patch_move(from, at.bound);
	d[0] -= d[2] * p->pressure[1];
	d[1] += d[2] * p->pressure[0];
	for (int i = 0; i < 6; i++)
		q[i] = at.bound[i] * at.power;
	c[0] = q[3] * q[5] - q[4] * q[4], c[1] = q[2] * q[4] - q[1] * q[5], c[2] = q[1] * q[4] - q[2] * q[3];
	c[3] = q[0] * q[5] - q[2] * q[2], c[4] = q[1] * q[2] - q[0] * q[4], c[5] = q[0] * q[3] - q[1] * q[1];
	lanes inverse = 1 / (q[0] * c[0] + q[1] * c[1] + q[2] * c[2]), power = 1 / at.power;
	for (int i = 0; i < 6; i++) {
		o->surface[i] = lanes_select(to, q[i], o->surface[i]);
		o->inverse[i] = lanes_select(to, c[i] * inverse, o->inverse[i]);
	}
	for (int i = 0; i < 3; i++)
		o->slip[i] = lanes_select(to, d[i] * power, o->slip[i]);
	for (int i = 0; i < 2; i++)
		o->pressure[i] = lanes_select(to, p->edges[i], o->pressure[i]);
	o->known |= lanes_bits(to);
}

// Input of friction beyond the block, and state of the search from one sweep to the next.
typedef struct patch_search {
	lanes start[3]; // impulses that would undo the slip at the substep's start
	lanes slip[3]; // slip at the substep's start: m/s, rad/s
	unsigned begun, slides; // lanes with a known start; lanes with friction at its limit
} patch_search;

// Finds the impulse within the limit surface that leaves the least slip: the projection of "hold", which leaves none,
// in the metric of the masses. mass: inverse of A for these rows. Lanes that are not in "outside" keep theirs.
//
// A lane that slides has lambda = -grad D(w), with w the mean of its slip before and after. So friction takes as much
// energy as its work says, and the error is of second order. With D = sqrt(u Q u): (t A^-1 + Q) z = load, lambda = -Q
// z. Newton's method in 1/|lambda| finds t; this function is a straight line if A^-1 and Q are in proportion.
// Returns the lanes whose slip has left the direction in which the ellipsoid touches.
static inline lane_mask patch_project(ob_patch_model *m, const lanes *pressure, lanes bound, const lanes *mass,
				      lane_mask outside, patch_search *search, lanes *hold)
{
	enum { MOST = 8 };
	// cos^2 of some .02 rad; relative to the bound, before the last step
	const double turned = 1 - 4e-4, close = 1e-9;
	lanes stay[3], load[3], y[3], against = lanes_of(0), b2 = bound * bound,
				      ib = 1 / lanes_max(bound, lanes_of(1e-300));
	for (int c = 0; c < 3; c++) {
		stay[c] = -hold[c];
		against += stay[c] * search->slip[c];
	}
	// Moves the ellipsoid with the centre of pressure.
	const lanes here[3] = { stay[0], stay[1], stay[2] - pressure[0] * stay[1] + pressure[1] * stay[0] };
	patch_mul(m->inverse, here, y);
	lanes size2 = patch_dot(here, y), along = patch_dot(m->slip, here), surface[6];
	lane_mask slides = outside & (size2 > b2), goes_on = against > 0;
	lane_mask away = outside & ~slides & (along * along < turned * size2);
	search->slides |= lanes_bits(slides);
	if (!lanes_bits(slides))
		return away;
	lanes z[3], qz[3] = { b2, b2, b2 }, mz[3], change[3], t = m->stretch, n2 = b2, n = bound;
	lane_mask goes = slides;
	memcpy(surface, m->surface, sizeof surface);
	patch_move(pressure, surface);
	for (int c = 0; c < 3; c++)
		load[c] = stay[c] + lanes_where(goes_on, search->start[c]);
	for (int k = 0; k < MOST && lanes_bits(goes); k++) {
		patch_solve(t, mass, surface, load, z);
		patch_mul(mass, z, mz);
		patch_solve(t, mass, surface, mz, change);
		lanes next[3];
		patch_mul(surface, z, next);
		lanes now2 = patch_dot(z, next), now = lanes_sqrt(now2), off = now * ib - 1;
		t = lanes_where(goes, lanes_max(t + off * now2 / patch_dot(next, change), lanes_of(0))) +
		    lanes_where(~goes, t);
		n2 = lanes_select(goes, now2, n2);
		n = lanes_select(goes, now, n);
		for (int c = 0; c < 3; c++)
			qz[c] = lanes_select(goes, next[c], qz[c]);
		goes &= lanes_abs(off) > close;
	}
	m->stretch = lanes_select(slides, t, m->stretch);
	along = patch_dot(m->slip, qz) + m->slip[2] * (pressure[1] * qz[0] - pressure[0] * qz[1]);
	lanes scale = bound / n, force = lanes_sqrt(qz[0] * qz[0] + qz[1] * qz[1]) * scale;
	lanes within = scale * bound / lanes_max(force, bound);
	for (int c = 0; c < 3; c++)
		hold[c] = lanes_select(slides, -qz[c] * (c < 2 ? within : scale), hold[c]);
	return away | (slides & (along * along < turned * n2));
}

// Returns lanes whose friction is certainly within the limit surface. Takes the same weight for all elements of the
// patch: |force| + |twist about the centre of pressure| reach / spread <= bound. A bound on this, exact where it
// matters, saves a root.
static inline lane_mask patch_holds(const ob_batch *b, const lanes *x, lanes sum, lanes bound, const lanes *hold)
{
	const double kern = .28;
	lanes inverse = 1 / lanes_max(sum, lanes_of(1e-300));
	lanes s = (x[0] * b->patch_s[0] + x[1] * b->patch_s[1] + x[2] * b->patch_s[2] + x[3] * b->patch_s[3]) * inverse;
	lanes t = (x[0] * b->patch_t[0] + x[1] * b->patch_t[1] + x[2] * b->patch_t[2] + x[3] * b->patch_t[3]) * inverse;
	const lanes *e1 = b->patch_e1, *e2 = b->patch_e2;
	lanes l1 = e1[0] * e1[0] + e1[1] * e1[1], l2 = e2[0] * e2[0] + e2[1] * e2[1];
	lanes skew = e1[0] * e2[0] + e1[1] * e2[1], as = lanes_abs(s), at = lanes_abs(t), fs = 1 + as, ft = 1 + at;
	lanes spread = l1 * (1. / 3 - s * s) + l2 * (1. / 3 - t * t) - 2 * s * t * skew;
	lanes reach2 = fs * fs * l1 + ft * ft * l2 + 2 * fs * ft * lanes_abs(skew);
	lanes twist = hold[2] - (s * e1[0] + t * e2[0]) * hold[1] + (s * e1[1] + t * e2[1]) * hold[0];
	lanes f2 = hold[0] * hold[0] + hold[1] * hold[1], b2 = bound * bound, room = (b2 - f2) * spread;
	return (f2 <= b2) & (4 * b2 * twist * twist * reach2 <= room * room) & ((as + at <= kern) | (l1 == 0));
}

#endif

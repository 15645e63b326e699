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
// Text compiled for one number (contact/lone.c) and for four in lanes (contact/patch_lanes.h). The including file first
// includes elementary/real.h or elementary/real_lanes.h and names two types:
//
//      friction_pair   a contact: mu, radius (m), patch_e1 and patch_e2 (m, half edges of the patch from its centroid along
//                      the tangents), friction_mass (inverse of A's block of friction and twist: 44 45 46 55 56 66)
//      patch_model     as ob_patch_model (contact/batch.h)
//
// It defines the functions declared first, and patch_ends. Unit load: the limit surface here is that of mu * (sum of
// normal impulses) = 1. Symmetric matrices: 11 12 13 22 23 33.
#ifndef OB_CONTACT_PATCH_H
#define OB_CONTACT_PATCH_H

#include <stdbool.h>
#include <string.h>

#include "contact/area.h"
#include "contact/batch.h"
#include "contact/border.h"
#include "contact/friction.h"

// Rule by which a search for sliding friction ends. Lanes and single numbers differ on purpose: a lane's ellipsoid serves
// a whole substep of a dense heap, a lone contact is iterated to the end.
typedef struct patch_rule {
	double turned; // cos^2 of the angle by which the slip may turn before its ellipsoid is renewed
	double close; // relative to the bound, before the last step
	bool follows; // keeps what a Newton step needs in which friction follows the load: spin and capped
} patch_rule;

static const patch_rule patch_ends;

// Pressure and the loaded part of a patch. The caller sets "edges".
typedef struct patch_load {
	real edges[2], pressure[2]; // centre of pressure: in half edges; in m from the centroid
	real centre[2], e1[2], e2[2]; // m: centre of the loaded part, from the centroid; its half edges
	real slope[2]; // 1/m: gradient of the relative pressure, which is 1 + slope x, with x from the centre
	real radius; // m: radius of a loaded disc; 0: a parallelogram
	real spread; // m^2: mean square distance from the centre of pressure
	unsigned areas; // lanes with a polygon in place of the parallelogram
	ob_area_load area[OB_LANES]; // of these lanes
} patch_load;

// Search for friction that slides, and its state from one sweep to the next.
typedef struct patch_search {
	const ob_body_row *v; // velocities when the substep began, for patch_begin_slip
	patch_model *model;
	real start[3]; // impulses that would undo the slip at the substep's start
	real slip[3]; // slip at the substep's start: m/s, rad/s
	unsigned begun, slides; // lanes with a known start; lanes with friction at its limit
	real spin; // rad/s: spin of the mean slip
	mask capped; // friction is at the bound of its force; the ellipsoid permitted more
} patch_search;

// Power D and its gradient at a slip u. bound: matrix with grad D(u) = bound u, the sum of all elements with their weights
// at u. D^2 is nowhere more than D(u) times this quadratic form.
typedef struct patch_slip {
	real power, grad[3], bound[6];
} patch_slip;

typedef struct patch_sums {
	real force[2], power, weight; // integrals of p u/|u|, p |u|, p/|u|, each twice along the border
} patch_sums;

// ---- defined by the including file

// Radius of a disc's patch (m); 0: a parallelogram.
static inline real patch_disc(const friction_pair *b);
// A's diagonal for the first tangent
static inline real patch_response(const friction_pair *b);
// Lanes whose patch is a polygon (contact/area.h), a bit for each; the polygon of one of them.
static inline unsigned patch_areas(const friction_pair *b);
static inline const ob_contact_area *patch_area(const friction_pair *b, int l);
// Reads and writes the number of a lane.
static inline double patch_get(const real *x, int l);
static inline void patch_put(real *x, int l, double y);
// Sets the slip at the substep's start.
static void patch_begin_slip(const friction_pair *b, patch_search *f);
// Adds the integrals along the border of the loaded part, about the centre of rotation. v, w: slip of the part's centre.
// at, slope: relative pressure at the centre of rotation, and its gradient in u. Returns twice the area.
static inline real patch_border(const patch_load *p, mask asked, const real *v, real w, real at, const real *slope,
				patch_sums *o);
// Nodes of an integral side by side: takes PATCH_NODES of them, and sums over these.
static inline lanes patch_nodes(const double *from);
static inline real patch_sum_nodes(lanes x);

// ---- arithmetic

static inline real dot3(const real *a, const real *b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void sym_mul(const real *s, const real *x, real *o)
{
	o[0] = s[0] * x[0] + s[1] * x[1] + s[2] * x[2];
	o[1] = s[1] * x[0] + s[3] * x[1] + s[4] * x[2];
	o[2] = s[2] * x[0] + s[4] * x[1] + s[5] * x[2];
}

// Factors L D L^T of t a + s
typedef struct patch_factors {
	real l1, l2, l3, i0, i1, i2;
} patch_factors;

static inline patch_factors patch_factor(real t, const real *a, const real *s)
{
	patch_factors f;
	real m[6];
	for (int i = 0; i < 6; i++)
		m[i] = t * a[i] + s[i];
	f.i0 = 1 / m[0], f.l1 = m[1] * f.i0, f.l2 = m[2] * f.i0;
	f.i1 = 1 / (m[3] - f.l1 * m[1]);
	const real b = m[4] - f.l1 * m[2];
	f.l3 = b * f.i1;
	f.i2 = 1 / (m[5] - f.l2 * m[2] - f.l3 * b);
	return f;
}

static inline void patch_back(const patch_factors *f, const real *y, real *x)
{
	const real y1 = y[1] - f->l1 * y[0], y2 = y[2] - f->l2 * y[0] - f->l3 * y1;
	x[2] = y2 * f->i2;
	x[1] = y1 * f->i1 - f->l3 * x[2];
	x[0] = y[0] * f->i0 - f->l1 * x[1] - f->l2 * x[2];
}

// Moves a matrix from one point to another: "centre" is the old one, seen from the new one.
static inline void patch_move(const real *centre, real *m)
{
	const real x = -centre[1], y = centre[0];
	m[5] += 2 * (x * m[2] + y * m[4]) + x * x * m[0] + 2 * x * y * m[1] + y * y * m[3];
	m[2] += x * m[0] + y * m[1];
	m[4] += x * m[1] + y * m[3];
}

// Inverts A's block of friction and twist, a, where this is a patch: else m has friction's alone. If neither body can be
// turned about the normal, the twist's row has no effect, and counts as very heavy.
static inline void patch_invert(real radius, const real *a, real *m)
{
	const double heavy = 1e-6;
	const real least = heavy * (a[0] + a[3]) / larger_of(radius * radius, real_of(1e-300));
	const real twist = chosen(a[5] > 0, a[5], least);
	const real c[6] = { a[3] * twist - a[4] * a[4], a[2] * a[4] - a[1] * twist, a[1] * a[4] - a[3] * a[2],
			    a[0] * twist - a[2] * a[2], a[1] * a[2] - a[0] * a[4],  a[0] * a[3] - a[1] * a[1] };
	const real det = a[0] * c[0] + a[1] * c[1] + a[2] * c[2], inverse = 1 / det;
	const mask patch = both_of(radius > 0, det > 0);
	for (int i = 0; i < 6; i++)
		m[i] = chosen(patch, c[i] * inverse, m[i]);
}

// ---- the load

static inline real patch_sign(real x)
{
	return chosen(x < 0, real_of(-1), real_of(1));
}

static inline void patch_set_pressure(const friction_pair *b, patch_load *o)
{
	for (int c = 0; c < 2; c++)
		o->pressure[c] = o->edges[0] * b->patch_e1[c] + o->edges[1] * b->patch_e2[c];
}

// Puts a loaded disc in place of the parallelogram.
static inline void patch_load_disc(const friction_pair *b, real smallest, real *ks, real *kt, patch_load *o)
{
	const double disc_kern = .244; // just below 1/4, for the polygon's corners
	const real radius = patch_disc(b);
	const mask disc = radius > 0;
	if (!is_any(disc))
		return;
	real r = larger_of(radius, real_of(1e-300)), ir = 1 / r;
	real off = root_of(o->pressure[0] * o->pressure[0] + o->pressure[1] * o->pressure[1]);
	real k = smaller_of(off * ir, real_of(1)), kd = smaller_of(k, real_of(disc_kern));
	real small = r * larger_of((1 - k) / (1 - kd), smallest), shrink = small * ir;
	real along = 1 / larger_of(off, 1e-9 * r);
	for (int c = 0; c < 2; c++) {
		const real direction = o->pressure[c] * along;
		o->slope[c] = chosen(disc, 4 * kd / small * direction, o->slope[c]);
		o->e1[c] = chosen(disc, shrink * b->patch_e1[c], o->e1[c]);
		o->e2[c] = chosen(disc, shrink * b->patch_e2[c], o->e2[c]);
		o->centre[c] = chosen(disc, o->pressure[c] - kd * small * direction, o->centre[c]);
	}
	*ks = chosen(disc, real_of(disc_kern), *ks), *kt = chosen(disc, real_of(disc_kern), *kt);
	o->radius = chosen(disc, small, real_of(0));
}

// Finds the loaded part under the pressure.
static inline void patch_load_set(const friction_pair *b, patch_load *o)
{
	const double thinnest = .01, thin = .05; // width of a loaded part, relative to its length
	const double kern = 1. / 3;
	const real one = real_of(1), none = real_of(0), smallest = real_of(.01), s = o->edges[0], t = o->edges[1];
	const real *e1 = b->patch_e1, *e2 = b->patch_e2;
	real as = smaller_of(size_of(s), one), at = smaller_of(size_of(t), one);
	real ks = smaller_of(as, real_of(kern)), kt = smaller_of(at, real_of(kern));
	real within = smaller_of(one, kern / larger_of(ks + kt, real_of(1e-300)));
	ks *= within, kt *= within;
	real ls = larger_of((1 - as) / (1 - ks), smallest), lt = larger_of((1 - at) / (1 - kt), smallest);
	real ratio = root_of((e2[0] * e2[0] + e2[1] * e2[1]) / (e1[0] * e1[0] + e1[1] * e1[1]));
	ls = larger_of(ls, thinnest * ratio * lt), lt = larger_of(lt, thinnest / ratio * ls);
	// Load is even across a thin part: the pressure is so steep there that rounding would show.
	ks = chosen(ls >= thin * ratio * lt, ks * patch_sign(s), none);
	kt = chosen(ratio * lt >= thin * ls, kt * patch_sign(t), none);
	real det = e1[0] * e2[1] - e1[1] * e2[0], slope_s = 3 * ks / (ls * det), slope_t = 3 * kt / (lt * det);
	o->slope[0] = slope_s * e2[1] - slope_t * e1[1];
	o->slope[1] = slope_t * e1[0] - slope_s * e2[0];
	for (int c = 0; c < 2; c++) {
		o->e1[c] = ls * e1[c];
		o->e2[c] = lt * e2[c];
		o->centre[c] = o->pressure[c] - ks * o->e1[c] - kt * o->e2[c];
	}
	o->radius = none;
	patch_load_disc(b, smallest, &ks, &kt, o);
	real l1 = o->e1[0] * o->e1[0] + o->e1[1] * o->e1[1], l2 = o->e2[0] * o->e2[0] + o->e2[1] * o->e2[1];
	real skew = o->e1[0] * o->e2[0] + o->e1[1] * o->e2[1];
	o->spread = l1 * (kern - ks * ks) + l2 * (kern - kt * kt) - 2 * ks * kt * skew;
}

// Finds the loaded part of polygons, in the lanes "due".
static inline void patch_load_areas(const friction_pair *b, unsigned due, patch_load *o)
{
	o->areas = patch_areas(b) & due;
	for (unsigned left = o->areas; left; left &= left - 1) {
		const int l = __builtin_ctz(left);
		const double centre[2] = { patch_get(&o->pressure[0], l), patch_get(&o->pressure[1], l) };
		ob_area_load_set(patch_area(b, l), centre, &o->area[l]);
		patch_put(&o->spread, l, o->area[l].spread);
	}
}

// Takes the power and its bound, about the centre of pressure, from the polygons.
static inline void patch_slip_areas(const patch_load *p, const real *d, patch_slip *o)
{
	for (unsigned left = p->areas; left; left &= left - 1) {
		const int l = __builtin_ctz(left);
		const double about[2] = { patch_get(&p->pressure[0], l), patch_get(&p->pressure[1], l) },
			     slip[3] = { patch_get(&d[0], l), patch_get(&d[1], l), patch_get(&d[2], l) };
		double power, bound[6];
		ob_area_slip(&p->area[l], slip, about, &power, bound);
		patch_put(&o->power, l, power);
		for (int i = 0; i < 6; i++)
			patch_put(&o->bound[i], l, bound[i]);
	}
}

// Finds the slip that the wrench x would resist if all elements of the patch had the same weight.
static inline void patch_first_slip(const patch_load *p, const real *x, real *d)
{
	d[2] = (x[2] - p->pressure[0] * x[1] + p->pressure[1] * x[0]) / p->spread;
	d[0] = x[0] + d[2] * p->pressure[1];
	d[1] = x[1] - d[2] * p->pressure[0];
}

// ---- the limit surface, about the centre of the loaded part

// Computes D and its derivatives for a centre of rotation nearby: w is not near 0. asked: lanes to compute.
static inline void patch_slip_near(const patch_load *p, mask asked, const real *v, real w, patch_slip *o)
{
	const real iw = 1 / w, slope[2] = { -p->slope[1] * iw, p->slope[0] * iw };
	const real at = 1 - slope[0] * v[0] - slope[1] * v[1];
	patch_sums sum = { 0 };
	const real area = patch_border(p, asked, v, w, at, slope, &sum), scale = 2 * iw * iw / area;
	for (int c = 0; c < 2; c++)
		o->grad[c] = scale * sum.force[c];
	o->power = scale * sum.power;
	o->grad[2] = (o->power - o->grad[0] * v[0] - o->grad[1] * v[1]) * iw;
	const real weight = scale * sum.weight, kx = (o->grad[0] - weight * v[0]) * iw,
		   ky = (o->grad[1] - weight * v[1]) * iw;
	const real bound[6] = { weight, real_of(0), kx, weight, ky, (o->grad[2] - kx * v[0] - ky * v[1]) * iw };
	memcpy(o->bound, bound, sizeof bound);
}

// Computes them for a distant centre of rotation, by four nodes: exact for a cubic.
static inline void patch_slip_far(const patch_load *p, const real *v, real w, patch_slip *o)
{
	static const double at = 0.57735026918962576, along[2][4] = { { -at, at, -at, at }, { -at, -at, at, at } };
	*o = (patch_slip){ 0 };
	for (int i = 0; i < 4; i += PATCH_NODES) {
		const lanes s = patch_nodes(along[0] + i), t = patch_nodes(along[1] + i);
		const lanes x = s * p->e1[0] + t * p->e2[0], y = s * p->e1[1] + t * p->e2[1];
		const lanes weight = .25 * (1 + p->slope[0] * x + p->slope[1] * y);
		const lanes a = v[0] - w * y, b = v[1] + w * x, inverse = 1 / (lanes_sqrt(a * a + b * b) + 1e-300);
		const lanes c = weight * inverse, fa = a * inverse, fb = b * inverse, ft = x * fb - y * fa;
		o->grad[0] += patch_sum_nodes(weight * fa);
		o->grad[1] += patch_sum_nodes(weight * fb);
		o->grad[2] += patch_sum_nodes(weight * ft);
		o->bound[0] += patch_sum_nodes(c);
		o->bound[2] -= patch_sum_nodes(c * y);
		o->bound[4] += patch_sum_nodes(c * x);
		o->bound[5] += patch_sum_nodes(c * (x * x + y * y));
	}
	o->bound[3] = o->bound[0];
	o->power = o->grad[0] * v[0] + o->grad[1] * v[1] + o->grad[2] * w;
}

// Computes D and its derivatives at the slip d in the lanes "asked". Scales d to the order of 1 (D is homogeneous).
static inline void patch_slip_at(const patch_load *p, mask asked, real *d, patch_slip *o)
{
	const double far_share = .02; // share of rotation in the slip
	real size = size_of(p->e1[0]) + size_of(p->e1[1]) + size_of(p->e2[0]) + size_of(p->e2[1]);
	real v[2] = { d[0] - d[2] * p->centre[1], d[1] + d[2] * p->centre[0] };
	real moves = size_of(v[0]) + size_of(v[1]), turns = size_of(d[2]) * size, scale = 1 / (moves + turns + 1e-300);
	for (int c = 0; c < 3; c++)
		d[c] *= scale;
	v[0] *= scale, v[1] *= scale;
	const mask far = turns < far_share * moves, near = both_of(asked, not_of(far)), distant = both_of(asked, far);
	if (is_any(near))
		patch_slip_near(p, near, v, chosen(far, 1 / size, d[2]), o);
	else
		*o = (patch_slip){ 0 };
	if (!is_any(distant))
		return;
	patch_slip at_far;
	patch_slip_far(p, v, d[2], &at_far);
	o->power = chosen(far, at_far.power, o->power);
	for (int i = 0; i < 6; i++)
		o->bound[i] = chosen(far, at_far.bound[i], o->bound[i]);
}

// ---- friction

// Finds the power and its bound about the centre of pressure, in the lanes "to". Moves the slip there, too.
static inline void patch_slip_about_pressure(const patch_load *p, mask to, real *slip, patch_slip *at)
{
	patch_slip_at(p, to, slip, at);
	patch_move((real[2]){ p->centre[0] - p->pressure[0], p->centre[1] - p->pressure[1] }, at->bound);
	if (p->areas)
		patch_slip_areas(p, slip, at);
	slip[0] -= slip[2] * p->pressure[1];
	slip[1] += slip[2] * p->pressure[0];
}

// Makes the ellipsoid about the centre of pressure that touches C at the wrench of "slip", with the same normal. It is
// as near to C as a quadratic form comes there (D(u)^2 <= u Q u, equal along the slip). A dense heap can afford the
// integrals once in a substep; in all its sweeps and iterations the ellipsoid takes the place of C. to: lanes to set.
static inline void patch_model_set(const patch_load *p, mask to, const real *slip, patch_model *o)
{
	real d[3] = { slip[0], slip[1], slip[2] }, q[6], c[6];
	patch_slip at;
	patch_slip_about_pressure(p, to, d, &at);
	for (int i = 0; i < 6; i++)
		q[i] = at.bound[i] * at.power;
	c[0] = q[3] * q[5] - q[4] * q[4], c[1] = q[2] * q[4] - q[1] * q[5], c[2] = q[1] * q[4] - q[2] * q[3];
	c[3] = q[0] * q[5] - q[2] * q[2], c[4] = q[1] * q[2] - q[0] * q[4], c[5] = q[0] * q[3] - q[1] * q[1];
	const real inverse = 1 / (q[0] * c[0] + q[1] * c[1] + q[2] * c[2]), power = 1 / at.power;
	for (int i = 0; i < 6; i++) {
		o->surface[i] = chosen(to, q[i], o->surface[i]);
		o->inverse[i] = chosen(to, c[i] * inverse, o->inverse[i]);
	}
	for (int i = 0; i < 3; i++)
		o->slip[i] = chosen(to, d[i] * power, o->slip[i]);
	for (int i = 0; i < 2; i++)
		o->pressure[i] = chosen(to, p->edges[i], o->pressure[i]);
	o->known |= bits_of(to);
}

// Renews the ellipsoid of the lanes "due", for the direction of the substep's mean slip. If this is too small to tell,
// it is the direction that the impulses "hold" resist.
static inline void patch_renew(const friction_pair *b, patch_load *load, real bound, mask due, const real *slip,
			       const patch_search *f, const real *hold, patch_model *m)
{
	const double telling = 1e-4; // relative to the change that friction can make in the substep
	const real stay[3] = { -hold[0], -hold[1], -hold[2] };
	real mean[3], resisted[3];
	patch_load_set(b, load);
	patch_load_areas(b, bits_of(due), load);
	for (int c = 0; c < 3; c++)
		mean[c] = slip[c] + f->slip[c];
	const real speed = size_of(mean[0]) + size_of(mean[1]) + b->radius * size_of(mean[2]);
	const mask tells = both_of(speed > telling * bound * patch_response(b), dot3(mean, stay) > 0);
	patch_first_slip(load, stay, resisted);
	for (int c = 0; c < 3; c++)
		mean[c] = chosen(tells, mean[c], resisted[c]);
	patch_model_set(load, due, mean, m);
}

// Finds t, Q z and |lambda| of patch_project in the lanes "slides", where load and surface are set.
static inline void patch_stretch(const friction_pair *b, const real *surface, const real *load, real bound, mask slides,
				 patch_model *m, patch_search *search, real *qz, real *length2, real *length)
{
	enum { MOST = 8 };
	const real ib = 1 / larger_of(bound, real_of(1e-300));
	real t = m->stretch;
	mask goes = slides;
	*length2 = bound * bound, *length = bound;
	for (int c = 0; c < 3; c++)
		qz[c] = *length2;
	for (int k = 0; k < MOST && is_any(goes); k++) {
		const patch_factors f = patch_factor(t, b->friction_mass, surface);
		real z[3], mz[3], change[3], next[3];
		patch_back(&f, load, z);
		sym_mul(b->friction_mass, z, mz);
		patch_back(&f, mz, change);
		sym_mul(surface, z, next);
		const real now2 = dot3(z, next), now = root_of(now2), off = now * ib - 1;
		if (patch_ends.follows)
			search->spin = chosen(goes, t * z[2], search->spin);
		t = chosen(goes, larger_of(t + off * now2 / dot3(next, change), real_of(0)), t);
		*length2 = chosen(goes, now2, *length2);
		*length = chosen(goes, now, *length);
		for (int c = 0; c < 3; c++)
			qz[c] = chosen(goes, next[c], qz[c]);
		goes = both_of(goes, size_of(off) > patch_ends.close);
	}
	m->stretch = chosen(slides, t, m->stretch);
}

// Finds the impulse within the limit surface that leaves the least slip: the projection of "hold", which leaves none,
// in the metric of the masses. Lanes that are not in "outside" keep theirs.
//
// A lane that slides has lambda = -grad D(w), with w the mean of its slip before and after. So friction takes as much
// energy as its work says, and the error is of second order. With D = sqrt(u Q u): (t A^-1 + Q) z = load, lambda = -Q
// z. Newton's method in 1/|lambda| finds t; this function is a straight line if A^-1 and Q are in proportion.
// Returns the lanes whose slip has left the direction in which the ellipsoid touches.
static inline mask patch_project(const friction_pair *b, patch_model *m, const real *pressure, real bound, mask outside,
				 patch_search *search, real *hold)
{
	const real stay[3] = { -hold[0], -hold[1], -hold[2] };
	// Moves the ellipsoid with the centre of pressure.
	const real here[3] = { stay[0], stay[1], stay[2] - pressure[0] * stay[1] + pressure[1] * stay[0] };
	real y[3], load[3], surface[6], qz[3], n2, n;
	sym_mul(m->inverse, here, y);
	const real size2 = dot3(here, y);
	real along = dot3(m->slip, here);
	const mask slides = both_of(outside, size2 > bound * bound), goes_on = dot3(stay, search->slip) > 0;
	const mask away = both_of(both_of(outside, not_of(slides)), along * along < patch_ends.turned * size2);
	search->slides |= bits_of(slides);
	if (!is_any(slides))
		return away;
	memcpy(surface, m->surface, sizeof surface);
	patch_move(pressure, surface);
	for (int c = 0; c < 3; c++)
		load[c] = stay[c] + chosen(goes_on, search->start[c], real_of(0));
	patch_stretch(b, surface, load, bound, slides, m, search, qz, &n2, &n);
	along = dot3(m->slip, qz) + m->slip[2] * (pressure[1] * qz[0] - pressure[0] * qz[1]);
	const real scale = bound / n, force = root_of(qz[0] * qz[0] + qz[1] * qz[1]) * scale;
	const real within = scale * bound / larger_of(force, bound);
	if (patch_ends.follows)
		search->capped = force > bound;
	for (int c = 0; c < 3; c++)
		hold[c] = chosen(slides, -qz[c] * (c < 2 ? within : scale), hold[c]);
	return away | both_of(slides, along * along < patch_ends.turned * n2);
}

// Returns lanes whose friction is certainly within the limit surface. Takes the same weight for all elements of the
// patch: |force| + |twist about the centre of pressure| reach / spread <= bound. A bound on this, exact where it
// matters, saves a root.
static inline mask patch_holds(const friction_pair *b, const patch_load *load, real bound, const real *hold)
{
	const double kern = .28;
	const real *e1 = b->patch_e1, *e2 = b->patch_e2, s = load->edges[0], t = load->edges[1];
	const real l1 = e1[0] * e1[0] + e1[1] * e1[1], l2 = e2[0] * e2[0] + e2[1] * e2[1];
	const real skew = e1[0] * e2[0] + e1[1] * e2[1], as = size_of(s), at = size_of(t), fs = 1 + as, ft = 1 + at;
	const real spread = l1 * (1. / 3 - s * s) + l2 * (1. / 3 - t * t) - 2 * s * t * skew;
	const real reach2 = fs * fs * l1 + ft * ft * l2 + 2 * fs * ft * size_of(skew);
	const real twist = hold[2] - load->pressure[0] * hold[1] + load->pressure[1] * hold[0];
	const real f2 = hold[0] * hold[0] + hold[1] * hold[1], b2 = bound * bound, room = (b2 - f2) * spread;
	const mask within = both_of(f2 <= b2, 4 * b2 * twist * twist * reach2 <= room * room);
	return both_of(both_of(within, (as + at <= kern) | (l1 == 0)), not_of(mask_of(patch_areas(b))));
}

// Limits "hold" in the lanes "outside", where it exceeds the limit surface: they slip. slip: the present one.
static __attribute__((noinline)) void patch_let_slip(const friction_pair *b, mask outside, patch_load *load, real sum,
						     const real *slip, patch_search *f, real *hold)
{
	const double same_pressure = 1e-9; // half edges: a smaller shift of the centre of pressure counts as none
	const real bound = b->mu * sum;
	patch_model *m = f->model;
	const mask none = both_of(outside, not_of(is_load(bound)));
	f->slides |= bits_of(none);
	for (int c = 0; c < 3; c++)
		hold[c] = chosen(none, real_of(0), hold[c]);
	outside = both_of(outside, not_of(none));
	if (!is_any(outside))
		return;
	if (!f->begun) {
		patch_begin_slip(b, f);
		sym_mul(b->friction_mass, f->slip, f->start);
		f->begun = 1;
	}
	const real shift = size_of(load->edges[0] - m->pressure[0]) + size_of(load->edges[1] - m->pressure[1]);
	const mask due = both_of(outside, (shift > same_pressure) | not_of(mask_of(m->known)));
	if (is_any(due))
		patch_renew(b, load, bound, due, slip, f, hold, m);
	m->known &= ~bits_of(patch_project(b, m, load->pressure, bound, outside, f, hold));
}

// Finds friction and twist of patches together: impulses that hold, or those that the limit surface permits. missing:
// m/s, rad/s: change of the slip that would end it; x: present impulses; load: with the centre of pressure in half edges.
static inline void patch_friction(const friction_pair *b, mask patch, patch_load *load, real sum, const real *missing,
				  const real *x, patch_search *f, real *next)
{
	sym_mul(b->friction_mass, missing, next);
	for (int c = 0; c < 3; c++)
		next[c] += x[c];
	patch_set_pressure(b, load);
	const mask outside = both_of(patch, not_of(patch_holds(b, load, b->mu * sum, next)));
	f->slides &= ~bits_of(patch);
	if (is_any(outside)) {
		const real slip[3] = { -missing[0], -missing[1], -missing[2] };
		patch_let_slip(b, outside, load, sum, slip, f, next);
	}
}

#endif

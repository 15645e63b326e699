// Solver for a contact of a body that touches nothing else, with a static or kinematic one: solves it to the end at
// once. The law is that of an isolated lane of a batch (contact/batch.h), with the same limit surface
// (contact/patch.h). Here the four points lie side by side in place of four pairs. So a sweep over the rows, a step of
// Newton's method and the four edges of a patch are a few vector operations each.
//
// A sweep finds the points under load, and whether friction holds. Then a step of Newton's method makes all their rows
// obey the law. Sliding friction follows the load: it grows with the sum, turns with the slip, and moves with the
// centre of pressure. The step does not include the change of the loaded part's shape; an extrapolation from two rounds
// does (Anderson 1965, of depth one).
//
// Part of kernel.c: compiled once for each instruction set, with no operations contracted.
#ifndef OB_CONTACT_LONE_H
#define OB_CONTACT_LONE_H

#include <math.h>
#include <string.h>

#include "contact/batch.h"
#include "contact/patch.h"

enum {
	LONE_FRICTION = 3, // rows: two tangents and the twist
	LONE_ROUNDS = 64, // maximum; beyond it, iterations go on
};

// Centre of pressure, and the loaded part of the patch (contact/patch.h).
typedef struct lone_load {
	double edges[2], pressure[2]; // centre of pressure: in half edges; m from the centroid
	double centre[2], e1[2], e2[2], slope[2], spread;
} lone_load;

// Ellipsoid in place of the limit surface (contact/batch.h).
typedef struct lone_model {
	double surface[6], inverse[6], slip[3], edges[2], stretch;
	bool known;
} lone_model;

typedef struct lone {
	lanes an[OB_ROWS], af[OB_ROWS]; // A: coupling of each row with the points; with the rows of friction
	lanes diag, inv_diag, near_s, near_t; // A's diagonal for the points, and its inverse; points in half edges
	lanes x, y; // impulses of the points; of friction
	lanes short_n, short_f; // m/s, rad/s: velocity that each row still lacks
	lanes start; // impulses that would undo the slip at the substep's start
	double slip[LONE_FRICTION]; // slip at the substep's start: m/s, rad/s
	double diag_f[LONE_FRICTION], mass[6]; // A's block of friction: diagonal, inverse
	double mu, radius, slide_rate2, e1[2], e2[2], ratio, det;
	double spin; // rad/s: spin of the mean slip while the contact slides
	bool slides, capped; // capped: friction is at its bound; the ellipsoid permitted more
	int points; // number of points: the first lanes
	lone_model model;
} lone;

// ---- arithmetic

static inline double lone_get(const lanes *x, int l)
{
	double y;
	memcpy(&y, (const char *)x + (unsigned)l * sizeof y, sizeof y);
	return y;
}

static inline lanes lone_four(const lanes *x, int l)
{
	return (lanes){ lone_get(&x[0], l), lone_get(&x[1], l), lone_get(&x[2], l), lone_get(&x[3], l) };
}

// Three components; lane 3 repeats the last, and is not read.
static inline lanes lone_vector(double x, double y, double z)
{
	return (lanes){ x, y, z, z };
}

static inline lanes lone_three(const lanes *x, int l)
{
	return lone_vector(lone_get(&x[0], l), lone_get(&x[1], l), lone_get(&x[2], l));
}

static inline double lone_sum(lanes x)
{
	return (x[0] + x[1]) + (x[2] + x[3]);
}

static inline double lone_max(double a, double b)
{
	return a > b ? a : b;
}

static inline double lone_min(double a, double b)
{
	return a < b ? a : b;
}

static inline double lone_abs(double a)
{
	return __builtin_fabs(a);
}

static inline double lone_dot(const double *a, const double *b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void lone_mul(const double *s, const double *x, double *o)
{
	o[0] = s[0] * x[0] + s[1] * x[1] + s[2] * x[2];
	o[1] = s[1] * x[0] + s[3] * x[1] + s[4] * x[2];
	o[2] = s[2] * x[0] + s[4] * x[1] + s[5] * x[2];
}

// Factors L D L^T of t a + s
typedef struct lone_factors {
	double l1, l2, l3, i0, i1, i2;
} lone_factors;

static inline lone_factors lone_factor(double t, const double *a, const double *s)
{
	lone_factors f;
	double m[6];
	for (int i = 0; i < 6; i++)
		m[i] = t * a[i] + s[i];
	f.i0 = 1 / m[0], f.l1 = m[1] * f.i0, f.l2 = m[2] * f.i0;
	f.i1 = 1 / (m[3] - f.l1 * m[1]);
	const double b = m[4] - f.l1 * m[2];
	f.l3 = b * f.i1;
	f.i2 = 1 / (m[5] - f.l2 * m[2] - f.l3 * b);
	return f;
}

static inline void lone_back(const lone_factors *f, const double *y, double *x)
{
	const double y1 = y[1] - f->l1 * y[0], y2 = y[2] - f->l2 * y[0] - f->l3 * y1;
	x[2] = y2 * f->i2;
	x[1] = y1 * f->i1 - f->l3 * x[2];
	x[0] = y[0] * f->i0 - f->l1 * x[1] - f->l2 * x[2];
}

// ---- the limit surface, as in contact/patch.h

static inline double lone_sign(double x)
{
	return x < 0 ? -1 : 1;
}

// Computes the centre of pressure: in half edges, and in m from the centroid.
static inline void lone_pressure(const lone *p, double sum, double *edges, double *at)
{
	const double inverse = 1 / lone_max(sum, 1e-300);
	edges[0] = lone_sum(p->x * p->near_s) * inverse;
	edges[1] = lone_sum(p->x * p->near_t) * inverse;
	at[0] = edges[0] * p->e1[0] + edges[1] * p->e2[0];
	at[1] = edges[0] * p->e1[1] + edges[1] * p->e2[1];
}

// Computes the loaded part, as patch_load_set. edges and pressure are set.
static inline void lone_load_set(const lone *p, lone_load *o)
{
	const double thinnest = .01, thin = .05, kern = 1. / 3, smallest = .01;
	const double s = o->edges[0], t = o->edges[1], as = lone_min(lone_abs(s), 1), at = lone_min(lone_abs(t), 1);
	double ks = lone_min(as, kern), kt = lone_min(at, kern);
	const double within = lone_min(1, kern / lone_max(ks + kt, 1e-300));
	ks *= within, kt *= within;
	double ls = lone_max((1 - as) / (1 - ks), smallest), lt = lone_max((1 - at) / (1 - kt), smallest);
	ls = lone_max(ls, thinnest * p->ratio * lt), lt = lone_max(lt, thinnest / p->ratio * ls);
	ks = ls >= thin * p->ratio * lt ? ks * lone_sign(s) : 0;
	kt = p->ratio * lt >= thin * ls ? kt * lone_sign(t) : 0;
	const double slope_s = 3 * ks / (ls * p->det), slope_t = 3 * kt / (lt * p->det);
	o->slope[0] = slope_s * p->e2[1] - slope_t * p->e1[1];
	o->slope[1] = slope_t * p->e1[0] - slope_s * p->e2[0];
	for (int c = 0; c < 2; c++) {
		o->e1[c] = ls * p->e1[c];
		o->e2[c] = lt * p->e2[c];
		o->centre[c] = o->pressure[c] - ks * o->e1[c] - kt * o->e2[c];
	}
	const double l1 = o->e1[0] * o->e1[0] + o->e1[1] * o->e1[1], l2 = o->e2[0] * o->e2[0] + o->e2[1] * o->e2[1];
	const double skew = o->e1[0] * o->e2[0] + o->e1[1] * o->e2[1];
	o->spread = l1 * (kern - ks * ks) + l2 * (kern - kt * kt) - 2 * ks * kt * skew;
}

// D, its gradient and its bound (patch_slip) at a slip (v, w) about the centre of the loaded part.
typedef struct lone_slip {
	double power, grad[3], bound[6];
} lone_slip;

// Computes it for a centre of rotation nearby: four edges at once.
static inline void lone_slip_near(const lone_load *p, const double *v, double w, lone_slip *o)
{
	const lanes side1 = { -1, 1, 1, -1 }, side2 = { -1, -1, 1, 1 };
	const lanes cx = side1 * p->e1[0] + side2 * p->e2[0], cy = side1 * p->e1[1] + side2 * p->e2[1];
	const double iw = 1 / w, area = 8 * (p->e1[0] * p->e2[1] - p->e1[1] * p->e2[0]), scale = 2 * iw * iw / area;
	const lanes slope[2] = { lanes_of(-p->slope[1] * iw), lanes_of(p->slope[0] * iw) };
	const lanes u[2] = { v[0] - w * cy, v[1] + w * cx }, r = lanes_sqrt(u[0] * u[0] + u[1] * u[1]);
	const lanes un[2] = { __builtin_shufflevector(u[0], u[0], 1, 2, 3, 0),
			      __builtin_shufflevector(u[1], u[1], 1, 2, 3, 0) },
		    rn = __builtin_shufflevector(r, r, 1, 2, 3, 0);
	patch_sums sums = { 0 };
	patch_add_edge(u, r, un, rn, 1 - slope[0] * v[0] - slope[1] * v[1], slope, &sums);
	o->grad[0] = scale * lone_sum(sums.force[0]);
	o->grad[1] = scale * lone_sum(sums.force[1]);
	o->power = scale * lone_sum(sums.power);
	o->grad[2] = (o->power - o->grad[0] * v[0] - o->grad[1] * v[1]) * iw;
	const double weight = scale * lone_sum(sums.weight), kx = (o->grad[0] - weight * v[0]) * iw,
		     ky = (o->grad[1] - weight * v[1]) * iw;
	o->bound[0] = o->bound[3] = weight;
	o->bound[1] = 0;
	o->bound[2] = kx, o->bound[4] = ky;
	o->bound[5] = (o->grad[2] - kx * v[0] - ky * v[1]) * iw;
}

// Computes it for a distant centre of rotation, by four nodes.
static inline void lone_slip_far(const lone_load *p, const double *v, double w, lone_slip *o)
{
	const double at = 0.57735026918962576;
	const lanes s = { -at, at, -at, at }, t = { -at, -at, at, at };
	const lanes x = s * p->e1[0] + t * p->e2[0], y = s * p->e1[1] + t * p->e2[1];
	const lanes weight = .25 * (1 + p->slope[0] * x + p->slope[1] * y), a = v[0] - w * y, b = v[1] + w * x;
	const lanes inverse = 1 / (lanes_sqrt(a * a + b * b) + 1e-300), c = weight * inverse, fa = a * inverse,
		    fb = b * inverse;
	o->grad[0] = lone_sum(weight * fa);
	o->grad[1] = lone_sum(weight * fb);
	o->grad[2] = lone_sum(weight * (x * fb - y * fa));
	o->bound[0] = o->bound[3] = lone_sum(c);
	o->bound[1] = 0;
	o->bound[2] = -lone_sum(c * y), o->bound[4] = lone_sum(c * x);
	o->bound[5] = lone_sum(c * (x * x + y * y));
	o->power = o->grad[0] * v[0] + o->grad[1] * v[1] + o->grad[2] * w;
}

static inline void lone_move(double x, double y, double *m)
{
	m[5] += 2 * (x * m[4] - y * m[2]) + y * y * m[0] - 2 * x * y * m[1] + x * x * m[3];
	m[2] += x * m[1] - y * m[0];
	m[4] += x * m[3] - y * m[1];
}

// Makes the ellipsoid that touches the limit surface at a slip.
static __attribute__((noinline)) void lone_model_set(const lone_load *p, const double *slip, lone_model *o)
{
	const double far_share = .02; // share of rotation in the slip
	double d[3] = { slip[0], slip[1], slip[2] }, q[6], c[6];
	const double size = lone_abs(p->e1[0]) + lone_abs(p->e1[1]) + lone_abs(p->e2[0]) + lone_abs(p->e2[1]);
	double v[2] = { d[0] - d[2] * p->centre[1], d[1] + d[2] * p->centre[0] };
	const double moves = lone_abs(v[0]) + lone_abs(v[1]), turns = lone_abs(d[2]) * size,
		     scale = 1 / (moves + turns + 1e-300);
	for (int i = 0; i < 3; i++)
		d[i] *= scale;
	v[0] *= scale, v[1] *= scale;
	lone_slip at;
	if (turns < far_share * moves)
		lone_slip_far(p, v, d[2], &at);
	else
		lone_slip_near(p, v, d[2], &at);
	lone_move(p->centre[0] - p->pressure[0], p->centre[1] - p->pressure[1], at.bound);
	d[0] -= d[2] * p->pressure[1];
	d[1] += d[2] * p->pressure[0];
	for (int i = 0; i < 6; i++)
		q[i] = at.bound[i] * at.power;
	c[0] = q[3] * q[5] - q[4] * q[4], c[1] = q[2] * q[4] - q[1] * q[5], c[2] = q[1] * q[4] - q[2] * q[3];
	c[3] = q[0] * q[5] - q[2] * q[2], c[4] = q[1] * q[2] - q[0] * q[4], c[5] = q[0] * q[3] - q[1] * q[1];
	const double inverse = 1 / (q[0] * c[0] + q[1] * c[1] + q[2] * c[2]), power = 1 / at.power;
	for (int i = 0; i < 6; i++) {
		o->surface[i] = q[i];
		o->inverse[i] = c[i] * inverse;
	}
	for (int i = 0; i < 3; i++)
		o->slip[i] = d[i] * power;
	o->edges[0] = p->edges[0], o->edges[1] = p->edges[1];
	o->known = true;
}

// ---- friction

// True if the impulses "hold" are certainly within the limit surface, without evaluating it.
static inline bool lone_holds(const lone *p, const lone_load *at, double bound, const double *hold)
{
	const double kern = .28, *e1 = p->e1, *e2 = p->e2, s = at->edges[0], t = at->edges[1];
	const double l1 = e1[0] * e1[0] + e1[1] * e1[1], l2 = e2[0] * e2[0] + e2[1] * e2[1];
	const double skew = e1[0] * e2[0] + e1[1] * e2[1], as = lone_abs(s), bt = lone_abs(t), fs = 1 + as, ft = 1 + bt;
	const double spread = l1 * (1. / 3 - s * s) + l2 * (1. / 3 - t * t) - 2 * s * t * skew;
	const double reach2 = fs * fs * l1 + ft * ft * l2 + 2 * fs * ft * lone_abs(skew);
	const double twist = hold[2] - at->pressure[0] * hold[1] + at->pressure[1] * hold[0];
	const double f2 = hold[0] * hold[0] + hold[1] * hold[1], b2 = bound * bound, room = (b2 - f2) * spread;
	return f2 <= b2 && 4 * b2 * twist * twist * reach2 <= room * room && (as + bt <= kern || l1 == 0);
}

// As patch_project. Returns true if the slip has left the direction in which the ellipsoid touches.
static inline bool lone_project(lone *p, const double *pressure, double bound, double *hold)
{
	enum { MOST = 8 };
	// Iterates to the end: an early end would depend on rounding, and so on the axes of the scene.
	const double turned = 1 - 1e-9, close = 1e-12;
	lone_model *m = &p->model;
	const double stay[3] = { -hold[0], -hold[1], -hold[2] }, b2 = bound * bound, ib = 1 / lone_max(bound, 1e-300);
	const double here[3] = { stay[0], stay[1], stay[2] - pressure[0] * stay[1] + pressure[1] * stay[0] };
	double y[3], surface[6], load[3], z[3], qz[3], mz[3], change[3], t = m->stretch, n2, n;
	lone_mul(m->inverse, here, y);
	const double size2 = lone_dot(here, y);
	double along = lone_dot(m->slip, here);
	p->slides = size2 > b2;
	if (!p->slides)
		return along * along < turned * size2;
	const bool goes_on = lone_dot(stay, p->slip) > 0;
	memcpy(surface, m->surface, sizeof surface);
	lone_move(pressure[0], pressure[1], surface);
	for (int c = 0; c < 3; c++)
		load[c] = stay[c] + (goes_on ? p->start[c] : 0);
	for (int k = 0;; k++) {
		const lone_factors f = lone_factor(t, p->mass, surface);
		lone_back(&f, load, z);
		lone_mul(p->mass, z, mz);
		lone_back(&f, mz, change);
		lone_mul(surface, z, qz);
		n2 = lone_dot(z, qz), n = __builtin_sqrt(n2);
		const double off = n * ib - 1;
		p->spin = t * z[2];
		t = lone_max(t + off * n2 / lone_dot(qz, change), 0);
		if (lone_abs(off) <= close || k == MOST - 1)
			break;
	}
	m->stretch = t;
	along = lone_dot(m->slip, qz) + m->slip[2] * (pressure[1] * qz[0] - pressure[0] * qz[1]);
	const double scale = bound / n, force = __builtin_sqrt(qz[0] * qz[0] + qz[1] * qz[1]) * scale,
		     within = scale * bound / lone_max(force, bound);
	p->capped = force > bound;
	hold[0] = -qz[0] * within, hold[1] = -qz[1] * within, hold[2] = -qz[2] * scale;
	return along * along < turned * n2;
}

// Limits "hold", which exceeds the limit surface: the contact slips. slip: the present one.
static inline void lone_let_slip(lone *p, lone_load *load, double sum, const double *slip, double *hold)
{
	const double telling = 1e-4, same_pressure = 1e-9;
	const double bound = p->mu * sum;
	lone_model *m = &p->model;
	if (!(bound > 0)) {
		hold[0] = hold[1] = hold[2] = 0;
		p->slides = true;
		return;
	}
	if (!m->known ||
	    lone_abs(load->edges[0] - m->edges[0]) + lone_abs(load->edges[1] - m->edges[1]) > same_pressure) {
		const double stay[3] = { -hold[0], -hold[1], -hold[2] };
		double mean[3];
		lone_load_set(p, load);
		for (int c = 0; c < 3; c++)
			mean[c] = slip[c] + p->slip[c];
		const double speed = lone_abs(mean[0]) + lone_abs(mean[1]) + p->radius * lone_abs(mean[2]);
		if (!(speed > telling * bound * p->diag_f[0] && lone_dot(mean, stay) > 0)) {
			mean[2] = (stay[2] - load->pressure[0] * stay[1] + load->pressure[1] * stay[0]) / load->spread;
			mean[0] = stay[0] + mean[2] * load->pressure[1];
			mean[1] = stay[1] - mean[2] * load->pressure[0];
		}
		lone_model_set(load, mean, m);
	}
	m->known = !lone_project(p, load->pressure, bound, hold);
}

// Friction of a sliding point, as solve_point of kernel.c. Sets stretch.
static inline void lone_slide_point(lone *p, double bound, double *next)
{
	enum { MOST = 16 };
	const double close = 1e-13, a = p->diag_f[0], c = p->diag_f[1], m = p->af[4][1];
	const double load[2] = { a * p->y[0] + m * p->y[1] + p->short_f[0], m * p->y[0] + c * p->y[1] + p->short_f[1] };
	double t = 0;
	for (int k = 0; k < MOST; k++) {
		const double d = a + t, q = c + t, inverse = 1 / (d * q - m * m);
		const double y0 = (q * load[0] - m * load[1]) * inverse, y1 = (d * load[1] - m * load[0]) * inverse;
		const double n2 = y0 * y0 + y1 * y1, n = __builtin_sqrt(n2), off = n / bound - 1;
		const double falls = (q * y0 * y0 - 2 * m * y0 * y1 + d * y1 * y1) * inverse;
		next[0] = y0 * (bound / n), next[1] = y1 * (bound / n);
		t += off * n2 / falls;
		if (!(lone_abs(off) > close))
			break;
	}
	p->model.stretch = t;
}

// Computes impulses of friction that hold, or those that the limit permits.
static inline void lone_friction(lone *p, double sum, double *next)
{
	const double bound = p->mu * sum, missing[3] = { p->short_f[0], p->short_f[1], p->short_f[2] };
	lone_mul(p->mass, missing, next);
	for (int c = 0; c < LONE_FRICTION; c++)
		next[c] += p->y[c];
	if (p->radius > 0) {
		lone_load load;
		const double slip[3] = { -missing[0], -missing[1], -missing[2] };
		p->slides = false;
		lone_pressure(p, sum, load.edges, load.pressure);
		if (!lone_holds(p, &load, bound, next))
			lone_let_slip(p, &load, sum, slip, next);
		return;
	}
	next[2] = 0;
	p->slides = next[0] * next[0] + next[1] * next[1] > bound * bound;
	if (p->slides && bound > 0)
		lone_slide_point(p, bound, next);
	else if (p->slides)
		next[0] = next[1] = 0;
}

// ---- sweeps, and steps of Newton's method

static inline void lone_change_point(lone *p, int i, double d)
{
	p->short_n -= p->an[i] * d;
	p->short_f -= p->af[i] * d;
}

static inline void lone_change_points(lone *p, lanes d)
{
#pragma GCC unroll 4
	for (int i = 0; i < OB_POINTS; i++) {
		if (i == p->points)
			break;
		lone_change_point(p, i, d[i]);
	}
}

static inline void lone_change_friction(lone *p, lanes d)
{
	for (int c = 0; c < LONE_FRICTION; c++)
		lone_change_point(p, OB_POINTS + c, d[c]);
	p->y += d;
}

// Upper bound on the square of the change of slip by a change of friction
static inline double lone_slip_change(const lone *p, lanes d)
{
	const double spin = d[2] * p->diag_f[2] * p->radius;
	return lone_max((d[0] * d[0] + d[1] * d[1]) * p->slide_rate2, spin * spin);
}

// Sweeps once over the rows. Returns the square of the largest change of a velocity.
static inline double lone_sweep(lone *p)
{
	double largest = 0, sum = 0, next[LONE_FRICTION];
#pragma GCC unroll 4
	for (int i = 0; i < OB_POINTS; i++) {
		if (i == p->points)
			break;
		const double x = p->x[i], d = lone_max(-x, p->short_n[i] * p->inv_diag[i]);
		lone_change_point(p, i, d);
		p->x[i] = x + d;
		sum += x + d;
		largest = lone_max(largest, lone_abs(d) * p->diag[i]);
	}
	lone_friction(p, sum, next);
	const lanes d = lone_vector(next[0], next[1], next[2]) - p->y;
	lone_change_friction(p, d);
	return lone_max(largest * largest, lone_slip_change(p, d));
}

// Replaces r by m^-1 r, by elimination without pivots. Includes the rows of points under load ("push"). If friction
// holds, it includes the rows of friction, with the columns mf.
static inline __attribute__((always_inline)) void lone_eliminate(unsigned push, lanes *m, lanes *mf, double *r,
								 int rows)
{
#pragma GCC unroll 7
	for (int k = 0; k < rows; k++) {
		if (k < OB_POINTS && !(push >> k & 1))
			continue;
		const double inverse = 1 / (k < OB_POINTS ? m[k][k] : mf[k][k - OB_POINTS]);
		m[k] *= inverse, r[k] *= inverse;
		if (rows > OB_POINTS)
			mf[k] *= inverse;
#pragma GCC unroll 7
		for (int i = 0; i < rows; i++) {
			if (i == k)
				continue;
			const double f = k < OB_POINTS ? m[i][k] : mf[i][k - OB_POINTS];
			m[i] -= f * m[k], r[i] -= f * r[k];
			if (rows > OB_POINTS)
				mf[i] -= f * mf[k];
		}
	}
}

// Friction added by a unit of load at each point. At a single point it keeps its share of the load.
static inline void lone_follow(const lone *p, double sum, lanes *by)
{
	const double brought = 1 / sum, t = p->model.stretch, bound = p->mu * sum, same = 1 / (bound * bound);
	const double y[3] = { p->y[0], p->y[1], p->y[2] };
	for (int c = 0; c < LONE_FRICTION; c++)
		by[c] = lanes_of(y[c] * brought);
	if (!(p->radius > 0) || !(t > 0) || p->capped)
		return;
	double edges[2], centre[2], turned[6];
	lone_pressure(p, sum, edges, centre);
	memcpy(turned, p->model.surface, sizeof turned);
	lone_move(centre[0], centre[1], turned);
	for (int i = 0, k = 0; i < 3; i++)
		for (int j = i; j < 3; j++, k++)
			turned[k] -= same * y[i] * y[j];
	const lone_factors f = lone_factor(t, p->mass, turned);
	const lanes qx = (p->near_s * p->e1[0] + p->near_t * p->e2[0] - centre[0]) * brought,
		    qy = (p->near_s * p->e1[1] + p->near_t * p->e2[1] - centre[1]) * brought;
	const lanes s0 = p->an[4] - p->spin * qy, s1 = p->an[5] + p->spin * qx, s2 = p->an[6];
	const double tb = t * brought;
	const lanes r0 = tb * y[0] - (turned[0] * s0 + turned[1] * s1 + turned[2] * s2),
		    r1 = tb * y[1] - (turned[1] * s0 + turned[3] * s1 + turned[4] * s2),
		    r2 = tb * y[2] + t * (qx * y[1] - qy * y[0]) - (turned[2] * s0 + turned[4] * s1 + turned[5] * s2);
	const lanes y1 = r1 - f.l1 * r0, y2 = r2 - f.l2 * r0 - f.l3 * y1;
	const lanes z2 = y2 * f.i2, z1 = y1 * f.i1 - f.l3 * z2, z0 = r0 * f.i0 - f.l1 * z1 - f.l2 * z2;
	by[0] = p->mass[0] * z0 + p->mass[1] * z1 + p->mass[2] * z2;
	by[1] = p->mass[1] * z0 + p->mass[3] * z1 + p->mass[4] * z2;
	by[2] = p->mass[2] * z0 + p->mass[4] * z1 + p->mass[5] * z2;
}

// Sets the rows of friction that holds. Without twist, the twist's row has no effect.
static inline void lone_hold_rows(const lone *p, lane_mask push, lanes *m, lanes *mf, double *r)
{
	const double proximity = 1 + 1e-7;
	for (int i = OB_POINTS; i < OB_ROWS; i++) {
		m[i] = lanes_where(push, p->an[i]);
		mf[i] = p->af[i];
		mf[i][i - OB_POINTS] *= proximity;
		r[i] = p->short_f[i - OB_POINTS];
	}
	if (p->radius > 0 && p->diag_f[2] > 0)
		return;
	for (int i = 0; i < OB_ROWS; i++)
		mf[i][2] = 0;
	m[6] = lanes_of(0), mf[6] = (lanes){ 0, 0, 1, 0 };
	r[6] = 0;
}

// Takes a step of Newton's method, up to the place where the first point lets go.
static __attribute__((noinline)) void lone_leap(lone *p)
{
	const double proximity = 1e-7; // relative to a row's own coefficient
	const double sum = lone_sum(p->x);
	if (!(sum > 0))
		return;
	const lane_mask push = (p->x > 0) & (p->inv_diag > 0);
	const unsigned pushing = lanes_bits(push);
	lanes m[OB_ROWS], mf[OB_ROWS], by[LONE_FRICTION] = { { 0 } };
	double r[OB_ROWS], share = 1;
	if (p->slides)
		lone_follow(p, sum, by);
	for (int i = 0; i < OB_POINTS; i++) {
		m[i] = mf[i] = lanes_of(0);
		r[i] = 0;
		if (!(pushing >> i & 1))
			continue;
		lanes row = p->an[i];
		if (p->slides)
			row += p->af[i][0] * by[0] + p->af[i][1] * by[1] + p->af[i][2] * by[2];
		m[i] = lanes_where(push, row);
		mf[i] = p->af[i];
		m[i][i] += proximity * p->diag[i];
		r[i] = p->short_n[i];
	}
	if (p->slides) {
		lone_eliminate(pushing, m, mf, r, OB_POINTS);
		r[4] = r[5] = r[6] = 0;
	} else {
		lone_hold_rows(p, push, m, mf, r);
		lone_eliminate(pushing, m, mf, r, OB_ROWS);
	}
	for (int i = 0; i < OB_ROWS; i++)
		if (!(lone_abs(r[i]) < INFINITY))
			return; // rows contradict each other: sweeps alone go on
	for (int i = 0; i < OB_POINTS; i++)
		if (p->x[i] + r[i] < 0)
			share = lone_min(share, -p->x[i] / r[i]);
	if (!(share > 0))
		return;
	const lanes d = share * (lanes){ r[0], r[1], r[2], r[3] };
	const lanes df = p->slides ? lone_vector(lone_sum(by[0] * d), lone_sum(by[1] * d), lone_sum(by[2] * d))
				   : share * lone_vector(r[4], r[5], r[6]);
	lone_change_points(p, d);
	p->x = lanes_max(p->x + d, lanes_of(0));
	lone_change_friction(p, df);
}

// Impulses of points and of friction, or changes of them
typedef struct lone_impulses {
	lanes x, y;
} lone_impulses;

// Extrapolates slow rounds: if each change is a share of the one before, two rounds give the limit. from: impulses
// before this round; to, by: impulses after the last round, and its change. Updates to and by.
static inline void lone_hasten(lone *p, const lone_impulses *from, lone_impulses *to, lone_impulses *by)
{
	// ratio of a round's change to the one before; limit of the added part, relative to a change
	const double slow = .03, most = 4;
	const double twist = p->diag_f[2] * p->radius;
	// Weights that do not depend on the tangents
	const lanes weight_x = p->diag * p->diag, weight_y = { p->slide_rate2, p->slide_rate2, twist * twist, 0 };
	const lanes fx = p->x - from->x, fy = p->y - from->y, ex = fx - by->x, ey = fy - by->y;
	const double now = lone_sum(weight_x * fx * fx + weight_y * fy * fy),
		     before = lone_sum(weight_x * by->x * by->x + weight_y * by->y * by->y),
		     size = lone_sum(weight_x * ex * ex + weight_y * ey * ey);
	const lone_impulses here = { p->x, p->y };
	if (now > slow * slow * before && now < before && size > 0) {
		const double share =
			lone_max(-most, lone_min(most, -lone_sum(weight_x * fx * ex + weight_y * fy * ey) / size));
		const lanes d = lanes_max(share * (p->x - to->x), -p->x);
		lone_change_points(p, d);
		p->x += d;
		lone_change_friction(p, share * (p->y - to->y));
	}
	by->x = fx, by->y = fy;
	*to = here;
}

// Alternates sweeps and steps until a sweep changes less than "converged" (m/s). Returns the number of rounds;
// LONE_ROUNDS + 1: not converged.
static inline int lone_rounds(lone *p, double converged)
{
	lone_impulses to = { { 0 }, { 0 } }, by = to;
	for (int k = 1; k <= LONE_ROUNDS; k++) {
		const lone_impulses from = { p->x, p->y };
		if (!(lone_sweep(p) > converged * converged))
			return k;
		lone_leap(p);
		lone_hasten(p, &from, &to, &by);
	}
	return LONE_ROUNDS + 1;
}

// ---- between the batch and this solver

// A body, and the rows of J from its side
typedef struct lone_body {
	uint32_t row;
	double sign; // sign of its part in the contact: 1 for body a
	double inv_mass, inv_inertia[6];
	double n[3], t1[3], t2[3], f1[3], f2[3];
	lanes arm[3]; // angular Jacobians of the normals: r x n
} lone_body;

static inline void lone_load_body(const ob_batch *b, int l, bool a, lone_body *o)
{
	const lanes(*j)[3] = a ? b->ja : b->jb;
	const lanes *f1 = a ? b->fa1 : b->fb1, *f2 = a ? b->fa2 : b->fb2, *inv_inertia = a ? b->ia : b->ib;
	o->row = a ? b->body_a[l] : b->body_b[l];
	o->sign = a ? 1 : -1;
	o->inv_mass = lone_get(a ? &b->ima : &b->imb, l);
	for (int i = 0; i < 6; i++)
		o->inv_inertia[i] = lone_get(&inv_inertia[i], l);
	for (int c = 0; c < 3; c++) {
		o->n[c] = o->sign * lone_get(&b->n[c], l);
		o->t1[c] = o->sign * lone_get(&b->t1[c], l), o->t2[c] = o->sign * lone_get(&b->t2[c], l);
		o->f1[c] = o->sign * lone_get(&f1[c], l), o->f2[c] = o->sign * lone_get(&f2[c], l);
		o->arm[c] = o->sign * (lanes){ lone_get(&j[0][c], l), lone_get(&j[1][c], l), lone_get(&j[2][c], l),
					       lone_get(&j[3][c], l) };
	}
}

// Inverts A's block of friction, as invert_patch of kernel.c. tt: 44 45 46 55 56 66
static inline void lone_invert_friction(lone *p, const double *tt)
{
	const double heavy = 1e-6, half = .5 * (tt[0] - tt[3]), least = heavy * (tt[0] + tt[3]);
	const double most = .5 * (tt[0] + tt[3]) + __builtin_sqrt(half * half + tt[1] * tt[1]); // largest eigenvalue
	const double twist = tt[5] > 0 ? tt[5] : least / lone_max(p->radius * p->radius, 1e-300);
	const double c[6] = { tt[3] * twist - tt[4] * tt[4], tt[2] * tt[4] - tt[1] * twist,
			      tt[1] * tt[4] - tt[3] * tt[2], tt[0] * twist - tt[2] * tt[2],
			      tt[1] * tt[2] - tt[0] * tt[4], tt[0] * tt[3] - tt[1] * tt[1] };
	const double det = tt[0] * c[0] + tt[1] * c[1] + tt[2] * c[2];
	p->slide_rate2 = most * most;
	if (p->radius > 0 && det > 0) {
		const double inverse = 1 / det;
		for (int i = 0; i < 6; i++)
			p->mass[i] = c[i] * inverse;
	} else { // a point has no twist
		const double inverse = c[5] > 0 ? 1 / c[5] : 0;
		p->mass[0] = tt[3] * inverse, p->mass[1] = -tt[1] * inverse, p->mass[3] = tt[0] * inverse;
		p->mass[2] = p->mass[4] = p->mass[5] = 0;
	}
}

// Computes A, from the one body that impulses move.
static __attribute__((noinline)) void lone_couple(const ob_batch *b, int l, const lone_body *o, lone *p)
{
	const double *k = o->inv_inertia;
	const lane_mask used = lone_four(b->gap, l) < .5 * ob_no_contact;
	const lanes turn[3] = { k[0] * o->arm[0] + k[1] * o->arm[1] + k[2] * o->arm[2],
				k[1] * o->arm[0] + k[3] * o->arm[1] + k[4] * o->arm[2],
				k[2] * o->arm[0] + k[4] * o->arm[1] + k[5] * o->arm[2] };
	const double *about[LONE_FRICTION] = { o->f1, o->f2, o->n };
	double turned[LONE_FRICTION][3], tt[6];
	for (int c = 0; c < LONE_FRICTION; c++) {
		const double *x = about[c];
		lone_mul(k, x, turned[c]);
		p->an[OB_POINTS + c] = lanes_where(used, turn[0] * x[0] + turn[1] * x[1] + turn[2] * x[2]);
	}
	for (int i = 0; i < OB_POINTS; i++) {
		p->an[i] = lanes_where(used, turn[0][i] * o->arm[0] + turn[1][i] * o->arm[1] + turn[2][i] * o->arm[2] +
						     o->inv_mass);
		p->af[i] = lone_vector(p->an[4][i], p->an[5][i], p->an[6][i]);
	}
	for (int i = 0, n = 0; i < LONE_FRICTION; i++)
		for (int j = i; j < LONE_FRICTION; j++, n++)
			tt[n] = lone_dot(turned[i], about[j]) + (i == j && i < 2 ? o->inv_mass : 0);
	p->af[4] = lone_vector(tt[0], tt[1], tt[2]);
	p->af[5] = lone_vector(tt[1], tt[3], tt[4]);
	p->af[6] = lone_vector(tt[2], tt[4], tt[5]);
	p->diag = (lanes){ p->an[0][0], p->an[1][1], p->an[2][2], p->an[3][3] };
	p->inv_diag = lanes_where(used, 1 / p->diag);
	p->points = (int)lanes_count(lanes_bits(used));
	p->diag_f[0] = tt[0], p->diag_f[1] = tt[3], p->diag_f[2] = tt[5];
	lone_invert_friction(p, tt);
}

static inline void lone_load_pair(const ob_batch *b, int l, const lone_body *o, lone *p)
{
	p->near_s = lone_four(b->patch_s, l), p->near_t = lone_four(b->patch_t, l);
	p->x = lone_four(b->impulse, l), p->y = lone_three(b->impulse + OB_POINTS, l);
	for (int c = 0; c < 2; c++)
		p->e1[c] = lone_get(&b->patch_e1[c], l), p->e2[c] = lone_get(&b->patch_e2[c], l);
	p->mu = lone_get(&b->mu, l), p->radius = lone_get(&b->radius, l);
	p->det = p->e1[0] * p->e2[1] - p->e1[1] * p->e2[0];
	p->ratio = p->radius > 0 ? __builtin_sqrt((p->e2[0] * p->e2[0] + p->e2[1] * p->e2[1]) /
						  (p->e1[0] * p->e1[0] + p->e1[1] * p->e1[1]))
				 : 1;
	p->model.known = p->slides = p->capped = false;
	p->model.stretch = lone_get(&b->model.stretch, l);
	p->spin = 0;
	lone_couple(b, l, o, p);
}

// J x: opening of the points (m/s), sliding (m/s) and spin (rad/s) of the contact.
typedef struct lone_rates {
	lanes opening, sliding;
} lone_rates;

static inline void lone_add_rates(const lone_body *o, const double *x, lone_rates *r)
{
	r->opening += lone_dot(o->n, x) + (o->arm[0] * x[3] + o->arm[1] * x[4] + o->arm[2] * x[5]);
	r->sliding += lone_vector(lone_dot(o->t1, x) + lone_dot(o->f1, x + 3),
				  lone_dot(o->t2, x) + lone_dot(o->f2, x + 3), lone_dot(o->n, x + 3));
}

static inline bool lone_is_zero(const double *x)
{
	return !lanes_bits((lanes_load(x) != 0) | (lanes_load(x + 4) != 0));
}

// Rates of the contact by the motions of both bodies. o: the body that impulses move.
static inline lone_rates lone_rates_of(const ob_batch *b, int l, const lone_body *o, const ob_body_row *rows)
{
	lone_rates r = { { 0 }, { 0 } };
	const uint32_t other = o->sign > 0 ? b->body_b[l] : b->body_a[l];
	lone_add_rates(o, rows[o->row], &r);
	if (!lone_is_zero(rows[other])) {
		lone_body told; // the other body, with its prescribed motion
		lone_load_body(b, l, o->sign < 0, &told);
		lone_add_rates(&told, rows[other], &r);
	}
	return r;
}

// Speed (m/s) at which each gap may close, as in set_bias of kernel.c; computed in the first iteration.
static inline lanes lone_bias(const ob_batch *b, int l, const lone *p, const lone_body *o,
			      const ob_solver_iteration *iteration, lanes now, const ob_body_row *d)
{
	if (!iteration->first)
		return lone_four(b->bias, l);
	const double h = iteration->h;
	const bool turning = b->turning >> l & 1;
	lanes bias = lone_four(b->gap, l) + lone_rates_of(b, l, o, d).opening;
	const double most = turning ? iteration->turning_gap : iteration->resting_gap;
	const lane_mask held = (p->x > 0) & (bias < most);
	if (b->elastic >> l & 1) {
		const lanes gained = lone_rates_of(b, l, o, iteration->dv).opening;
		bias += lanes_max(lanes_min(-.5 * h * gained, bias + h * now), lanes_of(0));
	}
	bias = lanes_where(~held, lanes_max(bias, lanes_of(0))) / h;
	if (turning)
		bias += lone_four(b->turn, l);
	return b->hit >> l & 1 ? bias : lanes_max(bias, now);
}

// Square of the largest change of a row's velocity (m/s), as if each impulse acted alone
static inline double lone_largest_change(const lone *p, lanes dx, lanes dy)
{
	const double most = lanes_largest(lanes_abs(dx) * p->diag);
	return lone_max(most * most, lone_slip_change(p, dy));
}

static inline void lone_apply(const lone_body *o, lanes dx, lanes dy, double *u)
{
	const double sum = lone_sum(dx);
	double turn[3], change[3];
	for (int c = 0; c < 3; c++) {
		u[c] += o->inv_mass * (o->n[c] * sum + o->t1[c] * dy[0] + o->t2[c] * dy[1]);
		turn[c] = lone_sum(o->arm[c] * dx) + o->f1[c] * dy[0] + o->f2[c] * dy[1] + o->n[c] * dy[2];
	}
	lone_mul(o->inv_inertia, turn, change);
	for (int c = 0; c < 3; c++)
		u[3 + c] += change[c];
}

static void solve_lone(ob_batch *b, int l, const ob_solver_iteration *iteration, ob_body_row *u, const ob_body_row *v,
		       const ob_body_row *d)
{
	const double impact2 = iteration->impact_threshold * iteration->impact_threshold,
		     wake2 = iteration->wake_threshold * iteration->wake_threshold;
	lone p;
	lone_body o;
	lone_load_body(b, l, lone_get(&b->ima, l) > 0, &o);
	lone_load_pair(b, l, &o, &p);
	const lone_rates now = lone_rates_of(b, l, &o, v), next = lone_rates_of(b, l, &o, u);
	const lanes x = p.x, y = p.y, bias = lone_bias(b, l, &p, &o, iteration, now.opening, d);
	double start[3];
	for (int c = 0; c < LONE_FRICTION; c++)
		p.slip[c] = now.sliding[c];
	lone_mul(p.mass, p.slip, start);
	p.start = lone_vector(start[0], start[1], start[2]);
	p.short_n = -(next.opening + bias);
	p.short_f = -next.sliding;
	if (b->turning >> l & 1)
		p.short_f -= lone_three(b->turn + OB_POINTS, l);
	const unsigned used = lanes_bits(p.inv_diag > 0);
	const bool hits = iteration->first &&
			  used & lanes_bits((next.opening < -iteration->impact_threshold) & (next.opening + bias < 0));
	const int rounds = lone_rounds(&p, iteration->converged);
	const lanes dx = p.x - x, dy = p.y - y;
	const double changed = lone_largest_change(&p, dx, dy);
	lone_apply(&o, dx, dy, u[o.row]);
	for (int i = 0; i < OB_POINTS; i++) {
		lanes_put(&b->impulse[i], l, p.x[i]);
		lanes_put(&b->bias[i], l, bias[i]);
	}
	for (int i = 0; i < LONE_FRICTION; i++)
		lanes_put(&b->impulse[OB_POINTS + i], l, p.y[i]);
	if (iteration->first) {
		for (int i = 0; i < OB_POINTS; i++)
			lanes_put(&b->impulse_start[i], l, x[i]);
		for (int i = 0; i < LONE_FRICTION; i++)
			lanes_put(&b->impulse_start[OB_POINTS + i], l, y[i]);
	}
	const double jump = lone_largest_change(&p, p.x - lone_four(b->impulse_start, l),
						p.y - lone_three(b->impulse_start + OB_POINTS, l));
	lanes_put(&b->model.stretch, l, p.model.stretch);
	const bool solved = rounds <= LONE_ROUNDS, wakes = !solved && changed > wake2;
	b->model.known &= ~(1u << l);
	b->impact |= (unsigned)(hits || jump > impact2) << l;
	b->slides |= (unsigned)p.slides << l;
	b->solved |= (unsigned)solved << l;
	b->active |= (unsigned)wakes << l;
	b->sweeps += (unsigned)rounds;
	b->changed = lone_max(b->changed, changed);
	b->residual = solved ? b->residual : lone_max(b->residual, changed);
}

#endif

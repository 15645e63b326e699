#include "contact/lone.h"

#include <math.h>
#include <string.h>

#include "contact/bias.h"
#include "elementary/real.h"

enum {
	LONE_FRICTION = 3, // rows: two tangents and the twist
	LONE_ROUNDS = 64, // maximum; beyond it, iterations go on
	PATCH_NODES = OB_LANES,
};

// Friction of the contact, as contact/patch.h names it.
typedef struct lone_patch {
	double mu, radius, patch_e1[2], patch_e2[2];
	const ob_contact_area *area; // NULL: a parallelogram
	double response, friction_mass[6]; // A's block of friction: first element of its diagonal, inverse
} lone_patch;

// Ellipsoid in place of the limit surface (contact/batch.h).
typedef struct lone_model {
	double surface[6], inverse[6], slip[3], pressure[2], stretch;
	unsigned known;
} lone_model;

typedef lone_patch friction_pair;
typedef lone_model patch_model;

#include "contact/patch.h"

// Iterates to the end: an early end would depend on rounding, and so on the axes of the scene.
static const patch_rule patch_ends = { .turned = 1 - 1e-9, .close = 1e-12, .follows = true };

typedef struct lone {
	lanes an[OB_ROWS], af[OB_ROWS]; // A: coupling of each row with the points; with the rows of friction
	lanes diag, inv_diag, near_s, near_t; // A's diagonal for the points, and its inverse; points in half edges
	lanes x, y; // impulses of the points; of friction
	lanes short_n, short_f; // m/s, rad/s: velocity that each row still lacks
	double diag_f[LONE_FRICTION]; // A's diagonal for friction
	double slide_rate2;
	int points; // number of points: the first lanes
	lone_patch patch;
	lone_model model;
	patch_search search;
} lone;

// ---- arithmetic

static inline lanes lone_four(const lanes *x, int l)
{
	return (lanes){ lanes_get(&x[0], l), lanes_get(&x[1], l), lanes_get(&x[2], l), lanes_get(&x[3], l) };
}

// Three components; lane 3 repeats the last, and is not read.
static inline lanes lone_vector(double x, double y, double z)
{
	return (lanes){ x, y, z, z };
}

static inline lanes lone_three(const lanes *x, int l)
{
	return lone_vector(lanes_get(&x[0], l), lanes_get(&x[1], l), lanes_get(&x[2], l));
}

static inline double lone_sum(lanes x)
{
	return (x[0] + x[1]) + (x[2] + x[3]);
}

// ---- interface of contact/patch.h

// A batch solves discs.
static inline double patch_disc(const lone_patch *b)
{
	return 0;
}

static inline unsigned patch_areas(const lone_patch *b)
{
	return b->area != NULL;
}

static inline const ob_contact_area *patch_area(const lone_patch *b, int l)
{
	return b->area;
}

static inline double patch_get(const double *x, int l)
{
	return *x;
}

static inline void patch_put(double *x, int l, double y)
{
	*x = y;
}

static inline double patch_response(const lone_patch *b)
{
	return b->response;
}

static inline lanes patch_nodes(const double *from)
{
	return lanes_load(from);
}

static inline double patch_sum_nodes(lanes x)
{
	return lone_sum(x);
}

// Adds the integrals along four edges side by side.
static inline double patch_border(const patch_load *p, int asked, const double *v, double w, double at,
				  const double *slope, patch_sums *o)
{
	const lanes side1 = { -1, 1, 1, -1 }, side2 = { -1, -1, 1, 1 };
	const lanes cx = side1 * p->e1[0] + side2 * p->e2[0], cy = side1 * p->e1[1] + side2 * p->e2[1];
	const lanes u[2] = { v[0] - w * cy, v[1] + w * cx }, r = lanes_sqrt(u[0] * u[0] + u[1] * u[1]);
	const lanes un[2] = { __builtin_shufflevector(u[0], u[0], 1, 2, 3, 0),
			      __builtin_shufflevector(u[1], u[1], 1, 2, 3, 0) },
		    rn = __builtin_shufflevector(r, r, 1, 2, 3, 0);
	const lanes wide[2] = { lanes_of(slope[0]), lanes_of(slope[1]) };
	border_sums sums = { 0 };
	border_add_edge(u, r, un, rn, lanes_of(at), wide, &sums);
	for (int c = 0; c < 2; c++)
		o->force[c] = lone_sum(sums.force[c]);
	o->power = lone_sum(sums.power);
	o->weight = lone_sum(sums.weight);
	return 8 * (p->e1[0] * p->e2[1] - p->e1[1] * p->e2[0]);
}

// The slip is known before.
static void patch_begin_slip(const lone_patch *b, patch_search *search) {}

// ---- friction

// Computes the centre of pressure in half edges.
static inline void lone_pressure(const lone *p, double sum, double *edges)
{
	const double inverse = 1 / larger_of(sum, 1e-300);
	edges[0] = lone_sum(p->x * p->near_s) * inverse;
	edges[1] = lone_sum(p->x * p->near_t) * inverse;
}

// Computes impulses of friction that hold, or those that the limit permits.
static inline void lone_friction(lone *p, double sum, double *next)
{
	const double bound = p->patch.mu * sum, missing[3] = { p->short_f[0], p->short_f[1], p->short_f[2] };
	const double y[3] = { p->y[0], p->y[1], p->y[2] };
	if (p->patch.radius > 0) {
		patch_load load;
		lone_pressure(p, sum, load.edges);
		patch_friction(&p->patch, true, &load, sum, missing, y, &p->search, next);
		return;
	}
	sym_mul(p->patch.friction_mass, missing, next);
	next[0] += y[0], next[1] += y[1], next[2] = 0;
	p->search.slides = next[0] * next[0] + next[1] * next[1] > bound * bound;
	if (!p->search.slides)
		return;
	const double a[3] = { p->diag_f[0], p->af[4][1], p->diag_f[1] };
	const double load[2] = { a[0] * y[0] + a[1] * y[1] + missing[0], a[1] * y[0] + a[2] * y[1] + missing[1] };
	const double t = point_slide(true, bound, a, load, next);
	p->model.stretch = is_load(bound) ? t : p->model.stretch;
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
	const double spin = d[2] * p->diag_f[2] * p->patch.radius;
	return larger_of((d[0] * d[0] + d[1] * d[1]) * p->slide_rate2, spin * spin);
}

// Sweeps once over the rows. Returns the square of the largest change of a velocity.
static inline double lone_sweep(lone *p)
{
	double largest = 0, sum = 0, next[LONE_FRICTION];
#pragma GCC unroll 4
	for (int i = 0; i < OB_POINTS; i++) {
		if (i == p->points)
			break;
		double x = p->x[i];
		lone_change_point(p, i,
				  push_sweep(true, p->short_n[i] * p->inv_diag[i], p->diag[i], &x, &sum, &largest));
		p->x[i] = x;
	}
	lone_friction(p, sum, next);
	const lanes d = lone_vector(next[0], next[1], next[2]) - p->y;
	lone_change_friction(p, d);
	return larger_of(largest * largest, lone_slip_change(p, d));
}

// Replaces r by m^-1 r, by elimination without pivots. Includes the
// rows of points under load ("push"). If friction holds, it includes the rows of friction, with the columns mf.
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
	const double brought = 1 / sum, t = p->model.stretch, bound = p->patch.mu * sum, same = 1 / (bound * bound);
	const double y[3] = { p->y[0], p->y[1], p->y[2] };
	for (int c = 0; c < LONE_FRICTION; c++)
		by[c] = lanes_of(y[c] * brought);
	if (!(p->patch.radius > 0) || !(t > 0) || p->search.capped)
		return;
	patch_load load;
	double turned[6];
	lone_pressure(p, sum, load.edges);
	patch_set_pressure(&p->patch, &load);
	const double *centre = load.pressure;
	memcpy(turned, p->model.surface, sizeof turned);
	patch_move(centre, turned);
	for (int i = 0, k = 0; i < 3; i++)
		for (int j = i; j < 3; j++, k++)
			turned[k] -= same * y[i] * y[j];
	const patch_factors f = patch_factor(t, p->patch.friction_mass, turned);
	const lanes qx = (p->near_s * p->patch.patch_e1[0] + p->near_t * p->patch.patch_e2[0] - centre[0]) * brought,
		    qy = (p->near_s * p->patch.patch_e1[1] + p->near_t * p->patch.patch_e2[1] - centre[1]) * brought;
	const lanes s0 = p->an[4] - p->search.spin * qy, s1 = p->an[5] + p->search.spin * qx, s2 = p->an[6];
	const double tb = t * brought;
	const lanes r0 = tb * y[0] - (turned[0] * s0 + turned[1] * s1 + turned[2] * s2),
		    r1 = tb * y[1] - (turned[1] * s0 + turned[3] * s1 + turned[4] * s2),
		    r2 = tb * y[2] + t * (qx * y[1] - qy * y[0]) - (turned[2] * s0 + turned[4] * s1 + turned[5] * s2);
	const lanes y1 = r1 - f.l1 * r0, y2 = r2 - f.l2 * r0 - f.l3 * y1;
	const lanes z2 = y2 * f.i2, z1 = y1 * f.i1 - f.l3 * z2, z0 = r0 * f.i0 - f.l1 * z1 - f.l2 * z2;
	by[0] = p->patch.friction_mass[0] * z0 + p->patch.friction_mass[1] * z1 + p->patch.friction_mass[2] * z2;
	by[1] = p->patch.friction_mass[1] * z0 + p->patch.friction_mass[3] * z1 + p->patch.friction_mass[4] * z2;
	by[2] = p->patch.friction_mass[2] * z0 + p->patch.friction_mass[4] * z1 + p->patch.friction_mass[5] * z2;
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
	if (p->patch.radius > 0 && p->diag_f[2] > 0)
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
	if (!is_load(sum))
		return;
	const lane_mask push = (p->x > 0) & (p->inv_diag > 0);
	const unsigned pushing = lanes_bits(push);
	lanes m[OB_ROWS], mf[OB_ROWS], by[LONE_FRICTION] = { { 0 } };
	double r[OB_ROWS], share = 1;
	if (p->search.slides)
		lone_follow(p, sum, by);
	for (int i = 0; i < OB_POINTS; i++) {
		m[i] = mf[i] = lanes_of(0);
		r[i] = 0;
		if (!(pushing >> i & 1))
			continue;
		lanes row = p->an[i];
		if (p->search.slides)
			row += p->af[i][0] * by[0] + p->af[i][1] * by[1] + p->af[i][2] * by[2];
		m[i] = lanes_where(push, row);
		mf[i] = p->af[i];
		m[i][i] += proximity * p->diag[i];
		r[i] = p->short_n[i];
	}
	if (p->search.slides) {
		lone_eliminate(pushing, m, mf, r, OB_POINTS);
		r[4] = r[5] = r[6] = 0;
	} else {
		lone_hold_rows(p, push, m, mf, r);
		lone_eliminate(pushing, m, mf, r, OB_ROWS);
	}
	for (int i = 0; i < OB_ROWS; i++)
		if (!(size_of(r[i]) < INFINITY))
			return; // rows contradict each other: sweeps alone go on
	for (int i = 0; i < OB_POINTS; i++)
		if (p->x[i] + r[i] < 0)
			share = smaller_of(share, -p->x[i] / r[i]);
	if (!(share > 0))
		return;
	const lanes d = share * (lanes){ r[0], r[1], r[2], r[3] };
	const lanes df = p->search.slides ? lone_vector(lone_sum(by[0] * d), lone_sum(by[1] * d), lone_sum(by[2] * d))
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
	const double twist = p->diag_f[2] * p->patch.radius;
	// Weights that do not depend on the tangents
	const lanes weight_x = p->diag * p->diag, weight_y = { p->slide_rate2, p->slide_rate2, twist * twist, 0 };
	const lanes fx = p->x - from->x, fy = p->y - from->y, ex = fx - by->x, ey = fy - by->y;
	const double now = lone_sum(weight_x * fx * fx + weight_y * fy * fy),
		     before = lone_sum(weight_x * by->x * by->x + weight_y * by->y * by->y),
		     size = lone_sum(weight_x * ex * ex + weight_y * ey * ey);
	const lone_impulses here = { p->x, p->y };
	if (now > slow * slow * before && now < before && size > 0) {
		const double share =
			larger_of(-most, smaller_of(most, -lone_sum(weight_x * fx * ex + weight_y * fy * ey) / size));
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
	o->inv_mass = lanes_get(a ? &b->ima : &b->imb, l);
	for (int i = 0; i < 6; i++)
		o->inv_inertia[i] = lanes_get(&inv_inertia[i], l);
	for (int c = 0; c < 3; c++) {
		o->n[c] = o->sign * lanes_get(&b->n[c], l);
		o->t1[c] = o->sign * lanes_get(&b->t1[c], l), o->t2[c] = o->sign * lanes_get(&b->t2[c], l);
		o->f1[c] = o->sign * lanes_get(&f1[c], l), o->f2[c] = o->sign * lanes_get(&f2[c], l);
		o->arm[c] = o->sign * (lanes){ lanes_get(&j[0][c], l), lanes_get(&j[1][c], l), lanes_get(&j[2][c], l),
					       lanes_get(&j[3][c], l) };
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
		sym_mul(k, x, turned[c]);
		p->an[OB_POINTS + c] = lanes_where(used, turn[0] * x[0] + turn[1] * x[1] + turn[2] * x[2]);
	}
	for (int i = 0; i < OB_POINTS; i++) {
		p->an[i] = lanes_where(used, turn[0][i] * o->arm[0] + turn[1][i] * o->arm[1] + turn[2][i] * o->arm[2] +
						     o->inv_mass);
		p->af[i] = lone_vector(p->an[4][i], p->an[5][i], p->an[6][i]);
	}
	for (int i = 0, n = 0; i < LONE_FRICTION; i++)
		for (int j = i; j < LONE_FRICTION; j++, n++)
			tt[n] = dot3(turned[i], about[j]) + (i == j && i < 2 ? o->inv_mass : 0);
	p->af[4] = lone_vector(tt[0], tt[1], tt[2]);
	p->af[5] = lone_vector(tt[1], tt[3], tt[4]);
	p->af[6] = lone_vector(tt[2], tt[4], tt[5]);
	p->diag = (lanes){ p->an[0][0], p->an[1][1], p->an[2][2], p->an[3][3] };
	p->inv_diag = lanes_where(used, 1 / p->diag);
	p->points = (int)lanes_count(lanes_bits(used));
	p->patch.response = p->diag_f[0] = tt[0], p->diag_f[1] = tt[3], p->diag_f[2] = tt[5];
	double m[3];
	const double most = disc_invert((double[3]){ tt[0], tt[1], tt[3] }, m), disc[6] = { m[0], m[1], 0, m[2] };
	memcpy(p->patch.friction_mass, disc, sizeof disc);
	patch_invert(p->patch.radius, tt, p->patch.friction_mass);
	p->slide_rate2 = most * most;
}

static inline void lone_load_pair(const ob_batch *b, int l, const lone_body *o, lone *p)
{
	p->near_s = lone_four(b->patch_s, l), p->near_t = lone_four(b->patch_t, l);
	p->x = lone_four(b->impulse, l), p->y = lone_three(b->impulse + OB_POINTS, l);
	for (int c = 0; c < 2; c++)
		p->patch.patch_e1[c] = lanes_get(&b->patch_e1[c], l),
		p->patch.patch_e2[c] = lanes_get(&b->patch_e2[c], l);
	p->patch.area = b->areas >> l & 1 ? &b->area[l] : NULL;
	p->patch.mu = lanes_get(&b->mu, l), p->patch.radius = lanes_get(&b->radius, l);
	p->model.known = 0;
	p->model.pressure[0] = p->model.pressure[1] = 0;
	p->model.stretch = lanes_get(&b->model.stretch, l);
	p->search = (patch_search){ .model = &p->model };
	lone_couple(b, l, o, p);
}

// J x: opening of the points (m/s), sliding (m/s) and spin (rad/s) of the contact.
typedef struct lone_rates {
	lanes opening, sliding;
} lone_rates;

static inline void lone_add_rates(const lone_body *o, const double *x, lone_rates *r)
{
	r->opening += dot3(o->n, x) + (o->arm[0] * x[3] + o->arm[1] * x[4] + o->arm[2] * x[5]);
	r->sliding += lone_vector(dot3(o->t1, x) + dot3(o->f1, x + 3), dot3(o->t2, x) + dot3(o->f2, x + 3),
				  dot3(o->n, x + 3));
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

// Speed (m/s) at which each gap may close (contact/bias.h); computed in the first iteration.
static inline lanes lone_bias(const ob_batch *b, int l, const lone *p, const lone_body *o,
			      const ob_solver_iteration *iteration, lanes now, const ob_body_row *d)
{
	if (!iteration->first)
		return lone_four(b->bias, l);
	const double h = iteration->h;
	const bool turning = b->turning >> l & 1;
	lanes bias = lone_four(b->gap, l) + lone_rates_of(b, l, o, d).opening;
	const lane_mask keeps = bias_keeps(p->x, bias, lanes_of(iteration->resting_gap));
	if (b->elastic >> l & 1) {
		const lanes gained = lone_rates_of(b, l, o, iteration->dv).opening;
		bias += bias_of_fall(bias, now, gained, h);
	}
	bias = bias_of(bias, keeps, h);
	if (turning)
		bias += lone_four(b->turn, l);
	return b->hit >> l & 1 ? bias : bias_alone(bias, now);
}

// Square of the largest change of a row's velocity (m/s), as if each impulse acted alone
static inline double lone_largest_change(const lone *p, lanes dx, lanes dy)
{
	const double most = lanes_largest(lanes_abs(dx) * p->diag);
	return larger_of(most * most, lone_slip_change(p, dy));
}

static inline void lone_apply(const lone_body *o, lanes dx, lanes dy, double *u)
{
	const double sum = lone_sum(dx);
	double turn[3], change[3];
	for (int c = 0; c < 3; c++) {
		u[c] += o->inv_mass * (o->n[c] * sum + o->t1[c] * dy[0] + o->t2[c] * dy[1]);
		turn[c] = lone_sum(o->arm[c] * dx) + o->f1[c] * dy[0] + o->f2[c] * dy[1] + o->n[c] * dy[2];
	}
	sym_mul(o->inv_inertia, turn, change);
	for (int c = 0; c < 3; c++)
		u[3 + c] += change[c];
}

void OB_SOLVE_LONE(ob_batch *b, int l, const ob_solver_iteration *iteration, ob_body_row *u, const ob_body_row *v,
		   const ob_body_row *d)
{
	const double impact2 = iteration->impact_threshold * iteration->impact_threshold,
		     wake2 = iteration->wake_threshold * iteration->wake_threshold;
	lone p;
	lone_body o;
	lone_load_body(b, l, lanes_get(&b->ima, l) > 0, &o);
	lone_load_pair(b, l, &o, &p);
	const lone_rates now = lone_rates_of(b, l, &o, v), next = lone_rates_of(b, l, &o, u);
	const lanes x = p.x, y = p.y, bias = lone_bias(b, l, &p, &o, iteration, now.opening, d);
	for (int c = 0; c < LONE_FRICTION; c++)
		p.search.slip[c] = now.sliding[c];
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
	b->slides |= (unsigned)p.search.slides << l;
	b->solved |= (unsigned)solved << l;
	b->active |= (unsigned)wakes << l;
	b->sweeps += (unsigned)rounds;
	b->changed = larger_of(b->changed, changed);
	b->residual = solved ? b->residual : larger_of(b->residual, changed);
}

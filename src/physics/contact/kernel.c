// Arithmetic of the contact solver on a batch, and of two boxes. Compiled once per instruction set under the name
// OB_KERNEL (see meson.build). All versions compute the same lanes side by side and contract no operations, so their
// bits are the same.
#include "contact/kernel.h"

#include <string.h>

#include "contact/bias.h"
#include "contact/boxes.h"
#include "contact/lone.h"
#include "contact/patch_lanes.h"
#include "contact/points.h"

static const int max_block_sweeps = 64;
static const int coarse_block_sweeps = 2; // sweeps of a block that the next iteration will solve again
static const double min_projection = .01; // relative to the slop: shallower penetrations stay, else it never ends

// Rows depend on the pair's kind alone. The compiler makes a kernel for each kind from the same text: for a constant
// "kind" it removes unused rows.
#define PER_KIND static inline __attribute__((always_inline))

PER_KIND int points_of(ob_batch_kind kind)
{
	return kind & OB_KIND_POINT ? 1 : OB_POINTS;
}

PER_KIND bool in_use(ob_batch_kind kind, int row)
{
	const bool rough = !(kind & OB_KIND_FRICTIONLESS);
	return row < OB_POINTS ? row < points_of(kind) : row < OB_ROW_TWIST ? rough : rough && !(kind & OB_KIND_POINT);
}

static inline double square(double x)
{
	return x * x;
}

// Inverts A's block of friction, and what solve_disc needs of it.
static inline void invert_friction(ob_batch *b, lanes a44, lanes a45, lanes a55)
{
	const lanes none = lanes_of(0), a[3] = { a44, a45, a55 };
	lanes m[3];
	const lanes most = disc_invert(a, m);
	b->friction_mass[0] = m[0], b->friction_mass[1] = m[1], b->friction_mass[3] = m[2];
	b->friction_mass[2] = b->friction_mass[4] = b->friction_mass[5] = none;
	b->hold[0] = m[0] * a44, b->hold[1] = m[1] * a55;
	b->hold[2] = m[1] * a44, b->hold[3] = m[2] * a55;
	b->slide_mass = lanes_select(most > 0, 1 / most, none);
	b->slide[0] = b->slide_mass * a44;
	b->slide[1] = b->slide_mass * a55;
	b->slide_rate2 = most * most;
}

// moves_a, moves_b: some lane's body a, or b, can move.
PER_KIND void prepare_kind(ob_batch *b, ob_batch_kind kind, bool moves_a, bool moves_b)
{
	lanes mass = b->ima * b->ka + b->imb * b->kb, a[OB_ROWS][OB_ROWS];
#pragma GCC unroll 7
	for (int i = 0; i < OB_ROWS; i++) {
		const ob_row row = ob_batch_row(b, i);
		lanes xa[3], xb[3];
		if (!in_use(kind, i))
			continue;
		if (moves_a)
			sym_mul(b->ia, row.about_a, xa);
		if (moves_b)
			sym_mul(b->ib, row.about_b, xb);
#pragma GCC unroll 7
		for (int j = 0; j <= i; j++) {
			const ob_row other = ob_batch_row(b, j);
			if (!in_use(kind, j))
				continue;
			lanes s = moves_a ? dot3(xa, other.about_a) * b->ka : lanes_of(0);
			if (moves_b)
				s += dot3(xb, other.about_b) * b->kb;
			if (row.along && row.along == other.along)
				s += mass; // two normals, or a tangent with itself: others are across each other
			a[i][j] = a[j][i] = s;
		}
		b->diag[i] = a[i][i];
		lane_mask used = a[i][i] > 0;
		if (i < OB_POINTS) // an absent point has no row
			used &= b->gap[i] < .5 * ob_no_contact;
		b->inv_diag[i] = lanes_select(used, 1 / a[i][i], lanes_of(0));
	}
	for (int i = 0; i < OB_ROWS; i++)
		for (int j = 0; j < OB_ROWS; j++)
			if (in_use(kind, i) && in_use(kind, j))
				b->coupling[i][j] = a[i][j] * b->inv_diag[j];
	if (in_use(kind, OB_ROW_FRICTION))
		invert_friction(b, a[4][4], a[4][5], a[5][5]);
	if (in_use(kind, OB_ROW_TWIST))
		patch_invert(b->radius, (lanes[6]){ a[4][4], a[4][5], a[4][6], a[5][5], a[5][6], a[6][6] },
			     b->friction_mass);
	b->dirty = 0;
}

static void prepare(ob_batch *b)
{
	const bool moves_a = lanes_bits(b->ima > 0), moves_b = lanes_bits(b->imb > 0);
	if (b->kind != OB_KIND_FULL)
		prepare_kind(b, b->kind, true, true);
	else if (moves_a && moves_b)
		prepare_kind(b, OB_KIND_FULL, true, true);
	else if (moves_a)
		prepare_kind(b, OB_KIND_FULL, true, false);
	else
		prepare_kind(b, OB_KIND_FULL, false, true);
}

static inline __attribute__((always_inline)) void gather(const ob_body_row *rows, const uint32_t *index, lanes *o)
{
	lanes linear[OB_LANES], rest[OB_LANES];
	for (int l = 0; l < OB_LANES; l++) {
		linear[l] = lanes_load(rows[index[l]]);
		rest[l] = lanes_load(rows[index[l]] + 4);
	}
	lanes_transpose(linear);
	lanes_transpose(rest);
	for (int c = 0; c < 4; c++)
		o[c] = linear[c];
	o[4] = rest[0];
	o[5] = rest[1];
}

// Transposes components by body to rows by body: columns 0..3 (linear) and columns 4..7 (rest).
static inline void transpose_bodies(const lanes *x, lanes *linear, lanes *rest)
{
	for (int l = 0; l < OB_LANES; l++)
		linear[l] = x[l];
	rest[0] = x[4];
	rest[1] = x[5];
	rest[2] = rest[3] = lanes_of(0);
	lanes_transpose(linear);
	lanes_transpose(rest);
}

static inline void scatter(ob_body_row *rows, const uint32_t *index, const lanes *x)
{
	lanes linear[OB_LANES], rest[OB_LANES];
	transpose_bodies(x, linear, rest);
	for (int l = 0; l < OB_LANES; l++) {
		lanes_store(rows[index[l]], linear[l]);
		lanes_store(rows[index[l]] + 4, rest[l]);
	}
}

// Body 0 and static bodies may be in several lanes of a batch: their rows stay zero, whichever lane writes last.
static inline void gather_both(const ob_batch *b, const ob_body_row *rows, lanes *xa, lanes *xb)
{
	gather(rows, b->body_a, xa);
	gather(rows, b->body_b, xb);
}

static inline void scatter_both(const ob_batch *b, ob_body_row *rows, const lanes *xa, const lanes *xb)
{
	scatter(rows, b->body_a, xa);
	scatter(rows, b->body_b, xb);
}

// va += M_a^-1 J_a^T d, vb -= M_b^-1 J_b^T d
PER_KIND void apply(const ob_batch *b, ob_batch_kind kind, const lanes *d, lanes *va, lanes *vb)
{
	lanes sum = d[0], la[3], lb[3], x[3];
	for (int i = 1; i < points_of(kind); i++)
		sum += d[i];
	for (int c = 0; c < 3; c++) {
		lanes p = b->n[c] * sum;
		la[c] = b->ja[0][c] * d[0];
		lb[c] = b->jb[0][c] * d[0];
		for (int i = 1; i < points_of(kind); i++) {
			la[c] += b->ja[i][c] * d[i];
			lb[c] += b->jb[i][c] * d[i];
		}
		if (in_use(kind, OB_ROW_FRICTION)) {
			p += b->t1[c] * d[4] + b->t2[c] * d[5];
			la[c] += b->fa1[c] * d[4] + b->fa2[c] * d[5];
			lb[c] += b->fb1[c] * d[4] + b->fb2[c] * d[5];
		}
		if (in_use(kind, OB_ROW_TWIST)) {
			lanes twist = b->n[c] * d[6];
			la[c] += twist;
			lb[c] += twist;
		}
		va[c] += b->ima * p;
		vb[c] -= b->imb * p;
	}
	sym_mul(b->ia, la, x);
	for (int c = 0; c < 3; c++)
		va[3 + c] += x[c];
	sym_mul(b->ib, lb, x);
	for (int c = 0; c < 3; c++)
		vb[3 + c] -= x[c];
}

// Normal rows of J (xa, xb): opening velocity of each point (m/s).
PER_KIND void normal_velocities(const ob_batch *b, ob_batch_kind kind, const lanes *xa, const lanes *xb, lanes *r)
{
	lanes d[3] = { xa[0] - xb[0], xa[1] - xb[1], xa[2] - xb[2] };
	lanes nd = dot3(b->n, d);
	for (int i = 0; i < points_of(kind); i++)
		r[i] = nd + dot3(b->ja[i], xa + 3) - dot3(b->jb[i], xb + 3);
}

// Rows of friction and twist of J (xa, xb): sliding (m/s) and spin (rad/s) of the contact.
PER_KIND void friction_velocities(const ob_batch *b, ob_batch_kind kind, const lanes *xa, const lanes *xb, lanes *r)
{
	for (int i = OB_ROW_FRICTION; in_use(kind, i) && i < OB_ROW_TWIST; i++) {
		const lanes d[3] = { xa[0] - xb[0], xa[1] - xb[1], xa[2] - xb[2] };
		const ob_row row = ob_batch_row(b, i);
		r[i] = dot3(row.along, d) + dot3(row.about_a, xa + 3) - dot3(row.about_b, xb + 3);
	}
	if (in_use(kind, OB_ROW_TWIST)) {
		lanes w[3] = { xa[3] - xb[3], xa[4] - xb[4], xa[5] - xb[5] };
		r[6] = dot3(b->n, w);
	}
}

// Updates the steps of all rows after a change d of row i's impulse.
PER_KIND void couple(const ob_batch *b, ob_batch_kind kind, int i, lanes d, lanes *step)
{
	for (int j = 0; j < OB_ROWS; j++)
		if (in_use(kind, j))
			step[j] -= b->coupling[i][j] * d;
}

// Upper bound on the square of the change of slip (m/s) by a change of friction: the same whatever the tangents.
static inline lanes square_of_slip(const ob_batch *b, lanes d4, lanes d5)
{
	return (d4 * d4 + d5 * d5) * b->slide_rate2;
}

static void patch_begin_slip(const ob_batch *b, patch_search *search)
{
	lanes va[6], vb[6], start[OB_ROWS] = { 0 };
	gather_both(b, search->v, va, vb);
	friction_velocities(b, OB_KIND_FULL, va, vb, start);
	memcpy(search->slip, start + OB_POINTS, sizeof search->slip);
}

// Computes the centre of pressure in half edges.
static inline void find_pressure(const ob_batch *b, const lanes *x, lanes sum, lanes *edges)
{
	const lanes *s = b->patch_s, *t = b->patch_t, inverse = 1 / lanes_max(sum, lanes_of(1e-300));
	edges[0] = (x[0] * s[0] + x[1] * s[1] + x[2] * s[2] + x[3] * s[3]) * inverse;
	edges[1] = (x[0] * t[0] + x[1] * t[1] + x[2] * t[2] + x[3] * t[3]) * inverse;
}

// Solves friction and twist of patches together.
static inline void solve_patch(const ob_batch *b, lane_mask patch, const lanes *x, lanes sum, const lanes *step,
			       patch_search *f, lanes *next)
{
	const lanes missing[3] = { step[4] * b->diag[4], step[5] * b->diag[5], step[6] * b->diag[6] };
	patch_load load;
	find_pressure(b, x, sum, load.edges);
	patch_friction(b, patch, &load, sum, missing, x + OB_POINTS, f, next);
}

// Finds the patches that slide throughout the substep, and the direction of their friction: that against the mean slip. v, u:
// velocities at the substep's start, and as the impulses of the last one would leave them.
static void find_follows(ob_batch *b, const ob_body_row *v, const ob_body_row *u)
{
	const lanes *x = b->impulse, sum = x[0] + x[1] + x[2] + x[3], bound = b->mu * sum;
	lanes va[6], vb[6], start[OB_ROWS] = { 0 }, last[OB_ROWS] = { 0 }, undo[3], mean[3], grad[3];
	lanes *slip = start + OB_POINTS, *end = last + OB_POINTS;
	lane_mask slides = lanes_mask(b->follows) & (b->radius > 0) & is_load(bound);
	b->follows = 0;
	if (!lanes_bits(slides))
		return;
	if (b->dirty)
		prepare(b);
	gather_both(b, v, va, vb);
	friction_velocities(b, OB_KIND_FULL, va, vb, start);
	sym_mul(b->friction_mass, slip, undo);
	const lanes rim = undo[2] / b->radius;
	slides &= undo[0] * undo[0] + undo[1] * undo[1] + rim * rim > bound * bound;
	if (!lanes_bits(slides))
		return;
	gather_both(b, u, va, vb);
	friction_velocities(b, OB_KIND_FULL, va, vb, last);
	for (int c = 0; c < 3; c++)
		end[c] += (lanes)(lanes_mask(b->turning) & (lane_mask)b->turn[OB_POINTS + c]);
	slides &= dot3(undo, end) > 0;
	if (!lanes_bits(slides))
		return;
	b->follows = lanes_bits(slides);
	patch_load load;
	patch_slip at;
	find_pressure(b, x, sum, load.edges);
	patch_set_pressure(b, &load);
	patch_load_set(b, &load);
	patch_load_areas(b, lanes_bits(slides), &load);
	for (int c = 0; c < 3; c++)
		mean[c] = slip[c] + end[c];
	patch_slip_about_pressure(&load, slides, mean, &at);
	sym_mul(at.bound, mean, grad);
	for (int c = 0; c < 3; c++)
		grad[c] *= -b->mu;
	for (int c = 0; c < 2; c++)
		b->follow[c] = lanes_select(slides, grad[c], b->follow[c]);
	for (int k = 0; k < OB_POINTS; k++) {
		const lanes s = b->patch_s[k], t = b->patch_t[k];
		const lanes arm[2] = { s * b->patch_e1[0] + t * b->patch_e2[0],
				       s * b->patch_e1[1] + t * b->patch_e2[1] };
		const lanes twist = grad[2] + arm[0] * grad[1] - arm[1] * grad[0];
		b->follow_twist[k] = lanes_select(slides, twist, b->follow_twist[k]);
	}
}

// Friction of patches that follow the load.
static inline void follow_load(const ob_batch *b, const lanes *x, lanes sum, lanes *friction)
{
	friction[0] = b->follow[0] * sum, friction[1] = b->follow[1] * sum;
	friction[2] = b->follow_twist[0] * x[0] + b->follow_twist[1] * x[1] + b->follow_twist[2] * x[2] +
		      b->follow_twist[3] * x[3];
}

// A lane whose slip has turned round follows the load no longer.
static inline void check_follows(ob_batch *b, const lanes *r, const lanes *x)
{
	lanes friction[3];
	follow_load(b, x, x[0] + x[1] + x[2] + x[3], friction);
	b->follows &= ~lanes_bits(dot3(friction, r + OB_POINTS) > 0);
}

// Friction at a point or at the centroid: the impulse that holds, or if that is too large, one on the disc. The step to
// the disc has the same scale in all directions, whatever the masses; else the slip's direction would depend on the
// tangents.
static inline void solve_disc(const ob_batch *b, lane_mask point, lanes bound, const lanes *x, const lanes *step,
			      lanes *change)
{
	lanes d4 = b->hold[0] * step[4] + b->hold[1] * step[5], d5 = b->hold[2] * step[4] + b->hold[3] * step[5];
	lanes f4 = x[4] + d4, f5 = x[5] + d5, b2 = bound * bound;
	const lane_mask slips = f4 * f4 + f5 * f5 > b2;
	if (lanes_bits(slips)) { // the root and the quotient take as long as all the rest
		f4 = x[4] + b->slide[0] * step[4], f5 = x[5] + b->slide[1] * step[5];
		lanes shrink = disc_share(bound, f4 * f4 + f5 * f5), next[2] = { f4 * shrink, f5 * shrink };
		if (lanes_bits(slips & point)) {
			const lanes a[3] = { b->diag[4], b->coupling[4][5] * b->diag[5], b->diag[5] };
			const lanes load[2] = { a[0] * (x[4] + step[4]) + a[1] * x[5],
						a[1] * x[4] + a[2] * (x[5] + step[5]) };
			point_slide(slips & point, bound, a, load, next);
		}
		d4 = lanes_select(slips, next[0] - x[4], d4);
		d5 = lanes_select(slips, next[1] - x[5], d5);
	}
	change[0] = d4, change[1] = d5;
}

// Sweep of projected Gauss-Seidel inside the block. x: impulses; step: change of its own impulse that each row alone
// would make, -(J v) / A_ii. In this form few operations separate one row's change from the next: a maximum, a product,
// a difference. If the two bodies touch nothing else, friction and twist are one block of rows. Lanes that are not open
// keep their impulses. Returns the square of the largest change of a velocity. patches: the bodies of some lane touch
// nothing else.
PER_KIND lanes sweep_block(const ob_batch *b, ob_batch_kind kind, bool patches, lane_mask open, patch_search *f,
			   lanes *x, lanes *step)
{
	lanes largest = lanes_of(0), sum = lanes_of(0), next[3] = { sum, sum, sum }, disc[2];
	for (int i = 0; i < points_of(kind); i++) {
		const lanes d = push_sweep(open, step[i], b->diag[i], &x[i], &sum, &largest);
		couple(b, kind, i, d, step);
	}
	largest *= largest;
	if (!in_use(kind, OB_ROW_FRICTION))
		return largest;
	lane_mask isolated = { 0 }, patch = isolated;
	if (patches) {
		isolated = open & lanes_mask(b->isolated);
		patch = isolated & (b->radius > 0);
	}
	if (patches && lanes_bits(patch))
		solve_patch(b, patch, x, sum, step, f, next);
	lanes bound = b->mu * sum;
	if (in_use(kind, OB_ROW_TWIST) && b->follows) {
		lanes load[3];
		const lane_mask follows = open & lanes_mask(b->follows);
		follow_load(b, x, sum, load);
		for (int c = 0; c < 3; c++)
			next[c] = lanes_select(follows, load[c], next[c]);
		patch |= follows;
	}
	solve_disc(b, isolated & ~patch, bound, x, step, disc);
	lanes d4 = disc[0], d5 = disc[1];
	if (in_use(kind, OB_ROW_TWIST)) {
		d4 = lanes_select(patch, next[0] - x[4], d4);
		d5 = lanes_select(patch, next[1] - x[5], d5);
	}
	couple(b, kind, 4, d4, step);
	couple(b, kind, 5, d5, step);
	x[4] += lanes_where(open, d4);
	x[5] += lanes_where(open, d5);
	largest = lanes_max(largest, square_of_slip(b, d4, d5));
	if (!in_use(kind, OB_ROW_TWIST))
		return largest;
	bound *= b->radius;
	lanes d6 = twist_within(-bound - x[6], bound - x[6], step[6]);
	if (in_use(kind, OB_ROW_TWIST))
		d6 = lanes_select(patch, next[2] - x[6], d6);
	couple(b, kind, 6, d6, step);
	x[6] += lanes_where(open, d6);
	lanes spin = d6 * b->diag[6] * b->radius;
	return lanes_max(largest, spin * spin);
}

// Sweeps a block until it is solved, up to the iteration's number of sweeps. Ends sooner if the block changes so much
// that another iteration will follow. An isolated lane has no later iteration to correct a residual, so it is solved to
// the end. alone: there is such a lane. Sets the number of sweeps, and the isolated lanes that are solved.
PER_KIND void solve_block(ob_batch *b, ob_batch_kind kind, bool alone, const ob_solver_iteration *iteration,
			  patch_search *f, lanes *x, const lanes *r)
{
	const bool patches = alone && in_use(kind, OB_ROW_TWIST);
	lanes step[OB_ROWS];
	for (int i = 0; i < OB_ROWS; i++)
		if (in_use(kind, i))
			step[i] = -(r[i] * b->inv_diag[i]);
	const lane_mask isolated = lanes_mask(b->isolated);
	const double converged = square(iteration->converged), tolerable = square(iteration->block_tolerance),
		     coarse = square(iteration->wake_threshold);
	lane_mask open = lanes_mask(b->live);
	int s = 1;
	for (; s <= max_block_sweeps && lanes_bits(open); s++) {
		lanes moving = sweep_block(b, kind, patches, open, f, x, step);
		open &= (moving > converged) & (isolated | (moving > tolerable));
		if (s >= iteration->block_sweeps)
			open &= isolated;
		else if (s >= coarse_block_sweeps)
			open &= isolated | (moving <= coarse);
	}
	b->sweeps = (unsigned)s - 1;
	b->solved = lanes_bits(isolated & ~open);
}

// Applies the impulses of lane l to one of its bodies: the sums of apply, in their order.
static void apply_impulses_of(const ob_batch *b, int l, bool a, const lanes *d, ob_body_row *rows)
{
	const double sign = a ? 1 : -1, inv_mass = sign * lanes_get(a ? &b->ima : &b->imb, l);
	const lanes(*j)[3] = a ? b->ja : b->jb;
	const lanes *f1 = a ? b->fa1 : b->fb1, *f2 = a ? b->fa2 : b->fb2, *inertia = a ? b->ia : b->ib;
	double *row = rows[a ? b->body_a[l] : b->body_b[l]];
	double x[OB_ROWS], turn[3], k[6];
	for (int i = 0; i < OB_ROWS; i++)
		x[i] = lanes_get(&d[i], l);
	for (int i = 0; i < 6; i++)
		k[i] = sign * lanes_get(&inertia[i], l);
	const double sum = x[0] + x[1] + x[2] + x[3];
	for (int c = 0; c < 3; c++) {
		const double n = lanes_get(&b->n[c], l);
		row[c] += inv_mass * (n * sum + (lanes_get(&b->t1[c], l) * x[4] + lanes_get(&b->t2[c], l) * x[5]));
		turn[c] = lanes_get(&j[0][c], l) * x[0];
		for (int i = 1; i < OB_POINTS; i++)
			turn[c] += lanes_get(&j[i][c], l) * x[i];
		turn[c] += lanes_get(&f1[c], l) * x[4] + lanes_get(&f2[c], l) * x[5];
		turn[c] += n * x[6];
	}
	row[3] += k[0] * turn[0] + k[1] * turn[1] + k[2] * turn[2];
	row[4] += k[1] * turn[0] + k[3] * turn[1] + k[4] * turn[2];
	row[5] += k[2] * turn[0] + k[4] * turn[1] + k[5] * turn[2];
}

// As apply, for bodies that may be in several lanes: adds their changes one by one, in lane order.
static void apply_impulses(const ob_batch *b, const lanes *d, ob_body_row *rows)
{
	if (lanes_count(b->live) == 1) {
		const int l = __builtin_ctz(b->live);
		if (b->ima[l] > 0)
			apply_impulses_of(b, l, true, d, rows);
		if (b->imb[l] > 0)
			apply_impulses_of(b, l, false, d, rows);
		return;
	}
	lanes da[6] = { 0 }, db[6] = { 0 };
	apply(b, OB_KIND_FULL, d, da, db);
	lanes linear[2][OB_LANES], rest[2][OB_LANES];
	transpose_bodies(da, linear[0], rest[0]);
	transpose_bodies(db, linear[1], rest[1]);
	for (int l = 0; l < OB_LANES; l++)
		for (int side = 0; side < 2; side++) {
			double *row = rows[side ? b->body_b[l] : b->body_a[l]];
			lanes_store(row, lanes_load(row) + linear[side][l]);
			lanes_store(row + 4, lanes_load(row + 4) + rest[side][l]);
		}
}

PER_KIND void write_changes(const ob_batch *b, ob_batch_kind kind, bool jacobi, const lanes *d, lanes *va, lanes *vb,
			    ob_body_row *v, ob_body_row *delta)
{
	if (jacobi) {
		apply_impulses(b, d, delta);
		return;
	}
	apply(b, kind, d, va, vb);
	scatter_both(b, v, va, vb);
}

// Sets the velocity at which each gap may close in the substep (contact/bias.h).
PER_KIND void set_bias(ob_batch *b, ob_batch_kind kind, const ob_solver_iteration *iteration, const ob_body_row *v,
		       const ob_body_row *d)
{
	const double h = iteration->h;
	lanes da[6], db[6], moved[4];
	gather_both(b, d, da, db);
	normal_velocities(b, kind, da, db, moved);
	for (int i = 0; i < points_of(kind); i++)
		b->bias[i] = b->gap[i] + moved[i];
	const lane_mask turning = lanes_mask(b->turning);
	const lanes most = lanes_of(iteration->resting_gap);
	lane_mask keeps[4];
	for (int i = 0; i < points_of(kind); i++)
		keeps[i] = bias_keeps(b->impulse[i], b->bias[i], most);
	if (b->elastic) {
		lanes va[6], vb[6], now[4], gained[4];
		gather_both(b, v, va, vb);
		normal_velocities(b, kind, va, vb, now);
		gather_both(b, iteration->dv, va, vb);
		normal_velocities(b, kind, va, vb, gained);
		const lane_mask elastic = lanes_mask(b->elastic);
		for (int i = 0; i < points_of(kind); i++)
			b->bias[i] += lanes_where(elastic, bias_of_fall(b->bias[i], now[i], gained[i], h));
	}
	for (int i = 0; i < points_of(kind); i++)
		b->bias[i] = bias_of(b->bias[i], keeps[i], h) + lanes_where(turning, b->turn[i]);
	const unsigned alone = b->isolated & ~b->hit;
	if (!alone)
		return;
	lanes va[6], vb[6], now[4];
	gather_both(b, v, va, vb);
	normal_velocities(b, kind, va, vb, now);
	for (int i = 0; i < points_of(kind); i++)
		b->bias[i] = lanes_select(lanes_mask(alone), bias_alone(b->bias[i], now[i]), b->bias[i]);
}

// Square of the largest change of a row's velocity (m/s), as if each impulse acted alone.
PER_KIND lanes largest_change(const ob_batch *b, ob_batch_kind kind, const lanes *change)
{
	lanes most = lanes_of(0);
	for (int i = 0; i < points_of(kind); i++)
		most = lanes_max(most, lanes_abs(change[i]) * b->diag[i]);
	most *= most;
	if (in_use(kind, OB_ROW_FRICTION))
		most = lanes_max(most, square_of_slip(b, change[4], change[5]));
	if (in_use(kind, OB_ROW_TWIST)) {
		lanes spin = change[6] * b->diag[6] * b->radius;
		most = lanes_max(most, spin * spin);
	}
	return most;
}

PER_KIND void solve_kind(ob_batch *b, ob_batch_kind kind, const ob_solver_iteration *iteration, ob_body_row *u,
			 const ob_body_row *v, const ob_body_row *d, ob_body_row *delta)
{
	lanes va[6], vb[6], r[OB_ROWS], x[OB_ROWS], change[OB_ROWS], jump[OB_ROWS];
	gather_both(b, u, va, vb);
	if (iteration->first) {
		set_bias(b, kind, iteration, v, d);
		memcpy(b->impulse_start, b->impulse, sizeof b->impulse);
		b->impact = 0;
	}
	normal_velocities(b, kind, va, vb, r);
	friction_velocities(b, kind, va, vb, r);
	if (b->turning)
		for (int i = OB_POINTS; i < OB_ROWS; i++)
			if (in_use(kind, i))
				r[i] += (lanes)(lanes_mask(b->turning) & (lane_mask)b->turn[i]);
	for (int i = 0; i < points_of(kind); i++) {
		if (iteration->first)
			b->impact |= lanes_bits((r[i] < -iteration->impact_threshold) & (r[i] + b->bias[i] < 0));
		r[i] += b->bias[i];
	}
	memcpy(x, b->impulse, sizeof x);
	b->slides = 0;
	if (in_use(kind, OB_ROW_TWIST) && b->follows)
		check_follows(b, r, x);
	if (b->isolated) {
		patch_search friction = { .v = v, .model = &b->model };
		b->model.known =
			iteration->first ? 0 : b->model.known; // made once in a substep; again if the slip turns
		solve_block(b, kind, true, iteration, &friction, x, r);
		b->slides = friction.slides & b->live;
	} else {
		solve_block(b, kind, false, iteration, NULL, x, r);
	}
	b->slides |= b->follows;
	for (int i = 0; i < OB_ROWS; i++) {
		change[i] = lanes_of(0);
		if (!in_use(kind, i))
			continue;
		change[i] = x[i] - b->impulse[i];
		b->impulse[i] = x[i];
	}
	b->solved &= iteration->ghosts ? 0 : ~0u;
	const lanes changed = largest_change(b, kind, change),
		    left = lanes_where(lanes_mask(b->live & ~b->solved), changed);
	b->changed = lanes_largest(changed);
	b->residual = lanes_largest(left);
	b->active = lanes_bits(left > square(iteration->wake_threshold));
	for (int i = 0; i < OB_ROWS; i++)
		if (in_use(kind, i))
			jump[i] = x[i] - b->impulse_start[i];
	b->impact |= lanes_bits(largest_change(b, kind, jump) > square(iteration->impact_threshold));
	b->impact &= b->live;
	write_changes(b, kind, iteration->jacobi, change, va, vb, u, delta);
}

static void solve(ob_batch *b, const ob_solver_iteration *iteration, ob_body_row *u, const ob_body_row *v,
		  const ob_body_row *d, ob_body_row *delta)
{
	switch (b->kind) {
	case OB_KIND_FULL:
		solve_kind(b, OB_KIND_FULL, iteration, u, v, d, delta);
		break;
	case OB_KIND_POINT:
		solve_kind(b, OB_KIND_POINT, iteration, u, v, d, delta);
		break;
	case OB_KIND_FRICTIONLESS:
		solve_kind(b, OB_KIND_FRICTIONLESS, iteration, u, v, d, delta);
		break;
	default:
		solve_kind(b, OB_KIND_FRICTIONLESS_POINT, iteration, u, v, d, delta);
	}
}

static bool project(ob_batch *b, double slop, double beta, bool jacobi, ob_body_row *d, ob_body_row *delta)
{
	lanes da[6], db[6], r[OB_POINTS], x[OB_ROWS] = { 0 };
	lane_mask deep = { 0 };
	gather_both(b, d, da, db);
	const int points = points_of(b->kind);
	normal_velocities(b, b->kind, da, db, r);
	for (int i = 0; i < points; i++) {
		r[i] += b->gap[i] + slop;
		deep |= r[i] < -min_projection * slop;
		r[i] = lanes_select(r[i] < 0, r[i] * beta, r[i]);
	}
	if (!lanes_bits(deep))
		return false;
	if (b->dirty)
		prepare(b);
	for (int i = 0; i < points; i++)
		r[i] = -lanes_where(deep, r[i] * b->inv_diag[i]); // change by each row alone, as in a sweep
	for (int s = 0; s < 4; s++)
		for (int i = 0; i < points; i++) {
			lanes change = push_change(x[i], r[i]);
			x[i] += change;
			for (int j = 0; j < points; j++)
				r[j] -= b->coupling[i][j] * change;
		}
	write_changes(b, OB_KIND_FULL, jacobi, x, da, db, d, delta);
	return true;
}

static void limit_prediction(ob_batch *b, const double *cap_impulse, double cap_velocity)
{
	if (!b->impact)
		return;
	for (int l = 0; l < OB_LANES; l++) {
		if (!(b->impact >> l & 1))
			continue;
		double change[OB_ROWS], share = 1;
		for (int i = 0; i < OB_ROWS; i++)
			change[i] = b->impulse[i][l] - b->impulse_start[i][l];
		for (int i = 0; i < OB_POINTS; i++)
			change[i] = ob_min(change[i], ob_max(cap_impulse[l], cap_velocity / b->diag[i][l]));
		const double slip = __builtin_sqrt(change[4] * change[4] + change[5] * change[5]),
			     most = ob_max(cap_impulse[l], cap_velocity * b->slide_mass[l]), arm = b->radius[l];
		if (slip > most)
			share = most / slip;
		change[4] *= share, change[5] *= share;
		const double twist = ob_max(cap_impulse[l] * arm, cap_velocity / (b->diag[6][l] * arm));
		change[6] = change[6] > twist ? twist : change[6] < -twist ? -twist : change[6];
		for (int i = 0; i < OB_ROWS; i++)
			b->impulse[i][l] = b->impulse_start[i][l] + change[i];
	}
	b->impact = 0;
}

static void row_velocities(const ob_batch *b, const ob_body_row *rows, lanes *r)
{
	lanes xa[6], xb[6];
	gather_both(b, rows, xa, xb);
	normal_velocities(b, OB_KIND_FULL, xa, xb, r);
	friction_velocities(b, OB_KIND_FULL, xa, xb, r);
}

const ob_kernel OB_KERNEL = {
	.set = set_lane,
	.friction_arms = friction_arms,
	.prepare = prepare,
	.find_follows = find_follows,
	.solve = solve,
	.solve_lone = OB_SOLVE_LONE,
	.project = project,
	.limit_prediction = limit_prediction,
	.row_velocities = row_velocities,
	.apply_impulses = apply_impulses,
	.boxes = boxes,
};

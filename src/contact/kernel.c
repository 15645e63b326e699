// The contact solver's arithmetic on a batch. Compiled once for each instruction set under the name OB_KERNEL (see
// meson.build): no lane sees another and nothing is contracted, so the bits are the same.
#include "contact/batch.h"

#include <string.h>

static const double unpredicted_change =
	1e-4; // m/s: a first sweep that changes more was not predicted by warm starting
static const double converged_change = 1e-10; // m/s: a block whose sweep changes less is solved
static const int max_block_sweeps = 64;
static const int coarse_block_sweeps = 2; // of a block that will be solved again in the next iteration
static const double resting_gap = 1e-7; // m: a point that presses keeps its distance from the surface, if that is less
static const double min_projection = .01; // of the slop: shallower penetrations are not pushed, or that would never end

// The rows of a pair depend on its kind alone. Each kind has a kernel of its own, made by the compiler from the same
// text: where "kind" is a constant, what is not in use falls away.
#define PER_KIND static inline __attribute__((always_inline))

PER_KIND int points_of(ob_batch_kind kind)
{
	return kind & OB_KIND_POINT ? 1 : OB_POINTS;
}

PER_KIND bool in_use(ob_batch_kind kind, int row)
{
	bool rough = !(kind & OB_KIND_FRICTIONLESS);
	return row < OB_POINTS ? row < points_of(kind) : row < 6 ? rough : rough && !(kind & OB_KIND_POINT);
}

static inline void sym_mul(const lanes *s, const lanes *x, lanes *o)
{
	o[0] = s[0] * x[0] + s[1] * x[1] + s[2] * x[2];
	o[1] = s[1] * x[0] + s[3] * x[1] + s[4] * x[2];
	o[2] = s[2] * x[0] + s[4] * x[1] + s[5] * x[2];
}

static inline lanes dot3(const lanes *a, const lanes *b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

PER_KIND void prepare_kind(ob_batch *b, ob_batch_kind kind)
{
	const lanes *ja[7] = { b->ja[0], b->ja[1], b->ja[2], b->ja[3], b->fa1, b->fa2, b->n };
	const lanes *jb[7] = { b->jb[0], b->jb[1], b->jb[2], b->jb[3], b->fb1, b->fb2, b->n };
	lanes mass = b->ima * b->ka + b->imb * b->kb, a[OB_ROWS][OB_ROWS];
	for (int i = 0; i < OB_ROWS; i++) {
		lanes xa[3], xb[3];
		if (!in_use(kind, i))
			continue;
		sym_mul(b->ia, ja[i], xa);
		sym_mul(b->ib, jb[i], xb);
		for (int j = 0; j <= i; j++) {
			if (!in_use(kind, j))
				continue;
			lanes s = dot3(xa, ja[j]) * b->ka + dot3(xb, jb[j]) * b->kb;
			if ((i < 4 && j < 4) || (i == j && i < 6))
				s += mass; // the same direction: normals, and each tangent with itself
			a[i][j] = a[j][i] = s;
		}
		b->diag[i] = a[i][i];
		lane_mask used = a[i][i] > 0;
		if (i < OB_POINTS) // a point that is not used has no row
			used &= b->gap[i] < .5 * ob_no_contact;
		b->inv_diag[i] = lanes_select(used, 1 / a[i][i], lanes_of(0));
	}
	for (int i = 0; i < OB_ROWS; i++)
		for (int j = 0; j < OB_ROWS; j++)
			if (in_use(kind, i) && in_use(kind, j))
				b->coupling[i][j] = a[i][j] * b->inv_diag[j];
	b->dirty = 0;
}

static void prepare(ob_batch *b)
{
	if (b->kind == OB_KIND_FULL)
		prepare_kind(b, OB_KIND_FULL);
	else
		prepare_kind(b, b->kind);
}

static inline void gather(const ob_body_row *rows, const uint32_t *index, lanes *o)
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

// From components by body to rows by body: columns 0..3 of the four rows, and columns 4..7.
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

// Body 0 and static bodies may stand in several lanes of one batch: their rows stay zero, whoever writes last.
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
		if (in_use(kind, 4)) {
			p += b->t1[c] * d[4] + b->t2[c] * d[5];
			la[c] += b->fa1[c] * d[4] + b->fa2[c] * d[5];
			lb[c] += b->fb1[c] * d[4] + b->fb2[c] * d[5];
		}
		if (in_use(kind, 6)) {
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

// Normal rows of J (xa, xb): how fast each point's gap opens (m/s)
PER_KIND void normal_velocities(const ob_batch *b, ob_batch_kind kind, const lanes *xa, const lanes *xb, lanes *r)
{
	lanes d[3] = { xa[0] - xb[0], xa[1] - xb[1], xa[2] - xb[2] };
	lanes nd = dot3(b->n, d);
	for (int i = 0; i < points_of(kind); i++)
		r[i] = nd + dot3(b->ja[i], xa + 3) - dot3(b->jb[i], xb + 3);
}

// Rows of friction and twist of J (xa, xb): how fast the contact slides (m/s) and spins (rad/s).
PER_KIND void friction_velocities(const ob_batch *b, ob_batch_kind kind, const lanes *xa, const lanes *xb, lanes *r)
{
	if (in_use(kind, 4)) {
		lanes d[3] = { xa[0] - xb[0], xa[1] - xb[1], xa[2] - xb[2] };
		r[4] = dot3(b->t1, d) + dot3(b->fa1, xa + 3) - dot3(b->fb1, xb + 3);
		r[5] = dot3(b->t2, d) + dot3(b->fa2, xa + 3) - dot3(b->fb2, xb + 3);
	}
	if (in_use(kind, 6)) {
		lanes w[3] = { xa[3] - xb[3], xa[4] - xb[4], xa[5] - xb[5] };
		r[6] = dot3(b->n, w);
	}
}

// Row i's impulse changed by d: what the rows are still short of.
PER_KIND void couple(const ob_batch *b, ob_batch_kind kind, int i, lanes d, lanes *step)
{
	for (int j = 0; j < OB_ROWS; j++)
		if (in_use(kind, j))
			step[j] -= b->coupling[i][j] * d;
}

static inline lanes lanes_where(lane_mask m, lanes x)
{
	return (lanes)(m & (lane_mask)x);
}

// A sweep of projected Gauss-Seidel inside the block: x are impulses, step what each row alone would change of its own
// impulse, -(J v) / A_ii. Kept that way, little stands between one row's change and the next one's: a maximum, a
// product, a difference.
// Lanes that are not open keep their impulses. Returns the largest change of a row's velocity.
PER_KIND lanes sweep_block(const ob_batch *b, ob_batch_kind kind, lane_mask open, lanes *x, lanes *step)
{
	lanes largest = lanes_of(0), sum = lanes_of(0);
	for (int i = 0; i < points_of(kind); i++) {
		lanes d = lanes_max(-x[i], step[i]);
		couple(b, kind, i, d, step);
		x[i] += lanes_where(open, d);
		sum += x[i];
		largest = lanes_max(largest, lanes_abs(d) * b->diag[i]);
	}
	if (!in_use(kind, 4))
		return largest;
	lanes bound = b->mu * sum, d4 = step[4], d5 = step[5];
	lanes f4 = x[4] + d4, f5 = x[5] + d5, l2 = f4 * f4 + f5 * f5;
	lane_mask slips = l2 > bound * bound;
	if (lanes_bits(slips)) { // the root and the quotient take as long as all the rest
		lanes shrink = bound / lanes_sqrt(l2 + 1e-300);
		d4 = lanes_select(slips, f4 * shrink - x[4], d4);
		d5 = lanes_select(slips, f5 * shrink - x[5], d5);
	}
	couple(b, kind, 4, d4, step);
	couple(b, kind, 5, d5, step);
	x[4] += lanes_where(open, d4);
	x[5] += lanes_where(open, d5);
	largest = lanes_max(largest, lanes_abs(d4) * b->diag[4]);
	largest = lanes_max(largest, lanes_abs(d5) * b->diag[5]);
	if (!in_use(kind, 6))
		return largest;
	bound *= b->radius;
	lanes d6 = lanes_max(-bound - x[6], lanes_min(bound - x[6], step[6]));
	couple(b, kind, 6, d6, step);
	x[6] += lanes_where(open, d6);
	return largest;
}

// Sweeps a block until it is solved, up to the iteration's number of sweeps; fewer if it changes so much that another
// iteration will follow. An isolated lane has no later iteration to mend what is left over, so it is solved to the end.
PER_KIND void solve_block(const ob_batch *b, ob_batch_kind kind, const ob_solver_iteration *iteration, lanes *x,
			  const lanes *r)
{
	lanes step[OB_ROWS];
	for (int i = 0; i < OB_ROWS; i++)
		if (in_use(kind, i))
			step[i] = -(r[i] * b->inv_diag[i]);
	lane_mask isolated = lanes_mask(b->isolated), open = lanes_mask(b->live);
	for (int s = 1; s <= max_block_sweeps && lanes_bits(open); s++) {
		lanes moving = sweep_block(b, kind, open, x, step);
		if (s == 1)
			isolated &= moving > unpredicted_change;
		open &= (moving > converged_change) & (isolated | (moving > iteration->block_tolerance));
		if (s >= iteration->block_sweeps)
			open &= isolated;
		else if (s >= coarse_block_sweeps)
			open &= isolated | (moving <= iteration->wake_threshold);
	}
}

// va, vb of apply for rows that may stand in several lanes: their changes are added one by one, in lane order.
static void apply_impulses(const ob_batch *b, const lanes *d, ob_body_row *rows)
{
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

// How far each gap may close in the substep, as a velocity. The points of a resting contact are each where rounding
// left them, and would take turns for ever to close what is left: they stay. Restitution is exact in time, so an
// elastic point must not be stopped early: a body that falls freely closes less than its final velocity says, by half
// of what it gains.
PER_KIND void set_bias(ob_batch *b, ob_batch_kind kind, double h, const lanes *ua, const lanes *ub,
		       const ob_body_row *v, const ob_body_row *d)
{
	lanes da[6], db[6], moved[4];
	gather_both(b, d, da, db);
	normal_velocities(b, kind, da, db, moved);
	for (int i = 0; i < points_of(kind); i++)
		b->bias[i] = b->gap[i] + moved[i];
	for (int i = 0; i < points_of(kind); i++)
		b->bias[i] = lanes_select((b->impulse[i] > 0) & (b->bias[i] < resting_gap), lanes_of(0), b->bias[i]);
	if (b->elastic) {
		lanes va[6], vb[6], before[4], after[4];
		gather_both(b, v, va, vb);
		normal_velocities(b, kind, va, vb, before);
		normal_velocities(b, kind, ua, ub, after);
		for (int i = 0; i < points_of(kind); i++)
			for (int l = 0; l < OB_LANES; l++)
				if (b->elastic >> l & 1)
					b->bias[i][l] += .5 * h * fmax(0, before[i][l] - after[i][l]);
	}
	for (int i = 0; i < points_of(kind); i++)
		b->bias[i] = lanes_max(b->bias[i], lanes_of(0)) / h;
}

PER_KIND void solve_kind(ob_batch *b, ob_batch_kind kind, const ob_solver_iteration *iteration, ob_body_row *u,
			 const ob_body_row *v, const ob_body_row *d, ob_body_row *delta)
{
	lanes va[6], vb[6], r[OB_ROWS], x[OB_ROWS], change[OB_ROWS], big = lanes_of(0), jump = lanes_of(0);
	gather_both(b, u, va, vb);
	if (iteration->first) {
		set_bias(b, kind, iteration->h, va, vb, v, d);
		memcpy(b->impulse_start, b->impulse, sizeof b->impulse);
		b->impact = 0;
	}
	normal_velocities(b, kind, va, vb, r);
	friction_velocities(b, kind, va, vb, r);
	for (int i = 0; i < points_of(kind); i++) {
		if (iteration->first)
			b->impact |= lanes_bits((r[i] < -iteration->impact_threshold) & (r[i] + b->bias[i] < 0));
		r[i] += b->bias[i];
	}
	memcpy(x, b->impulse, sizeof x);
	solve_block(b, kind, iteration, x, r);
	for (int i = 0; i < OB_ROWS; i++) {
		change[i] = lanes_of(0);
		if (!in_use(kind, i))
			continue;
		change[i] = x[i] - b->impulse[i];
		b->impulse[i] = x[i];
		if (i < 6) {
			big = lanes_max(big, lanes_abs(change[i]) * b->diag[i]);
			jump = lanes_max(jump, lanes_abs(x[i] - b->impulse_start[i]) * b->diag[i]);
		}
	}
	b->residual = big;
	b->active = lanes_bits(big > iteration->wake_threshold) & b->live;
	b->impact |= lanes_bits(jump > iteration->impact_threshold);
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
	for (int i = 0; i < points; i++)
		r[i] = -lanes_where(deep, r[i] * b->inv_diag[i]); // what each row alone would change, as in a sweep
	for (int s = 0; s < 4; s++)
		for (int i = 0; i < points; i++) {
			lanes change = lanes_max(-x[i], r[i]);
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
		for (int i = 0; i < OB_ROWS; i++) {
			double cap = fmax(cap_impulse[l], cap_velocity / (b->diag[i][l] + 1e-9));
			double x = b->impulse[i][l] - b->impulse_start[i][l];
			if (i == 6)
				cap *= b->radius[l];
			b->impulse[i][l] += x > cap ? cap - x : x < -cap && i > 3 ? -cap - x : 0;
		}
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

const ob_kernel OB_KERNEL = { prepare, solve, project, limit_prediction, row_velocities, apply_impulses };

#include "contact/impact.h"

#include <string.h>

#include "contact/relax.h"

static const double together = 1e-4; // m: points that are nearer than this when the first one hits, hit with it

// One lane's rows as plain numbers.
typedef struct rows {
	double ja[7][6], jb[7][6]; // linear, angular; b's with the opposite sign
	double a[7][7];
	double rate[7]; // J v
	double gap[4], time[4]; // now; s until it closes, infinity if not within the substep
	double goal[4]; // m/s, normal velocity to reach, in terms of the substep's start
	double max_time;
} rows;

static void row_set(rows *r, int i, const lanes *lin, const lanes *ang_a, const lanes *ang_b, int l)
{
	for (int c = 0; c < 3; c++) {
		r->ja[i][c] = lin ? lin[c][l] : 0;
		r->jb[i][c] = -r->ja[i][c];
		r->ja[i][3 + c] = ang_a[c][l];
		r->jb[i][3 + c] = -ang_b[c][l];
	}
}

static double row_dot(const double *j, const double *x)
{
	return j[0] * x[0] + j[1] * x[1] + j[2] * x[2] + j[3] * x[3] + j[4] * x[4] + j[5] * x[5];
}

// M^-1 j, for a body of the lane
static void response(const double *j, double inv_mass, const lanes *inv_inertia, int l, double *o)
{
	double s[6];
	for (int c = 0; c < 6; c++)
		s[c] = inv_inertia[c][l];
	for (int c = 0; c < 3; c++)
		o[c] = inv_mass * j[c];
	o[3] = s[0] * j[3] + s[1] * j[4] + s[2] * j[5];
	o[4] = s[1] * j[3] + s[3] * j[4] + s[4] * j[5];
	o[5] = s[2] * j[3] + s[4] * j[4] + s[5] * j[5];
}

// Points that hit later than the first one are left: what happens to them after the first hit is seen then.
static void leave_later(rows *r)
{
	double first = fmin(fmin(r->time[0], r->time[1]), fmin(r->time[2], r->time[3]));
	r->max_time = 0;
	for (int i = 0; i < 4; i++) {
		if (isinf(r->time[i]))
			continue;
		if ((r->time[i] - first) * (r->goal[i] - r->rate[i]) > together)
			r->time[i] = INFINITY;
		else
			r->max_time = fmax(r->max_time, r->time[i]);
	}
}

static bool rows_init(rows *r, const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at)
{
	const uint32_t ia = b->body_a[l], ib = b->body_b[l];
	bool any = false;
	for (int i = 0; i < 4; i++)
		row_set(r, i, b->n, b->ja[i], b->jb[i], l);
	for (int i = 0; i < 4; i++) {
		r->rate[i] = row_dot(r->ja[i], at->v[ia]) + row_dot(r->jb[i], at->v[ib]);
		r->gap[i] = b->gap[i][l] + row_dot(r->ja[i], at->d[ia]) + row_dot(r->jb[i], at->d[ib]);
		double a = (row_dot(r->ja[i], at->dv[ia]) + row_dot(r->jb[i], at->dv[ib])) / in->h;
		double t = b->inv_diag[i][l] > 0 ? ob_time_of_closing(r->gap[i], r->rate[i], a, in->h) : INFINITY;
		double approach = r->rate[i] + a * t;
		if (!(t <= in->within) || !(approach < -in->threshold)) {
			r->time[i] = INFINITY;
			continue;
		}
		any = true;
		r->time[i] = t;
		r->goal[i] = r->rate[i] - approach;
	}
	if (any)
		leave_later(r);
	return any;
}

double ob_impact_pending(const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at)
{
	rows r;
	if (!rows_init(&r, b, l, in, at))
		return INFINITY;
	return fmin(fmin(r.time[0], r.time[1]), fmin(r.time[2], r.time[3]));
}

static void rows_matrix(rows *r, const ob_batch *b, int l, const ob_impact *in)
{
	for (int i = 0; i < OB_ROWS; i++) {
		double xa[6], xb[6];
		response(r->ja[i], b->ima[l], b->ia, l, xa);
		response(r->jb[i], b->imb[l], b->ib, l, xb);
		for (int j = 0; j < OB_ROWS; j++)
			r->a[i][j] = in->split_a * row_dot(r->ja[j], xa) + in->split_b * row_dot(r->jb[j], xb);
	}
}

static double set_impulse(const rows *r, int i, double next, double *x, double *rate)
{
	return ob_relax_set((const double *)r->a, OB_ROWS, i, next, x, rate);
}

// One sweep over friction, its vector projected on the cone's disc, and the twist.
static double sweep_friction(const rows *r, const ob_batch *b, int l, double *x, double *rate)
{
	double bound = b->mu[l] * (x[0] + x[1] + x[2] + x[3]);
	double change = ob_relax_friction((const double *)r->a, OB_ROWS, 4, bound, x, rate);
	bound *= b->radius[l];
	if (r->a[6][6] > 0)
		change = fmax(change,
			      set_impulse(r, 6, fmax(-bound, fmin(bound, x[6] - rate[6] / r->a[6][6])), x, rate));
	return change;
}

static double sweep_normals(const rows *r, double *x, double *rate)
{
	double change = 0;
	for (int i = 0; i < 4; i++)
		if (!isinf(r->time[i])) {
			double next = fmax(0, x[i] - (rate[i] - r->goal[i]) / r->a[i][i]);
			change = fmax(change, set_impulse(r, i, next, x, rate));
		}
	return change;
}

// Impulses of the points of a set that bring just these to their goals, by elimination; false: the rows of the set
// depend on each other.
static bool solve_set(const rows *r, unsigned set, double *x)
{
	int row[4], n = 0;
	double a[4][5];
	for (int i = 0; i < 4; i++)
		if (set >> i & 1)
			row[n++] = i;
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < n; j++)
			a[i][j] = r->a[row[i]][row[j]];
		a[i][n] = r->goal[row[i]] - r->rate[row[i]];
	}
	for (int k = 0; k < n; k++) { // positive definite: the diagonal serves as pivots
		if (!(a[k][k] > 1e-13 * r->a[row[k]][row[k]]))
			return false;
		for (int i = 0; i < n; i++) {
			double f = i == k ? 0 : a[i][k] / a[k][k];
			for (int j = k; j <= n; j++)
				a[i][j] -= f * a[k][j];
		}
	}
	memset(x, 0, 4 * sizeof *x);
	for (int k = 0; k < n; k++)
		x[row[k]] = a[k][n] / a[k][k];
	return true;
}

// By how much normal impulses miss what they must do (m/s): no pull, no approach left, and none where a point leaves.
static double missing(const rows *r, const double *x)
{
	double most = 0;
	for (int i = 0; i < 4; i++) {
		if (isinf(r->time[i]))
			continue;
		double left = r->rate[i] - r->goal[i];
		for (int j = 0; j < 4; j++)
			left += r->a[i][j] * x[j];
		most = fmax(most, fmax(-left, -x[i] * r->a[i][i]));
		most = fmax(most, x[i] > 0 ? fabs(left) : 0);
	}
	return most;
}

// Points in a row or in one corner share a load that sweeps pass to and fro for long. Without friction there is a
// solution in which the rows of those that carry it are independent: of the few sets of points, the best.
static void solve_normals(const rows *r, double *x)
{
	double least = missing(r, x), y[4];
	for (unsigned set = 1; set < 16; set++) {
		bool hits = true;
		for (int i = 0; i < 4; i++)
			hits &= !(set >> i & 1) || !isinf(r->time[i]);
		if (!hits || !solve_set(r, set, y) || missing(r, y) >= least)
			continue;
		least = missing(r, y);
		for (int i = 0; i < 4; i++)
			x[i] = fmax(0, y[i]);
	}
}

// Where a long lever jams, the sweeps do not settle. Then all impulses shrink until they bring no energy:
// x J v + x A x / 2 <= 0, with the rates of the instant of impact.
static void shrink_to_energy(const rows *r, double *x)
{
	double given = 0, spread = 0;
	for (int i = 0; i < OB_ROWS; i++) {
		double at_impact = i < 4 ? r->rate[i] - r->goal[i] : r->rate[i];
		if (x[i] == 0)
			continue;
		given += x[i] * at_impact;
		for (int j = 0; j < OB_ROWS; j++)
			spread += x[i] * r->a[i][j] * x[j];
	}
	double share = spread > 0 ? fmin(1, -2 * given / spread) : 1;
	for (int i = 0; i < OB_ROWS; i++)
		x[i] *= fmax(0, share);
}

static void set_rates(const rows *r, const double *x, double *rate)
{
	for (int i = 0; i < OB_ROWS; i++) {
		rate[i] = r->rate[i];
		for (int j = 0; j < OB_ROWS; j++)
			rate[i] += r->a[i][j] * x[j];
	}
}

// First the impact without rebound: projected Gauss-Seidel until nothing changes. All impulses times 1 + e then send
// every point off at e times its approach or faster, and cannot gain energy: the plastic solution x obeys
// x (J v + A x) <= 0, so the change (1+e) x J v + (1+e)^2/2 x A x is at most -(1+e)(1-e)/2 x A x. Last, friction finds
// its place under the final normal impulses, which only takes energy.
static void rows_solve(const rows *r, const ob_batch *b, int l, double e, double *x)
{
	double rate[OB_ROWS], largest = 0, change = 1;
	memcpy(rate, r->rate, sizeof rate);
	for (int i = 0; i < OB_ROWS; i++)
		largest = fmax(largest, fabs(rate[i]));
	const double done = 1e-14 * largest; // m/s: what rounding leaves
	for (int s = 0; s < 100 && change > done; s++) {
		change = sweep_normals(r, x, rate);
		change = fmax(change, sweep_friction(r, b, l, x, rate));
	}
	if (change > done && b->mu[l] == 0)
		solve_normals(r, x);
	for (int i = 0; i < OB_ROWS; i++)
		x[i] *= 1 + e;
	set_rates(r, x, rate);
	change = 1;
	for (int s = 0; s < 50 && change > done; s++)
		change = sweep_friction(r, b, l, x, rate);
	shrink_to_energy(r, x);
}

double ob_impact_solve(const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at, ob_body_row *out_v,
		       ob_body_row *out_d)
{
	rows r;
	double x[7] = { 0 };
	if (!rows_init(&r, b, l, in, at))
		return -1;
	row_set(&r, 4, b->t1, b->fa1, b->fb1, l);
	row_set(&r, 5, b->t2, b->fa2, b->fb2, l);
	row_set(&r, 6, NULL, b->n, b->n, l);
	const uint32_t ia = b->body_a[l], ib = b->body_b[l];
	for (int i = 4; i < OB_ROWS; i++)
		r.rate[i] = row_dot(r.ja[i], at->v[ia]) + row_dot(r.jb[i], at->v[ib]);
	rows_matrix(&r, b, l, in);
	rows_solve(&r, b, l, in->e, x);
	double ca[6], cb[6], change_a[6] = { 0 }, change_b[6] = { 0 }, shift_a[6] = { 0 }, shift_b[6] = { 0 };
	for (int i = 0; i < OB_ROWS; i++) {
		double t = i < 4 ? r.time[i] : r.max_time;
		if (x[i] == 0)
			continue;
		response(r.ja[i], b->ima[l], b->ia, l, ca);
		response(r.jb[i], b->imb[l], b->ib, l, cb);
		for (int c = 0; c < 6; c++) {
			change_a[c] += x[i] * ca[c];
			change_b[c] += x[i] * cb[c];
			shift_a[c] -= t * x[i] * ca[c];
			shift_b[c] -= t * x[i] * cb[c];
		}
	}
	for (int c = 0; c < 6; c++) {
		out_v[ia][c] += change_a[c];
		out_v[ib][c] += change_b[c];
		out_d[ia][c] += shift_a[c];
		out_d[ib][c] += shift_b[c];
	}
	return r.max_time;
}

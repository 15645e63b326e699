#include "contact/impact.h"

#include <string.h>

static const double simultaneous = 1e-4; // m: points that are nearer than this when the first one hits, hit with it

// ---- projected Gauss-Seidel on a small dense system: impulses x, and the velocities of all rows that they leave. The
// ---- matrix lies row by row, so many doubles to a row as there are rows.

// Sets one impulse; returns how much that changes its row's velocity (m/s).
static double set_impulse(const double *a, int rows, int i, double next, double *x, double *rate)
{
	double dx = next - x[i];
	x[i] = next;
	for (int j = 0; j < rows; j++)
		rate[j] += a[j * rows + i] * dx;
	return fabs(dx) * a[i * rows + i];
}

// Friction, rows i and i + 1, projected onto the disc of radius bound (N s); returns the larger change (m/s).
static double project_friction(const double *a, int rows, int i, double bound, double *x, double *rate)
{
	double f1 = x[i] - rate[i] / a[i * rows + i], f2 = x[i + 1] - rate[i + 1] / a[(i + 1) * rows + i + 1];
	double l2 = f1 * f1 + f2 * f2, shrink = l2 > bound * bound ? bound / sqrt(l2) : 1;
	double change = set_impulse(a, rows, i, f1 * shrink, x, rate);
	return fmax(change, set_impulse(a, rows, i + 1, f2 * shrink, x, rate));
}

// ---- an impact of a pair

// One lane's rows as plain numbers.
typedef struct pair_rows {
	double ja[7][6], jb[7][6]; // linear, angular; b's with the opposite sign
	double a[7][7];
	double rate[7]; // J v
	double gap[4], time[4]; // now; s until it closes, infinity if not within the substep
	double goal[4]; // m/s, normal velocity to reach, in terms of the substep's start
	double max_time;
} pair_rows;

static void row_set(pair_rows *r, int i, const lanes *lin, const lanes *ang_a, const lanes *ang_b, int l)
{
	for (int c = 0; c < 3; c++) {
		r->ja[i][c] = lin ? lin[c][l] : 0;
		r->jb[i][c] = -r->ja[i][c];
		r->ja[i][3 + c] = ang_a[c][l];
		r->jb[i][3 + c] = -ang_b[c][l];
	}
}

static double dot6(const double *j, const double *x)
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
static void leave_later(pair_rows *r)
{
	double first = fmin(fmin(r->time[0], r->time[1]), fmin(r->time[2], r->time[3]));
	r->max_time = 0;
	for (int i = 0; i < 4; i++) {
		if (isinf(r->time[i]))
			continue;
		if ((r->time[i] - first) * (r->goal[i] - r->rate[i]) > simultaneous)
			r->time[i] = INFINITY;
		else
			r->max_time = fmax(r->max_time, r->time[i]);
	}
}

static bool pair_rows_init(pair_rows *r, const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at)
{
	const uint32_t ia = b->body_a[l], ib = b->body_b[l];
	bool any = false;
	for (int i = 0; i < 4; i++)
		row_set(r, i, b->n, b->ja[i], b->jb[i], l);
	for (int i = 0; i < 4; i++) {
		r->rate[i] = dot6(r->ja[i], at->v[ia]) + dot6(r->jb[i], at->v[ib]);
		r->gap[i] = b->gap[i][l] + dot6(r->ja[i], at->d[ia]) + dot6(r->jb[i], at->d[ib]);
		double a = (dot6(r->ja[i], at->dv[ia]) + dot6(r->jb[i], at->dv[ib])) / in->h;
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

double ob_impact_time(const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at)
{
	pair_rows r;
	if (!pair_rows_init(&r, b, l, in, at))
		return INFINITY;
	return fmin(fmin(r.time[0], r.time[1]), fmin(r.time[2], r.time[3]));
}

static void pair_rows_matrix(pair_rows *r, const ob_batch *b, int l, const ob_impact *in)
{
	for (int i = 0; i < OB_ROWS; i++) {
		double xa[6], xb[6];
		response(r->ja[i], b->ima[l], b->ia, l, xa);
		response(r->jb[i], b->imb[l], b->ib, l, xb);
		for (int j = 0; j < OB_ROWS; j++)
			r->a[i][j] = in->split_a * dot6(r->ja[j], xa) + in->split_b * dot6(r->jb[j], xb);
	}
}

// One sweep over friction, its vector projected on the cone's disc, and the twist.
static double sweep_pair_friction(const pair_rows *r, const ob_batch *b, int l, double *x, double *rate)
{
	double bound = b->mu[l] * (x[0] + x[1] + x[2] + x[3]);
	double change = project_friction((const double *)r->a, OB_ROWS, 4, bound, x, rate);
	bound *= b->radius[l];
	if (r->a[6][6] > 0)
		change = fmax(change, set_impulse((const double *)r->a, OB_ROWS, 6,
						  fmax(-bound, fmin(bound, x[6] - rate[6] / r->a[6][6])), x, rate));
	return change;
}

static double sweep_normals(const pair_rows *r, double *x, double *rate)
{
	double change = 0;
	for (int i = 0; i < 4; i++)
		if (!isinf(r->time[i])) {
			double next = fmax(0, x[i] - (rate[i] - r->goal[i]) / r->a[i][i]);
			change = fmax(change, set_impulse((const double *)r->a, OB_ROWS, i, next, x, rate));
		}
	return change;
}

// Impulses of the points of a set that bring just these to their goals, by elimination; false: the rows of the set
// depend on each other.
static bool solve_set(const pair_rows *r, unsigned set, double *x)
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
static double normal_error(const pair_rows *r, const double *x)
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
static void solve_normals(const pair_rows *r, double *x)
{
	double least = normal_error(r, x), y[4];
	for (unsigned set = 1; set < 16; set++) {
		bool hits = true;
		for (int i = 0; i < 4; i++)
			hits &= !(set >> i & 1) || !isinf(r->time[i]);
		if (!hits || !solve_set(r, set, y) || normal_error(r, y) >= least)
			continue;
		least = normal_error(r, y);
		for (int i = 0; i < 4; i++)
			x[i] = fmax(0, y[i]);
	}
}

// Where a long lever jams, the sweeps do not settle. Then all impulses shrink until they bring no energy:
// x J v + x A x / 2 <= 0, with the rates of the instant of impact.
static void shrink_to_energy(const pair_rows *r, double *x)
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

static void set_rates(const pair_rows *r, const double *x, double *rate)
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
static void pair_rows_solve(const pair_rows *r, const ob_batch *b, int l, double e, double *x)
{
	double rate[OB_ROWS], largest = 0, change = 1;
	memcpy(rate, r->rate, sizeof rate);
	for (int i = 0; i < OB_ROWS; i++)
		largest = fmax(largest, fabs(rate[i]));
	const double done = 1e-14 * largest; // m/s: what rounding leaves
	for (int s = 0; s < 100 && change > done; s++) {
		change = sweep_normals(r, x, rate);
		change = fmax(change, sweep_pair_friction(r, b, l, x, rate));
	}
	if (change > done && b->mu[l] == 0)
		solve_normals(r, x);
	for (int i = 0; i < OB_ROWS; i++)
		x[i] *= 1 + e;
	set_rates(r, x, rate);
	change = 1;
	for (int s = 0; s < 50 && change > done; s++)
		change = sweep_pair_friction(r, b, l, x, rate);
	shrink_to_energy(r, x);
}

double ob_impact_solve(const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at, ob_body_row *out_v,
		       ob_body_row *out_d)
{
	pair_rows r;
	double x[7] = { 0 };
	if (!pair_rows_init(&r, b, l, in, at))
		return -1;
	row_set(&r, 4, b->t1, b->fa1, b->fb1, l);
	row_set(&r, 5, b->t2, b->fa2, b->fb2, l);
	row_set(&r, 6, NULL, b->n, b->n, l);
	const uint32_t ia = b->body_a[l], ib = b->body_b[l];
	for (int i = 4; i < OB_ROWS; i++)
		r.rate[i] = dot6(r.ja[i], at->v[ia]) + dot6(r.jb[i], at->v[ib]);
	pair_rows_matrix(&r, b, l, in);
	pair_rows_solve(&r, b, l, in->e, x);
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

// ---- an impact at a single point

enum { POINT_ROWS = 3 }; // normal, two of friction

typedef struct point_rows {
	ob_vec3 along[POINT_ROWS], about[POINT_ROWS]; // body frame: unit direction, arm x direction
	ob_vec3 turn[POINT_ROWS]; // of about, by the inverse inertia
	double a[POINT_ROWS][POINT_ROWS], rate[POINT_ROWS];
} point_rows;

static void point_rows_init(point_rows *r, const ob_point_impact *in, const ob_mat3 *body, ob_vec3 arm, ob_vec3 normal,
			    const ob_state *s)
{
	ob_vec3 t1, t2, at = ob_rotate_back(body, arm);
	ob_vec3 v = ob_rotate_back(body, s->v), w = ob_rotate_back(body, s->w), j = in->inertia;
	ob_tangents(normal, &t1, &t2);
	ob_vec3 world[POINT_ROWS] = { normal, t1, t2 };
	for (int i = 0; i < POINT_ROWS; i++) {
		ob_vec3 b = r->along[i] = ob_rotate_back(body, world[i]);
		r->about[i] = ob_cross(at, b);
		r->turn[i] = ob_v3(r->about[i].x / j.x, r->about[i].y / j.y, r->about[i].z / j.z);
		r->rate[i] = ob_dot(b, v) + ob_dot(r->about[i], w);
	}
	for (int i = 0; i < POINT_ROWS; i++)
		for (int k = 0; k < POINT_ROWS; k++)
			r->a[i][k] = (i == k ? in->inv_mass : 0) + ob_dot(r->about[i], r->turn[k]);
}

static double sweep_point_friction(const point_rows *r, double mu, double *x, double *rate)
{
	return project_friction((const double *)r->a, POINT_ROWS, 1, mu * x[0], x, rate);
}

// The impulses that would stop the point; true if friction can hold that.
static bool stop_point(const point_rows *r, double mu, double *x)
{
	const double(*a)[POINT_ROWS] = r->a;
	double c0 = a[1][1] * a[2][2] - a[1][2] * a[2][1], c1 = a[1][2] * a[2][0] - a[1][0] * a[2][2];
	double c2 = a[1][0] * a[2][1] - a[1][1] * a[2][0], det = a[0][0] * c0 + a[0][1] * c1 + a[0][2] * c2;
	double b0 = -r->rate[0], b1 = -r->rate[1], b2 = -r->rate[2];
	x[0] = (b0 * c0 + b1 * (a[0][2] * a[2][1] - a[0][1] * a[2][2]) + b2 * (a[0][1] * a[1][2] - a[0][2] * a[1][1])) /
	       det;
	x[1] = (b0 * c1 + b1 * (a[0][0] * a[2][2] - a[0][2] * a[2][0]) + b2 * (a[0][2] * a[1][0] - a[0][0] * a[1][2])) /
	       det;
	x[2] = (b0 * c2 + b1 * (a[0][1] * a[2][0] - a[0][0] * a[2][1]) + b2 * (a[0][0] * a[1][1] - a[0][1] * a[1][0])) /
	       det;
	return x[0] > 0 && x[1] * x[1] + x[2] * x[2] <= mu * mu * x[0] * x[0];
}

// As ob_impact_solve has it: the plastic impact, all of it times 1 + e, friction under the final normal impulse, and no
// more than brings no energy.
static void solve_point(const point_rows *r, double mu, double e, double *x)
{
	double rate[POINT_ROWS], change = 1, largest = fmax(fabs(r->rate[0]), fmax(fabs(r->rate[1]), fabs(r->rate[2])));
	const double done = 1e-14 * largest; // m/s: what rounding leaves
	if (mu == 0 || !stop_point(r, mu, x)) {
		x[0] = x[1] = x[2] = 0;
		for (int i = 0; i < POINT_ROWS; i++)
			rate[i] = r->rate[i];
		for (int s = 0; s < 100 && change > done; s++) {
			change = set_impulse((const double *)r->a, POINT_ROWS, 0, fmax(0, x[0] - rate[0] / r->a[0][0]),
					     x, rate);
			if (mu > 0)
				change = fmax(change, sweep_point_friction(r, mu, x, rate));
		}
	}
	for (int i = 0; i < POINT_ROWS; i++)
		x[i] *= 1 + e;
	for (int i = 0; i < POINT_ROWS; i++)
		rate[i] = r->rate[i] + r->a[i][0] * x[0] + r->a[i][1] * x[1] + r->a[i][2] * x[2];
	change = mu > 0 ? 1 : 0;
	for (int s = 0; s < 50 && change > done; s++)
		change = sweep_point_friction(r, mu, x, rate);
	double given = 0, spread = 0;
	for (int i = 0; i < POINT_ROWS; i++) {
		given += x[i] * r->rate[i];
		for (int k = 0; k < POINT_ROWS; k++)
			spread += x[i] * r->a[i][k] * x[k];
	}
	double share = spread > 0 ? fmin(1, -2 * given / spread) : 1;
	for (int i = 0; i < POINT_ROWS; i++)
		x[i] *= fmax(0, share);
}

void ob_point_impact_solve(const ob_point_impact *in, ob_vec3 arm, ob_vec3 normal, ob_state *s)
{
	point_rows r;
	double x[POINT_ROWS];
	bool isotropic = in->inertia.x == in->inertia.y && in->inertia.y == in->inertia.z; // any axes do
	ob_mat3 body = ob_quat_matrix(isotropic ? ob_quat_identity() : s->pose.q);
	point_rows_init(&r, in, &body, arm, normal, s);
	solve_point(&r, in->friction, in->restitution, x);
	ob_vec3 push = ob_v3(0, 0, 0), turn = ob_v3(0, 0, 0);
	for (int i = 0; i < POINT_ROWS; i++) {
		push = ob_madd(push, x[i], r.along[i]);
		turn = ob_madd(turn, x[i], r.turn[i]);
	}
	s->v = ob_madd(s->v, in->inv_mass, ob_rotate(&body, push));
	s->w = ob_add(s->w, ob_rotate(&body, turn));
}

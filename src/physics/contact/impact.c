#include "contact/impact.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "elementary/real.h"

#include "contact/friction.h" // for one number

enum {
	MAX_DENSE_ROWS = 3 * OB_IMPACT_MOST_POINTS, // maximum for Newton's method
	MAX_CYCLES = 3, // attempts by Newton's method
	CYCLE_ITERATIONS = 60, // iterations before the second attempt; three times as many before the third
	MAX_NEWTON_STEPS = 10,
	MAX_ITERATIONS = 4000, // iterations of a set that is too large for Newton's method
	WORK_OF_POINT = 4, // units of work for a point in an iteration
	ELIMINATED_PER_WORK = 32, // n^3 per unit of work, for an elimination of n rows
};

static const double exact = 2e-15; // relative to the largest velocity: error that rounding leaves
static const double stalled = 1e-12; // relative to the largest velocity: residual of a solution that cannot be improved
static const double same_residual = 1e-9; // relative to a residual: one this near to an earlier one means a cycle
static const double proximity = 1e-7; // relative to a row's own coefficient: keeps dependent rows solvable

// Rows of a point: the normal, two tangents.
typedef struct point_rows {
	uint32_t a, b;
	ob_vec3 along[3]; // unit
	ob_vec3 about_a[3], about_b[3]; // m: arm x along
	ob_vec3 turn_a[3], turn_b[3]; // about, times the inverse inertia
	double mass_a, mass_b; // inverse masses
	double before[3]; // J v before the impact, m/s
	double mu, e;
	double rate; // kg: factor from a velocity to an impulse in an iteration, small enough to converge
} point_rows;

// Set of points that are solved together.
typedef struct impact_set {
	uint32_t bodies, points;
	int dims; // rows of a point: 3, or 1 without friction
	point_rows *point;
	ob_impact_change *change; // [bodies]
	double largest; // m/s: largest velocity of the points
	double share; // factor of e: 1, or 0 for the plastic impact
	const ob_impact_links *links; // NULL: no joints
	double *response; // [rows][rows]: J P M^-1 J', with the joints' share P; NULL: too many points for Newton's method
	const ob_impact_payer *payer; // NULL: no budget
} impact_set;

static ob_vec3 times(const double *s, ob_vec3 x)
{
	return ob_v3(s[0] * x.x + s[1] * x.y + s[2] * x.z, s[1] * x.x + s[3] * x.y + s[4] * x.z,
		     s[2] * x.x + s[4] * x.y + s[5] * x.z);
}

void ob_inverse_inertia(ob_vec3 inertia, const ob_mat3 *r, double *out)
{
	const ob_vec3 k = ob_v3(1 / inertia.x, 1 / inertia.y, 1 / inertia.z);
	if (inertia.x == inertia.y && inertia.y == inertia.z) {
		memcpy(out, (double[6]){ k.x, 0, 0, k.x, 0, k.x }, 6 * sizeof *out);
		return;
	}
	int c = 0;
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++)
			out[c++] = r->m[i][0] * r->m[j][0] * k.x + r->m[i][1] * r->m[j][1] * k.y +
				   r->m[i][2] * r->m[j][2] * k.z;
}

static ob_vec3 relative_velocity(const ob_impact_body *body, const ob_impact_point *p)
{
	const ob_impact_body *a = &body[p->a], *b = &body[p->b];
	return ob_sub(ob_add(a->v, ob_cross(a->w, p->arm_a)), ob_add(b->v, ob_cross(b->w, p->arm_b)));
}

double ob_impact_opening(const ob_impact_body *body, const ob_impact_point *p)
{
	return ob_dot(p->normal, relative_velocity(body, p));
}

double ob_impact_approach(const ob_impact_body *body, const ob_impact_point *point, uint32_t points)
{
	double most = 0;
	for (uint32_t k = 0; k < points; k++)
		most = ob_max(most, -ob_impact_opening(body, &point[k]));
	return most;
}

static void point_rows_init(point_rows *r, const ob_impact_body *body, const ob_impact_point *p)
{
	const ob_impact_body *a = &body[p->a], *b = &body[p->b];
	const ob_vec3 v = relative_velocity(body, p);
	*r = (point_rows){ .a = p->a, .b = p->b, .mass_a = a->inv_mass, .mass_b = b->inv_mass, .mu = p->mu, .e = p->e };
	r->along[0] = p->normal;
	ob_tangents(p->normal, &r->along[1], &r->along[2]);
	for (int i = 0; i < 3; i++) {
		if (a->inv_mass > 0) {
			r->about_a[i] = ob_cross(p->arm_a, r->along[i]);
			r->turn_a[i] = times(a->inv_inertia, r->about_a[i]);
		}
		if (b->inv_mass > 0) {
			r->about_b[i] = ob_cross(p->arm_b, r->along[i]);
			r->turn_b[i] = times(b->inv_inertia, r->about_b[i]);
		}
		r->before[i] = ob_dot(r->along[i], v);
	}
}

// Sets the rates. A body with k points counts as a k-th of itself in each, so that no iteration overshoots (mass
// splitting: Tonge et al. 2012).
static void set_rates(impact_set *s, uint32_t *count)
{
	memset(count, 0, s->bodies * sizeof *count);
	for (uint32_t k = 0; k < s->points; k++)
		count[s->point[k].a]++, count[s->point[k].b]++;
	for (uint32_t k = 0; k < s->points; k++) {
		point_rows *r = &s->point[k];
		double a = 0, b = 0;
		for (int i = 0; i < s->dims; i++) {
			a += r->mass_a + ob_dot(r->about_a[i], r->turn_a[i]);
			b += r->mass_b + ob_dot(r->about_b[i], r->turn_b[i]);
		}
		r->rate = 1 / (a * count[r->a] + b * count[r->b]);
	}
}

static void add_changes(const impact_set *s, const double *x)
{
	memset(s->change, 0, s->bodies * sizeof *s->change);
	for (uint32_t k = 0; k < s->points; k++) {
		const point_rows *r = &s->point[k];
		ob_impact_change *a = &s->change[r->a], *b = &s->change[r->b];
		for (int i = 0; i < s->dims; i++) {
			const double xi = x[k * (uint32_t)s->dims + (uint32_t)i];
			if (r->mass_a > 0) {
				a->v = ob_madd(a->v, r->mass_a * xi, r->along[i]);
				a->w = ob_madd(a->w, xi, r->turn_a[i]);
			}
			if (r->mass_b > 0) {
				b->v = ob_madd(b->v, -r->mass_b * xi, r->along[i]);
				b->w = ob_madd(b->w, -xi, r->turn_b[i]);
			}
		}
	}
	if (s->links)
		s->links->share(s->links->with, s->change);
}

// Velocity of a row that has begun at "before", by the changes of the bodies' velocities.
static double velocity_of(const impact_set *s, uint32_t row, double before)
{
	const uint32_t dims = (uint32_t)s->dims, i = row % dims;
	const point_rows *r = &s->point[row / dims];
	const ob_impact_change *a = &s->change[r->a], *b = &s->change[r->b];
	return before + ob_dot(r->along[i], ob_sub(a->v, b->v)) + ob_dot(r->about_a[i], a->w) -
	       ob_dot(r->about_b[i], b->w);
}

// Velocity of a row that has begun at "before", by impulses x, from the responses to them.
static double answer_of(const impact_set *s, uint32_t row, double before, const double *x)
{
	const uint32_t rows = s->points * (uint32_t)s->dims;
	for (uint32_t j = 0; j < rows; j++)
		before += s->response[row * rows + j] * x[j];
	return before;
}

// Velocity of row i of r by a unit impulse of row j of q, without joints.
static double coupling(const point_rows *r, int i, const point_rows *q, int j)
{
	const double along = ob_dot(r->along[i], q->along[j]);
	double sum = 0;
	if (r->a == q->a)
		sum += r->mass_a * along + ob_dot(r->about_a[i], q->turn_a[j]);
	if (r->b == q->b)
		sum += r->mass_b * along + ob_dot(r->about_b[i], q->turn_b[j]);
	if (r->a == q->b)
		sum -= r->mass_a * along + ob_dot(r->about_a[i], q->turn_b[j]);
	if (r->b == q->a)
		sum -= r->mass_b * along + ob_dot(r->about_b[i], q->turn_a[j]);
	return sum;
}

// Finds the response of all rows to each other; with joints a column by a unit impulse.
static void find_response(impact_set *s, double *x)
{
	const uint32_t dims = (uint32_t)s->dims, rows = s->points * dims;
	double *a = s->response;
	for (uint32_t i = 0; !s->links && i < rows; i++)
		for (uint32_t j = 0; j <= i; j++)
			a[i * rows + j] = a[j * rows + i] =
				coupling(&s->point[i / dims], (int)(i % dims), &s->point[j / dims], (int)(j % dims));
	memset(x, 0, rows * sizeof *x);
	for (uint32_t j = 0; s->links && j < rows; j++) {
		x[j] = 1;
		add_changes(s, x);
		x[j] = 0;
		for (uint32_t i = 0; i < rows; i++)
			a[i * rows + j] = velocity_of(s, i, 0);
	}
}

// Computes the velocities u of all rows with the impulses x. A normal row has the excess over the law: 0 if the point
// leaves at exactly -e times its approach.
static void find_velocities(const impact_set *s, const double *x, double *u)
{
	const uint32_t dims = (uint32_t)s->dims;
	// With joints impulses that share a load cancel each other in its sums.
	const bool by_response = s->response && (s->links || s->points == 1);
	if (!by_response)
		add_changes(s, x);
	for (uint32_t i = 0; i < s->points * dims; i++) {
		const point_rows *r = &s->point[i / dims];
		const double before = r->before[i % dims];
		u[i] = by_response ? answer_of(s, i, before, x) : velocity_of(s, i, before);
		if (i % dims == 0)
			u[i] += s->share * r->e * before;
	}
}

// Impulses of a point after an iteration at the velocities u: projected onto its cone.
typedef struct projection {
	double x[3];
	double z[2], length; // friction before it is bounded, and its length
	double bound;
} projection;

static projection project(const impact_set *s, const point_rows *r, const double *x, const double *u)
{
	projection p = { { ob_max(0, x[0] - r->rate * u[0]), 0, 0 }, { 0, 0 }, 0, 0 };
	if (s->dims == 1)
		return p;
	p.bound = r->mu * p.x[0];
	p.z[0] = x[1] - r->rate * u[1], p.z[1] = x[2] - r->rate * u[2];
	const double length2 = p.z[0] * p.z[0] + p.z[1] * p.z[1], share = disc_share(p.bound, length2);
	p.length = sqrt(length2);
	p.x[1] = share * p.z[0], p.x[2] = share * p.z[1];
	return p;
}

// Largest change that an iteration would make, as a velocity (m/s).
static double residual(const impact_set *s, const double *x, const double *u)
{
	double most = 0;
	for (uint32_t k = 0; k < s->points; k++) {
		const uint32_t at = k * (uint32_t)s->dims;
		projection p = project(s, &s->point[k], x + at, u + at);
		for (int i = 0; i < s->dims; i++)
			most = ob_max(most, fabs(p.x[i] - x[at + (uint32_t)i]) / s->point[k].rate);
	}
	return most;
}

// Pays for n iterations and an elimination of so many rows. Returns true if the budget is spent.
static bool pay(const impact_set *s, uint64_t iterations, uint64_t rows)
{
	const uint64_t work = WORK_OF_POINT * s->points * iterations + rows * rows * rows / ELIMINATED_PER_WORK;
	return s->payer && s->payer->is_over(s->payer->with, work);
}

// Repeats iterations of all points at once.
static void iterate(const impact_set *s, int iterations, double *x, double *u)
{
	double most = INFINITY;
	for (int n = 0; n < iterations && most > exact * s->largest && !pay(s, 1, 0); n++) {
		find_velocities(s, x, u);
		most = 0;
		for (uint32_t k = 0; k < s->points; k++) {
			const uint32_t at = k * (uint32_t)s->dims;
			projection p = project(s, &s->point[k], x + at, u + at);
			for (int i = 0; i < s->dims; i++) {
				most = ob_max(most, fabs(p.x[i] - x[at + (uint32_t)i]) / s->point[k].rate);
				x[at + (uint32_t)i] = p.x[i];
			}
		}
	}
}

// ---- Newton's method on the projections (Alart and Curnier 1991)

typedef struct newton_system {
	int n;
	const double *a; // [n][n]: the response
	double m[MAX_DENSE_ROWS][MAX_DENSE_ROWS], step[MAX_DENSE_ROWS];
	int open[MAX_DENSE_ROWS], opens; // rows of points under load; the other points' impulses go to zero
} newton_system;

// Eliminates the first n rows and columns with row pivots. Returns false if they are singular.
static bool eliminate(newton_system *y, int n)
{
	for (int k = 0; k < n; k++) {
		int pivot = k;
		for (int i = k + 1; i < n; i++)
			if (fabs(y->m[i][k]) > fabs(y->m[pivot][k]))
				pivot = i;
		if (!(fabs(y->m[pivot][k]) > 0))
			return false;
		for (int j = k; j < n && pivot != k; j++) {
			double t = y->m[k][j];
			y->m[k][j] = y->m[pivot][j], y->m[pivot][j] = t;
		}
		double t = y->step[k];
		y->step[k] = y->step[pivot], y->step[pivot] = t;
		for (int i = k + 1; i < n; i++) {
			double f = y->m[i][k] / y->m[k][k];
			if (f == 0)
				continue;
			for (int j = k + 1; j < n; j++)
				y->m[i][j] -= f * y->m[k][j];
			y->step[i] -= f * y->step[k];
		}
	}
	for (int i = n - 1; i >= 0; i--) {
		for (int j = i + 1; j < n; j++)
			y->step[i] -= y->m[i][j] * y->step[j];
		y->step[i] /= y->m[i][i];
	}
	return true;
}

// Makes row "row" reach zero velocity.
static void put_stop(newton_system *y, int row, double u)
{
	memcpy(y->m[row], y->a + row * y->n, (unsigned)y->n * sizeof **y->m);
	y->m[row][row] += proximity * y->m[row][row];
	y->step[row] = -u;
}

// Makes "row" and the next row obey friction of magnitude mu x against z, which turns with the sliding velocity.
static void put_sliding(newton_system *y, int row, const point_rows *r, const projection *p, const double *x)
{
	const double k = p->bound / p->length, d[2] = { p->z[0] / p->length, p->z[1] / p->length };
	for (int i = 0; i < 2; i++) {
		double *m = y->m[row + i];
		memset(m, 0, (unsigned)y->n * sizeof *m);
		for (int c = 0; c < 2; c++) {
			const double across = k * ((i == c) - d[i] * d[c]);
			for (int j = 0; j < y->n; j++)
				m[j] += across * r->rate * y->a[(row + c) * y->n + j];
			m[row + c] += (i == c) - across;
		}
		for (int j = 0; j < y->n; j++) // the bound is that of the normal impulse after the step
			m[j] += r->mu * d[i] * r->rate * y->a[(row - 1) * y->n + j];
		m[row - 1] -= r->mu * d[i];
		y->step[row + i] = p->x[1 + i] - x[1 + i];
	}
}

// Eliminates open rows and columns alone: the steps of the others are known.
static bool eliminate_open(newton_system *y, const double *x)
{
	double others[MAX_DENSE_ROWS];
	bool is_open[MAX_DENSE_ROWS];
	if (y->opens == y->n)
		return eliminate(y, y->n);
	memset(is_open, 0, (unsigned)y->n * sizeof *is_open);
	for (int k = 0; k < y->opens; k++)
		is_open[y->open[k]] = true;
	for (int i = 0; i < y->n; i++)
		others[i] = is_open[i] ? 0 : -x[i];
	for (int k = 0; k < y->opens; k++) {
		const double *from = y->m[y->open[k]];
		double right = y->step[y->open[k]];
		for (int j = 0; j < y->n; j++)
			right -= from[j] * others[j];
		for (int j = 0; j < y->opens; j++)
			y->m[k][j] = from[y->open[j]];
		y->step[k] = right;
	}
	if (!eliminate(y, y->opens))
		return false;
	for (int i = y->n - 1, k = y->opens; i >= 0; i--)
		y->step[i] = is_open[i] ? y->step[--k] : others[i];
	return true;
}

static bool newton_step(const impact_set *s, newton_system *y, const double *x, const double *u)
{
	y->opens = 0;
	for (uint32_t k = 0; k < s->points; k++) {
		const point_rows *r = &s->point[k];
		const int row = (int)k * s->dims;
		projection p = project(s, r, x + row, u + row);
		if (!(p.x[0] > 0))
			continue;
		put_stop(y, row, u[row]);
		for (int i = 0; i < (p.bound > 0 ? 3 : 1); i++)
			y->open[y->opens++] = row + i;
		if (p.bound > 0 && p.length <= p.bound) {
			put_stop(y, row + 1, u[row + 1]);
			put_stop(y, row + 2, u[row + 2]);
		} else if (p.bound > 0) {
			put_sliding(y, row + 1, r, &p, x + row);
		}
	}
	return eliminate_open(y, x);
}

// Runs Newton's method from x; x is also the result. A whole step may lead through worse places to the solution, as it
// changes the sets of points under load and of sliding ones. With "downhill", steps are shortened until the residual
// falls. Returns true if solved to rounding; false also as soon as a residual is repeated.
static bool newton(const impact_set *s, newton_system *y, bool downhill, double *x, double *u)
{
	double next[MAX_DENSE_ROWS], seen[MAX_NEWTON_STEPS], then = INFINITY;
	find_velocities(s, x, u);
	double now = residual(s, x, u);
	for (int n = 0; n < MAX_NEWTON_STEPS && now > exact * s->largest; n++) {
		double share = 1;
		if (pay(s, 1, (uint64_t)y->n) || !newton_step(s, y, x, u))
			return false;
		for (int tries = 0; tries < 4; tries++, share *= .5) {
			pay(s, 1, 0);
			for (int i = 0; i < y->n; i++)
				next[i] = x[i] + share * y->step[i];
			find_velocities(s, next, u);
			then = residual(s, next, u);
			if (!downhill || then < now)
				break;
		}
		if (!(then < now) && (downhill || now <= stalled * s->largest))
			break;
		for (int k = 0; k < n; k++)
			if (fabs(then - seen[k]) <= same_residual * then) // it cycles
				return false;
		memcpy(x, next, (unsigned)y->n * sizeof *x);
		seen[n] = now = then;
	}
	return now <= stalled * s->largest;
}

// Alternates iterations and Newton's method. The latter must begin with nearly the right points sliding. If it fails,
// iterations go on from their last result.
static void solve_cycles(const impact_set *s, double *x, double *u)
{
	newton_system *y = ob_allocate(sizeof *y); // larger than the stack of one of many threads
	double start[MAX_DENSE_ROWS];
	bool solved = false;
	y->n = (int)s->points * s->dims;
	y->a = s->response;
	for (int cycle = 0; cycle < MAX_CYCLES && !solved; cycle++) {
		iterate(s, cycle == 0 ? 0 : cycle == 1 ? CYCLE_ITERATIONS : 3 * CYCLE_ITERATIONS, x, u);
		memcpy(start, x, (unsigned)y->n * sizeof *x);
		const int last = cycle + 1 == MAX_CYCLES; // downhill is seldom needed
		for (int downhill = 0; downhill <= last && !solved; downhill++) {
			solved = newton(s, y, downhill, x, u);
			if (!solved)
				memcpy(x, start, (unsigned)y->n * sizeof *x);
		}
	}
	free(y);
}

// Computes the impulses x of the law. share: factor of e.
static void solve_law(const impact_set *s, double share, double *x, double *u)
{
	impact_set set = *s;
	set.share = share;
	if (s->points == 1 && s->dims == 1) { // a quotient
		const point_rows *r = s->point;
		x[0] = ob_max(0, -(1 + share * r->e) * r->before[0] / s->response[0]);
		return;
	}
	memset(x, 0, s->points * (unsigned)s->dims * sizeof *x);
	if (s->response)
		solve_cycles(&set, x, u);
	else
		iterate(&set, MAX_ITERATIONS, x, u);
}

// ---- energy

// Kinetic energy (J) that impulses x add as they change the rows' velocities from u0 to u1.
static double gain(uint32_t rows, const double *x, const double *u0, const double *u1)
{
	double sum = 0;
	for (uint32_t i = 0; i < rows; i++)
		sum += .5 * x[i] * (u0[i] + u1[i]);
	return sum;
}

// Computes the velocities of the rows, without the part of restitution.
static void true_velocities(const impact_set *s, const double *x, double *u)
{
	impact_set set = *s;
	set.share = 0;
	find_velocities(&set, x, u);
}

// Largest share of the way from impulses p to x that gains no energy. The gain is a parabola over the share, <= 0 at 0.
static double share_without_gain(uint32_t rows, const double *p, const double *x, const double *u0, const double *up,
				 const double *ux)
{
	const double c0 = gain(rows, p, u0, up);
	double c1 = 0, c2 = 0;
	for (uint32_t i = 0; i < rows; i++) {
		c1 += .5 * (x[i] - p[i]) * (u0[i] + up[i]) + .5 * p[i] * (ux[i] - up[i]);
		c2 += .5 * (x[i] - p[i]) * (ux[i] - up[i]);
	}
	if (!(c0 < 0) || !(c2 > 0))
		return 0;
	double root = sqrt(c1 * c1 - 4 * c2 * c0);
	return ob_min(1, c1 > 0 ? -2 * c0 / (c1 + root) : (root - c1) / (2 * c2));
}

// Mixes in as much of the plastic impact as makes the gain of energy zero. memory: four numbers per row
static void limit_energy(const impact_set *s, double *x, double *memory)
{
	const uint32_t rows = s->points * (unsigned)s->dims;
	double *u0 = memory, *ux = u0 + rows, *p = ux + rows, *up = p + rows, scale = 0;
	for (uint32_t i = 0; i < rows; i++) {
		u0[i] = s->point[i / (unsigned)s->dims].before[i % (unsigned)s->dims];
		scale += fabs(x[i] * u0[i]);
	}
	true_velocities(s, x, ux);
	if (gain(rows, x, u0, ux) <= 1e-15 * scale)
		return;
	solve_law(s, 0, p, up);
	true_velocities(s, p, up);
	const double share = share_without_gain(rows, p, x, u0, up, ux);
	for (uint32_t i = 0; i < rows; i++)
		x[i] = p[i] + share * (x[i] - p[i]);
	true_velocities(s, x, ux);
	double given = 0, spread = 0; // a long lever that jams has no solution: its impulses shrink
	for (uint32_t i = 0; i < rows; i++) {
		given += x[i] * u0[i];
		spread += x[i] * (ux[i] - u0[i]);
	}
	const double less = spread > 0 ? ob_max(0, ob_min(1, -2 * given / spread)) : 1;
	for (uint32_t i = 0; i < rows; i++)
		x[i] *= less;
}

// ---- an impact

static void gather_points(impact_set *s, const ob_impact_body *body, const ob_impact_point *point, uint32_t points)
{
	s->dims = 1;
	for (uint32_t k = 0; k < points; k++) {
		if (!(ob_impact_opening(body, &point[k]) < 0) && point[k].e > 0)
			continue;
		point_rows *r = &s->point[s->points++];
		point_rows_init(r, body, &point[k]);
		if (r->mu > 0)
			s->dims = 3;
		for (int i = 0; i < 3; i++)
			s->largest = ob_max(s->largest, fabs(r->before[i]));
	}
}

void ob_impact_solve(ob_impact_body *body, uint32_t bodies, const ob_impact_point *point, uint32_t points,
		     const ob_impact_links *links, const ob_impact_payer *payer)
{
	enum { FEW = 8 };
	struct {
		point_rows point[FEW];
		ob_impact_change change[2 * FEW];
		double row[6 * 3 * FEW], response[9 * FEW * FEW];
		uint32_t count[2 * FEW];
	} few;
	const bool many = points > FEW || bodies > 2 * FEW;
	impact_set s = { .bodies = bodies, .point = few.point, .change = few.change, .links = links, .payer = payer };
	double *row = few.row;
	uint32_t *count = few.count;
	if (many) {
		s.point = ob_allocate(points * sizeof *s.point);
		s.change = ob_allocate(bodies * sizeof *s.change);
		row = ob_allocate(6 * 3 * points * sizeof *row);
		count = ob_allocate(bodies * sizeof *count);
	}
	gather_points(&s, body, point, points);
	s.response = !many                              ? few.response
		     : s.points > OB_IMPACT_MOST_POINTS ? NULL
							: ob_allocate(9 * s.points * s.points * sizeof *row);
	if (s.points && !pay(&s, 1, 0)) {
		double *x = row, *u = x + 3 * points;
		if (s.response)
			find_response(&s, x);
		set_rates(&s, count);
		solve_law(&s, 1, x, u);
		limit_energy(&s, x, u);
		add_changes(&s, x);
		for (uint32_t i = 0; i < bodies; i++) {
			body[i].v = ob_add(body[i].v, s.change[i].v);
			body[i].w = ob_add(body[i].w, s.change[i].w);
		}
	}
	if (many) {
		free(s.response);
		free(s.point);
		free(s.change);
		free(row);
		free(count);
	}
}

bool ob_impact_part(ob_impact_body *body, uint32_t bodies, const ob_impact_point *point, uint32_t points,
		    double approach)
{
	enum { REFLECTIONS = 32 }; // maximum at an instant
	const double rounding = 1e-12; // relative to the approach: remaining approach that counts as none
	double left = approach;
	for (int k = 0; k < REFLECTIONS && left > rounding * approach; k++) {
		ob_impact_solve(body, bodies, point, points, NULL, NULL); // few points: no budget
		left = ob_impact_approach(body, point, points);
	}
	return left <= rounding * approach;
}

// ---- a lane of a batch

double ob_impact_time(const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at)
{
	const uint32_t ia = b->body_a[l], ib = b->body_b[l];
	double first = INFINITY;
	for (int i = 0; i < OB_POINTS; i++) {
		if (!ob_batch_has_point(b, l, i) || !(in->points >> i & 1))
			continue;
		double rate = ob_batch_opening(b, (uint32_t)l, (uint32_t)i, at->v[ia], at->v[ib]);
		if (rate > in->gain - in->threshold ||
		    b->gap[i][l] + ob_batch_opening(b, (uint32_t)l, (uint32_t)i, at->d[ia], at->d[ib]) - in->slack >
			    (in->gain - rate) * in->h)
			continue;
		double a = ob_batch_opening(b, (uint32_t)l, (uint32_t)i, at->dv[ia], at->dv[ib]) / in->h;
		const double threshold = in->threshold + in->settling * ob_max(0, -a);
		if (!(rate + ob_min(0, a) * in->h < -threshold))
			continue;
		double gap = b->gap[i][l] + ob_batch_opening(b, (uint32_t)l, (uint32_t)i, at->d[ia], at->d[ib]);
		double t = ob_time_of_closing(gap - in->slack, rate, a, in->h);
		if (t < first && rate + a * t < -threshold)
			first = t;
	}
	return first;
}

#include "contact/rebound.h"

#include "contact/batch.h"
#include "contact/relax.h"

enum { ROWS = 3 }; // normal, two of friction

typedef struct rows {
	ob_vec3 along[ROWS], about[ROWS]; // body frame: unit direction, arm x direction
	ob_vec3 turn[ROWS]; // of about, by the inverse inertia
	double a[ROWS][ROWS], rate[ROWS];
} rows;

static void rows_init(rows *r, const ob_rebound *in, const ob_mat3 *body, ob_vec3 arm, ob_vec3 normal,
		      const ob_state *s)
{
	ob_vec3 t1, t2, at = ob_rotate_back(body, arm);
	ob_vec3 v = ob_rotate_back(body, s->v), w = ob_rotate_back(body, s->w), j = in->inertia;
	ob_tangents(normal, &t1, &t2);
	ob_vec3 world[ROWS] = { normal, t1, t2 };
	for (int i = 0; i < ROWS; i++) {
		ob_vec3 b = r->along[i] = ob_rotate_back(body, world[i]);
		r->about[i] = ob_cross(at, b);
		r->turn[i] = ob_v3(r->about[i].x / j.x, r->about[i].y / j.y, r->about[i].z / j.z);
		r->rate[i] = ob_dot(b, v) + ob_dot(r->about[i], w);
	}
	for (int i = 0; i < ROWS; i++)
		for (int k = 0; k < ROWS; k++)
			r->a[i][k] = (i == k ? in->inv_mass : 0) + ob_dot(r->about[i], r->turn[k]);
}

static double sweep_friction(const rows *r, double mu, double *x, double *rate)
{
	return ob_relax_friction((const double *)r->a, ROWS, 1, mu * x[0], x, rate);
}

// The impulses that would stop the point; true if friction can hold that.
static bool stick(const rows *r, double mu, double *x)
{
	const double(*a)[ROWS] = r->a;
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
static void solve(const rows *r, double mu, double e, double *x)
{
	double rate[ROWS], change = 1, largest = fmax(fabs(r->rate[0]), fmax(fabs(r->rate[1]), fabs(r->rate[2])));
	const double done = 1e-14 * largest; // m/s: what rounding leaves
	if (mu == 0 || !stick(r, mu, x)) {
		x[0] = x[1] = x[2] = 0;
		for (int i = 0; i < ROWS; i++)
			rate[i] = r->rate[i];
		for (int s = 0; s < 100 && change > done; s++) {
			change = ob_relax_set((const double *)r->a, ROWS, 0, fmax(0, x[0] - rate[0] / r->a[0][0]), x,
					      rate);
			if (mu > 0)
				change = fmax(change, sweep_friction(r, mu, x, rate));
		}
	}
	for (int i = 0; i < ROWS; i++)
		x[i] *= 1 + e;
	for (int i = 0; i < ROWS; i++)
		rate[i] = r->rate[i] + r->a[i][0] * x[0] + r->a[i][1] * x[1] + r->a[i][2] * x[2];
	change = mu > 0 ? 1 : 0;
	for (int s = 0; s < 50 && change > done; s++)
		change = sweep_friction(r, mu, x, rate);
	double given = 0, spread = 0;
	for (int i = 0; i < ROWS; i++) {
		given += x[i] * r->rate[i];
		for (int k = 0; k < ROWS; k++)
			spread += x[i] * r->a[i][k] * x[k];
	}
	double share = spread > 0 ? fmin(1, -2 * given / spread) : 1;
	for (int i = 0; i < ROWS; i++)
		x[i] *= fmax(0, share);
}

void ob_rebound_solve(const ob_rebound *in, ob_vec3 arm, ob_vec3 normal, ob_state *s)
{
	rows r;
	double x[ROWS];
	bool round = in->inertia.x == in->inertia.y && in->inertia.y == in->inertia.z; // any axes do
	ob_mat3 body = ob_quat_matrix(round ? ob_quat_identity() : s->pose.q);
	rows_init(&r, in, &body, arm, normal, s);
	solve(&r, in->friction, in->restitution, x);
	ob_vec3 push = ob_v3(0, 0, 0), turn = ob_v3(0, 0, 0);
	for (int i = 0; i < ROWS; i++) {
		push = ob_madd(push, x[i], r.along[i]);
		turn = ob_madd(turn, x[i], r.turn[i]);
	}
	s->v = ob_madd(s->v, in->inv_mass, ob_rotate(&body, push));
	s->w = ob_add(s->w, ob_rotate(&body, turn));
}

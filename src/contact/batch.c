#include "contact/kernel.h"

#include <stddef.h>
#include <string.h>

static void set3(lanes *x, int l, ob_vec3 v)
{
	lanes_put(&x[0], l, v.x);
	lanes_put(&x[1], l, v.y);
	lanes_put(&x[2], l, v.z);
}

void ob_tangents(ob_vec3 n, ob_vec3 *t1, ob_vec3 *t2)
{
	if (fabs(n.z) > .7) {
		double k = 1 / sqrt(n.y * n.y + n.z * n.z);
		*t1 = ob_v3(0, -n.z * k, n.y * k);
	} else {
		double k = 1 / sqrt(n.x * n.x + n.y * n.y);
		*t1 = ob_v3(-n.y * k, n.x * k, 0);
	}
	*t2 = ob_cross(n, *t1);
}

static ob_vec3 middle_of(const ob_vec3 *arm, int points)
{
	ob_vec3 middle = { 0, 0, 0 };
	for (int j = 0; j < points; j++)
		middle = ob_madd(middle, 1. / points, arm[j]);
	return middle;
}

void ob_friction_arms(const ob_vec3 *arm_a, const ob_vec3 *arm_b, const double *gap, int points, ob_vec3 n, ob_vec3 *a,
		      ob_vec3 *b)
{
	const double near = 1e-3; // of the points' distance from their middle
	const ob_vec3 middle_a = middle_of(arm_a, points), middle_b = middle_of(arm_b, points);
	double least = INFINITY, size2 = 0, sum = 0, height_a = 0, height_b = 0;
	for (int j = 0; j < points; j++) {
		least = ob_min(least, gap[j]);
		size2 = ob_max(size2, ob_norm2(ob_sub(arm_a[j], middle_a)));
		size2 = ob_max(size2, ob_norm2(ob_sub(arm_b[j], middle_b))); // whichever body is a
	}
	const double reach = near * sqrt(size2);
	for (int j = 0; j < points; j++) {
		const double above = gap[j] - least, share = above <= 0 ? 1 : above < reach ? 1 - above / reach : 0;
		sum += share;
		height_a += share * ob_dot(n, ob_sub(arm_a[j], middle_a));
		height_b += share * ob_dot(n, ob_sub(arm_b[j], middle_b));
	}
	*a = ob_madd(middle_a, height_a / sum, n);
	*b = ob_madd(middle_b, height_b / sum, n);
}

void ob_batch_init(ob_batch *b, ob_batch_kind kind)
{
	memset(b, 0, offsetof(ob_batch, coupling)); // which is made before it is used
	b->kind = kind;
	for (int i = 0; i < 4; i++)
		b->gap[i] = lanes_of(ob_no_contact);
	b->ka = b->kb = lanes_of(1);
}

void ob_batch_clear(ob_batch *b, int l)
{
	static const ob_vec3 zero;
	static const double none[6];
	ob_batch_lane empty = {
		.normal = { 0, 0, 1 }, .inv_inertia_a = none, .inv_inertia_b = none, .arm_a = &zero, .arm_b = &zero
	};
	ob_batch_set(b, l, &empty);
	b->live &= ~(1u << l);
	for (int i = 0; i < OB_ROWS; i++) {
		lanes_put(&b->impulse[i], l, 0);
		lanes_put(&b->impulse_start[i], l, 0);
	}
}

// ---- the patch

typedef struct vec2 {
	double x, y;
} vec2;

static double cross2(vec2 a, vec2 b)
{
	return a.x * b.y - a.y * b.x;
}

static double length2(vec2 a)
{
	return sqrt(a.x * a.x + a.y * a.y);
}

static vec2 mean2(vec2 a, double f, vec2 b, double g)
{
	return (vec2){ f * a.x + g * b.x, f * a.y + g * b.y };
}

// Half edges of a parallelogram like the four points, which are taken in the order around them: the one that encloses
// most.
static void edges_of_four(const vec2 *p, vec2 *e1, vec2 *e2)
{
	static const int order[3][4] = { { 0, 1, 2, 3 }, { 0, 2, 1, 3 }, { 0, 1, 3, 2 } };
	double most = -1;
	for (int k = 0; k < 3; k++) {
		vec2 a = p[order[k][0]], b = p[order[k][1]], c = p[order[k][2]], d = p[order[k][3]];
		vec2 along = mean2(mean2(b, .25, c, .25), 1, mean2(a, .25, d, .25), -1);
		vec2 across = mean2(mean2(c, .25, d, .25), 1, mean2(a, .25, b, .25), -1);
		if (fabs(cross2(along, across)) > most)
			most = fabs(cross2(along, across)), *e1 = along, *e2 = across;
	}
}

// .. with the second moment of the triangle's area. One edge is along the longest side.
static void edges_of_three(const vec2 *p, vec2 *e1, vec2 *e2)
{
	double longest = -1;
	for (int k = 0; k < 3; k++) {
		vec2 side = mean2(p[(k + 1) % 3], 1, p[(k + 2) % 3], -1);
		double length = length2(side);
		if (length > longest) {
			longest = length;
			*e1 = mean2(side, sqrt(.5) / 2, p[k], 0);
			*e2 = mean2(p[k], sqrt(1.5) / 2, side, 0);
		}
	}
}

// Points in a row make an edge: a parallelogram that is thin.
static void set_thickness(vec2 *e1, vec2 *e2)
{
	const double thinnest = .01;
	double l1 = length2(*e1), l2 = length2(*e2);
	if (l2 > l1) {
		vec2 e = *e1;
		*e1 = *e2, *e2 = e;
		double l = l1;
		l1 = l2, l2 = l;
	}
	if (fabs(cross2(*e1, *e2)) < thinnest * l1 * l1) {
		double along = fabs(e1->x * e2->x + e1->y * e2->y) / l1, longer = (l1 + along) / l1;
		*e1 = mean2(*e1, longer, *e1, 0);
		*e2 = (vec2){ -thinnest * e1->y, thinnest * e1->x };
	}
	if (cross2(*e1, *e2) < 0)
		*e2 = (vec2){ -e2->x, -e2->y };
}

// p: the points, about their mean, along the tangents
static void set_patch(ob_batch *b, int l, const vec2 *p, int points, double disc)
{
	vec2 e1 = { 0, 0 }, e2 = { 0, 0 };
	if (disc > 0)
		e1.x = e2.y = sqrt(.75) * disc; // its second moment
	else if (points == 4)
		edges_of_four(p, &e1, &e2);
	else if (points == 3)
		edges_of_three(p, &e1, &e2);
	else if (points == 2)
		e1 = mean2(p[1], .5, p[0], -.5);
	double size2 = e1.x * e1.x + e1.y * e1.y + e2.x * e2.x + e2.y * e2.y;
	if (size2 > 0)
		set_thickness(&e1, &e2);
	const double inverse = size2 > 0 ? 1 / cross2(e1, e2) : 0;
	for (int j = 0; j < OB_POINTS; j++) {
		lanes_put(&b->patch_s[j], l, j < points ? cross2(p[j], e2) * inverse : 0);
		lanes_put(&b->patch_t[j], l, j < points ? cross2(e1, p[j]) * inverse : 0);
	}
	lanes_put(&b->patch_e1[0], l, e1.x), lanes_put(&b->patch_e1[1], l, e1.y);
	lanes_put(&b->patch_e2[0], l, e2.x), lanes_put(&b->patch_e2[1], l, e2.y);
	lanes_put(&b->disc, l, disc);
}

void ob_batch_set(ob_batch *b, int l, const ob_batch_lane *in)
{
	const ob_vec3 n = in->normal, ca = in->friction_a, cb = in->friction_b;
	ob_vec3 t1, t2;
	ob_tangents(n, &t1, &t2);
	double radius = 0;
	vec2 at[OB_POINTS] = { { 0 } };
	for (int j = 0; j < OB_POINTS; j++) {
		bool used = j < in->points;
		set3(b->ja[j], l, used ? ob_cross(in->arm_a[j], n) : ob_v3(0, 0, 0));
		set3(b->jb[j], l, used ? ob_cross(in->arm_b[j], n) : ob_v3(0, 0, 0));
		lanes_put(&b->gap[j], l, used ? in->gap[j] : ob_no_contact);
		if (used) {
			ob_vec3 from = ob_sub(in->arm_a[j], ca);
			at[j] = (vec2){ ob_dot(from, t1), ob_dot(from, t2) };
			radius += length2(at[j]) / in->points;
		}
	}
	set3(b->n, l, n);
	set3(b->t1, l, t1);
	set3(b->t2, l, t2);
	set3(b->fa1, l, ob_cross(ca, t1));
	set3(b->fa2, l, ob_cross(ca, t2));
	set3(b->fb1, l, ob_cross(cb, t1));
	set3(b->fb2, l, ob_cross(cb, t2));
	for (int c = 0; c < 6; c++) {
		lanes_put(&b->ia[c], l, in->inv_inertia_a[c]);
		lanes_put(&b->ib[c], l, in->inv_inertia_b[c]);
	}
	lanes_put(&b->ima, l, in->inv_mass_a);
	lanes_put(&b->imb, l, in->inv_mass_b);
	lanes_put(&b->mu, l, in->mu);
	lanes_put(&b->radius, l, in->points > 1 ? radius : 0);
	set_patch(b, l, at, in->points, in->points > 1 ? in->disc_radius : 0);
	b->body_a[l] = in->body_a;
	b->body_b[l] = in->body_b;
	b->live |= 1u << l;
	b->model.known &= ~(1u << l);
	b->elastic = in->e > 0 ? b->elastic | 1u << l : b->elastic & ~(1u << l);
	b->dirty = 1;
}

// ---- the arithmetic, by the kernel for this processor

void ob_batch_prepare(ob_batch *b)
{
	if (b->dirty)
		ob_kernel_best()->prepare(b);
}

static unsigned lone_lanes(const ob_batch *b, const ob_solver_iteration *iteration)
{
	unsigned found = 0;
	if (b->kind != OB_KIND_FULL || iteration->jacobi || iteration->ghosts)
		return 0;
	for (unsigned left = b->live & b->isolated; left; left &= left - 1) {
		const int l = __builtin_ctz(left);
		found |= (unsigned)((b->ima[l] > 0) != (b->imb[l] > 0) && !(b->disc[l] > 0)) << l;
	}
	return found;
}

void ob_batch_solve(ob_batch *b, const ob_solver_iteration *iteration, ob_body_row *u, const ob_body_row *v,
		    const ob_body_row *d, ob_body_row *delta)
{
	const ob_kernel *kernel = ob_kernel_best();
	const unsigned live = b->live, isolated = b->isolated, lone = lone_lanes(b, iteration);
	const unsigned impact = iteration->first ? 0 : b->impact & lone;
	b->live &= ~lone, b->isolated &= ~lone;
	b->changed = b->residual = 0;
	b->impact &= iteration->first ? 0 : ~0u;
	b->solved = b->active = b->slides = b->sweeps = 0;
	if (b->live) {
		ob_batch_prepare(b);
		kernel->solve(b, iteration, u, v, d, delta);
	}
	b->live = live, b->isolated = isolated;
	b->impact |= impact;
	for (unsigned left = lone; left; left &= left - 1)
		kernel->solve_lone(b, __builtin_ctz(left), iteration, u, v, d);
}

bool ob_batch_project(ob_batch *b, double slop, double beta, bool jacobi, ob_body_row *d, ob_body_row *delta)
{
	return ob_kernel_best()->project(b, slop, beta, jacobi, d, delta);
}

void ob_batch_limit_prediction(ob_batch *b, const double *cap_impulse, double cap_velocity)
{
	if (b->impact)
		ob_batch_prepare(b);
	ob_kernel_best()->limit_prediction(b, cap_impulse, cap_velocity);
}

void ob_batch_row_velocities(const ob_batch *b, const ob_body_row *rows, lanes *r)
{
	ob_kernel_best()->row_velocities(b, rows, r);
}

void ob_batch_apply_impulses(const ob_batch *b, const lanes *x, ob_body_row *rows)
{
	ob_kernel_best()->apply_impulses(b, x, rows);
}

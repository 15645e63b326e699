// Contact points of a pair side by side: the place where its friction acts, and its lane of a batch. For
// contact/kernel.c.
#ifndef OB_CONTACT_POINTS_H
#define OB_CONTACT_POINTS_H

#include "contact/batch.h"
#include "contact/patch_lanes.h"

// Vectors from one centre to the points.
typedef struct arms {
	lanes x[OB_POINTS]; // x, y, z and the gap of each point; 0 and infinity for an absent one
	ob_vec3 middle;
} arms;

static inline arms arms_to(const ob_vec3 *arm, const double *gap, int points)
{
	const double share = 1. / points;
	lanes sum = { 0 };
	arms out;
	for (int j = 0; j < points; j++) {
		out.x[j] = (lanes){ arm[j].x, arm[j].y, arm[j].z, gap[j] };
		sum += share * out.x[j];
	}
	for (int j = points; j < OB_POINTS; j++)
		out.x[j] = (lanes){ 0, 0, 0, INFINITY };
	lanes_transpose(out.x);
	out.middle = ob_v3(sum[0], sum[1], sum[2]);
	return out;
}

static inline void points_from(const arms *r, ob_vec3 from, lanes *out)
{
	out[0] = r->x[0] - from.x, out[1] = r->x[1] - from.y, out[2] = r->x[2] - from.z;
}

static inline lanes points_along(const lanes *x, ob_vec3 n)
{
	return n.x * x[0] + n.y * x[1] + n.z * x[2];
}

static inline void find_friction(const arms *of_a, const arms *of_b, ob_vec3 n, ob_vec3 *a, ob_vec3 *b)
{
	const double near = 1e-3; // relative to the points' distance from their mean
	const lanes gap = of_a->x[3], above = gap + lanes_largest(-gap);
	lanes xa[3], xb[3];
	points_from(of_a, of_a->middle, xa);
	points_from(of_b, of_b->middle, xb);
	const lanes far = lanes_max(dot3(xa, xa), dot3(xb, xb)); // symmetric in a and b
	const double reach = near * __builtin_sqrt(lanes_largest(lanes_where(gap < INFINITY, far)));
	const lanes share = lanes_select(above <= 0, lanes_of(1), lanes_where(above < reach, 1 - above / reach));
	lanes sum = lanes_of(0), of[OB_POINTS] = { share, share * points_along(xa, n), share * points_along(xb, n) };
	lanes_transpose(of);
	for (int j = 0; j < OB_POINTS; j++)
		sum += of[j];
	*a = ob_madd(of_a->middle, sum[1] / sum[0], n);
	*b = ob_madd(of_b->middle, sum[2] / sum[0], n);
}

static void friction_arms(const ob_vec3 *arm_a, const ob_vec3 *arm_b, const double *gap, int points, ob_vec3 n,
			  ob_vec3 *a, ob_vec3 *b)
{
	const arms of_a = arms_to(arm_a, gap, points), of_b = arms_to(arm_b, gap, points);
	find_friction(&of_a, &of_b, n, a, b);
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
	return __builtin_sqrt(a.x * a.x + a.y * a.y);
}

static vec2 mean2(vec2 a, double f, vec2 b, double g)
{
	return (vec2){ f * a.x + g * b.x, f * a.y + g * b.y };
}

// Half edges of a parallelogram in place of four points, taken in the order around them: the one that encloses the
// largest area. The three orders are computed side by side, the last one twice.
static void edges_of_four(lanes x, lanes y, vec2 *e1, vec2 *e2)
{
	const lanes qx = .25 * x, qy = .25 * y;
	const lanes ax = __builtin_shufflevector(qx, qx, 0, 0, 0, 0), ay = __builtin_shufflevector(qy, qy, 0, 0, 0, 0);
	const lanes bx = __builtin_shufflevector(qx, qx, 1, 2, 1, 1), by = __builtin_shufflevector(qy, qy, 1, 2, 1, 1);
	const lanes cx = __builtin_shufflevector(qx, qx, 2, 1, 3, 3), cy = __builtin_shufflevector(qy, qy, 2, 1, 3, 3);
	const lanes dx = __builtin_shufflevector(qx, qx, 3, 3, 2, 2), dy = __builtin_shufflevector(qy, qy, 3, 3, 2, 2);
	const lanes along_x = (bx + cx) - (ax + dx), along_y = (by + cy) - (ay + dy), across_x = (cx + dx) - (ax + bx),
		    across_y = (cy + dy) - (ay + by);
	const lanes area = lanes_abs(along_x * across_y - along_y * across_x);
	const int best = __builtin_ctz(lanes_bits(area == lanes_largest(area)) | 1u << 3);
	*e1 = (vec2){ along_x[best], along_y[best] };
	*e2 = (vec2){ across_x[best], across_y[best] };
}

// Half edges of a parallelogram with the second moment of the triangle's area; one is along the longest side.
static void edges_of_three(const vec2 *p, vec2 *e1, vec2 *e2)
{
	double longest = -1;
	for (int k = 0; k < 3; k++) {
		vec2 side = mean2(p[(k + 1) % 3], 1, p[(k + 2) % 3], -1);
		double length = length2(side);
		if (length > longest) {
			longest = length;
			*e1 = mean2(side, __builtin_sqrt(.5) / 2, p[k], 0);
			*e2 = mean2(p[k], __builtin_sqrt(1.5) / 2, side, 0);
		}
	}
}

// Makes e1 the longer half edge, and e2 counterclockwise of it. Collinear points get a thin parallelogram.
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

// x, y: points from their mean, along the tangents (m); 0 for an absent one
static void set_patch(ob_batch *b, int l, lanes x, lanes y, int points, double disc)
{
	const vec2 p[OB_POINTS] = { { x[0], y[0] }, { x[1], y[1] }, { x[2], y[2] }, { x[3], y[3] } };
	vec2 e1 = { 0, 0 }, e2 = { 0, 0 };
	if (disc > 0)
		e1.x = e2.y = __builtin_sqrt(.75) * disc; // a square with its second moment
	else if (points == 4)
		edges_of_four(x, y, &e1, &e2);
	else if (points == 3)
		edges_of_three(p, &e1, &e2);
	else if (points == 2)
		e1 = mean2(p[1], .5, p[0], -.5);
	double size2 = e1.x * e1.x + e1.y * e1.y + e2.x * e2.x + e2.y * e2.y;
	if (size2 > 0)
		set_thickness(&e1, &e2);
	const double inverse = size2 > 0 ? 1 / cross2(e1, e2) : 0;
	const lanes s = (x * e2.y - y * e2.x) * inverse, t = (e1.x * y - e1.y * x) * inverse;
	for (int j = 0; j < OB_POINTS; j++) {
		lanes_put(&b->patch_s[j], l, j < points ? s[j] : 0);
		lanes_put(&b->patch_t[j], l, j < points ? t[j] : 0);
	}
	lanes_put(&b->patch_e1[0], l, e1.x), lanes_put(&b->patch_e1[1], l, e1.y);
	lanes_put(&b->patch_e2[0], l, e2.x), lanes_put(&b->patch_e2[1], l, e2.y);
	lanes_put(&b->disc, l, disc);
}

static inline void set3(lanes *x, int l, ob_vec3 v)
{
	lanes_put(&x[0], l, v.x);
	lanes_put(&x[1], l, v.y);
	lanes_put(&x[2], l, v.z);
}

// Angular Jacobians of the normal rows, arm x n; 0 for an absent point
static inline void set_arms(lanes (*rows)[3], int l, const lanes *x, ob_vec3 n, lane_mask used)
{
	const lanes turn[3] = { lanes_where(used, x[1] * n.z - x[2] * n.y), lanes_where(used, x[2] * n.x - x[0] * n.z),
				lanes_where(used, x[0] * n.y - x[1] * n.x) };
	for (int j = 0; j < OB_POINTS; j++)
		for (int c = 0; c < 3; c++)
			lanes_put(&rows[j][c], l, turn[c][j]);
}

static void set_lane(ob_batch *b, int l, const ob_batch_lane *in, ob_vec3 *friction_a, ob_vec3 *friction_b)
{
	const arms of_a = arms_to(in->arm_a, in->gap, in->points), of_b = arms_to(in->arm_b, in->gap, in->points);
	const lane_mask used = of_a.x[3] < INFINITY;
	const lanes gap = lanes_select(used, of_a.x[3], lanes_of(ob_no_contact));
	const ob_vec3 n = in->normal;
	ob_vec3 t1, t2, ca = { 0, 0, 0 }, cb = { 0, 0, 0 };
	lanes from[3];
	const bool leans = in->disc_radius < 0;
	if (leans)
		ca = in->arm_a[0], cb = in->arm_b[0];
	else if (in->points > 0)
		find_friction(&of_a, &of_b, n, &ca, &cb);
	*friction_a = ca, *friction_b = cb;
	ob_tangents(n, &t1, &t2);
	set_arms(b->ja, l, of_a.x, n, used);
	set_arms(b->jb, l, of_b.x, n, used);
	for (int j = 0; j < OB_POINTS; j++)
		lanes_put(&b->gap[j], l, gap[j]);
	points_from(&of_a, ca, from);
	const lanes x = lanes_where(used, points_along(from, t1)), y = lanes_where(used, points_along(from, t2)),
		    far = lanes_sqrt(x * x + y * y) / in->points;
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
	const int points = leans ? 1 : in->points; // of the patch
	lanes_put(&b->radius, l, points > 1 ? far[0] + far[1] + far[2] + far[3] : 0);
	set_patch(b, l, x, y, points, points > 1 ? in->disc_radius : 0);
	b->body_a[l] = in->body_a;
	b->body_b[l] = in->body_b;
	b->live |= 1u << l;
	b->model.known &= ~(1u << l);
	b->areas &= ~(1u << l);
	b->elastic = in->e > 0 ? b->elastic | 1u << l : b->elastic & ~(1u << l);
	b->dirty = 1;
}

#endif

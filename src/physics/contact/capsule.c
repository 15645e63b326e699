// Contacts of capsules with planes, spheres and capsules. A capsule is a segment grown by its radius. The nearest points
// of two segments are in closed form (Ericson 2005, 5.1.9). The separation is the distance itself while the segments are
// apart. One point is at the nearest place. Up to two more are at the ends of the part that runs along the other one.
#include "contact/capsule.h"

#include "contact/pairs.h"

static const double side_by_side = .99; // cosine: directions this near to each other run side by side
static const double crossing =
	1e-9; // relative to the radius: a segment this near to another shape's inside has no direction away from it
static const double redundant = 1e-9; // relative to the line: a point between two others must be deeper by this
static const double same_place = 1e-3; // relative to the radius: points nearer to each other count as one
static double clamp(double x, double limit)
{
	return x < -limit ? -limit : x > limit ? limit : x;
}

static void put(ob_manifold *m, const ob_line_point *p)
{
	m->at[m->points] = p->at;
	m->gap[m->points++] = ob_max(p->gap, m->separation);
}

void ob_manifold_line(const ob_line_point *nearest, const ob_line_point end[2], double margin, ob_manifold *out)
{
	out->points = 0;
	out->separation = nearest->gap;
	if (nearest->gap > margin)
		return;
	bool use[2] = { end[0].there && end[0].gap <= margin, end[1].there && end[1].gap <= margin };
	bool alone = true;
	if (use[0] && use[1]) {
		double share = (nearest->s - end[0].s) / (end[1].s - end[0].s);
		alone = nearest->gap <
			end[0].gap + share * (end[1].gap - end[0].gap) - redundant * fabs(end[1].s - end[0].s);
	}
	if (alone)
		put(out, nearest);
	for (int k = 0; k < 2; k++)
		if (use[k])
			put(out, &end[k]);
}

static ob_vec3 point_on(const ob_placed *c, double s)
{
	return ob_madd(c->p, s, ob_column(&c->r, 2));
}

// Unit vector across u, from the axis of the shape's frame that is most nearly across u: it turns with the shape.
static ob_vec3 across(const ob_placed *x, ob_vec3 u)
{
	ob_vec3 best = { 0, 0, 1 };
	double least = INFINITY;
	for (int i = 0; i < 3; i++) {
		ob_vec3 c = ob_column(&x->r, i);
		double along = fabs(ob_dot(c, u));
		if (along < least)
			least = along, best = ob_madd(c, -ob_dot(c, u), u);
	}
	return ob_scale(best, 1 / ob_norm(best));
}

// ---- plane, sphere

void ob_manifold_capsule_plane(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_vec3 n = ob_column(&b->r, 2), at[2];
	double gap[2];
	for (int k = 0; k < 2; k++) {
		ob_vec3 x = point_on(a, k ? a->size.y : -a->size.y);
		gap[k] = ob_dot(n, ob_sub(x, b->p)) - a->size.x;
		at[k] = ob_madd(x, -(a->size.x + .5 * gap[k]), n);
	}
	int low = gap[1] < gap[0];
	out->normal = n;
	out->separation = gap[low];
	out->points = 0;
	for (int k = 0; k < 2 && gap[low ^ k] <= margin; k++) {
		out->at[k] = at[low ^ k];
		out->gap[k] = gap[low ^ k];
		out->points = k + 1;
	}
}

void ob_manifold_capsule_sphere(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_vec3 u = ob_column(&a->r, 2);
	ob_vec3 x = point_on(a, clamp(ob_dot(u, ob_sub(b->p, a->p)), a->size.y)), d = ob_sub(x, b->p);
	double l = ob_norm(d), gap = l - a->size.x - b->size.x;
	out->normal = l > crossing * a->size.x ? ob_scale(d, 1 / l) : across(a, u);
	out->separation = gap;
	out->points = gap <= margin;
	out->gap[0] = gap;
	out->at[0] = ob_madd(b->p, b->size.x + .5 * gap, out->normal);
}

// ---- capsule

// Contact point between the capsules a and b, at s and t along their axes (m). Sets normal, unless the axes cross
// there.
static ob_line_point between_at(const ob_placed *a, const ob_placed *b, double s, double t, ob_vec3 *normal)
{
	ob_vec3 x = point_on(a, s), y = point_on(b, t), d = ob_sub(x, y);
	double l = ob_norm(d), gap = l - a->size.x - b->size.x;
	if (l > crossing * a->size.x)
		*normal = ob_scale(d, 1 / l);
	ob_vec3 on_a = ob_madd(x, -a->size.x, *normal), on_b = ob_madd(y, b->size.x, *normal);
	return (ob_line_point){ s, gap, ob_scale(ob_add(on_a, on_b), .5), true };
}

void ob_nearest_on_lines(ob_vec3 u, ob_vec3 v, ob_vec3 w, double la, double lb, double *s, double *t)
{
	double c = ob_dot(u, v), uw = ob_dot(u, w), vw = ob_dot(v, w), det = ob_norm2(ob_cross(u, v));
	if (det > 1e-14) {
		*s = clamp((c * vw - uw) / det, la);
	} else {
		double low = ob_max(-la, -uw - lb), high = ob_min(la, -uw + lb);
		*s = clamp(.5 * (low + high), la);
	}
	*t = vw + c * *s;
	if (fabs(*t) > lb) {
		*t = clamp(*t, lb);
		*s = clamp(c * *t - uw, la);
	}
}

void ob_side_by_side(const ob_placed *a, const ob_placed *b, ob_vec3 n, double nearest, ob_line_point end[2])
{
	ob_vec3 u = ob_column(&a->r, 2), v = ob_column(&b->r, 2), w = ob_sub(a->p, b->p);
	double la = a->size.y, lb = b->size.y, c = ob_dot(u, v), uw = ob_dot(u, w), vw = ob_dot(v, w);
	for (int k = 0; k < 2 && fabs(c) > side_by_side; k++) {
		// the inner one of two ends: a's, or b's if it comes first
		double sa = k ? la : -la, tb = (k ? lb : -lb) * (c < 0 ? -1 : 1), sb = c * tb - uw;
		bool of_b = k ? sb < sa : sb > sa;
		double at_s = of_b ? sb : sa, at_t = of_b ? tb : vw + c * sa;
		ob_vec3 local = n;
		if (fabs(at_s) > la || fabs(at_t) > lb)
			continue; // they do not lie side by side
		end[k] = between_at(a, b, at_s, at_t, &local);
		end[k].there = ob_dot(local, n) > side_by_side && fabs(at_s - nearest) > same_place * a->size.x;
	}
}

void ob_manifold_capsules(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_vec3 u = ob_column(&a->r, 2), v = ob_column(&b->r, 2), w = ob_sub(a->p, b->p), n = ob_cross(u, v);
	double s, t;
	ob_nearest_on_lines(u, v, w, a->size.y, b->size.y, &s, &t);
	n = ob_norm2(n) > 1e-14 ? ob_scale(n, (ob_dot(n, w) < 0 ? -1 : 1) / ob_norm(n)) : across(a, u);
	ob_line_point nearest = between_at(a, b, s, t, &n), end[2] = { 0 };
	out->normal = n;
	if (nearest.gap <= margin)
		ob_side_by_side(a, b, n, s, end);
	ob_manifold_line(&nearest, end, margin, out);
}

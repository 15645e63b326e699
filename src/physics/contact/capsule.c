// Contacts of capsules with planes, spheres, boxes and capsules. A capsule is a segment grown by its radius. The
// nearest points are in closed form: segment and segment (Ericson 2005, 5.1.9), and segment and box (zero of the
// squared distance's derivative, which is piecewise linear along the segment). The separation is the distance itself
// while the segment is outside the other shape. One point is at the nearest place. Up to two more are at the ends of
// the part of the segment that runs along a face, an edge or another capsule.
#include "contact/capsule.h"

#include "contact/facets.h"
#include "contact/pairs.h"

static const double side_by_side = .99; // cosine: directions this near to each other run side by side
static const double crossing =
	1e-9; // relative to the radius: a segment this near to another shape's inside has no direction away from it
static const double redundant = 1e-9; // relative to the line: a point between two others must be deeper by this
static const double same_place = 1e-3; // relative to the radius: points nearer to each other count as one
static const double prefer_face =
	5e-5; // relative to the radius: a way out across an edge must be shorter by this than one across a face

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

// ---- box

// Segment in the box's frame: l + s k for |s| <= length; h: half extents. In m.
typedef struct box_segment {
	double l[3], k[3], h[3], length, radius;
} box_segment;

static double along(const box_segment *x, int i, double s)
{
	return x->l[i] + s * x->k[i];
}

// Half the derivative, along the segment, of the squared distance from the box.
static double slope(const box_segment *x, double s)
{
	double sum = 0;
	for (int i = 0; i < 3; i++) {
		double at = along(x, i, s);
		sum += x->k[i] * (at - clamp(at, x->h[i]));
	}
	return sum;
}

// Position of the segment's point nearest to the box (m); the middle, if several are. The slope never falls, and is
// linear between the places where the segment crosses a face's plane.
static double nearest_to_box(const box_segment *x)
{
	double low = -x->length, high = x->length, at_low = slope(x, low), at_high = slope(x, high);
	double level_from = INFINITY, level_to = -INFINITY; // range of zero slope
	if (at_low > 0 || at_high < 0)
		return at_low > 0 ? low : high;
	for (int i = 0; i < 8; i++) {
		double h = i & 1 ? x->h[i / 2 % 3] : -x->h[i / 2 % 3], s = (h - x->l[i / 2 % 3]) / x->k[i / 2 % 3];
		if (i >= 6)
			s = i & 1 ? x->length : -x->length;
		if (!(fabs(s) <= x->length))
			continue;
		double at = slope(x, s);
		if (at < 0 && s >= low)
			low = s, at_low = at;
		else if (at > 0 && s <= high)
			high = s, at_high = at;
		else if (at == 0)
			level_from = ob_min(level_from, s), level_to = ob_max(level_to, s);
	}
	if (level_from <= level_to)
		return .5 * (level_from + level_to);
	return low + (high - low) * (at_low / (at_low - at_high));
}

// Vector from the nearest point of the box to the segment's point at s (m, box's frame).
static void away(const box_segment *x, double s, double d[3])
{
	for (int i = 0; i < 3; i++) {
		double at = along(x, i, s);
		d[i] = at - clamp(at, x->h[i]);
	}
}

static double norm(const double d[3])
{
	return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

// Finds the shortest way out for a segment that goes through the box: along a face's normal, or across the segment and
// an edge (Gottschalk et al. 1996). Returns the segment's depth (m). axis: 0 .. 2 faces, 3 .. 5 edges.
static double way_out(const box_segment *x, double n[3], int *axis)
{
	double least = INFINITY;
	*axis = 3;
	for (int i = 0; i < 3; i++) {
		double in = x->h[i] + fabs(x->k[i]) * x->length - fabs(x->l[i]);
		if (in < least) {
			least = in, *axis = i;
			n[0] = n[1] = n[2] = 0;
			n[i] = x->l[i] < 0 ? -1 : 1;
		}
	}
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, m = (i + 2) % 3;
		double l = sqrt(x->k[j] * x->k[j] + x->k[m] * x->k[m]);
		if (l < 1e-6)
			continue;
		double nj = -x->k[m] / l, nm = x->k[j] / l, at = nj * x->l[j] + nm * x->l[m];
		double in = fabs(nj) * x->h[j] + fabs(nm) * x->h[m] - fabs(at);
		if (in < least - prefer_face * x->radius) {
			least = in, *axis = 3 + i;
			n[i] = 0, n[j] = at < 0 ? -nj : nj, n[m] = at < 0 ? -nm : nm;
		}
	}
	return least;
}

static ob_vec3 to_world(const ob_placed *box, const double d[3])
{
	return ob_rotate(&box->r, ob_v3(d[0], d[1], d[2]));
}

// Range of the segment that runs along the part of the box nearest at s: over its face, or along its edge.
static void side_by_side_range(const box_segment *x, double s, double *low, double *high)
{
	*low = -x->length, *high = x->length;
	for (int i = 0; i < 3; i++) {
		if (fabs(along(x, i, s)) > x->h[i] + crossing * x->radius || x->k[i] == 0)
			continue;
		double one = (x->h[i] - x->l[i]) / x->k[i], other = (-x->h[i] - x->l[i]) / x->k[i];
		*low = ob_max(*low, ob_min(one, other));
		*high = ob_min(*high, ob_max(one, other));
	}
}

// Contact point of the segment at s, which is "from" (m) away from the box along the unit vector n.
static ob_line_point on_line(const ob_placed *a, const box_segment *x, double s, double from, ob_vec3 n)
{
	double gap = from - x->radius;
	return (ob_line_point){ s, gap, ob_madd(point_on(a, s), -(x->radius + .5 * gap), n), true };
}

// Makes the manifold over the face on which the capsule rolls or slides across a seam, if n is not its normal. Returns
// false if there is none.
static bool on_face_underfoot(const ob_placed *a, const ob_placed *b, ob_vec3 n, double gap, double margin,
			      ob_manifold *out)
{
	ob_placed wider;
	ob_vec3 normal;
	ob_spots spots;
	bool leaving;
	if (!ob_face_underfoot(a, b, n, gap, margin, &wider, &normal, &leaving))
		return false;
	ob_spots_find(&wider, a, normal, margin, &spots);
	ob_spots_put(&spots, 1, out);
	out->separation = gap;
	if (leaving) // it may still fall off the edge
		out->valid_path = ob_leaving_path(a, b);
	return true;
}

static void outside_box(const ob_placed *a, const ob_placed *b, const box_segment *x, double s, double margin,
			ob_manifold *out)
{
	double d[3], range[2];
	away(x, s, d);
	const double l = norm(d);
	const ob_vec3 n = ob_scale(to_world(b, d), 1 / l);
	ob_line_point nearest = on_line(a, x, s, l, n), end[2] = { 0 };
	bool border = ob_max(fabs(d[0]), ob_max(fabs(d[1]), fabs(d[2]))) < l;
	if (border && nearest.gap <= margin && on_face_underfoot(a, b, n, nearest.gap, margin, out))
		return;
	side_by_side_range(x, s, &range[0], &range[1]);
	for (int k = 0; k < 2 && nearest.gap <= margin; k++) {
		double e[3];
		away(x, range[k], e);
		double le = norm(e), same = e[0] * d[0] + e[1] * d[1] + e[2] * d[2];
		if (!(same > side_by_side * l * le) || !(fabs(range[k] - s) > same_place * x->radius))
			continue;
		end[k] = on_line(a, x, range[k], le, ob_scale(to_world(b, e), 1 / le));
	}
	out->normal = n;
	ob_manifold_line(&nearest, end, margin, out);
}

// Position on the segment nearest to the edge along axis i, on the side of n.
static double nearest_to_edge(const box_segment *x, const double n[3], int i)
{
	double sum = 0, square = 0;
	for (int j = 0; j < 3; j++) {
		if (j == i)
			continue;
		sum += x->k[j] * (copysign(x->h[j], n[j]) - x->l[j]);
		square += x->k[j] * x->k[j];
	}
	return clamp(sum / square, x->length);
}

static void through_box(const ob_placed *a, const ob_placed *b, const box_segment *x, double margin, ob_manifold *out)
{
	double n[3] = { 0 }, low = -x->length, high = x->length;
	int axis;
	const double in = way_out(x, n, &axis);
	const ob_vec3 normal = to_world(b, n);
	ob_line_point nearest, end[2] = { 0 };
	if (axis >= 3) {
		nearest = on_line(a, x, nearest_to_edge(x, n, axis - 3), -in, normal);
	} else {
		for (int i = 0; i < 3; i++) {
			double one = (x->h[i] - x->l[i]) / x->k[i], other = (-x->h[i] - x->l[i]) / x->k[i];
			if (i == axis || x->k[i] == 0)
				continue;
			low = ob_max(low, ob_min(one, other));
			high = ob_min(high, ob_max(one, other));
		}
		double at_low = n[axis] * along(x, axis, low) - x->h[axis];
		double at_high = n[axis] * along(x, axis, high) - x->h[axis];
		end[0] = on_line(a, x, low, at_low, normal);
		end[1] = on_line(a, x, high, at_high, normal);
		nearest = end[at_high < at_low];
	}
	out->normal = normal;
	ob_manifold_line(&nearest, end, margin, out);
	out->separation = -in - x->radius;
}

void ob_manifold_capsule_box(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_vec3 l = ob_rotate_back(&b->r, ob_sub(a->p, b->p)), k = ob_rotate_back(&b->r, ob_column(&a->r, 2));
	const box_segment x = {
		{ l.x, l.y, l.z }, { k.x, k.y, k.z }, { b->size.x, b->size.y, b->size.z }, a->size.y, a->size.x
	};
	double s = nearest_to_box(&x), d[3];
	away(&x, s, d);
	if (norm(d) > crossing * a->size.x)
		outside_box(a, b, &x, s, margin, out);
	else
		through_box(a, b, &x, margin, out);
}

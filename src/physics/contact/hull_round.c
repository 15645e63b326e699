// Contacts of boxes and hulls with spheres and capsules: a point or a segment, grown by its radius. The nearest points of
// segment and polyhedron are in closed form: an end and a face, or the segment and an edge. The separation is the distance
// itself while the segment is outside the polyhedron.
//
// Seams: beyond a face's border a body meets an edge, unless it touches the face's plane, and the plane closes no sooner
// than the edge. Then it rolls or slides from one coplanar face to the next, and does not hit the edge.
#include "contact/capsule.h"
#include "contact/facets.h"
#include "contact/pairs.h"
#include "contact/polytope.h"
#include "shape/shape.h"

static const double side_by_side = .99; // cosine: directions this near to each other run side by side
static const double crossing = 1e-9; // relative to the radius: a segment this near to the inside has no direction away
static const double same_place = 1e-3; // relative to the radius: points nearer to each other count as one
static const double least_shorter =
	5e-5; // relative to the radius: a way out across an edge must be shorter by this than a face's
static const double equal_gap = 1e-3; // relative to the resting depth: gaps that differ by less are equal
static const double face_like = 1e-9; // 1 - cosine: a direction this near to a face's normal counts as it

// Segment in the polyhedron's frame: p + s k for |s| <= length (m); a sphere has length 0.
typedef struct segment {
	const ob_polytope *hull;
	ob_vec3 p, k;
	double length, radius;
} segment;

static ob_vec3 at(const segment *x, double s)
{
	return ob_madd(x->p, s, x->k);
}

static double clamp(double x, double limit)
{
	return x < -limit ? -limit : x > limit ? limit : x;
}

static double height(const ob_polytope *h, uint32_t f, ob_vec3 x)
{
	return ob_dot(h->shape->normal[f], x) - h->offset[f];
}

static ob_vec3 corner_of(const ob_polytope *h, uint32_t k)
{
	return h->corner[h->shape->loop[k]];
}

// Limits the range of s to the part over a face, which is extended by reach (m) on all sides. Returns false if it is
// empty.
static bool over_face(const segment *x, uint32_t f, double reach, double range[2])
{
	const ob_polytope *h = x->hull;
	for (uint32_t k = h->shape->first[f]; k < h->shape->first[f + 1]; k++) {
		const ob_vec3 from = corner_of(h, k),
			      to = corner_of(h, k + 1 < h->shape->first[f + 1] ? k + 1 : h->shape->first[f]);
		const ob_vec3 out = ob_cross(ob_sub(to, from), h->shape->normal[f]);
		const double past = ob_dot(out, ob_sub(x->p, from)) - (reach > 0 ? reach * ob_norm(out) : 0),
			     rate = ob_dot(out, x->k);
		if (rate > 0)
			range[1] = ob_min(range[1], -past / rate);
		else if (rate < 0)
			range[0] = ob_max(range[0], -past / rate);
		else if (past > 0)
			return false;
	}
	return range[0] <= range[1];
}

// True if a part of the segment is inside the hull.
static bool goes_through(const segment *x)
{
	double low = -x->length, high = x->length;
	for (uint32_t f = 0; f < x->hull->shape->faces && low <= high; f++) {
		const double there = height(x->hull, f, x->p) - crossing * x->radius,
			     rate = ob_dot(x->hull->shape->normal[f], x->k);
		if (rate > 0)
			high = ob_min(high, -there / rate);
		else if (rate < 0)
			low = ob_max(low, -there / rate);
		else if (there > 0)
			return false;
	}
	return low <= high;
}

// ---- outside

typedef struct nearest {
	double s, distance; // m: position along the segment; distance from the hull
	ob_vec3 n; // unit, from the hull to the segment
	double along; // cosine of the segment and the edge where it is; 1 over a face
} nearest;

// along: cosine of segment and edge. Of edges that are equally near at a corner, the one along the segment counts.
static void offer(nearest *best, const segment *x, double s, ob_vec3 on_hull, double along)
{
	const ob_vec3 d = ob_sub(at(x, s), on_hull);
	const double l = ob_norm(d), tie = crossing * x->radius;
	if (l > 0 && (l < best->distance - tie || (l < best->distance + tie && along > best->along)))
		*best = (nearest){ s, l, ob_scale(d, 1 / l), along };
}

// Offers the nearest place over each face: an end of the segment, or the middle if it is level.
static void offer_faces(nearest *best, const segment *x)
{
	const ob_polytope *h = x->hull;
	for (uint32_t f = 0; f < h->shape->faces; f++) {
		const double rate = ob_dot(h->shape->normal[f], x->k), middle = height(h, f, x->p);
		const double reach = fabs(rate) * x->length;
		if (middle + reach <= 0 || middle - reach >= best->distance)
			continue;
		double range[2] = { -x->length, x->length };
		if (!over_face(x, f, 0, range))
			continue;
		const double level = 1e-9;
		const double s = fabs(rate) < level ? .5 * (range[0] + range[1]) : rate > 0 ? range[0] : range[1];
		const double there = middle + s * rate;
		if (there > 0 && there < best->distance)
			*best = (nearest){ s, there, h->shape->normal[f], 1 };
	}
}

// Offers the nearest place at each edge of the faces that a part of the segment is above. It wins only if it is nearer
// than any place over a face.
static void offer_edges(nearest *best, const segment *x)
{
	const ob_polytope *h = x->hull;
	bool above[OB_HULL_FACES_MAX];
	for (uint32_t f = 0; f < h->shape->faces; f++)
		above[f] = height(h, f, x->p) + fabs(ob_dot(h->shape->normal[f], x->k)) * x->length > 0;
	for (uint32_t i = 0; i < h->shape->edges; i++) {
		const ob_hull_edge *e = &h->shape->edge[i];
		if (!above[e->left] && !above[e->right])
			continue;
		const ob_vec3 from = h->corner[e->from], way = ob_sub(h->corner[e->to], from);
		const double l = ob_norm(way);
		const ob_vec3 v = ob_scale(way, 1 / l), middle = ob_madd(from, .5, way);
		double s = 0, t;
		if (x->length > 0)
			ob_nearest_on_lines(x->k, v, ob_sub(x->p, middle), x->length, .5 * l, &s, &t);
		else
			t = clamp(ob_dot(v, ob_sub(x->p, middle)), .5 * l);
		offer(best, x, s, ob_madd(middle, t, v), fabs(ob_dot(v, x->k)));
	}
}

static nearest find_nearest(const segment *x)
{
	nearest best = { 0, INFINITY, { 0, 0, 1 }, -1 };
	offer_faces(&best, x);
	if (x->length > 0 || isinf(best.distance)) // a point over a face is nearest to it
		offer_edges(&best, x);
	return best;
}

// Returns the face with the normal nearest to n, within the cosine; -1: none.
static int face_towards(const ob_polytope *h, ob_vec3 n, double cosine)
{
	int best = -1;
	for (uint32_t f = 0; f < h->shape->faces; f++) {
		const double c = ob_dot(h->shape->normal[f], n);
		if (c >= cosine)
			cosine = c, best = (int)f;
	}
	return best;
}

// Range of the segment that runs along the part of the hull nearest to it: over a face, or along an edge.
static void side_by_side_range(const segment *x, const nearest *near, double range[2])
{
	const ob_polytope *h = x->hull;
	const int f = face_towards(h, near->n, 1 - face_like);
	const double near_by = crossing * x->radius;
	range[0] = -x->length, range[1] = x->length;
	if (f >= 0) {
		if (!over_face(x, (uint32_t)f, near_by, range))
			range[0] = range[1] = near->s;
		return;
	}
	const ob_vec3 foot = ob_madd(at(x, near->s), -near->distance, near->n);
	for (uint32_t i = 0; i < h->shape->edges; i++) {
		const ob_vec3 from = h->corner[h->shape->edge[i].from],
			      way = ob_sub(h->corner[h->shape->edge[i].to], from);
		const double l = ob_norm(way), c = ob_dot(way, x->k) / l, along = ob_dot(way, ob_sub(foot, from)) / l;
		if (c == 0 || along < near_by || along > l - near_by ||
		    ob_norm(ob_sub(ob_madd(from, along / l, way), foot)) > near_by)
			continue;
		const double one = (ob_dot(way, ob_sub(from, x->p)) / l) / c, other = one + l / c;
		range[0] = ob_max(-x->length, ob_min(one, other));
		range[1] = ob_min(x->length, ob_max(one, other));
	}
}

static ob_vec3 to_world(const ob_placed *b, ob_vec3 n)
{
	return ob_rotate(&b->r, n);
}

// Contact point of the segment at s, which is "from" (m) away from the hull along the unit vector n (hull's frame).
static ob_line_point on_line(const ob_placed *b, const segment *x, double s, double from, ob_vec3 n)
{
	const double gap = from - x->radius;
	const ob_vec3 local = ob_madd(at(x, s), -(x->radius + .5 * gap), n);
	return (ob_line_point){ s, gap, ob_add(b->p, ob_rotate(&b->r, local)), true };
}

// Speed (m/s) at which a's point nearest to the plane across n (hull's frame) leaves the plane.
static double opening(const ob_placed *a, const ob_placed *b, const segment *x, double s, ob_vec3 n)
{
	const ob_vec3 w = ob_rotate(&b->r, ob_madd(at(x, s), -x->radius, n)), normal = to_world(b, n);
	const ob_vec3 va = ob_add(a->v, ob_cross(a->w, ob_sub(ob_add(b->p, w), a->p)));
	return ob_dot(normal, ob_sub(va, ob_add(b->v, ob_cross(b->w, w))));
}

// Seams, as for ob_face_underfoot. Makes the manifold over a face that a touches, and that closes no sooner than the
// direction of the nearest place. Returns false if there is none.
static bool on_face_underfoot(const ob_placed *a, const ob_placed *b, const segment *x, const nearest *near,
			      double margin, ob_manifold *out)
{
	const double rest = ob_min(a->rest_depth, b->rest_depth), gap = near->distance - x->radius;
	const double other = ob_time_to_close(a, b, gap + rest, opening(a, b, x, near->s, near->n));
	double latest = other, range[2] = { -x->length, x->length };
	int face = -1;
	for (uint32_t f = 0; f < x->hull->shape->faces; f++) {
		const ob_vec3 n = x->hull->shape->normal[f];
		const double s = ob_dot(n, x->k) > 0 ? -x->length : x->length;
		const double there = height(x->hull, f, at(x, s)) - x->radius;
		if (!(fabs(there) <= rest))
			continue;
		const double closes = ob_time_to_close(a, b, there + rest, opening(a, b, x, s, n));
		if (closes >= latest)
			latest = closes, face = (int)f;
	}
	if (face < 0)
		return false;
	const bool leaving = latest == other;
	const double reach = leaving ? sqrt(2 * x->radius * equal_gap * rest) : margin;
	const ob_vec3 n = x->hull->shape->normal[face];
	out->normal = to_world(b, n);
	out->separation = gap;
	if (leaving) // it may still fall off the edge
		out->valid_path = ob_leaving_path(a, b);
	if (!over_face(x, (uint32_t)face, reach, range))
		return true;
	for (int k = 0; k < 2; k++) {
		const ob_line_point p = on_line(b, x, range[k], height(x->hull, (uint32_t)face, at(x, range[k])), n);
		if (p.gap > margin || (k && range[1] - range[0] <= same_place * x->radius))
			continue;
		out->at[out->points] = p.at;
		out->gap[out->points++] = p.gap;
	}
	return true;
}

static void outside(const ob_placed *a, const ob_placed *b, const segment *x, double margin, ob_manifold *out)
{
	const nearest near = find_nearest(x);
	ob_line_point first = on_line(b, x, near.s, near.distance, near.n), end[2] = { 0 };
	double range[2];
	out->separation = first.gap;
	if (first.gap > margin)
		return;
	if (face_towards(x->hull, near.n, 1 - face_like) < 0 && on_face_underfoot(a, b, x, &near, margin, out))
		return;
	if (x->length > 0) {
		side_by_side_range(x, &near, range);
		for (int k = 0; k < 2; k++) {
			if (!(fabs(range[k] - near.s) > same_place * x->radius))
				continue;
			const segment point = { x->hull, at(x, range[k]), x->k, 0, x->radius };
			const nearest there = find_nearest(&point);
			if (ob_dot(there.n, near.n) > side_by_side && isfinite(there.distance)) {
				end[k] = on_line(b, &point, 0, there.distance, there.n);
				end[k].s = range[k];
			}
		}
	}
	out->normal = to_world(b, near.n);
	ob_manifold_line(&first, end, margin, out);
}

// ---- through

static void through(const ob_placed *b, const segment *x, double margin, ob_manifold *out)
{
	const ob_polytope *h = x->hull;
	double in = INFINITY, range[2] = { -x->length, x->length };
	uint32_t face = 0, edge = h->shape->edges;
	ob_vec3 n = { 0, 0, 1 };
	for (uint32_t f = 0; f < h->shape->faces; f++) {
		const double deep = fabs(ob_dot(h->shape->normal[f], x->k)) * x->length - height(h, f, x->p);
		if (deep < in)
			in = deep, face = f, n = h->shape->normal[f];
	}
	for (uint32_t i = 0; i < h->shape->edges && x->length > 0; i++) {
		const ob_hull_edge *e = &h->shape->edge[i];
		const ob_vec3 way = ob_sub(h->corner[e->to], h->corner[e->from]), c = ob_cross(way, x->k);
		const double l = ob_norm(c);
		if (ob_dot(x->k, h->shape->normal[e->left]) * ob_dot(x->k, h->shape->normal[e->right]) >= 0 ||
		    l < 1e-6 * ob_norm(way))
			continue;
		const ob_vec3 out_of = ob_scale(
			c, (ob_dot(c, ob_add(h->shape->normal[e->left], h->shape->normal[e->right])) < 0 ? -1 : 1) / l);
		const double deep = ob_dot(out_of, ob_sub(h->corner[e->from], x->p));
		if (deep < in - least_shorter * x->radius)
			in = deep, edge = i, n = out_of;
	}
	ob_line_point first, end[2] = { 0 };
	if (edge < h->shape->edges) {
		const ob_vec3 from = h->corner[h->shape->edge[edge].from],
			      way = ob_sub(h->corner[h->shape->edge[edge].to], from);
		const double l = ob_norm(way);
		double s, t;
		ob_nearest_on_lines(x->k, ob_scale(way, 1 / l), ob_sub(x->p, ob_madd(from, .5, way)), x->length, .5 * l,
				    &s, &t);
		first = on_line(b, x, s, -in, n);
	} else {
		over_face(x, face, 0, range);
		for (int k = 0; k < 2; k++) {
			const double s = clamp(range[k], x->length);
			end[k] = on_line(b, x, s, height(h, face, at(x, s)), n);
		}
		first = end[end[1].gap < end[0].gap];
		if (x->length == 0)
			end[0].there = end[1].there = false;
	}
	out->normal = to_world(b, n);
	ob_manifold_line(&first, end, margin, out);
	out->separation = -in - x->radius;
}

void ob_manifold_round_hull(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	const double length = ob_shape_is(a->shape, OB_AXIAL) ? a->size.y : 0;
	ob_polytope hull;
	ob_polytope_init(&hull, b, b->p);
	const segment x = { &hull, ob_rotate_back(&b->r, ob_sub(a->p, b->p)),
			    ob_rotate_back(&b->r, ob_column(&a->r, 2)), length, a->size.x };
	out->points = 0;
	if (goes_through(&x))
		through(b, &x, margin, out);
	else
		outside(a, b, &x, margin, out);
}

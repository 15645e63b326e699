#include "motion/depth.h"

#include "elementary/elementary.h"
#include "shape/part.h"
#include "shape/shape.h"

// ---- hull depth

// Penetration depth with hulls (depth.h). Pure, thread-safe.

static const double golden = .6180339887498949;

// ---- polyhedra

typedef struct edge {
	ob_vec3 at, way, left, right; // a point, m; unit outward normals of its faces
} edge;

// Polyhedron in the world's axes, about the origin that both share.
typedef struct polyhedron {
	uint32_t corners, faces, edges;
	ob_vec3 centre;
	double inner; // m
	ob_vec3 corner[OB_HULL_CORNERS_MAX], normal[OB_HULL_FACES_MAX];
	edge edge[OB_HULL_EDGES_MAX];
} polyhedron;

static void box_polyhedron(polyhedron *x, const ob_solid *s)
{
	const double h[3] = { s->size.x, s->size.y, s->size.z };
	ob_vec3 axis[3];
	x->corners = 8, x->faces = 6, x->edges = 12;
	x->inner = fmin(h[0], fmin(h[1], h[2]));
	for (int i = 0; i < 3; i++)
		axis[i] = ob_column(&s->r, i);
	for (int k = 0; k < 8; k++) {
		x->corner[k] = x->centre;
		for (int i = 0; i < 3; i++)
			x->corner[k] = ob_madd(x->corner[k], k >> i & 1 ? h[i] : -h[i], axis[i]);
	}
	for (int f = 0; f < 6; f++)
		x->normal[f] = ob_scale(axis[f / 2], f & 1 ? 1 : -1);
	for (int k = 0; k < 12; k++) {
		const int i = k / 4, j = (i + 1) % 3, l = (i + 2) % 3;
		const double sj = k & 1 ? 1 : -1, sl = k & 2 ? 1 : -1;
		const ob_vec3 at = ob_madd(ob_madd(x->centre, sj * h[j], axis[j]), sl * h[l], axis[l]);
		x->edge[k] = (edge){ at, axis[i], ob_scale(axis[j], sj), ob_scale(axis[l], sl) };
	}
}

static void hull_polyhedron(polyhedron *x, const ob_solid *s)
{
	const ob_hull *h = s->hull;
	x->corners = h->corners, x->faces = h->faces, x->edges = h->edges;
	x->inner = h->inner;
	for (uint32_t k = 0; k < h->corners; k++)
		x->corner[k] = ob_add(x->centre, ob_rotate(&s->r, h->corner[k]));
	for (uint32_t f = 0; f < h->faces; f++)
		x->normal[f] = ob_rotate(&s->r, h->normal[f]);
	for (uint32_t k = 0; k < h->edges; k++) {
		const ob_hull_edge *e = &h->edge[k];
		x->edge[k] = (edge){ x->corner[e->from], ob_sub(x->corner[e->to], x->corner[e->from]),
				     x->normal[e->left], x->normal[e->right] };
	}
}

static void polyhedron_init(polyhedron *x, const ob_solid *s, ob_vec3 origin)
{
	x->centre = ob_sub(s->p, origin);
	if (!s->hull)
		box_polyhedron(x, s);
	else
		hull_polyhedron(x, s);
}

static double lowest(const polyhedron *x, ob_vec3 n)
{
	double low = INFINITY;
	for (uint32_t k = 0; k < x->corners; k++)
		low = fmin(low, ob_dot(n, x->corner[k]));
	return low;
}

static double overlap(const polyhedron *a, const polyhedron *b, ob_vec3 n)
{
	return -lowest(a, ob_scale(n, -1)) - lowest(b, n); // n from a to b
}

// True if n, across the edge, lies between the normals of its faces.
static bool is_between(const edge *e, ob_vec3 n)
{
	const double whole = ob_dot(ob_cross(e->left, e->right), e->way) < 0 ? -1 : 1;
	return whole * ob_dot(ob_cross(e->left, n), e->way) >= 0 && whole * ob_dot(ob_cross(n, e->right), e->way) >= 0;
}

// True if a normal n of the edge has n . d >= least; d unit.
static bool reaches(const edge *e, ob_vec3 d, double least)
{
	if (least <= 0 || ob_dot(e->left, d) >= least || ob_dot(e->right, d) >= least)
		return true;
	const double along = ob_dot(e->way, d), far2 = 1 - along * along / ob_norm2(e->way);
	const ob_vec3 flat = ob_madd(d, -along / ob_norm2(e->way), e->way);
	return far2 >= least * least && is_between(e, flat);
}

// Depth of two polyhedra: hulls and boxes. The separating axes are the faces' normals, and the products of two edges
// that are extreme in both solids along them.
static double depth_of_polyhedra(const ob_solid *one, const ob_solid *other)
{
	polyhedron a, b;
	double least = INFINITY;
	polyhedron_init(&a, one, one->p);
	polyhedron_init(&b, other, one->p);
	for (uint32_t f = 0; f < a.faces; f++)
		least = fmin(least, overlap(&a, &b, a.normal[f]));
	for (uint32_t f = 0; f < b.faces; f++)
		least = fmin(least, overlap(&a, &b, ob_scale(b.normal[f], -1)));
	if (least <= 0)
		return least;
	const ob_vec3 d = ob_sub(b.centre, a.centre);
	const double apart = ob_norm(d);
	const ob_vec3 towards = apart > 0 ? ob_scale(d, 1 / apart) : ob_v3(0, 0, 1), back = ob_scale(towards, -1);
	for (uint32_t i = 0; i < a.edges; i++)
		for (uint32_t j = 0; j < b.edges; j++) {
			const edge *ea = &a.edge[i], *eb = &b.edge[j];
			const double needed = apart > 0 ? (a.inner + b.inner - least) / apart - 1e-9 : -1; // shrinks
			if (j == 0 && !reaches(ea, towards, needed))
				break;
			if (!reaches(eb, back, needed))
				continue;
			ob_vec3 n = ob_cross(ea->way, eb->way);
			const double l2 = ob_norm2(n);
			if (!(l2 > 1e-12 * ob_norm2(ea->way) * ob_norm2(eb->way)))
				continue;
			n = ob_scale(n, (ob_dot(n, ob_add(ea->left, ea->right)) < 0 ? -1 : 1) / sqrt(l2));
			if (is_between(ea, n) && is_between(eb, ob_scale(n, -1)))
				least = fmin(least, ob_dot(n, ob_sub(ea->at, eb->at)));
			if (least <= 0)
				return least;
		}
	return least;
}

// ---- spheres and capsules

static double from_segment(ob_vec3 x, ob_vec3 from, ob_vec3 to)
{
	const ob_vec3 way = ob_sub(to, from);
	const double s = fmax(0, fmin(1, ob_dot(way, ob_sub(x, from)) / ob_norm2(way)));
	return ob_norm(ob_sub(x, ob_madd(from, s, way)));
}

// Signed distance of the point from the hull (its frame); < 0 inside. A point above a face, but not over any such
// face's area, is nearest to an edge.
static double signed_distance(const ob_hull *h, ob_vec3 x)
{
	double inside = -INFINITY, nearest = INFINITY;
	for (uint32_t f = 0; f < h->faces; f++)
		inside = fmax(inside, ob_dot(h->normal[f], x) - h->offset[f]);
	if (inside <= 0)
		return inside;
	for (uint32_t f = 0; f < h->faces; f++) {
		const double height = ob_dot(h->normal[f], x) - h->offset[f];
		bool over = height > 0;
		for (uint32_t k = h->first[f]; over && k < h->first[f + 1]; k++) {
			const ob_vec3 from = h->corner[h->loop[k]],
				      to = h->corner[h->loop[k + 1 < h->first[f + 1] ? k + 1 : h->first[f]]];
			over = ob_dot(ob_cross(h->normal[f], ob_sub(to, from)), ob_sub(x, from)) >= 0;
			nearest = height < nearest ? fmin(nearest, from_segment(x, from, to)) : nearest;
		}
		if (over)
			nearest = fmin(nearest, height);
	}
	for (uint32_t k = 0; k < h->edges; k++)
		nearest = fmin(nearest, from_segment(x, h->corner[h->edge[k].from], h->corner[h->edge[k].to]));
	return nearest;
}

// Least distance over the segment c + s u, |s| <= half, by golden section (Kiefer 1953): the distance from a convex
// solid is a convex function of place.
static double least_distance(const ob_hull *h, ob_vec3 c, ob_vec3 u, double half)
{
	enum { ROUNDS = 60 };
	double low = -half, high = half,
	       least = fmin(signed_distance(h, ob_madd(c, low, u)), signed_distance(h, ob_madd(c, high, u)));
	for (int i = 0; half > 0 && i < ROUNDS; i++) {
		const double left = high - golden * (high - low), right = low + golden * (high - low);
		const double at_left = signed_distance(h, ob_madd(c, left, u)),
			     at_right = signed_distance(h, ob_madd(c, right, u));
		least = fmin(least, fmin(at_left, at_right));
		if (at_left < at_right)
			high = right;
		else
			low = left;
	}
	return least;
}

// Depth of the segment in the hull, along the faces' normals and across its edges and the segment.
static double segment_depth(const ob_hull *h, ob_vec3 c, ob_vec3 u, double half)
{
	double least = INFINITY;
	for (uint32_t f = 0; f < h->faces; f++)
		least = fmin(least, h->offset[f] - ob_dot(h->normal[f], c) + fabs(ob_dot(h->normal[f], u)) * half);
	for (uint32_t k = 0; half > 0 && k < h->edges; k++) {
		const ob_hull_edge *e = &h->edge[k];
		const edge x = { h->corner[e->from], ob_sub(h->corner[e->to], h->corner[e->from]), h->normal[e->left],
				 h->normal[e->right] };
		ob_vec3 n = ob_cross(x.way, u);
		const double l = ob_norm(n);
		if (!(l > 1e-6 * ob_norm(x.way)))
			continue;
		n = ob_scale(n, (ob_dot(n, ob_add(x.left, x.right)) < 0 ? -1 : 1) / l);
		if (is_between(&x, n))
			least = fmin(least, ob_dot(n, ob_sub(x.at, c)));
	}
	return least;
}

// Depth of a sphere or capsule in a hull.
static double depth_of_round_and_hull(const ob_solid *round, const ob_solid *hull)
{
	const double half = ob_shape_is(round->shape, OB_AXIAL) ? round->size.y : 0;
	const ob_vec3 c = ob_rotate_back(&hull->r, ob_sub(round->p, hull->p)),
		      u = ob_rotate_back(&hull->r, ob_column(&round->r, 2));
	const double distance = least_distance(hull->hull, c, u, half);
	if (distance > 1e-12 * hull->hull->radius)
		return round->size.x - distance;
	return round->size.x + fmax(segment_depth(hull->hull, c, u, half), 0);
}

// ---- depth

ob_solid ob_solid_of(ob_shape shape, ob_vec3 size, ob_pose pose, const ob_hull *hull)
{
	ob_solid out = { shape, size, pose.p, ob_quat_matrix(pose.q), hull };
	if (!ob_part_is_round(hull))
		return out;
	ob_part_enter(hull, &out.p, &out.r);
	out.shape = (ob_shape)hull->round;
	out.size = hull->size;
	out.hull = NULL;
	return out;
}

// Half length (m) of the segment inside a capsule; 0 for a sphere.
static double core_length(const ob_solid *s)
{
	return ob_shape_is(s->shape, OB_AXIAL) ? s->size.y : 0;
}

static double clamp(double x, double low, double high)
{
	return x < low ? low : x > high ? high : x;
}

static double hull_extent(const ob_hull *h, ob_vec3 n)
{
	double most = -INFINITY;
	for (uint32_t k = 0; k < h->corners; k++)
		most = fmax(most, ob_dot(n, h->corner[k]));
	return most;
}

double ob_solid_extent(const ob_solid *s, ob_vec3 n)
{
	ob_vec3 b = ob_rotate_back(&s->r, n);
	return s->hull ? hull_extent(s->hull, b) : ob_shape_extent(s->shape, s->size, b);
}

static double plane_and_solid(const ob_solid *plane, const ob_solid *s)
{
	ob_vec3 n = ob_column(&plane->r, 2);
	return ob_solid_extent(s, ob_scale(n, -1)) - ob_dot(n, ob_sub(s->p, plane->p));
}

// Distance of two segments, with centres d apart, unit directions u and v, half lengths hu and hv (Lumelsky 1985).
static double between_segments(ob_vec3 d, ob_vec3 u, double hu, ob_vec3 v, double hv)
{
	double c = ob_dot(u, v), du = ob_dot(d, u), dv = ob_dot(d, v), sine2 = 1 - c * c;
	// d points from the first to the second: the first's nearest point lies at s u, the second's at d + t v.
	double s = sine2 > 1e-12 ? clamp((du - c * dv) / sine2, -hu, hu) : clamp(du, -hu, hu);
	double t = clamp(c * s - dv, -hv, hv);
	s = clamp(du + c * t, -hu, hu);
	return ob_norm(ob_sub(ob_madd(d, t, v), ob_scale(u, s)));
}

// Two crossing segments separate sideways, so that the radii alone count: exact in every position.
static double capsules(const ob_solid *a, const ob_solid *b)
{
	return a->size.x + b->size.x -
	       between_segments(ob_sub(b->p, a->p), ob_column(&a->r, 2), core_length(a), ob_column(&b->r, 2),
				core_length(b));
}

// In the half plane through the cylinder's axis and the centre, the cylinder is a rectangle.
static double sphere_and_cylinder(const ob_solid *sphere, const ob_solid *cylinder)
{
	ob_vec3 b = ob_rotate_back(&cylinder->r, ob_sub(sphere->p, cylinder->p));
	double out = sqrt(b.x * b.x + b.y * b.y) - cylinder->size.x, up = fabs(b.z) - cylinder->size.y;
	double distance = out > 0 && up > 0 ? sqrt(out * out + up * up) : fmax(out, up);
	return sphere->size.x - distance;
}

// ---- boxes with boxes and capsules

enum { BREAKS = 8 }; // both ends of a segment, and its crossings of the 6 planes of a box's faces

static void sort_two(double *low, double *high)
{
	if (*low > *high) {
		double x = *low;
		*low = *high;
		*high = x;
	}
}

static double depth_of_boxes(const ob_solid *a, const ob_solid *b)
{
	ob_vec3 d = ob_sub(b->p, a->p);
	double least = INFINITY;
	for (int k = 0; k < 15; k++) {
		ob_vec3 n = k < 3   ? ob_column(&a->r, k)
			    : k < 6 ? ob_column(&b->r, k - 3)
				    : ob_cross(ob_column(&a->r, (k - 6) / 3), ob_column(&b->r, (k - 6) % 3));
		double length = ob_norm(n);
		if (length < 1e-6) // parallel edges: the faces' normals cover this direction
			continue;
		double overlap = (ob_solid_extent(a, n) + ob_solid_extent(b, n) - fabs(ob_dot(d, n))) / length;
		if (overlap < least)
			least = overlap;
		if (least <= 0)
			break;
	}
	return least;
}

// Half the derivative in s of the squared distance of the point c + s u (box frame) from the box. Grows with s.
static double distance_slope(const double c[3], const double u[3], const double h[3], double s)
{
	double sum = 0;
	for (int i = 0; i < 3; i++) {
		double x = c[i] + s * u[i];
		sum += u[i] * (x - fmin(fmax(x, -h[i]), h[i]));
	}
	return sum;
}

// Distance of the segment c + s u, |s| <= half, from the box. The slope is linear between neighbouring breaks, so the
// interval with its change of sign gives the nearest point exactly.
static double segment_from_box(const double c[3], const double u[3], double half, const double h[3])
{
	double breaks[BREAKS] = { -half, half };
	for (int i = 0; i < 3; i++) {
		double inverse = fabs(u[i]) > 1e-300 ? 1 / u[i] : 0;
		breaks[2 + 2 * i] = fmin(fmax((-h[i] - c[i]) * inverse, -half), half);
		breaks[3 + 2 * i] = fmin(fmax((h[i] - c[i]) * inverse, -half), half);
	}
	for (int i = 1; i < BREAKS; i++)
		for (int j = i; j > 0; j--)
			sort_two(&breaks[j - 1], &breaks[j]);
	double s = -half;
	for (int i = 0; i + 1 < BREAKS; i++) {
		double left = distance_slope(c, u, h, breaks[i]), right = distance_slope(c, u, h, breaks[i + 1]);
		s = breaks[i + 1];
		if (left >= 0 || right >= 0) {
			s = left >= 0 ? breaks[i]
				      : breaks[i] + (breaks[i + 1] - breaks[i]) * fmin(left / (left - right), 1);
			break;
		}
	}
	double sum = 0;
	for (int i = 0; i < 3; i++) {
		double out = fabs(c[i] + s * u[i]) - h[i];
		sum += out > 0 ? out * out : 0;
	}
	return sqrt(sum);
}

// Depth of the segment itself in the box: the faces of box minus segment lie across the box's axes, and across the
// products of its edges with the segment.
static double segment_in_box(const double c[3], const double u[3], double half, const double h[3])
{
	double least = INFINITY;
	for (int k = 0; k < 6; k++) {
		double n[3] = { 0, 0, 0 };
		int i = k % 3, j = (k + 1) % 3, l = (k + 2) % 3;
		n[i] = k < 3;
		if (k >= 3) {
			double length = sqrt(u[j] * u[j] + u[l] * u[l]);
			if (length < 1e-6)
				continue;
			n[j] = -u[l] / length;
			n[l] = u[j] / length;
		}
		double reach = 0, along = 0, middle = 0;
		for (int m = 0; m < 3; m++) {
			reach += fabs(n[m]) * h[m];
			along += n[m] * u[m];
			middle += n[m] * c[m];
		}
		least = fmin(least, reach + fabs(along) * half - fabs(middle));
	}
	return least;
}

static double depth_of_capsule_and_box(const ob_solid *capsule, const ob_solid *box)
{
	ob_vec3 centre = ob_rotate_back(&box->r, ob_sub(capsule->p, box->p));
	ob_vec3 axis = ob_rotate_back(&box->r, ob_column(&capsule->r, 2));
	double c[3] = { centre.x, centre.y, centre.z }, u[3] = { axis.x, axis.y, axis.z };
	double h[3] = { box->size.x, box->size.y, box->size.z };
	double half = core_length(capsule);
	double distance = segment_from_box(c, u, half, h);
	// otherwise rounding: the nearest point found may be the segment's entry
	if (distance > 1e-12 * (h[0] + h[1] + h[2]))
		return capsule->size.x - distance;
	return capsule->size.x + fmax(segment_in_box(c, u, half, h), 0);
}

// ---- search
//
// Depth of two convex solids as the least overlap of their projections over all directions n:
//
//     overlap_along(n) = extent_a(n) + extent_b(-n) - n . d,    d from a's centre to b's
//
// and n stands for -n, too: all solids but hulls are symmetric.
//
// The function is smooth except for kinks: n along an axis of a solid, or in the plane across one (projections of a
// box's edges and of a cylinder's rims and mantle). Its minimum often lies in a kink. So the search tries the axes and
// their products directly, walks each plane of kinks in one dimension, and looks for smooth minima in two, from an even
// scatter of starts.

enum { AXES_MAX = 1 + OB_HULL_EDGES_MAX, PLANE_STARTS = 16, SPHERE_STARTS = 48, TURNS = 8 };

struct search {
	const ob_solid *a, *b;
	ob_vec3 d;
	ob_vec3 axis[AXES_MAX];
	int axes;
	double least;
	ob_vec3 best; // direction of the least overlap_along so far
};

static double overlap_along(const struct search *s, ob_vec3 n)
{
	const double along = ob_dot(n, s->d);
	if (!s->b->hull)
		return ob_solid_extent(s->a, n) + ob_solid_extent(s->b, n) - fabs(along);
	const ob_vec3 back = ob_scale(n, -1);
	return fmin(ob_solid_extent(s->a, n) + ob_solid_extent(s->b, back) - along,
		    ob_solid_extent(s->a, back) + ob_solid_extent(s->b, n) + along);
}

static ob_vec3 unit(ob_vec3 n)
{
	return ob_scale(n, 1 / ob_norm(n));
}

static void try_direction(struct search *s, ob_vec3 n)
{
	double x = overlap_along(s, n);
	if (x < s->least) {
		s->least = x;
		s->best = n;
	}
}

static void add_axes(struct search *s, const ob_solid *solid)
{
	if (ob_shape_is(solid->shape, OB_SIDED))
		for (int i = 0; i < 3; i++)
			s->axis[s->axes++] = ob_column(&solid->r, i);
	if (ob_shape_is(solid->shape, OB_AXIAL))
		s->axis[s->axes++] = ob_column(&solid->r, 2);
}

// A hull's kinks lie across its edges; it is b.
static void add_hull(struct search *s, const ob_solid *solid)
{
	const ob_hull *h = solid->hull;
	for (uint32_t f = 0; f < h->faces; f++)
		try_direction(s, ob_rotate(&solid->r, h->normal[f]));
	for (uint32_t k = 0; k < h->edges; k++)
		s->axis[s->axes++] =
			unit(ob_rotate(&solid->r, ob_sub(h->corner[h->edge[k].to], h->corner[h->edge[k].from])));
}

static void span_across(ob_vec3 n, ob_vec3 *u, ob_vec3 *v)
{
	*u = unit(ob_cross(n, fabs(n.x) < .6 ? ob_v3(1, 0, 0) : ob_v3(0, 1, 0)));
	*v = ob_cross(n, *u);
}

// Golden section (Kiefer 1953) over the angle (rad) in the plane of u and v.
static void refine_angle(struct search *s, ob_vec3 u, ob_vec3 v, double low, double high)
{
	for (int i = 0; i < 45; i++) { // narrows the angle to 4e-10 of the first bracket
		double left = high - golden * (high - low), right = low + golden * (high - low);
		double at_left = overlap_along(s, ob_madd(ob_scale(u, ob_cos(left)), ob_sin(left), v));
		double at_right = overlap_along(s, ob_madd(ob_scale(u, ob_cos(right)), ob_sin(right), v));
		if (at_left < at_right)
			high = right;
		else
			low = left;
	}
	double middle = .5 * (low + high);
	try_direction(s, unit(ob_madd(ob_scale(u, ob_cos(middle)), ob_sin(middle), v)));
}

// Walks the directions across one axis: half a circle, since n and -n give one projection.
static void walk_plane(struct search *s, ob_vec3 axis)
{
	const double angle = M_PI / PLANE_STARTS;
	double at[PLANE_STARTS];
	ob_vec3 u, v;
	span_across(axis, &u, &v);
	for (int i = 0; i < PLANE_STARTS; i++)
		at[i] = overlap_along(s, ob_madd(ob_scale(u, ob_cos(i * angle)), ob_sin(i * angle), v));
	for (int i = 0; i < PLANE_STARTS; i++)
		if (at[i] <= at[(i + 1) % PLANE_STARTS] && at[i] <= at[(i + PLANE_STARTS - 1) % PLANE_STARTS])
			refine_angle(s, u, v, (i - 1) * angle, (i + 1) * angle);
}

// Pattern search (Hooke and Jeeves 1961): TURNS steps around n, rotated a little each time so that no descent is missed
// for good; halves the step when none helps.
static void descend_from(struct search *s, ob_vec3 n, double step)
{
	double least = overlap_along(s, n), phase = 0;
	while (step > 1e-5) { // smooth: the overlap_along's error is the square of that
		ob_vec3 u, v, from = n;
		span_across(n, &u, &v);
		bool better = false;
		for (int i = 0; i < TURNS; i++) {
			double angle = phase + i * (2 * M_PI / TURNS);
			ob_vec3 side = ob_madd(ob_scale(u, ob_cos(angle)), ob_sin(angle), v);
			ob_vec3 m = unit(ob_madd(from, step, side));
			double x = overlap_along(s, m);
			if (x < least) {
				least = x;
				n = m;
				better = true;
			}
		}
		phase += 2.399963229728653; // the golden angle
		if (!better)
			step *= .5;
	}
	try_direction(s, n);
}

// Descends from the three best of an even scatter over half the sphere (Fibonacci lattice), and from the best so far.
static void search_sphere(struct search *s)
{
	ob_vec3 start[3];
	double value[3] = { INFINITY, INFINITY, INFINITY };
	for (int i = 0; i < SPHERE_STARTS; i++) {
		double z = (i + .5) / SPHERE_STARTS, r = sqrt(1 - z * z), angle = i * 2.399963229728653;
		ob_vec3 n = ob_v3(r * ob_cos(angle), r * ob_sin(angle), z);
		double x = overlap_along(s, n);
		for (int k = 0; k < 3; k++) {
			if (x >= value[k])
				continue;
			for (int l = 2; l > k; l--) {
				value[l] = value[l - 1];
				start[l] = start[l - 1];
			}
			value[k] = x;
			start[k] = n;
			break;
		}
	}
	descend_from(s, s->best, .1);
	for (int k = 0; k < 3; k++)
		descend_from(s, start[k], .2);
}

double ob_depth_search(const ob_solid *a, const ob_solid *b)
{
	struct search s = { .a = a, .b = b, .d = ob_sub(b->p, a->p), .least = INFINITY };
	add_axes(&s, a);
	if (b->hull)
		add_hull(&s, b);
	else
		add_axes(&s, b);
	double distance = ob_norm(s.d);
	try_direction(&s, distance > 0 ? ob_scale(s.d, 1 / distance) : ob_v3(0, 0, 1));
	for (int i = 0; i < s.axes; i++)
		try_direction(&s, s.axis[i]);
	for (int i = 0; i < s.axes; i++) {
		for (int j = i + 1; j < s.axes; j++) {
			ob_vec3 n = ob_cross(s.axis[i], s.axis[j]);
			if (ob_norm(n) > 1e-6)
				try_direction(&s, unit(n));
		}
	}
	if (s.least <= 0) // one separating projection is enough
		return s.least;
	for (int i = 0; i < s.axes; i++)
		walk_plane(&s, s.axis[i]);
	if (s.least > 0)
		search_sphere(&s);
	return s.least;
}

// ---- any two solids

// True for a point or a segment along z that is grown by a radius.
static bool is_rounded(ob_shape s)
{
	return ob_shape_is(s, OB_ROUND) && !ob_shape_is(s, OB_RIMMED);
}

bool ob_depth_needs_search(ob_shape a, ob_shape b)
{
	if (ob_shape_is(a, OB_UNBOUNDED) || ob_shape_is(b, OB_UNBOUNDED))
		return false;
	if ((is_rounded(a) || ob_shape_is(a, OB_SIDED)) && (is_rounded(b) || ob_shape_is(b, OB_SIDED)))
		return false;
	return !(ob_shape_is(a, OB_ISOTROPIC) && ob_shape_is(b, OB_RIMMED)) &&
	       !(ob_shape_is(b, OB_ISOTROPIC) && ob_shape_is(a, OB_RIMMED));
}

double ob_depth(const ob_solid *a, const ob_solid *b)
{
	if (a->shape > b->shape)
		return ob_depth(b, a);
	const bool round_a = is_rounded(a->shape), round_b = is_rounded(b->shape);
	if (a->shape == OB_SHAPE_NONE || (ob_shape_is(a->shape, OB_UNBOUNDED) && ob_shape_is(b->shape, OB_UNBOUNDED)))
		return -INFINITY;
	if (ob_shape_is(a->shape, OB_UNBOUNDED))
		return plane_and_solid(a, b);
	if (ob_shape_is(b->shape, OB_UNBOUNDED))
		return plane_and_solid(b, a);
	if (round_a && round_b)
		return capsules(a, b);
	if (b->hull && ob_shape_is(a->shape, OB_CORNERED))
		return depth_of_polyhedra(a, b);
	if (b->hull && round_a)
		return depth_of_round_and_hull(a, b);
	if (ob_depth_needs_search(a->shape, b->shape))
		return ob_depth_search(a, b);
	if (ob_shape_is(b->shape, OB_RIMMED))
		return sphere_and_cylinder(a, b);
	if (ob_shape_is(a->shape, OB_SIDED))
		return round_b ? depth_of_capsule_and_box(b, a) : depth_of_boxes(a, b);
	return depth_of_capsule_and_box(a, b);
}

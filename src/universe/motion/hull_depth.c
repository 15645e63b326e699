#include "motion/hull_depth.h"

#include "shape/shape.h"

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

double ob_depth_of_polyhedra(const ob_solid *one, const ob_solid *other)
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

double ob_depth_of_round_and_hull(const ob_solid *round, const ob_solid *hull)
{
	const double half = ob_shape_is(round->shape, OB_AXIAL) ? round->size.y : 0;
	const ob_vec3 c = ob_rotate_back(&hull->r, ob_sub(round->p, hull->p)),
		      u = ob_rotate_back(&hull->r, ob_column(&round->r, 2));
	const double distance = least_distance(hull->hull, c, u, half);
	if (distance > 1e-12 * hull->hull->radius)
		return round->size.x - distance;
	return round->size.x + fmax(segment_depth(hull->hull, c, u, half), 0);
}

// Contacts of cylinders. They are exact convex solids with a disc for a cap, a line for a side and a circle for a rim,
// never polygons. Planes and spheres are in closed form. Against a box, a capsule, another cylinder or a hull, the
// search tries the directions along which two features can touch: normals of caps and faces, and those across the axis
// and an edge or another axis. Then it tries the best direction across each axis and each edge, along which an arc
// touches a corner, an edge or an arc (contact/support.h). Two rims take Newton's method. The separation is the
// distance if it is at most the margin; for a rim beside a box's corner it is a lower bound.
#include "contact/capsule.h"
#include "contact/facets.h"
#include "contact/pairs.h"
#include "contact/support.h"
#include "shape/shape.h"

// Lengths, relative to the thickness of the thinner shape.
static const double crossing = 1e-9; // a point inside, this near to the surface, has no direction away from it
static const double as_deep = 3e-7; // a point at most this far above the lowest proves that a facet's normal is best
static const double noise = 3e-13; // a direction that is better by less counts as the same
static const double touching = 3e-6; // a direction with a smaller gap does not separate the shapes
static const double near_enough = 3e-3; // shapes farther apart may meet along another direction than the nearest one
static const double meet = 3e-10; // features this near to each other across the normal have a common point
static const double far = .06; // beyond the margin: shapes farther apart are not searched

static const double along_facet = .99; // cosine: a normal this near to a facet's takes the facet's other points, too
static const double side_lean = .03; // cosine: a side that leans by more touches with its rim
static const double level = 1e-9; // cosine: an edge this nearly across the normal is a feature as a whole
static const double deep = .01; // relative to a shape's size: deeper overlaps are searched more widely

enum { STARTS = 5 };

static ob_vec3 unit(ob_vec3 v)
{
	return ob_scale(v, 1 / ob_norm(v));
}

static ob_vec3 part_across(ob_vec3 v, ob_vec3 d)
{
	return ob_madd(v, -ob_dot(v, d), d);
}

// ---- plane, sphere

void ob_manifold_cylinder_plane(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_vec3 n = ob_column(&b->r, 2);
	ob_spots s;
	out->points = 0;
	out->separation = ob_dot(n, ob_sub(ob_support(a, ob_scale(n, -1)), b->p));
	if (out->separation > margin)
		return;
	ob_spots_find(b, a, n, margin, &s);
	ob_spots_reduce(&s);
	ob_spots_put(&s, 1, out);
}

// Finds the cylinder's point nearest to x, and the unit direction from there to x; inside, the nearest way out. Returns
// the distance (m), < 0 inside.
static double nearest_point(const ob_placed *c, ob_vec3 x, ob_vec3 *at, ob_vec3 *n)
{
	ob_vec3 l = ob_rotate_back(&c->r, ob_sub(x, c->p)), p = l, d;
	double across = sqrt(l.x * l.x + l.y * l.y), side = across - c->size.x, end = fabs(l.z) - c->size.y, distance;
	if (side > 0)
		p.x *= c->size.x / across, p.y *= c->size.x / across;
	if (end > 0)
		p.z = copysign(c->size.y, l.z);
	d = ob_sub(l, p);
	distance = ob_norm(d);
	if (distance > crossing * c->size.x) {
		d = ob_scale(d, 1 / distance);
	} else if (side > end) {
		distance = side;
		d = across > 0 ? ob_v3(l.x / across, l.y / across, 0) : ob_v3(1, 0, 0);
		p = ob_v3(c->size.x * d.x, c->size.x * d.y, l.z);
	} else {
		distance = end;
		d = ob_v3(0, 0, copysign(1, l.z));
		p.z = copysign(c->size.y, l.z);
	}
	*at = ob_add(c->p, ob_rotate(&c->r, p));
	*n = ob_rotate(&c->r, d);
	return distance;
}

void ob_manifold_cylinder_sphere(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_vec3 at, n;
	double gap = nearest_point(a, b->p, &at, &n) - b->size.x;
	out->normal = ob_scale(n, -1);
	out->separation = gap;
	out->points = gap <= margin;
	out->gap[0] = gap;
	out->at[0] = ob_madd(at, .5 * gap, n);
}

// ---- directions

// True for an axial shape without rims.
static bool is_rounded(const ob_placed *x)
{
	return ob_shape_is(x->shape, OB_AXIAL) && !ob_shape_is(x->shape, OB_RIMMED);
}

// Best directions so far.
typedef struct search {
	const ob_placed *a, *b;
	double thickness; // m, of the thinner shape
	double gap; // m, largest separation
	ob_vec3 normal; // its direction, from b to a
	bool is_facet; // normal is that of a cap or a face
	double time, last_gap; // s and m: time and gap of the direction that closes last; time < 0: none separates
	ob_vec3 last; // direction that closes last
	bool last_is_facet;
} search;

static void try_direction(search *s, ob_vec3 n, bool facet)
{
	double gap = ob_apart_along(s->a, s->b, n), rate = ob_dot(n, ob_sub(s->a->v, s->b->v));
	if (gap > s->gap + noise * s->thickness)
		s->gap = gap, s->normal = n, s->is_facet = facet;
	if (gap > touching * s->thickness) {
		double time = ob_time_to_close(s->a, s->b, gap, rate);
		if (time > s->time || (time == s->time && gap > s->last_gap + noise * s->thickness))
			s->time = time, s->last_gap = gap, s->last = n, s->last_is_facet = facet;
	}
}

// Tries d in the sense from b to a: the other sense cannot be best.
static void try_along(search *s, ob_vec3 d, bool facet)
{
	try_direction(s, ob_dot(d, ob_sub(s->a->p, ob_middle(s->b))) < 0 ? ob_scale(d, -1) : d, facet);
}

static void try_facets(search *s, const ob_placed *x)
{
	if (ob_shape_is(x->shape, OB_RIMMED))
		try_along(s, ob_column(&x->r, 2), true);
	for (int i = 0; ob_shape_is(x->shape, OB_SIDED) && i < 3; i++)
		try_along(s, ob_column(&x->r, i), true);
	for (uint32_t f = 0; x->hull && f < x->hull->faces; f++) { // x is b: its normals point to a
		const ob_vec3 n = ob_rotate(&x->r, x->hull->normal[f]);
		if (ob_dot(n, ob_sub(s->a->p, s->b->p)) - x->hull->offset[f] > ob_min(s->gap, touching * s->thickness))
			try_direction(s, n, true);
	}
}

enum { EDGES_MAX = 24 }; // maximum of a shape's edges to try: a hull may have more

// Finds the directions of the hull's edges at the corner farthest along n. Returns their number.
static int edges_at_corner(const ob_placed *x, ob_vec3 n, ob_vec3 *edge)
{
	const ob_hull *h = x->hull;
	const ob_vec3 l = ob_rotate_back(&x->r, n);
	uint32_t corner = 0;
	int found = 0;
	for (uint32_t k = 1; k < h->corners; k++)
		if (ob_dot(l, h->corner[k]) > ob_dot(l, h->corner[corner]))
			corner = k;
	for (uint32_t i = 0; i < h->edges && found < EDGES_MAX; i++) {
		const ob_hull_edge *e = &h->edge[i];
		if (e->from == corner || e->to == corner)
			edge[found++] = unit(ob_rotate(&x->r, ob_sub(h->corner[e->to], h->corner[e->from])));
	}
	return found;
}

// Finds edges of the shape to search across: the axis of a round shape, the edges of a box, or a hull's edges at its
// farthest corner along n. Returns their number.
static int edges_of(const ob_placed *x, ob_vec3 n0, ob_vec3 edge[EDGES_MAX])
{
	if (x->hull)
		return edges_at_corner(x, n0, edge);
	int n = ob_shape_is(x->shape, OB_SIDED) ? 3 : 1;
	for (int i = 0; i < n; i++)
		edge[i] = ob_column(&x->r, n == 3 ? i : 2);
	return n;
}

static bool is_deep(const search *s)
{
	return s->gap < -deep * ob_min(s->a->size.x, ob_min(s->a->size.y, s->b->size.x));
}

// Part of a shape that is farthest along n: a point, and the edges that lie across n as a whole.
typedef struct feature {
	ob_vec3 centre, edge[3]; // m: each edge runs from -edge to edge
	int edges;
} feature;

// Feature of a hull: a corner, or an edge if both of its ends are as far. A corner stands for a face.
static feature hull_feature(const ob_placed *x, ob_vec3 n)
{
	const ob_hull *h = x->hull;
	const ob_vec3 l = ob_rotate_back(&x->r, n);
	feature f = { .centre = ob_support(x, n) };
	const double most = ob_dot(n, ob_sub(f.centre, x->p)) - level * h->radius;
	uint32_t high = 0, last[2] = { 0, 0 };
	for (uint32_t k = 0; k < h->corners; k++)
		if (ob_dot(l, h->corner[k]) >= most)
			last[high++ & 1] = k;
	if (high == 2) {
		const ob_vec3 from = h->corner[last[0]], to = h->corner[last[1]];
		f.centre = ob_add(x->p, ob_rotate(&x->r, ob_scale(ob_add(from, to), .5)));
		f.edge[f.edges++] = ob_rotate(&x->r, ob_scale(ob_sub(to, from), .5));
	}
	return f;
}

static feature feature_along(const ob_placed *x, ob_vec3 n)
{
	if (x->hull)
		return hull_feature(x, n);
	const bool sided = ob_shape_is(x->shape, OB_SIDED);
	double h[3] = { x->size.x, x->size.y, x->size.z };
	feature f = { .centre = ob_support(x, n) };
	for (int i = 0; i < 3; i++) {
		ob_vec3 e = ob_column(&x->r, i);
		double half = sided ? h[i] : x->size.y, at = ob_dot(e, ob_sub(f.centre, x->p));
		if ((!sided && i < 2) || fabs(ob_dot(e, n)) > level)
			continue;
		f.centre = ob_madd(f.centre, -copysign(half, at), e);
		f.edge[f.edges++] = ob_scale(e, half);
	}
	return f;
}

// Finds the nearest points of two features, across the normal. Adjusts each edge's parameter in turn: one edge takes
// one round, two take few.
static void nearest_on_features(const feature *f, const feature *g, ob_vec3 *x, ob_vec3 *y)
{
	enum { ROUNDS = 60 };
	double s[6] = { 0 };
	const int n = f->edges + g->edges;
	ob_vec3 d = ob_sub(f->centre, g->centre);
	if (f->edges == 1 && g->edges == 1) {
		double lf = ob_norm(f->edge[0]), lg = ob_norm(g->edge[0]), at_f, at_g;
		ob_nearest_on_lines(unit(f->edge[0]), unit(g->edge[0]), d, lf, lg, &at_f, &at_g);
		s[0] = at_f / lf, s[1] = at_g / lg;
	} else {
		for (int round = 0; n > 0 && round < (n == 1 ? 1 : ROUNDS); round++)
			for (int k = 0; k < n; k++) {
				ob_vec3 e = k < f->edges ? f->edge[k] : ob_scale(g->edge[k - f->edges], -1);
				double next = ob_max(-1, ob_min(1, s[k] - ob_dot(e, d) / ob_norm2(e)));
				d = ob_madd(d, next - s[k], e);
				s[k] = next;
			}
	}
	*x = f->centre, *y = g->centre;
	for (int k = 0; k < n; k++)
		if (k < f->edges)
			*x = ob_madd(*x, s[k], f->edge[k]);
		else
			*y = ob_madd(*y, s[k], g->edge[k - f->edges]);
}

// True if the features along the best direction have a common point. Then no direction near it is better, and none at
// all if the shapes are apart.
static bool is_proven(const search *s)
{
	feature of_a = feature_along(s->a, ob_scale(s->normal, -1)), of_b = feature_along(s->b, s->normal);
	const double near = meet * s->thickness;
	ob_vec3 x, y;
	nearest_on_features(&of_a, &of_b, &x, &y);
	return ob_norm2(part_across(ob_sub(x, y), s->normal)) < near * near;
}

// Tries the directions across the axis of one shape and an axis or edge of the other.
static void try_crossed(search *s, const ob_vec3 *edge, int n)
{
	ob_vec3 d = ob_sub(s->a->p, s->b->p);
	for (int k = 1; k < n; k++) {
		ob_vec3 c = ob_cross(edge[0], edge[k]);
		if (ob_norm2(c) > 1e-12)
			try_along(s, unit(c), false);
		else if (ob_norm2(c = part_across(d, edge[0])) > 1e-12 * ob_norm2(d))
			try_direction(s, unit(c), false);
	}
}

// Climbs across the edge with the steepest slope, again and again, until no edge gives a better direction.
static void climb(search *s, const ob_vec3 *edge, int n, double enough)
{
	enum { CLIMBS = 24 };
	const bool rims = ob_shape_is(s->b->shape, OB_RIMMED);
	const unsigned all = (1u << (n + rims)) - 1; // n is 1 + EDGES_MAX at most
	unsigned tried = 0;
	for (int i = 0; i < CLIMBS && tried != all; i++) {
		ob_vec3 g = ob_support_between(s->a, s->b, s->normal);
		double most = -1, before = s->gap;
		int best = n;
		for (int k = 0; k < n; k++) {
			double slope = fabs(ob_dot(ob_cross(edge[k], s->normal), g));
			if (!(tried >> k & 1) && slope > most)
				most = slope, best = k;
		}
		try_direction(s,
			      best < n ? ob_climb_across(s->a, s->b, edge[best], s->normal)
				       : ob_climb_rims(s->a, s->b, s->normal),
			      false);
		tried = s->gap > before + noise * s->thickness ? 1u << best : tried | 1u << best;
		if (s->gap > enough || (s->gap > before && !is_deep(s) && is_proven(s)))
			return;
	}
}

// Climbs from several starts, since the separation of shapes that overlap deeply has several maxima.
static void climb_from_everywhere(search *s, const ob_vec3 *edge, int n)
{
	ob_vec3 d = ob_sub(s->a->p, ob_middle(s->b)), start[STARTS];
	int starts = 0;
	if (ob_norm2(d) > 0)
		start[starts++] = unit(d);
	for (int k = 0; k < n; k++)
		start[starts++] = ob_scale(edge[k], ob_dot(d, edge[k]) < 0 ? -1 : 1);
	for (int i = 0; i < starts; i++) {
		for (int k = 0; k < n; k++)
			try_direction(s, ob_climb_across(s->a, s->b, edge[k], start[i]), false);
		if (ob_shape_is(s->b->shape, OB_RIMMED))
			try_direction(s, ob_climb_rims(s->a, s->b, start[i]), false);
	}
}

// Tries directions across the axis and each edge of a hull that may be better than the best so far.
static void try_hull_crossed(search *s, ob_vec3 axis)
{
	const ob_placed *b = s->b;
	const ob_hull *h = b->hull;
	const ob_vec3 d = ob_sub(s->a->p, b->p);
	for (uint32_t i = 0; i < h->edges; i++) {
		const ob_hull_edge *e = &h->edge[i];
		const ob_vec3 from = ob_rotate(&b->r, h->corner[e->from]);
		const ob_vec3 way = ob_rotate(&b->r, ob_sub(h->corner[e->to], h->corner[e->from])),
			      c = ob_cross(axis, way);
		if (ob_norm2(c) <= 1e-12 * ob_norm2(way))
			continue;
		const ob_vec3 out = ob_rotate(&b->r, ob_add(h->normal[e->left], h->normal[e->right]));
		const ob_vec3 n = ob_scale(unit(c), ob_dot(c, out) < 0 ? -1 : 1);
		if (ob_dot(n, ob_sub(d, from)) > ob_min(s->gap, touching * s->thickness))
			try_direction(s, n, false);
	}
}

// Climbs across every edge of a hull with a side that may be better than the best so far.
static void climb_hull(search *s)
{
	const ob_placed *b = s->b;
	const ob_hull *h = b->hull;
	const ob_vec3 d = ob_sub(s->a->p, b->p);
	for (uint32_t i = 0; i < h->edges; i++) {
		const ob_hull_edge *e = &h->edge[i];
		const ob_vec3 n = unit(ob_rotate(&b->r, ob_add(h->normal[e->left], h->normal[e->right])));
		const ob_vec3 way = unit(ob_rotate(&b->r, ob_sub(h->corner[e->to], h->corner[e->from])));
		if (ob_dot(n, ob_sub(d, ob_rotate(&b->r, h->corner[e->from]))) > s->gap)
			try_direction(s, ob_climb_across(s->a, b, way, n), false);
	}
}

// Tries the directions from the corners of b to a.
static void try_corners(search *s)
{
	const ob_placed *b = s->b;
	ob_vec3 at, n;
	const uint32_t corners = b->hull ? b->hull->corners : 8;
	for (uint32_t k = 0; k < corners; k++) {
		const ob_vec3 h = b->hull ? b->hull->corner[k] : ob_box_corner(b->size, k);
		nearest_point(s->a, ob_add(b->p, ob_rotate(&b->r, h)), &at, &n);
		try_direction(s, ob_scale(n, -1), false);
	}
}

// Tries all directions along which features other than facets can touch. Ends when one is proven to be best, or
// separates the shapes by more than "enough" (m).
static void try_others(search *s, double enough)
{
	enum { CORNERS = 4 };
	const ob_placed *b = s->b;
	const bool hull = b->hull, rounded = is_rounded(b);
	ob_vec3 at, n, edge[1 + EDGES_MAX] = { ob_column(&s->a->r, 2) };
	int edges = 1 + edges_of(b, s->normal, edge + 1);
	for (int k = -1; rounded && k < 2; k += 2) {
		nearest_point(s->a, ob_madd(b->p, k * b->size.y, ob_column(&b->r, 2)), &at, &n);
		try_direction(s, ob_scale(n, -1), false);
	}
	if (hull)
		try_hull_crossed(s, edge[0]);
	else
		try_crossed(s, edge, edges);
	if (s->gap > enough || (!is_deep(s) && is_proven(s)))
		return;
	climb(s, edge, edges, enough);
	for (int i = 0; hull && i < CORNERS && s->gap <= enough; i++) { // from corner to corner
		const double before = s->gap;
		edges = 1 + edges_of(b, s->normal, edge + 1);
		climb(s, edge, edges, enough);
		if (s->gap <= before + noise * s->thickness)
			break;
	}
	if (hull && s->gap <= enough && !is_proven(s))
		climb_hull(s);
	if (is_deep(s))
		climb_from_everywhere(s, edge, edges < STARTS ? edges : STARTS - 1);
	if (!ob_shape_is(b->shape, OB_CORNERED) || !(s->gap > 0) || s->gap > enough || is_proven(s))
		return;
	try_corners(s); // a corner beside a rim
}

// ---- points

// Finds the outward normal of the facet of x that looks most along n. Returns false if none is within the cosine of n.
static bool facet_near(const ob_placed *x, ob_vec3 n, double cosine, ob_vec3 *outward)
{
	bool near = false;
	for (uint32_t f = 0; x->hull && f < x->hull->faces; f++) {
		const ob_vec3 e = ob_rotate(&x->r, x->hull->normal[f]);
		if (ob_dot(e, n) >= cosine)
			cosine = ob_dot(e, n), *outward = e, near = true;
	}
	if (x->hull)
		return near;
	for (int i = ob_shape_is(x->shape, OB_SIDED) ? 0 : 2; i < 3 && !is_rounded(x); i++) {
		ob_vec3 e = ob_column(&x->r, i);
		double c = ob_dot(e, n);
		if (fabs(c) >= cosine)
			cosine = fabs(c), *outward = ob_scale(e, c < 0 ? -1 : 1), near = true;
	}
	return near;
}

static bool hull_line_beside(const ob_placed *x, ob_vec3 n, ob_vec3 axis, ob_placed *line)
{
	const feature f = hull_feature(x, n);
	if (f.edges != 1 || fabs(ob_dot(unit(f.edge[0]), axis)) < along_facet)
		return false;
	const ob_vec3 e = unit(f.edge[0]), p = unit(ob_cross(e, fabs(e.x) < .6 ? ob_v3(1, 0, 0) : ob_v3(0, 1, 0))),
		      q = ob_cross(e, p);
	line->p = f.centre;
	line->size = ob_v3(0, ob_norm(f.edge[0]), 0);
	line->r = (ob_mat3){ { { p.x, q.x, e.x }, { p.y, q.y, e.y }, { p.z, q.z, e.z } } };
	return true;
}

// Finds a line with a radius, as a capsule, that runs along a's axis and reaches farthest along n: the axis of a round
// shape, or an edge. Returns false if there is none.
static bool line_beside(const ob_placed *x, ob_vec3 n, ob_vec3 axis, ob_placed *line)
{
	*line = *x;
	if (x->hull)
		return hull_line_beside(x, n, axis, line);
	if (!ob_shape_is(x->shape, OB_SIDED))
		return fabs(ob_dot(ob_column(&x->r, 2), n)) < side_lean;
	double h[3] = { x->size.x, x->size.y, x->size.z };
	for (int i = 0; i < 3; i++) {
		ob_vec3 e = ob_column(&x->r, i), corner = ob_support(x, n);
		if (fabs(ob_dot(e, axis)) < along_facet)
			continue;
		line->p = ob_madd(corner, -ob_dot(e, ob_sub(corner, x->p)), e);
		line->size = ob_v3(0, h[i], 0);
		for (int c = 0; c < 3; c++) {
			line->r.m[c][2] = x->r.m[c][i];
			line->r.m[c][0] = x->r.m[c][(i + 1) % 3];
			line->r.m[c][1] = x->r.m[c][(i + 2) % 3];
		}
		return true;
	}
	return false;
}

// Makes the manifold along n, which is no facet's normal. Its points are the nearest ones of two features, and the ends
// of a side that lies along a side or an edge. Points about to touch on facets with normals near n are added.
static void other_points(const search *s, ob_vec3 n, double margin, ob_manifold *out)
{
	feature of_a = feature_along(s->a, ob_scale(n, -1)), of_b = feature_along(s->b, n);
	ob_vec3 x, y, axis = ob_column(&s->a->r, 2);
	ob_line_point nearest = { .gap = ob_apart_along(s->a, s->b, n), .there = true }, end[2] = { 0 };
	ob_placed side_a, side_b;
	nearest_on_features(&of_a, &of_b, &x, &y);
	nearest.at = ob_scale(ob_add(x, y), .5);
	nearest.s = ob_dot(axis, ob_sub(nearest.at, s->a->p));
	if (line_beside(s->a, ob_scale(n, -1), axis, &side_a) && line_beside(s->b, n, axis, &side_b))
		ob_side_by_side(&side_a, &side_b, n, nearest.s, end);
	ob_manifold_line(&nearest, end, margin, out);
	out->normal = n;
	ob_spots all = { .normal = n, .margin = margin, .same = 1e-5 * s->a->size.x };
	for (int k = 0; k < out->points; k++)
		ob_spots_add(&all, out->at[k], out->gap[k]);
	for (int side = 0; side < 2; side++) {
		const ob_placed *on = side ? s->b : s->a, *over = side ? s->a : s->b;
		ob_vec3 outward;
		ob_spots beside;
		if (!facet_near(on, side ? n : ob_scale(n, -1), along_facet, &outward))
			continue;
		ob_spots_find(on, over, outward, margin, &beside);
		for (int k = 0; k < beside.n; k++)
			ob_spots_add(&all, beside.at[k], ob_max(beside.gap[k], nearest.gap));
	}
	ob_spots_reduce(&all);
	ob_spots_put(&all, 1, out);
}

// Finds the common points along n, a facet's normal. sign: for ob_spots_put.
static void facet_points(const search *s, ob_vec3 n, double margin, ob_spots *spots, double *sign)
{
	static const double same = 1 - 1e-12;
	ob_vec3 outward;
	bool of_b = facet_near(s->b, n, same, &outward);
	if (!of_b)
		facet_near(s->a, ob_scale(n, -1), 0, &outward);
	*sign = of_b ? 1 : -1;
	ob_spots_find(of_b ? s->b : s->a, of_b ? s->a : s->b, outward, margin, spots);
}

static bool proven_by(const search *s, const ob_spots *spots)
{
	for (int k = 0; k < spots->n; k++)
		if (spots->gap[k] <= s->gap + as_deep * s->thickness)
			return true;
	return false;
}

// True if the shapes overlap beyond a facet, but hardly more to the side. A point then proves that the facet's normal
// is better than directions near it, not than all.
static bool is_overhanging(const search *s)
{
	static const double hardly = 2; // ratio
	const ob_placed *x[2] = { s->a, s->b };
	const ob_vec3 d = ob_sub(s->a->p, s->b->p);
	for (int k = 0; s->gap < 0 && k < 2; k++) {
		const ob_vec3 side = part_across(d, ob_column(&x[k]->r, 2));
		if (ob_shape_is(x[k]->shape, OB_RIMMED) && ob_norm2(side) > 1e-12 * ob_norm2(d) &&
		    ob_apart_along(s->a, s->b, unit(side)) > hardly * s->gap)
			return true;
	}
	return false;
}

// Makes the manifold over the face of a box on which the cylinder rolls or slides across a seam, if n is not its
// normal. Returns false if there is none.
static bool on_face_underfoot(const search *s, ob_vec3 n, double margin, ob_manifold *out)
{
	ob_placed wider;
	ob_vec3 normal;
	ob_spots spots;
	bool leaving;
	if (!ob_face_underfoot(s->a, s->b, n, ob_apart_along(s->a, s->b, n), margin, &wider, &normal, &leaving))
		return false;
	ob_spots_find(&wider, s->a, normal, margin, &spots);
	ob_spots_reduce(&spots);
	ob_spots_put(&spots, 1, out);
	if (leaving) // it may still fall off the edge
		out->valid_path = ob_leaving_path(s->a, s->b);
	return true;
}

void ob_manifold_cylinder_edged(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	const bool sharp = !is_rounded(b); // a round shape slips off: the nearest direction will do
	const double thickness = ob_min(ob_shape_thickness(a->shape, a->size), ob_shape_thickness(b->shape, b->size));
	search s = { .a = a, .b = b, .thickness = thickness, .gap = -INFINITY, .time = -1 };
	ob_spots spots;
	double sign;
	try_facets(&s, a);
	try_facets(&s, b);
	out->points = 0;
	out->separation = s.gap;
	if (s.gap > margin + far * thickness)
		return;
	facet_points(&s, s.normal, margin, &spots, &sign);
	const ob_vec3 tried = s.normal;
	const bool proven = proven_by(&s, &spots) && !is_overhanging(&s);
	if (!proven || is_deep(&s) || (sharp && s.gap > near_enough * thickness))
		try_others(&s, margin + far * thickness);
	out->separation = s.gap;
	if (out->separation > margin)
		return;
	const bool closing = sharp && s.time >= 0;
	const ob_vec3 n = closing ? s.last : s.normal;
	const bool facet = closing ? s.last_is_facet : s.is_facet;
	const bool same = facet && ob_dot(n, tried) == ob_dot(tried, tried);
	if (ob_shape_is(b->shape, OB_SIDED) && !(same && proven) && on_face_underfoot(&s, n, margin, out))
		return;
	if (!facet) {
		other_points(&s, n, margin, out);
		return;
	}
	if (!same)
		facet_points(&s, n, margin, &spots, &sign);
	ob_spots_reduce(&spots);
	ob_spots_put(&spots, sign, out);
}

#include "terrain/terrain.h"

#include <math.h>
#include <stdlib.h>

#include "base/allocate.h"

static double component(ob_vec3 v, int i)
{
	return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

static void corners_of(const ob_terrain *t, uint32_t triangle, ob_vec3 out[3])
{
	const ob_terrain_triangle *x = &ob_terrain_triangles(t)[triangle];
	for (int k = 0; k < 3; k++)
		out[k] = ob_terrain_vertices(t)[x->corner[k]];
}

static const ob_terrain_region *region_of(const ob_terrain *t, uint32_t triangle)
{
	return &ob_terrain_regions(t)[ob_terrain_triangles(t)[triangle].region];
}

ob_vec3 ob_terrain_size(const ob_terrain *t)
{
	const double x = ob_max(-t->low[0], t->high[0]), y = ob_max(-t->low[1], t->high[1]),
		     z = ob_max(-t->low[2], t->high[2]);
	return ob_v3(x, y, z + .05 * (x + y));
}

// ---- search

static uint32_t column_of(const ob_terrain *t, int axis, double x)
{
	const double c = (x - t->low[axis]) * t->per_metre[axis];
	return c > 0 ? (uint32_t)ob_min(c, t->columns[axis] - 1) : 0;
}

static void enter_column(ob_terrain_search *s)
{
	const uint32_t *first = ob_terrain_first(s->t), column = s->y * s->t->columns[0] + s->x;
	s->at = first[column];
	s->stop = first[column + 1];
}

void ob_terrain_begin(const ob_terrain *t, const double low[3], const double high[3], ob_terrain_search *s)
{
	bool apart = false;
	*s = (ob_terrain_search){ .t = t };
	for (int i = 0; i < 3; i++) {
		s->low[i] = low[i], s->high[i] = high[i];
		apart |= !(low[i] <= t->high[i] && high[i] >= t->low[i]);
	}
	for (int i = 0; i < 2; i++)
		s->begin[i] = column_of(t, i, low[i]), s->end[i] = column_of(t, i, high[i]) + 1;
	s->x = s->begin[0], s->y = apart ? s->end[1] : s->begin[1];
	if (!apart)
		enter_column(s);
}

bool ob_terrain_overlaps(const ob_terrain *t, uint32_t triangle, const double low[3], const double high[3])
{
	ob_vec3 c[3];
	bool apart = false;
	corners_of(t, triangle, c);
	for (int i = 0; i < 3; i++) {
		const double a = component(c[0], i), b = component(c[1], i), d = component(c[2], i);
		apart |= ob_min(a, ob_min(b, d)) > high[i] || ob_max(a, ob_max(b, d)) < low[i];
	}
	return !apart;
}

// True if the triangle and a box of these half extents about the origin have no point in common along an axis.
static bool parts(const ob_vec3 c[3], ob_vec3 half, ob_vec3 axis)
{
	const double a = ob_dot(axis, c[0]), b = ob_dot(axis, c[1]), d = ob_dot(axis, c[2]),
		     reach = fabs(axis.x) * half.x + fabs(axis.y) * half.y + fabs(axis.z) * half.z;
	return ob_min(a, ob_min(b, d)) > reach || ob_max(a, ob_max(b, d)) < -reach;
}

// Separating axes (Akenine-Moeller 2001, Fast 3D triangle-box overlap testing).
bool ob_terrain_enters(const ob_terrain *t, uint32_t triangle, const double low[3], const double high[3])
{
	const ob_vec3 middle = ob_v3(.5 * (low[0] + high[0]), .5 * (low[1] + high[1]), .5 * (low[2] + high[2])),
		      half = ob_v3(.5 * (high[0] - low[0]), .5 * (high[1] - low[1]), .5 * (high[2] - low[2]));
	ob_vec3 c[3];
	corners_of(t, triangle, c);
	for (int k = 0; k < 3; k++)
		c[k] = ob_sub(c[k], middle);
	bool apart = parts(c, half, region_of(t, triangle)->normal);
	for (int k = 0; k < 3; k++) {
		const ob_vec3 way = ob_sub(c[(k + 1) % 3], c[k]);
		const ob_vec3 axis[] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
		apart = apart || parts(c, half, axis[k]);
		for (int i = 0; i < 3; i++)
			apart = apart || parts(c, half, ob_cross(way, axis[i]));
	}
	return !apart;
}

// True if the boxes overlap, and the search meets the triangle first in this column.
static bool is_found(const ob_terrain_search *s, uint32_t triangle)
{
	const uint32_t here[2] = { s->x, s->y };
	ob_vec3 c[3];
	corners_of(s->t, triangle, c);
	for (int i = 0; i < 3; i++) {
		const double a = component(c[0], i), b = component(c[1], i), d = component(c[2], i),
			     low = ob_min(a, ob_min(b, d)), high = ob_max(a, ob_max(b, d));
		if (low > s->high[i] || high < s->low[i])
			return false;
		if (i < 2) {
			const uint32_t begin = column_of(s->t, i, low);
			if (here[i] != (begin > s->begin[i] ? begin : s->begin[i]))
				return false;
		}
	}
	return true;
}

bool ob_terrain_next(ob_terrain_search *s, uint32_t *triangle)
{
	const uint32_t *entry = ob_terrain_first(s->t) + s->t->columns[0] * s->t->columns[1] + 1;
	while (s->y < s->end[1]) {
		while (s->at < s->stop) {
			*triangle = entry[s->at++];
			if (is_found(s, *triangle))
				return true;
		}
		if (++s->x == s->end[0])
			s->x = s->begin[0], s->y++;
		if (s->y < s->end[1])
			enter_column(s);
	}
	return false;
}

static int ascending(const void *x, const void *y)
{
	const uint32_t a = *(const uint32_t *)x, b = *(const uint32_t *)y;
	return a < b ? -1 : a > b;
}

uint32_t ob_terrain_find_regions(const ob_terrain *t, const double low[3], const double high[3], uint32_t *out,
				 uint32_t max)
{
	ob_terrain_search s;
	uint32_t triangle, n = 0, room = 0, *all = NULL, unlike = 0;
	ob_terrain_begin(t, low, high, &s);
	while (ob_terrain_next(&s, &triangle)) {
		const uint32_t region = ob_terrain_triangles(t)[triangle].region;
		if (n && all[n - 1] == region)
			continue;
		if (n == room) {
			room = 2 * room + 64;
			all = ob_reallocate(all, room * sizeof *all);
		}
		all[n++] = region;
	}
	if (n)
		qsort(all, n, sizeof *all, ascending);
	for (uint32_t i = 0; i < n; i++) {
		if (i && all[i] == all[i - 1])
			continue;
		if (unlike < max)
			out[unlike] = all[i];
		unlike++;
	}
	free(all);
	return unlike;
}

// ---- points of a triangle

// Height of x over the line through edge k, in the triangle's plane, inwards, as a share of the triangle's.
static double share_inside(const ob_vec3 c[3], ob_vec3 n, int k, ob_vec3 x)
{
	const ob_vec3 from = c[k], way = ob_sub(c[(k + 1) % 3], from), in = ob_cross(n, way);
	return ob_dot(in, ob_sub(x, from)) / ob_dot(in, ob_sub(c[(k + 2) % 3], from));
}

static const double gentle = 1e-3; // sine: an edge from which the surface falls by less is a seam
static const double least_lean = 1e-7; // sine that rounding brings about
static const double on_edge = 1e-6; // share of the triangle's height: points this near to an edge are on it

// The corner of the triangle beyond edge k that is not on the edge; UINT32_MAX: there is none.
static uint32_t corner_beyond(const ob_terrain *t, uint32_t triangle, int k)
{
	const ob_terrain_triangle *own = &ob_terrain_triangles(t)[triangle];
	if (!own->across[k])
		return UINT32_MAX;
	const ob_terrain_triangle *other = &ob_terrain_triangles(t)[own->across[k] - 1];
	for (int i = 0; i < 3; i++)
		if (other->corner[i] != own->corner[k] && other->corner[i] != own->corner[(k + 1) % 3])
			return other->corner[i];
	return UINT32_MAX;
}

// True if x lies over the triangle, seen along n.
static bool is_beyond_none(const ob_terrain *t, uint32_t triangle, ob_vec3 n, ob_vec3 x)
{
	ob_vec3 c[3];
	bool over = true;
	corners_of(t, triangle, c);
	for (int k = 0; k < 3; k++) {
		const ob_vec3 way = ob_sub(c[(k + 1) % 3], c[k]);
		over &= ob_dot(ob_cross(n, way), ob_sub(x, c[k])) >= -on_edge * ob_norm2(way);
	}
	return over;
}

bool ob_terrain_is_over(const ob_terrain *t, uint32_t triangle, ob_vec3 x, double near, double slack)
{
	const ob_terrain_triangle *all = ob_terrain_triangles(t);
	const ob_terrain_region *r = region_of(t, triangle);
	ob_vec3 c[3];
	corners_of(t, triangle, c);
	for (int k = 0; k < 3; k++) {
		if (share_inside(c, r->normal, k, x) >= -on_edge)
			continue;
		const ob_vec3 way = ob_sub(c[(k + 1) % 3], c[k]);
		const uint32_t beyond = corner_beyond(t, triangle, k), across = all[triangle].across[k];
		if (beyond == UINT32_MAX || all[across - 1].region == all[triangle].region)
			return false;
		const double length = ob_norm(way),
			     rise = ob_dot(r->normal, ob_sub(ob_terrain_vertices(t)[beyond], c[k])),
			     far = ob_dot(ob_cross(way, r->normal), ob_sub(x, c[k])) / length;
		if (rise < -gentle * length || far > slack ||
		    (far > near && !is_beyond_none(t, across - 1, r->normal, x)))
			return false;
	}
	return true;
}

static bool is_lower(const ob_terrain *t, uint32_t vertex, ob_vec3 x, ob_vec3 n, double lean)
{
	const ob_vec3 way = ob_sub(ob_terrain_vertices(t)[vertex], x);
	return ob_dot(n, way) <= lean * ob_norm(way);
}

static int corner_number(const ob_terrain_triangle *x, uint32_t vertex)
{
	return x->corner[0] == vertex ? 0 : x->corner[1] == vertex ? 1 : 2;
}

// True if all vertices of the triangles about a vertex are lower, as far as one way round goes: it ends at the triangle
// itself, or at a border. step: 0: over the edges that begin at the vertex; 2: over those that end there.
static bool are_lower_around(const ob_terrain *t, uint32_t triangle, uint32_t vertex, ob_vec3 x, ob_vec3 n, double lean,
			     int step)
{
	enum { MOST = 64 };
	const ob_terrain_triangle *all = ob_terrain_triangles(t);
	uint32_t at = triangle;
	for (int i = 0; i < MOST; i++) {
		const ob_terrain_triangle *x_at = &all[at];
		const int k = corner_number(x_at, vertex);
		if (!is_lower(t, x_at->corner[(k + 1) % 3], x, n, lean) ||
		    !is_lower(t, x_at->corner[(k + 2) % 3], x, n, lean))
			return false;
		const uint32_t next = x_at->across[(k + step) % 3];
		if (!next || next - 1 == triangle)
			return true;
		at = next - 1;
	}
	return true;
}

// The edge at the border below which x is, on the side of solid ground; -1: none.
static int border_above(const ob_terrain *t, uint32_t triangle, const ob_vec3 c[3], ob_vec3 x)
{
	const ob_terrain_triangle *own = &ob_terrain_triangles(t)[triangle];
	const ob_terrain_region *r = region_of(t, triangle);
	if (!t->solid || !(r->normal.z > 0))
		return -1;
	x.z += (r->offset - ob_dot(r->normal, x)) / r->normal.z;
	for (int k = 0; k < 3; k++)
		if (!own->across[k] && share_inside(c, r->normal, k, x) <= on_edge)
			return k;
	return -1;
}

bool ob_terrain_supports(const ob_terrain *t, uint32_t triangle, ob_vec3 x, ob_vec3 n, double lean)
{
	lean = ob_max(lean, least_lean);
	const ob_terrain_triangle *own = &ob_terrain_triangles(t)[triangle];
	const ob_vec3 normal = region_of(t, triangle)->normal;
	ob_vec3 c[3];
	int edge = -1, edges = 0;
	corners_of(t, triangle, c);
	for (int k = 0; k < 3; k++)
		if (share_inside(c, normal, k, x) <= on_edge) {
			edge = edges == 1 && edge == 0 && k == 2 ? 2 : edges ? edge : k; // 2, if corner 0
			edges++;
		}
	if (!edges && (edge = border_above(t, triangle, c, x)) < 0)
		return ob_dot(n, normal) > 1 - 1e-12;
	if (edges > 1) { // edge k and the next meet at corner k + 1
		const int corner = (edge + 1) % 3;
		const uint32_t vertex = own->corner[corner];
		return are_lower_around(t, triangle, vertex, c[corner], n, lean, 0) &&
		       are_lower_around(t, triangle, vertex, c[corner], n, lean, 2);
	}
	for (int k = 0; k < 3; k++)
		if (!is_lower(t, own->corner[k], x, n, lean))
			return false;
	const uint32_t beyond = corner_beyond(t, triangle, edge);
	return beyond == UINT32_MAX || is_lower(t, beyond, x, n, lean);
}

// ---- hulls

void ob_terrain_column(const ob_terrain *t, uint32_t triangle, double depth, ob_hull *out, ob_vec3 *centre)
{
	const ob_vec3 n = region_of(t, triangle)->normal;
	const double steepest = .05;
	const ob_vec3 down = t->solid ? ob_v3(0, 0, -depth / ob_max(n.z, steepest)) : ob_scale(n, -depth);
	ob_vec3 c[3];
	corners_of(t, triangle, c);
	*centre = ob_madd(ob_scale(ob_add(c[0], ob_add(c[1], c[2])), 1. / 3), .5, down);
	out->corners = 6, out->faces = 5, out->edges = 9;
	out->parts = 0, out->is_part = 1, out->round = 0;
	for (int k = 0; k < 3; k++) {
		out->corner[k] = ob_sub(c[k], *centre);
		out->corner[k + 3] = ob_add(out->corner[k], down);
	}
	static const uint8_t loop[] = { 0, 1, 2, 3, 5, 4, 1, 0, 3, 4, 2, 1, 4, 5, 0, 2, 5, 3 };
	static const uint16_t first[] = { 0, 3, 6, 10, 14, 18 };
	static const ob_hull_edge edge[] = { { 0, 1, 0, 2 }, { 1, 2, 0, 3 }, { 2, 0, 0, 4 },
					     { 4, 3, 1, 2 }, { 5, 4, 1, 3 }, { 3, 5, 1, 4 },
					     { 0, 3, 2, 4 }, { 1, 4, 3, 2 }, { 2, 5, 4, 3 } };
	for (size_t i = 0; i < sizeof loop; i++)
		out->loop[i] = loop[i];
	for (size_t i = 0; i < sizeof first / sizeof *first; i++)
		out->first[i] = first[i];
	for (size_t i = 0; i < sizeof edge / sizeof *edge; i++)
		out->edge[i] = edge[i];
	out->normal[0] = n, out->normal[1] = ob_scale(n, -1);
	double thickness = -ob_dot(n, down);
	for (int k = 0; k < 3; k++) {
		const ob_vec3 way = ob_sub(c[(k + 1) % 3], c[k]), side = ob_cross(way, down),
			      in = ob_scale(side, 1 / ob_norm(side));
		out->normal[2 + k] = ob_scale(in, -1);
		thickness = ob_min(thickness, fabs(ob_dot(in, ob_sub(c[(k + 2) % 3], c[k]))));
	}
	out->inner = INFINITY, out->radius = 0;
	for (uint32_t f = 0; f < out->faces; f++) {
		out->offset[f] = ob_dot(out->normal[f], out->corner[out->loop[out->first[f]]]);
		out->inner = ob_min(out->inner, out->offset[f]);
	}
	for (uint32_t k = 0; k < out->corners; k++)
		out->radius = ob_max(out->radius, ob_norm(out->corner[k]));
	out->thickness = thickness;
	out->volume = 1;
	out->centre = ob_v3(0, 0, 0);
	out->frame = ob_quat_identity();
	out->inertia = ob_v3(1, 1, 1);
}

void ob_terrain_take(const ob_terrain *t, uint32_t region, ob_terrain_part *out)
{
	const ob_terrain_region *r = &ob_terrain_regions(t)[region];
	const ob_vec3 n = r->normal, low = ob_v3(r->low[0], r->low[1], r->low[2]),
		      half = ob_scale(ob_sub(ob_v3(r->high[0], r->high[1], r->high[2]), low), .5),
		      middle = ob_add(low, half);
	ob_vec3 axis[3] = { { 0, 0, 0 }, { 0, 0, 0 }, n };
	double reach[3];
	axis[0] = ob_cross(n, fabs(n.z) > .7 ? ob_v3(0, 1, 0) : ob_v3(0, 0, 1));
	axis[0] = ob_scale(axis[0], 1 / ob_norm(axis[0]));
	axis[1] = ob_cross(n, axis[0]);
	for (int k = 0; k < 2; k++) // half of the region's box
		reach[k] = fabs(axis[k].x) * half.x + fabs(axis[k].y) * half.y + fabs(axis[k].z) * half.z;
	reach[2] = ob_norm(half); // whatever the axes
	ob_hull *h = &out->hull;
	h->corners = 8, h->faces = h->edges = 0;
	h->parts = 0, h->is_part = 1, h->round = 0;
	h->centre = ob_madd(middle, r->offset - ob_dot(n, middle) - reach[2], n);
	h->radius = 0;
	for (uint32_t k = 0; k < h->corners; k++) {
		h->corner[k] = h->centre;
		for (int i = 0; i < 3; i++)
			h->corner[k] = ob_madd(h->corner[k], k >> i & 1 ? reach[i] : -reach[i], axis[i]);
		h->radius = ob_max(h->radius, ob_norm(h->corner[k]));
	}
	h->inner = -1; // so that its middle is its own
	h->thickness = 2 * reach[2];
	out->terrain = t;
	out->region = region;
}

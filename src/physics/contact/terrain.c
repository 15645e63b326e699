// Contacts with a region of a terrain. Triangles are touched as the ground below each of them is, but only along
// directions that support the surface: its normal, those between the normals at a ridge, those about a peak. So bodies
// meet no seams between triangles. Where all triangles near a body are in one plane, the manifold is that of the plane.
#include "terrain/terrain.h"

#include "contact/pairs.h"
#include "contact/polytope.h"
#include "contact/support.h"
#include "shape/shape.h"

typedef void find_function(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

// By the shape of a body: its contacts with a plane, and with the hull of the ground below a triangle.
static find_function *const on_plane[OB_SHAPE_KINDS] = {
	[OB_SHAPE_SPHERE] = ob_manifold_sphere_plane,   [OB_SHAPE_BOX] = ob_manifold_box_plane,
	[OB_SHAPE_CAPSULE] = ob_manifold_capsule_plane, [OB_SHAPE_CYLINDER] = ob_manifold_cylinder_plane,
	[OB_SHAPE_HULL] = ob_manifold_hull_plane,
};
static find_function *const in_column[OB_SHAPE_KINDS] = {
	[OB_SHAPE_BOX] = ob_manifold_polytopes,
	[OB_SHAPE_CAPSULE] = ob_manifold_round_hull,
	[OB_SHAPE_CYLINDER] = ob_manifold_cylinder_edged,
	[OB_SHAPE_HULL] = ob_manifold_polytopes,
};

static const double as_normal = 1 - 1e-12; // cosine: a direction this near to the region's normal is the normal
// Sine: a flat face may lean by so much from what supports the surface, as it does while its body tilts on a ridge. Round
// sides may not: they would meet seams.
static const double face_lean = .02;
static const double cap = .9999; // cosine: a direction this near to a cylinder's axis is that of its flat end
static const double same_place = 1e-9; // relative to the body's radius: points nearer to each other are one

enum { OTHERS = 24 };
enum { FEW = 32 }; // triangles of a region that are looked at one by one

// Search for the contact of a body and a region.
typedef struct contact {
	const ob_placed *a, *b;
	const ob_terrain *terrain;
	const ob_terrain_region *region;
	uint32_t number; // of the region
	double margin, radius;
	ob_placed plane; // of the region
	ob_vec3 normal; // of the region, in the world
	ob_manifold on_plane; // of the body with the plane
	ob_polygon over; // points along the normal
	ob_vec3 u, w; // axes of the polygon
	uint32_t pieces; // triangles that were tested
	uint32_t others; // found along other directions
	ob_manifold other[OTHERS];
	double separation; // least, m
	ob_manifold deepest; // below this depth, along a direction that does not support the surface
} contact;

static ob_vec3 to_terrain(const contact *c, ob_vec3 x)
{
	return ob_rotate_back(&c->b->r, ob_sub(x, c->b->p));
}

// The region as an endless plane, with an attitude that is the terrain's where the two are parallel.
static void place_plane(contact *c)
{
	const ob_vec3 n = c->region->normal;
	const ob_quat q =
		n.z < -1 + 1e-12 ? (ob_quat){ 0, 1, 0, 0 } : ob_quat_normalize((ob_quat){ 1 + n.z, -n.y, n.x, 0 });
	const ob_mat3 turn = ob_quat_matrix(q);
	c->plane = *c->b;
	c->plane.shape = OB_SHAPE_PLANE;
	c->plane.hull = NULL;
	for (int k = 0; k < 3; k++) {
		const ob_vec3 axis = ob_rotate(&c->b->r, ob_column(&turn, k));
		c->plane.r.m[0][k] = axis.x, c->plane.r.m[1][k] = axis.y, c->plane.r.m[2][k] = axis.z;
	}
	c->normal = ob_column(&c->plane.r, 2);
	c->plane.p = ob_madd(c->b->p, c->region->offset, c->normal);
	c->u = ob_column(&c->plane.r, 0), c->w = ob_column(&c->plane.r, 1);
}

// Box of the body, in the terrain's frame, with a border.
static void box_of(const contact *c, double border, double low[3], double high[3])
{
	const ob_vec3 centre = to_terrain(c, c->a->p);
	const double at[3] = { centre.x, centre.y, centre.z };
	for (int k = 0; k < 3; k++) {
		const ob_vec3 e = ob_column(&c->b->r, k);
		low[k] = at[k] - ob_reach(c->a, ob_scale(e, -1)) - border;
		high[k] = at[k] + ob_reach(c->a, e) + border;
	}
}

// Distance (m) of the body's box from that of the region; <= 0: they overlap.
static double apart_by_box(const contact *c)
{
	double low[3], high[3], most = -INFINITY;
	box_of(c, 0, low, high);
	for (int k = 0; k < 3; k++)
		most = ob_max(most, ob_max(low[k] - (double)c->region->high[k], (double)c->region->low[k] - high[k]));
	return most;
}

// Looks at the triangles near the body. own: some are the region's; returns true if all are, none ends there, and one is as
// near as the body's box.
static bool is_endless(const contact *c, double border, bool *own)
{
	const ob_terrain_triangle *triangle = ob_terrain_triangles(c->terrain);
	double low[3], high[3];
	ob_terrain_search s;
	uint32_t i;
	const uint32_t *listed = ob_terrain_by_region(c->terrain) + c->region->first;
	bool endless = true, enters = false;
	*own = false;
	box_of(c, border, low, high);
	for (i = 0; i < c->region->triangles && i < FEW; i++)
		*own |= ob_terrain_overlaps(c->terrain, listed[i], low, high);
	if (!*own && c->region->triangles <= FEW)
		return false;
	ob_terrain_begin(c->terrain, low, high, &s);
	while (ob_terrain_next(&s, &i)) {
		const bool in = triangle[i].region == c->number;
		*own |= in;
		endless &= in && triangle[i].across[0] && triangle[i].across[1] && triangle[i].across[2];
		enters = enters || ob_terrain_enters(c->terrain, i, low, high);
		if (*own && !endless)
			break;
	}
	return endless && enters;
}

// ---- points

static void add_over(contact *c, ob_vec3 at, double gap)
{
	const ob_vec3 d = ob_sub(at, c->a->p);
	const double u = ob_dot(d, c->u), w = ob_dot(d, c->w);
	for (int k = 0; k < c->over.n; k++)
		if (fabs(c->over.u[k] - u) + fabs(c->over.w[k] - w) < same_place * c->radius)
			return;
	if (c->over.n == OB_POLYGON_MAX)
		return;
	c->over.u[c->over.n] = u, c->over.w[c->over.n] = w, c->over.z[c->over.n++] = gap;
}

// Takes the points along the normal; those of the plane that are over the triangle.
static void take_plane(contact *c, uint32_t triangle)
{
	const double usual = 10 * ob_min(c->a->rest_depth, c->b->rest_depth);
	const ob_manifold *m = &c->on_plane;
	for (int k = 0; k < m->points; k++)
		if (ob_terrain_is_over(c->terrain, triangle, to_terrain(c, m->at[k]), usual,
				       usual + 2 * ob_max(0, -m->gap[k])))
			add_over(c, m->at[k], m->gap[k]);
}

static bool may_lean(const contact *c, ob_vec3 n)
{
	if (ob_shape_is(c->a->shape, OB_RIMMED))
		return fabs(ob_dot(n, ob_column(&c->a->r, 2))) > cap;
	return !ob_shape_is(c->a->shape, OB_ROUND);
}

// Takes what was found at a triangle, as far as the surface is touched like that. Returns false if it is not.
static bool take(contact *c, uint32_t triangle, const ob_manifold *m)
{
	const ob_vec3 n = ob_rotate_back(&c->b->r, m->normal);
	ob_manifold kept = *m;
	if (ob_dot(m->normal, c->normal) > as_normal) {
		for (int k = 0; k < m->points; k++)
			add_over(c, m->at[k], m->gap[k]);
		return m->points > 0;
	}
	const double lean = may_lean(c, m->normal) ? face_lean : 0;
	kept.points = 0;
	for (int k = 0; k < m->points; k++) {
		const ob_vec3 on = to_terrain(c, ob_madd(m->at[k], -.5 * m->gap[k], m->normal));
		if (!ob_terrain_supports(c->terrain, triangle, on, n, lean))
			continue;
		kept.at[kept.points] = m->at[k];
		kept.gap[kept.points++] = m->gap[k];
	}
	if (kept.points && c->others < OTHERS)
		c->other[c->others++] = kept;
	return kept.points > 0;
}

// Point of a triangle nearest to x, and the number of its edges that it is on (Ericson, Real-Time Collision Detection,
// 2005, ch. 5.1.5).
static ob_vec3 nearest_point(const ob_terrain *t, uint32_t triangle, ob_vec3 x)
{
	const ob_terrain_triangle *tri = &ob_terrain_triangles(t)[triangle];
	const ob_vec3 n = ob_terrain_regions(t)[tri->region].normal;
	ob_vec3 best = x;
	double least = INFINITY;
	bool inside = true;
	for (int k = 0; k < 3; k++) {
		const ob_vec3 from = ob_terrain_vertices(t)[tri->corner[k]],
			      way = ob_sub(ob_terrain_vertices(t)[tri->corner[(k + 1) % 3]], from), d = ob_sub(x, from);
		if (ob_dot(ob_cross(n, way), d) >= 0)
			continue;
		inside = false;
		const double share = ob_max(0, ob_min(1, ob_dot(d, way) / ob_norm2(way)));
		const ob_vec3 at = ob_madd(from, share, way);
		if (ob_norm2(ob_sub(x, at)) < least)
			least = ob_norm2(ob_sub(x, at)), best = at;
	}
	if (!inside)
		return best;
	return ob_madd(x, -ob_dot(n, ob_sub(x, ob_terrain_vertices(t)[tri->corner[0]])), n);
}

// Manifold of a ball with a triangle.
static void find_ball(const contact *c, uint32_t triangle, ob_manifold *m)
{
	const ob_vec3 x = to_terrain(c, c->a->p), on = nearest_point(c->terrain, triangle, x), d = ob_sub(x, on);
	const double height = ob_dot(c->region->normal, x) - c->region->offset, length = ob_norm(d);
	const bool over = length * as_normal <= fabs(height);
	const ob_vec3 n = over ? c->region->normal : ob_scale(d, 1 / length);
	const double gap = (over ? height : length) - c->a->size.x;
	m->normal = ob_rotate(&c->b->r, n);
	m->separation = gap;
	m->points = gap <= c->margin;
	m->gap[0] = gap;
	m->at[0] = ob_add(c->b->p, ob_rotate(&c->b->r, ob_madd(on, .5 * gap, n)));
}

static void find_at(const contact *c, uint32_t triangle, ob_manifold *m)
{
	*m = (ob_manifold){ .valid_path = INFINITY };
	if (ob_shape_is(c->a->shape, OB_ISOTROPIC)) {
		find_ball(c, triangle, m);
		return;
	}
	ob_hull column;
	ob_vec3 centre;
	ob_placed ground = *c->b;
	ob_terrain_column(c->terrain, triangle, (c->terrain->solid ? 2 : 1) * c->radius, &column, &centre);
	ground.shape = OB_SHAPE_HULL;
	ground.hull = &column;
	ground.size = ob_v3(column.radius, .5 * column.thickness, column.inner);
	ground.p = ob_add(c->b->p, ob_rotate(&c->b->r, centre));
	in_column[c->a->shape](c->a, &ground, c->margin, m);
}

static void touch(contact *c, uint32_t triangle)
{
	ob_manifold m;
	find_at(c, triangle, &m);
	c->pieces++;
	const bool touches = m.separation <= c->margin;
	if (touches && !take(c, triangle, &m)) {
		take_plane(c, triangle);
		if (m.separation < c->deepest.separation)
			c->deepest = m;
	}
	c->separation = ob_min(c->separation, m.separation);
}

static void touch_all(contact *c)
{
	const uint32_t *own = ob_terrain_by_region(c->terrain) + c->region->first;
	double low[3], high[3];
	ob_terrain_search s;
	uint32_t i;
	box_of(c, c->margin, low, high);
	if (c->region->triangles <= FEW) {
		for (i = 0; i < c->region->triangles; i++)
			if (ob_terrain_overlaps(c->terrain, own[i], low, high))
				touch(c, own[i]);
		return;
	}
	ob_terrain_begin(c->terrain, low, high, &s);
	while (ob_terrain_next(&s, &i))
		if (ob_terrain_triangles(c->terrain)[i].region == c->number)
			touch(c, i);
}

// Makes the manifold of the points along the normal. level: a point of the ground's plane, from which they have their
// gaps upwards (share .5), or of the body's face, from which they have them downwards (-.5).
static void put_over(contact *c, ob_vec3 level, double share, ob_manifold *out)
{
	const double rest = ob_min(c->a->rest_depth, c->b->rest_depth);
	ob_polygon_reduce(&c->over, 2 * rest);
	out->normal = c->normal;
	out->points = c->over.n;
	out->disc_radius = 0;
	for (int k = 0; k < c->over.n; k++) {
		const ob_vec3 from = ob_madd(ob_madd(c->a->p, c->over.u[k], c->u), c->over.w[k], c->w);
		const double height = ob_dot(c->normal, ob_sub(from, level));
		out->gap[k] = c->over.z[k];
		out->at[k] = ob_madd(from, share * c->over.z[k] - height, c->normal);
	}
}

// Takes the nearest of the contacts along other directions, with all points along its own.
static void put_nearest(contact *c, ob_manifold *out)
{
	uint32_t best = 0;
	for (uint32_t i = 1; i < c->others; i++)
		if (c->other[i].separation < c->other[best].separation)
			best = i;
	*out = c->other[best];
	c->normal = out->normal;
	c->u = ob_cross(c->normal, fabs(c->normal.z) > .7 ? ob_v3(0, 1, 0) : ob_v3(0, 0, 1));
	c->u = ob_scale(c->u, 1 / ob_norm(c->u));
	c->w = ob_cross(c->normal, c->u);
	for (uint32_t i = 0; i < c->others; i++)
		for (int k = 0; k < c->other[i].points && ob_dot(c->other[i].normal, c->normal) > as_normal; k++)
			add_over(c, c->other[i].at[k], c->other[i].gap[k]);
	if (c->over.n > out->points)
		put_over(c, ob_madd(out->at[0], .5 * out->gap[0], out->normal), -.5, out);
}

// Holds a body along the region's normal that is deep in the ground below it, where no direction supports the surface: about a
// vertex each region may leave the body to the others.
static void put_deepest(const contact *c, ob_manifold *out)
{
	const double least = .3; // cosine
	const double cosine = ob_dot(c->deepest.normal, c->normal);
	if (!c->deepest.points || cosine < least)
		return;
	*out = c->deepest;
	out->normal = c->normal;
	for (int k = 0; k < out->points; k++)
		out->gap[k] /= cosine;
}

void ob_manifold_terrain(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	const ob_terrain_part *part = (const ob_terrain_part *)b->hull;
	const double look_ahead = .5;
	out->points = 0;
	out->separation = 0;
	if (!part)
		return;
	contact c = { .a = a,
		      .b = b,
		      .terrain = part->terrain,
		      .region = &ob_terrain_regions(part->terrain)[part->region],
		      .number = part->region,
		      .margin = margin,
		      .radius = ob_shape_radius(a->shape, a->size) };
	place_plane(&c);
	const double rest = ob_min(a->rest_depth, b->rest_depth),
		     height = ob_dot(c.normal, ob_sub(ob_middle(a), c.plane.p)),
		     above = ob_dot(c.normal, ob_sub(a->p, c.plane.p)) - ob_reach(a, ob_scale(c.normal, -1));
	out->normal = c.normal;
	out->separation = ob_max(above, apart_by_box(&c));
	if (out->separation > margin)
		return;
	const double border = ob_max(margin, look_ahead * c.radius);
	bool own;
	const bool endless = is_endless(&c, border, &own);
	if (!own || (height < 0 && !c.terrain->solid)) { // far, or behind a skin
		out->separation = own ? ob_max(rest, out->separation) : ob_max(border, out->separation);
		return;
	}
	c.on_plane = (ob_manifold){ .valid_path = INFINITY };
	on_plane[a->shape](a, &c.plane, margin, &c.on_plane);
	if (endless) {
		*out = c.on_plane;
		return;
	}
	c.separation = border;
	c.deepest = (ob_manifold){ .separation = -2 * rest };
	touch_all(&c);
	if (c.over.n)
		put_over(&c, c.plane.p, .5, out);
	else if (c.others)
		put_nearest(&c, out);
	else
		put_deepest(&c, out);
	out->separation = c.separation;
	out->pieces = c.pieces;
	if (!out->points) { // others hold the body here: checked again before this region can
		out->separation = ob_max(c.separation, rest);
		out->valid_path = out->separation;
	}
}

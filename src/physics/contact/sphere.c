// Contacts of spheres with spheres, planes and boxes: one point, in closed form.
#include "contact/pairs.h"

static void one_point(ob_manifold *m, ob_vec3 normal, ob_vec3 at, double gap, double margin)
{
	m->separation = gap;
	m->normal = normal;
	m->points = gap <= margin;
	m->at[0] = at;
	m->gap[0] = gap;
}

void ob_manifold_spheres(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *m)
{
	ob_vec3 d = ob_sub(a->p, b->p);
	double l = ob_norm(d), gap = l - a->size.x - b->size.x;
	ob_vec3 n = l > 0 ? ob_scale(d, 1 / l) : ob_v3(0, 0, 1);
	one_point(m, n, ob_madd(b->p, b->size.x + .5 * gap, n), gap, margin);
}

void ob_manifold_sphere_plane(const ob_placed *a, const ob_placed *plane, double margin, ob_manifold *m)
{
	ob_vec3 n = ob_column(&plane->r, 2);
	double gap = ob_dot(n, ob_sub(a->p, plane->p)) - a->size.x;
	one_point(m, n, ob_madd(a->p, -(a->size.x + .5 * gap), n), gap, margin);
}

// Relative to the resting depth: gaps that differ by less count as equal; path after which a sphere that has left a
// face is checked again.
static const double same_gap = 1e-3, leaving_share = .1;

static double clamp(double x, double limit)
{
	return x < -limit ? -limit : x > limit ? limit : x;
}

// Direction in which sphere a is outside box b, and the distance. In b's frame.
typedef struct box_side {
	ob_vec3 n, surface; // unit; the point of the box's surface where it begins
	double distance; // m, of the sphere's centre from that point
} box_side;

static double *component(ob_vec3 *v, int i)
{
	return i == 0 ? &v->x : i == 1 ? &v->y : &v->z;
}

// Side along axis i of the box, from the plane of its face.
static box_side face_side(ob_vec3 l, ob_vec3 size, int i)
{
	box_side s = { .surface = l };
	double at = *component(&l, i), half = *component(&size, i), sign = at < 0 ? -1 : 1;
	*component(&s.n, i) = sign;
	*component(&s.surface, i) = sign * half;
	s.distance = sign * at - half;
	return s;
}

// Side at the nearest point of the box; inside the box, at the nearest face.
static box_side nearest_side(ob_vec3 l, ob_vec3 size)
{
	box_side s = { .surface = { clamp(l.x, size.x), clamp(l.y, size.y), clamp(l.z, size.z) } };
	ob_vec3 d = ob_sub(l, s.surface);
	s.distance = ob_norm(d);
	if (s.distance > 1e-12 * ob_norm(size)) {
		s.n = ob_scale(d, 1 / s.distance);
		return s;
	}
	double dx = fabs(l.x) - size.x, dy = fabs(l.y) - size.y, dz = fabs(l.z) - size.z;
	return face_side(l, size, dx >= dy && dx >= dz ? 0 : dy >= dz ? 1 : 2);
}

// Finds the face on which a sphere rolls across a seam. Beyond a face's border the sphere meets an edge, unless it
// touches the face's plane, and the plane closes no sooner than the edge. Then it rolls from one coplanar face to the
// next, and does not hit the edge. The next face bears the sphere as soon as the sphere is over it: its plane extends
// ahead by "reach" (m). Behind, it extends as far as the edge is no farther away than the plane. v: m/s, of the sphere
// as seen from b. leaving: the sphere leaves the face.
static void find_plane_underfoot(const ob_placed *a, const ob_placed *b, ob_vec3 l, ob_vec3 v, double reach,
				 box_side *side, bool *leaving)
{
	const double radius = a->size.x, rest = ob_min(a->rest_depth, b->rest_depth), nearest = side->distance;
	const double closes_at_edge = ob_time_to_close(a, b, side->distance - radius + rest, ob_dot(side->n, v));
	double latest = closes_at_edge;
	bool found = false;
	for (int i = 0; i < 3; i++) {
		box_side face = face_side(l, b->size, i);
		double closes = ob_time_to_close(a, b, face.distance - radius + rest, ob_dot(face.n, v));
		if (fabs(face.distance - radius) <= rest && closes >= latest)
			latest = closes, *side = face, found = true;
	}
	*leaving = found && latest == closes_at_edge;
	ob_vec3 s = side->surface;
	ob_vec3 past = ob_v3(s.x - clamp(s.x, b->size.x), s.y - clamp(s.y, b->size.y), s.z - clamp(s.z, b->size.z));
	if (found && (*leaving ? nearest - side->distance > same_gap * rest : ob_norm(past) > reach))
		side->distance = INFINITY;
}

void ob_manifold_sphere_box(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *m)
{
	const ob_vec3 apart = ob_sub(a->p, b->p), l = ob_rotate_back(&b->r, apart);
	box_side side = nearest_side(l, b->size);
	const double separation = side.distance - a->size.x;
	const bool past_border = ob_max(fabs(side.n.x), ob_max(fabs(side.n.y), fabs(side.n.z))) < 1;
	m->valid_path = INFINITY;
	if (past_border && separation <= margin) {
		ob_vec3 v = ob_rotate_back(&b->r, ob_sub(ob_sub(a->v, b->v), ob_cross(b->w, apart)));
		bool leaving;
		find_plane_underfoot(a, b, l, v, margin, &side, &leaving);
		if (leaving) // it may still fall off the edge
			m->valid_path = leaving_share * ob_min(a->rest_depth, b->rest_depth);
	}
	double gap = side.distance - a->size.x;
	ob_vec3 n = ob_rotate(&b->r, side.n), surface = ob_add(b->p, ob_rotate(&b->r, side.surface));
	one_point(m, n, ob_madd(surface, .5 * gap, n), gap, margin);
	m->separation = separation;
}

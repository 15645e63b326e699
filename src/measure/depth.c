#include "measure/depth.h"

static double clamp(double x, double low, double high)
{
	return x < low ? low : x > high ? high : x;
}

double ob_solid_extent(const ob_solid *s, ob_vec3 n)
{
	ob_vec3 b = ob_rotate_back(&s->r, n);
	switch (s->shape) {
	case OB_SHAPE_SPHERE:
		return s->size.x;
	case OB_SHAPE_BOX:
		return fabs(b.x) * s->size.x + fabs(b.y) * s->size.y + fabs(b.z) * s->size.z;
	case OB_SHAPE_CAPSULE:
		return s->size.x + fabs(b.z) * s->size.y;
	case OB_SHAPE_CYLINDER:
		return s->size.x * sqrt(b.x * b.x + b.y * b.y) + fabs(b.z) * s->size.y;
	case OB_SHAPE_PLANE:
	case OB_SHAPE_NONE:
		break;
	}
	return 0;
}

static double plane_and_solid(const ob_solid *plane, const ob_solid *s)
{
	ob_vec3 n = ob_column(&plane->r, 2);
	return ob_solid_extent(s, n) - ob_dot(n, ob_sub(s->p, plane->p));
}

// Distance of two segments, centres d apart, unit directions u and v, half lengths hu and hv (Lumelsky 1985).
static double between_segments(ob_vec3 d, ob_vec3 u, double hu, ob_vec3 v, double hv)
{
	double c = ob_dot(u, v), du = ob_dot(d, u), dv = ob_dot(d, v), sine2 = 1 - c * c;
	// d points from the first to the second: the first's nearest point lies at s u, the second's at d + t v
	double s = sine2 > 1e-12 ? clamp((du - c * dv) / sine2, -hu, hu) : clamp(du, -hu, hu);
	double t = clamp(c * s - dv, -hv, hv);
	s = clamp(du + c * t, -hu, hu);
	return ob_norm(ob_sub(ob_madd(d, t, v), ob_scale(u, s)));
}

// Two crossing segments leave each other sideways, so that the radii alone count: exact in every position.
static double capsules(const ob_solid *a, const ob_solid *b)
{
	return a->size.x + b->size.x -
	       between_segments(ob_sub(b->p, a->p), ob_column(&a->r, 2), ob_solid_core(a), ob_column(&b->r, 2),
				ob_solid_core(b));
}

// In the half plane through the cylinder's axis and the centre, the cylinder is a rectangle.
static double sphere_and_cylinder(const ob_solid *sphere, const ob_solid *cylinder)
{
	ob_vec3 b = ob_rotate_back(&cylinder->r, ob_sub(sphere->p, cylinder->p));
	double out = hypot(b.x, b.y) - cylinder->size.x, up = fabs(b.z) - cylinder->size.y;
	double distance = out > 0 && up > 0 ? hypot(out, up) : fmax(out, up);
	return sphere->size.x - distance;
}

double ob_depth(const ob_solid *a, const ob_solid *b)
{
	if (a->shape > b->shape)
		return ob_depth(b, a); // from here on a's shape comes first in sphere, box, plane, capsule, cylinder
	if (a->shape == OB_SHAPE_NONE || (a->shape == OB_SHAPE_PLANE && b->shape == OB_SHAPE_PLANE))
		return -INFINITY;
	if (a->shape == OB_SHAPE_PLANE)
		return plane_and_solid(a, b);
	if (b->shape == OB_SHAPE_PLANE)
		return plane_and_solid(b, a);
	if (b->shape == OB_SHAPE_CYLINDER)
		return a->shape == OB_SHAPE_SPHERE ? sphere_and_cylinder(a, b) : ob_depth_search(a, b);
	if (a->shape == OB_SHAPE_BOX)
		return b->shape == OB_SHAPE_BOX ? ob_depth_boxes(a, b) : ob_depth_capsule_box(b, a);
	if (b->shape == OB_SHAPE_BOX)
		return ob_depth_capsule_box(a, b);
	return capsules(a, b);
}

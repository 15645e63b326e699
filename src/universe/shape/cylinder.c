#include "shape/enter.h"
#include "shape/shape.h"

static double radius(ob_vec3 size)
{
	return sqrt(size.x * size.x + size.y * size.y);
}

static double thickness(ob_vec3 size)
{
	return 2 * ob_min(size.x, size.y);
}

static double longest(ob_vec3 size)
{
	return ob_max(size.x, size.y);
}

// Of a disc: by how much its plane leans towards the axis.
static double extent(ob_vec3 size, ob_vec3 n)
{
	return size.x * sqrt(n.x * n.x + n.y * n.y) + fabs(n.z) * size.y;
}

static ob_vec3 farthest(const ob_vec3 *size, const ob_hull *hull, const ob_vec3 *n)
{
	static const double flat = 1e-12; // a smaller part across the axis has no direction
	const double across = sqrt(n->x * n->x + n->y * n->y);
	ob_vec3 at = { 0, 0, copysign(size->y, n->z) };
	if (across > flat)
		at.x = size->x * n->x / across, at.y = size->x * n->y / across;
	return at;
}

static ob_outline outline(ob_vec3 size)
{
	return (ob_outline){ .half = { 0, 0, size.y }, .rim = size.x };
}

static double volume(ob_vec3 size)
{
	return M_PI * size.x * size.x * 2 * size.y;
}

// The order of operations is ODE's, whose moments these were at first.
static ob_vec3 inertia(ob_vec3 size, double mass)
{
	const double r2 = size.x * size.x, l = 2 * size.y, across = mass * (.25 * r2 + 1. / 12 * l * l);
	return ob_v3(across, across, mass * .5 * r2);
}

static double enter_cap(double radius, double half, ob_vec3 p, ob_vec3 d, ob_vec3 *n)
{
	const double side = p.z > 0 ? 1 : -1;
	if (fabs(p.z) <= half || d.z * side >= 0)
		return INFINITY;
	const double t = (side * half - p.z) / d.z, x = p.x + t * d.x, y = p.y + t * d.y;
	if (x * x + y * y > radius * radius)
		return INFINITY;
	*n = ob_v3(0, 0, side);
	return t;
}

static double enter(ob_vec3 size, ob_vec3 p, ob_vec3 d, ob_vec3 *n)
{
	ob_vec3 there;
	const double wall = ob_enter_wall(size.x, size.y, p, d, n), cap = enter_cap(size.x, size.y, p, d, &there);
	if (!(cap < wall))
		return wall;
	*n = there;
	return cap;
}

const ob_shape_kind ob_shape_cylinder = {
	.name = "cylinder",
	.key = { { "radius", 0, 1 }, { "length", 1, .5 } },
	.radius = radius,
	.thickness = thickness,
	.longest = longest,
	.extent = extent,
	.farthest = farthest,
	.outline = outline,
	.volume = volume,
	.inertia = inertia,
	.enter = enter,
};

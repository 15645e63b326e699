#include "shape/enter.h"
#include "shape/shape.h"

static double length(ob_vec3 size)
{
	return size.x + size.y;
}

static double thickness(ob_vec3 size)
{
	return 2 * size.x;
}

static double extent(ob_vec3 size, ob_vec3 n)
{
	return size.x + fabs(n.z) * size.y;
}

static ob_vec3 farthest(const ob_vec3 *size, const ob_hull *hull, const ob_vec3 *n)
{
	return ob_madd(ob_v3(0, 0, copysign(size->y, n->z)), size->x / ob_norm(*n), *n);
}

static ob_outline outline(ob_vec3 size)
{
	return (ob_outline){ .half = { 0, 0, size.y }, .ball = size.x };
}

static double volume(ob_vec3 size)
{
	return M_PI * size.x * size.x * (2 * size.y + 4. / 3 * size.x);
}

// A cylinder and two half spheres. The order of operations is ODE's, whose moments these were at first.
static ob_vec3 inertia(ob_vec3 size, double mass)
{
	const double r = size.x, l = 2 * size.y, core = M_PI * r * r * l, caps = 4. / 3 * M_PI * r * r * r,
		     density = mass / (core + caps);
	const double across = core * (.25 * r * r + 1. / 12 * l * l) + caps * (.4 * r * r + .375 * r * l + .25 * l * l),
		     along = (core * .5 + caps * .4) * r * r;
	return ob_v3(across * density, across * density, along * density);
}

static double enter(ob_vec3 size, ob_vec3 p, ob_vec3 d, ob_vec3 *n)
{
	const double r = size.x, half = size.y, past = fmax(0, fabs(p.z) - half);
	if (p.x * p.x + p.y * p.y + past * past <= r * r)
		return INFINITY;
	double first = ob_enter_wall(r, half, p, d, n);
	for (int side = -1; side <= 1; side += 2) {
		ob_vec3 there;
		const double t = ob_enter_ball(ob_v3(0, 0, side * half), r, p, d, &there);
		if (t < first)
			first = t, *n = there;
	}
	return first;
}

const ob_shape_kind ob_shape_capsule = {
	.name = "capsule",
	.key = { { "radius", 0, 1 }, { "length", 1, .5 } },
	.radius = length,
	.thickness = thickness,
	.longest = length,
	.extent = extent,
	.farthest = farthest,
	.outline = outline,
	.volume = volume,
	.inertia = inertia,
	.enter = enter,
};

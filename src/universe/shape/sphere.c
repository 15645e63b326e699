#include "shape/enter.h"
#include "shape/shape.h"

static double radius(ob_vec3 size)
{
	return size.x;
}

static double thickness(ob_vec3 size)
{
	return 2 * size.x;
}

static double extent(ob_vec3 size, ob_vec3 n)
{
	return size.x;
}

static ob_vec3 farthest(const ob_vec3 *size, const ob_hull *hull, const ob_vec3 *n)
{
	return ob_scale(*n, size->x / ob_norm(*n));
}

static ob_outline outline(ob_vec3 size)
{
	return (ob_outline){ .ball = size.x };
}

static double volume(ob_vec3 size)
{
	return 4. / 3 * (M_PI * size.x * size.x) * size.x;
}

static ob_vec3 inertia(ob_vec3 size, double mass)
{
	const double all = .4 * mass * size.x * size.x;
	return ob_v3(all, all, all);
}

static double enter(ob_vec3 size, ob_vec3 p, ob_vec3 d, ob_vec3 *n)
{
	return ob_enter_ball(ob_v3(0, 0, 0), size.x, p, d, n);
}

const ob_shape_kind ob_shape_sphere = {
	.name = "sphere",
	.key = { { "radius", 0, 1 } },
	.radius = radius,
	.thickness = thickness,
	.longest = radius,
	.extent = extent,
	.farthest = farthest,
	.outline = outline,
	.volume = volume,
	.inertia = inertia,
	.enter = enter,
};

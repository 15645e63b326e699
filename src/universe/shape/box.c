#include "shape/shape.h"

static double radius(ob_vec3 size)
{
	return ob_norm(size);
}

static double thickness(ob_vec3 size)
{
	return 2 * ob_min(size.x, ob_min(size.y, size.z));
}

static double longest(ob_vec3 size)
{
	return ob_max(size.x, ob_max(size.y, size.z));
}

static double extent(ob_vec3 size, ob_vec3 n)
{
	return fabs(n.x) * size.x + fabs(n.y) * size.y + fabs(n.z) * size.z;
}

static ob_vec3 farthest(const ob_vec3 *size, const ob_hull *hull, const ob_vec3 *n)
{
	return ob_v3(copysign(size->x, n->x), copysign(size->y, n->y), copysign(size->z, n->z));
}

static ob_outline outline(ob_vec3 size)
{
	return (ob_outline){ .half = size };
}

static double volume(ob_vec3 size)
{
	return 8 * size.x * size.y * size.z;
}

static ob_vec3 inertia(ob_vec3 size, double mass)
{
	const double x = size.x * size.x, y = size.y * size.y, z = size.z * size.z;
	return ob_scale(ob_v3(y + z, z + x, x + y), mass / 3);
}

static double enter(ob_vec3 size, ob_vec3 p, ob_vec3 d, ob_vec3 *n)
{
	const double h[] = { size.x, size.y, size.z }, at[] = { p.x, p.y, p.z }, to[] = { d.x, d.y, d.z };
	double first = -INFINITY, last = INFINITY;
	for (int i = 0; i < 3; i++) {
		double in = (-h[i] - at[i]) / to[i], out = (h[i] - at[i]) / to[i];
		if (to[i] == 0) {
			if (fabs(at[i]) > h[i])
				return INFINITY;
			continue;
		}
		const double sign = in < out ? -1 : 1, near = fmin(in, out);
		if (near > first) {
			first = near;
			*n = ob_v3(i == 0 ? sign : 0, i == 1 ? sign : 0, i == 2 ? sign : 0);
		}
		last = fmin(last, fmax(in, out));
	}
	return first > 0 && first <= last ? first : INFINITY;
}

const ob_shape_kind ob_shape_box = {
	.name = "box",
	.key = { { "size", OB_SHAPE_SIDES, .5 } },
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

#include "shape/shape.h"

static double radius(ob_vec3 size)
{
	return size.x;
}

static double thickness(ob_vec3 size)
{
	return 2 * size.y;
}

static double extent(ob_vec3 size, ob_vec3 n)
{
	return size.x;
}

static ob_vec3 farthest(const ob_vec3 *size, const ob_hull *hull, const ob_vec3 *n)
{
	double most = -INFINITY;
	ob_vec3 at = { 0, 0, 0 };
	for (uint32_t k = 0; k < hull->corners; k++) {
		const double there = ob_dot(*n, hull->corner[k]);
		if (there > most)
			most = there, at = hull->corner[k];
	}
	return at;
}

const ob_shape_kind ob_shape_hull = {
	.name = "hull",
	.radius = radius,
	.thickness = thickness,
	.longest = radius,
	.extent = extent,
	.farthest = farthest,
};

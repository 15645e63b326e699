#include "shape/shape.h"

static double radius(ob_vec3 size)
{
	return ob_norm(size);
}

static double thickness(ob_vec3 size)
{
	return INFINITY;
}

static double longest(ob_vec3 size)
{
	return ob_max(size.x, ob_max(size.y, size.z));
}

static double extent(ob_vec3 size, ob_vec3 n)
{
	return fabs(n.x) * size.x + fabs(n.y) * size.y + fabs(n.z) * size.z;
}

// The hull is that of a region.
static ob_vec3 farthest(const ob_vec3 *size, const ob_hull *hull, const ob_vec3 *n)
{
	double most = -INFINITY;
	ob_vec3 at = { 0, 0, 0 };
	for (uint32_t k = 0; hull && k < hull->corners; k++) {
		const double there = ob_dot(*n, hull->corner[k]);
		if (there > most)
			most = there, at = hull->corner[k];
	}
	return at;
}

const ob_shape_kind ob_shape_terrain = {
	.name = "terrain",
	.radius = radius,
	.thickness = thickness,
	.longest = longest,
	.extent = extent,
	.farthest = farthest,
};

#include "shape/shape.h"

static double endless(ob_vec3 size)
{
	return INFINITY;
}

static double extent(ob_vec3 size, ob_vec3 n)
{
	return INFINITY;
}

static double enter(ob_vec3 size, ob_vec3 p, ob_vec3 d, ob_vec3 *n)
{
	*n = ob_v3(0, 0, 1);
	return p.z > 0 && d.z < 0 ? -p.z / d.z : INFINITY;
}

const ob_shape_kind ob_shape_plane = {
	.name = "plane",
	.radius = endless,
	.thickness = endless,
	.longest = endless,
	.extent = extent,
	.enter = enter,
};

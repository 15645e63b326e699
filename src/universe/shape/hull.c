#include "shape/part.h"
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

static ob_vec3 farthest_of_round(const ob_hull *part, ob_vec3 n)
{
	const ob_mat3 r = ob_quat_matrix(part->frame);
	const ob_vec3 l = ob_rotate_back(&r, n);
	const ob_shape_kind *kind = part->round == OB_SHAPE_SPHERE    ? &ob_shape_sphere
				    : part->round == OB_SHAPE_CAPSULE ? &ob_shape_capsule
								      : &ob_shape_cylinder;
	return ob_add(part->centre, ob_rotate(&r, kind->farthest(&part->size, NULL, &l)));
}

static ob_vec3 farthest(const ob_vec3 *size, const ob_hull *hull, const ob_vec3 *n)
{
	if (ob_part_is_round(hull))
		return farthest_of_round(hull, *n);
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

#include "shape/shape.h"

#include <string.h>

static double no_length(ob_vec3 size)
{
	return 0;
}

static double no_extent(ob_vec3 size, ob_vec3 n)
{
	return 0;
}

static const ob_shape_kind none = {
	.name = "", .radius = no_length, .thickness = no_length, .longest = no_length, .extent = no_extent
};

#define OB_SHAPE_ENTRY(NAME, name, properties) [OB_SHAPE_##NAME] = &ob_shape_##name,

const ob_shape_kind *const ob_shape_kinds[OB_SHAPE_KINDS] = { [OB_SHAPE_NONE] = &none, OB_SHAPES(OB_SHAPE_ENTRY) };

const char *ob_shape_name(ob_shape shape)
{
	return ob_shape_kind_of(shape)->name;
}

ob_shape ob_shape_named(const char *name)
{
	int shape = OB_SHAPE_KINDS - 1;
	while (shape > OB_SHAPE_NONE && strcmp(ob_shape_kinds[shape]->name, name) != 0)
		shape--;
	return (ob_shape)shape;
}

double ob_shape_radius(ob_shape shape, ob_vec3 size)
{
	return ob_shape_kind_of(shape)->radius(size);
}

double ob_shape_thickness(ob_shape shape, ob_vec3 size)
{
	return ob_shape_kind_of(shape)->thickness(size);
}

double ob_shape_longest(ob_shape shape, ob_vec3 size)
{
	return ob_shape_kind_of(shape)->longest(size);
}

double ob_shape_extent(ob_shape shape, ob_vec3 size, ob_vec3 n)
{
	return ob_shape_kind_of(shape)->extent(size, n);
}

bool ob_shape_outline(ob_shape shape, ob_vec3 size, ob_outline *out)
{
	const ob_shape_kind *kind = ob_shape_kind_of(shape);
	*out = kind->outline ? kind->outline(size) : (ob_outline){ 0 };
	return kind->outline;
}

double ob_shape_volume(ob_shape shape, ob_vec3 size, const ob_hull *hull)
{
	const ob_shape_kind *kind = ob_shape_kind_of(shape);
	return hull ? hull->volume : kind->volume ? kind->volume(size) : 0;
}

ob_vec3 ob_shape_inertia(ob_shape shape, ob_vec3 size, const ob_hull *hull, double mass)
{
	const ob_shape_kind *kind = ob_shape_kind_of(shape);
	return hull ? ob_scale(hull->inertia, mass) : kind->inertia ? kind->inertia(size, mass) : ob_v3(0, 0, 0);
}

void ob_shape_bounds(ob_shape shape, ob_vec3 size, ob_pose pose, double bounds[6])
{
	const ob_shape_kind *kind = ob_shape_kind_of(shape);
	const double p[3] = { pose.p.x, pose.p.y, pose.p.z };
	const ob_mat3 r = ob_quat_matrix(pose.q);
	for (int i = 0; i < 3; i++) { // a row of the matrix is the world's axis in the shape's frame
		const double half = kind->extent(size, ob_v3(r.m[i][0], r.m[i][1], r.m[i][2]));
		bounds[i] = p[i] - half;
		bounds[i + 3] = p[i] + half;
	}
}

#include "sim/boxed.h"

// Half the width of the shape along the world's axis i.
static double half_width(const ob_placed *x, int i)
{
	const double *m = x->r.m[i];
	switch (x->shape) {
	case OB_SHAPE_SPHERE:
		return x->size.x;
	case OB_SHAPE_BOX:
		return fabs(m[0]) * x->size.x + fabs(m[1]) * x->size.y + fabs(m[2]) * x->size.z;
	case OB_SHAPE_CAPSULE:
		return x->size.x + fabs(m[2]) * x->size.y;
	case OB_SHAPE_CYLINDER:
		return x->size.x * sqrt(m[0] * m[0] + m[1] * m[1]) + fabs(m[2]) * x->size.y;
	default:
		return 0;
	}
}

static ob_placed boxed(const ob_placed *x)
{
	if (x->shape == OB_SHAPE_PLANE)
		return *x;
	return (ob_placed){ .shape = OB_SHAPE_BOX,
			    .size = ob_v3(half_width(x, 0), half_width(x, 1), half_width(x, 2)),
			    .p = x->p,
			    .r = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } },
			    .v = x->v };
}

void ob_manifold_aabb(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_placed box_a = boxed(a), box_b = boxed(b);
	ob_manifold_find(&box_a, &box_b, margin, out);
}

#include "solver/boxes.h"

#include "base/cpu.h"
#include "shape/shape.h"

// Finds centre and half widths of a hull's box, which is not about the hull's centre.
static void find_extent(const ob_placed *x, ob_vec3 *middle, ob_vec3 *half)
{
	ob_vec3 low = { INFINITY, INFINITY, INFINITY }, high = { -INFINITY, -INFINITY, -INFINITY };
	for (uint32_t k = 0; k < x->hull->corners; k++) {
		const ob_vec3 c = ob_rotate(&x->r, x->hull->corner[k]);
		low = ob_v3(ob_min(low.x, c.x), ob_min(low.y, c.y), ob_min(low.z, c.z));
		high = ob_v3(ob_max(high.x, c.x), ob_max(high.y, c.y), ob_max(high.z, c.z));
	}
	*middle = ob_madd(x->p, .5, ob_add(low, high));
	*half = ob_scale(ob_sub(high, low), .5);
}

// Half the width of the shape along the world's axis i (m).
static double half_width(const ob_placed *x, int i)
{
	return ob_shape_extent(x->shape, x->size, ob_v3(x->r.m[i][0], x->r.m[i][1], x->r.m[i][2]));
}

static ob_placed box_around(const ob_placed *x)
{
	if (ob_shape_is(x->shape, OB_UNBOUNDED))
		return *x;
	ob_placed box = { .shape = OB_SHAPE_BOX,
			  .p = x->p,
			  .r = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } },
			  .v = x->v,
			  .rest_depth = x->rest_depth,
			  .far_future = x->far_future };
	if (x->hull)
		find_extent(x, &box.p, &box.size);
	else
		box.size = ob_v3(half_width(x, 0), half_width(x, 1), half_width(x, 2));
	return box;
}

void ob_manifold_aabb(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_placed box_a = box_around(a), box_b = box_around(b);
	ob_manifold_find(&box_a, &box_b, margin, out);
}

void ob_boxes_find(ob_solver *s, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	s->counters.box_tests++;
	ob_synthetic_load(s->settings->load);
	ob_manifold_aabb(a, b, margin, out);
}

#include <ob/hull.h>

#include "shape/shape.h"

static bool is_length(double x)
{
	return x > 0 && isfinite(x);
}

static bool faces_make_sense(const ob_hull *h)
{
	if (h->first[0] != 0 || h->first[h->faces] != 2 * h->edges)
		return false;
	for (uint32_t f = 0; f < h->faces; f++) {
		if (h->first[f + 1] < h->first[f] + 3 || h->first[f + 1] > 2 * h->edges)
			return false;
		if (!ob_is_finite(h->normal[f]) || !(h->is_part ? isfinite(h->offset[f]) : is_length(h->offset[f])) ||
		    !(fabs(ob_norm2(h->normal[f]) - 1) < .1))
			return false;
	}
	for (uint32_t k = 0; k < 2 * h->edges; k++)
		if (h->loop[k] >= h->corners)
			return false;
	return true;
}

static bool roundness_makes_sense(const ob_hull *h)
{
	if (!h->is_part)
		return h->round <= h->parts;
	return !h->round ||
	       (ob_shape_is((ob_shape)h->round, OB_ROUND) && h->round < OB_SHAPE_KINDS && is_length(h->size.x) &&
		(!ob_shape_is((ob_shape)h->round, OB_AXIAL) || is_length(h->size.y)));
}

bool ob_hull_makes_sense(const ob_hull *h)
{
	const ob_quat q = h->frame;
	const double norm = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
	if (h->corners < 4 || h->corners > OB_HULL_CORNERS_MAX || h->faces < 4 || h->faces > OB_HULL_FACES_MAX ||
	    h->edges != h->corners + h->faces - 2 || h->edges > OB_HULL_EDGES_MAX || h->parts > OB_HULL_PARTS_MAX ||
	    h->is_part > 1 || (h->is_part && h->parts) || !roundness_makes_sense(h))
		return false;
	if (!is_length(h->radius) || !(h->is_part ? isfinite(h->inner) : is_length(h->inner)) ||
	    !is_length(h->thickness) || !is_length(h->volume) || !ob_is_finite(h->inertia) ||
	    !ob_is_finite(h->centre) || !(norm > .9 && norm < 1.1) || !faces_make_sense(h))
		return false;
	for (uint32_t k = 0; k < h->corners; k++)
		if (!ob_is_finite(h->corner[k]))
			return false;
	for (uint32_t k = 0; k < h->edges; k++) {
		const ob_hull_edge *e = &h->edge[k];
		if (e->from >= h->corners || e->to >= h->corners || e->left >= h->faces || e->right >= h->faces)
			return false;
	}
	return true;
}

void ob_hull_bounds(const ob_hull *h, ob_pose pose, double bounds[6])
{
	const ob_mat3 r = ob_quat_matrix(pose.q);
	const double p[3] = { pose.p.x, pose.p.y, pose.p.z };
	for (int i = 0; i < 3; i++) {
		const double *m = r.m[i];
		double low = INFINITY, high = -INFINITY;
		for (uint32_t k = 0; k < h->corners; k++) {
			const double x = m[0] * h->corner[k].x + m[1] * h->corner[k].y + m[2] * h->corner[k].z;
			low = x < low ? x : low, high = x > high ? x : high;
		}
		bounds[i] = p[i] + low, bounds[i + 3] = p[i] + high;
	}
}

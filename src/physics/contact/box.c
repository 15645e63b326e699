// Contacts of boxes with planes and boxes. Two boxes: separating axes (Gottschalk et al. 1996), of which the one that
// closes last is chosen, and face clipping (Sutherland and Hodgman 1974).
#include "contact/kernel.h"
#include "contact/pairs.h"
#include "shape/shape.h"

void ob_manifold_boxes(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_kernel_best()->boxes(a, b, margin, out);
}

// Box a against a plane: the four lowest corners within the margin.
void ob_manifold_box_plane(const ob_placed *a, const ob_placed *plane, double margin, ob_manifold *m)
{
	ob_vec3 n = ob_column(&plane->r, 2), corner[8];
	double gap[8];
	unsigned used = 0;
	for (int k = 0; k < 8; k++) {
		corner[k] = ob_add(a->p, ob_rotate(&a->r, ob_box_corner(a->size, (uint32_t)k)));
		gap[k] = ob_dot(n, ob_sub(corner[k], plane->p));
	}
	m->normal = n;
	m->points = 0;
	for (int c = 0; c < 4; c++) {
		int low = -1;
		for (int k = 0; k < 8; k++)
			if (!(used >> k & 1) && (low < 0 || gap[k] < gap[low]))
				low = k;
		if (c == 0)
			m->separation = gap[low];
		if (gap[low] > margin)
			break;
		used |= 1u << low;
		m->at[m->points] = ob_madd(corner[low], -.5 * gap[low], n);
		m->gap[m->points++] = gap[low];
	}
}

#include "ode/ode_boxed.h"

#include <stdbool.h>

static void put(dContactGeom *c, dGeomID a, dGeomID b, const double *at, const double *normal, double depth)
{
	*c = (dContactGeom){ .depth = depth, .g1 = a, .g2 = b, .side1 = -1, .side2 = -1 };
	for (int k = 0; k < 3; k++) {
		c->pos[k] = at[k];
		c->normal[k] = normal[k];
	}
}

// The corner of a box (ODE's order: least and most along each axis) that bit k of "which" says for axis k.
static void corner(const double *box, unsigned which, double *at)
{
	for (int k = 0; k < 3; k++)
		at[k] = box[2 * k + (which >> k & 1)];
}

// sign: 1 where the box belongs to the pair's a.
static int box_plane(dGeomID a, dGeomID b, const double *box, dGeomID plane, double sign, dContactGeom *point)
{
	dVector4 face; // n . x = d
	dGeomPlaneGetParams(plane, face);
	double normal[3] = { sign * face[0], sign * face[1], sign * face[2] }, depth[8], at[8][3];
	bool used[8] = { false };
	for (unsigned i = 0; i < 8; i++) {
		corner(box, i, at[i]);
		depth[i] = face[3] - (face[0] * at[i][0] + face[1] * at[i][1] + face[2] * at[i][2]);
	}
	int n = 0;
	for (; n < 4; n++) {
		int deepest = -1;
		for (int i = 0; i < 8; i++)
			if (!used[i] && depth[i] >= 0 && (deepest < 0 || depth[i] > depth[deepest]))
				deepest = i;
		if (deepest < 0)
			break;
		used[deepest] = true;
		put(&point[n], a, b, at[deepest], normal, depth[deepest]);
	}
	return n;
}

int ob_ode_collide_boxed(dGeomID a, dGeomID b, dContactGeom point[4])
{
	dReal box_a[6], box_b[6];
	double overlap[6], normal[3] = { 0, 0, 0 }, depth = dInfinity;
	int axis = 0;
	dGeomGetAABB(a, box_a);
	dGeomGetAABB(b, box_b);
	if (dGeomGetClass(b) == dPlaneClass)
		return box_plane(a, b, box_a, b, 1, point);
	if (dGeomGetClass(a) == dPlaneClass)
		return box_plane(a, b, box_b, a, -1, point);
	for (int k = 0; k < 3; k++) {
		overlap[2 * k] = box_a[2 * k] > box_b[2 * k] ? box_a[2 * k] : box_b[2 * k];
		overlap[2 * k + 1] = box_a[2 * k + 1] < box_b[2 * k + 1] ? box_a[2 * k + 1] : box_b[2 * k + 1];
		if (overlap[2 * k + 1] < overlap[2 * k])
			return 0;
		// the way out for a: up or down along this axis
		double up = box_b[2 * k + 1] - box_a[2 * k], down = box_a[2 * k + 1] - box_b[2 * k];
		if ((up < down ? up : down) < depth) {
			depth = up < down ? up : down;
			axis = k;
			normal[0] = normal[1] = normal[2] = 0;
			normal[k] = up < down ? 1 : -1;
		}
	}
	double middle = .5 * (overlap[2 * axis] + overlap[2 * axis + 1]);
	overlap[2 * axis] = overlap[2 * axis + 1] = middle;
	for (unsigned i = 0, n = 0; i < 8; i++) {
		double at[3];
		if (i >> axis & 1)
			continue;
		corner(overlap, i, at);
		put(&point[n++], a, b, at, normal, depth);
	}
	return 4;
}

// Friction of patches of four pairs side by side: contact/patch.h compiled for lanes.
#ifndef OB_CONTACT_PATCH_LANES_H
#define OB_CONTACT_PATCH_LANES_H

#include "contact/batch.h"
#include "elementary/real_lanes.h"

typedef ob_batch friction_pair;
typedef ob_patch_model patch_model;
enum { PATCH_NODES = 1, PATCH_CORNERS = 12 };

#include "contact/patch.h"

static const patch_rule patch_ends = { .turned = 1 - 4e-4, .close = 1e-9, .follows = false }; // turned: some .02 rad

static inline lanes patch_disc(const ob_batch *b)
{
	return b->disc;
}

static inline unsigned patch_areas(const ob_batch *b)
{
	return b->areas;
}

static inline const ob_contact_area *patch_area(const ob_batch *b, int l)
{
	return &b->area[l];
}

static inline double patch_get(const lanes *x, int l)
{
	return lanes_get(x, l);
}

static inline void patch_put(lanes *x, int l, double y)
{
	lanes_put(x, l, y);
}

static inline lanes patch_response(const ob_batch *b)
{
	return b->diag[4];
}

static inline lanes patch_nodes(const double *from)
{
	return lanes_of(*from);
}

static inline lanes patch_sum_nodes(lanes x)
{
	return x;
}

// Computes the corners, counterclockwise. Returns their number. A disc's first corner is on the left of the slip.
static inline int patch_corners(const patch_load *p, const lanes *v, lanes (*at)[2])
{
	static const double c[PATCH_CORNERS] = { 1,  0.86602540378443865,  .5,  0, -.5, -0.86602540378443865,
						 -1, -0.86602540378443865, -.5, 0, .5,  0.86602540378443865 };
	const double out = 1.0231039; // relative radius of a polygon with the disc's second moment
	for (int k = 0; k < 2; k++) {
		at[0][k] = -p->e1[k] - p->e2[k];
		at[1][k] = p->e1[k] - p->e2[k];
		at[2][k] = p->e1[k] + p->e2[k];
		at[3][k] = p->e2[k] - p->e1[k];
	}
	const lane_mask disc = p->radius > 0;
	if (!lanes_bits(disc))
		return 4;
	lanes speed = lanes_sqrt(v[0] * v[0] + v[1] * v[1]);
	lane_mask moves = speed > 0;
	lanes f = out * p->radius / lanes_select(moves, speed, lanes_of(1));
	lanes x = -f * v[1], y = lanes_select(moves, f * v[0], out * p->radius);
	for (int i = 0; i < PATCH_CORNERS; i++) {
		const double cos = c[i], sin = c[(i + 9) % PATCH_CORNERS];
		at[i][0] = lanes_select(disc, cos * x - sin * y, at[i < 4 ? i : 3][0]);
		at[i][1] = lanes_select(disc, sin * x + cos * y, at[i < 4 ? i : 3][1]);
	}
	return PATCH_CORNERS;
}

// Computes the slip u at a corner x. Returns its magnitude.
static inline lanes patch_corner_slip(const lanes *v, lanes w, const lanes *x, lanes *u)
{
	u[0] = v[0] - w * x[1];
	u[1] = v[1] + w * x[0];
	return lanes_sqrt(u[0] * u[0] + u[1] * u[1]);
}

// Adds the integrals along the border. Returns twice the area.
static inline lanes patch_sum_edges(const lanes (*corner)[2], int corners, const lanes *v, lanes w, lanes at,
				    const lanes *slope, patch_sums *o)
{
	lanes u[PATCH_CORNERS][2], r[PATCH_CORNERS], area = lanes_of(0);
	border_sums all = { 0 };
	for (int i = 0; i < corners; i++) {
		const lanes *x = corner[i], *next = corner[i + 1 < corners ? i + 1 : 0];
		r[i] = patch_corner_slip(v, w, x, u[i]);
		area += x[0] * next[1] - x[1] * next[0];
	}
	for (int i = 0; i < corners; i++) {
		int next = i + 1 < corners ? i + 1 : 0;
		border_add_edge(u[i], r[i], u[next], r[next], at, slope, &all);
	}
	memcpy(o, &all, sizeof *o);
	return area;
}

static inline lanes add_across(lanes sum, lanes x)
{
	return lanes_of(sum[0] + x[0] + x[1] + x[2] + x[3]);
}

// As patch_sum_edges, for lane l alone, with four edges side by side: the same sums in the same order.
static inline lanes patch_sum_edges_of(int l, const lanes (*corner)[2], int corners, const lanes *v, lanes w, lanes at,
				       const lanes *slope, patch_sums *o)
{
	const lanes own_v[2] = { lanes_of(v[0][l]), lanes_of(v[1][l]) }, own_w = lanes_of(w[l]);
	const lanes own_slope[2] = { lanes_of(slope[0][l]), lanes_of(slope[1][l]) };
	lanes area = lanes_of(0);
	for (int i = 0; i < corners; i += OB_LANES) {
		const int end = i + OB_LANES < corners ? i + OB_LANES : 0;
		border_sums four = { 0 };
		lanes x[2], next[2], u[2], un[2];
		for (int c = 0; c < 2; c++) {
			x[c] = (lanes){ corner[i][c][l], corner[i + 1][c][l], corner[i + 2][c][l],
					corner[i + 3][c][l] };
			next[c] = (lanes){ x[c][1], x[c][2], x[c][3], corner[end][c][l] };
		}
		const lanes r = patch_corner_slip(own_v, own_w, x, u), rn = patch_corner_slip(own_v, own_w, next, un);
		border_add_edge(u, r, un, rn, lanes_of(at[l]), own_slope, &four);
		area = add_across(area, x[0] * next[1] - x[1] * next[0]);
		for (int c = 0; c < 2; c++)
			o->force[c] = add_across(o->force[c], four.force[c]);
		o->power = add_across(o->power, four.power);
		o->weight = add_across(o->weight, four.weight);
	}
	return area;
}

static inline lanes patch_border(const patch_load *p, lane_mask asked, const lanes *v, lanes w, lanes at,
				 const lanes *slope, patch_sums *o)
{
	lanes corner[PATCH_CORNERS][2];
	const int corners = patch_corners(p, v, corner);
	const unsigned lanes_asked = lanes_bits(asked);
	return lanes_count(lanes_asked) == 1
		       ? patch_sum_edges_of(__builtin_ctz(lanes_asked), corner, corners, v, w, at, slope, o)
		       : patch_sum_edges(corner, corners, v, w, at, slope, o);
}

#endif

#include "step/terrain.h"

#include <math.h>

// Box in the terrain's frame that holds a box of the world.
static void turn_box(ob_pose pose, const double low[3], const double high[3], double out_low[3], double out_high[3])
{
	const ob_mat3 r = ob_quat_matrix(pose.q);
	const ob_vec3 half = ob_v3(.5 * (high[0] - low[0]), .5 * (high[1] - low[1]), .5 * (high[2] - low[2])),
		      middle = ob_rotate_back(&r,
					      ob_sub(ob_v3(low[0] + half.x, low[1] + half.y, low[2] + half.z), pose.p));
	const double at[3] = { middle.x, middle.y, middle.z };
	for (int i = 0; i < 3; i++) {
		const double reach = fabs(r.m[0][i]) * half.x + fabs(r.m[1][i]) * half.y + fabs(r.m[2][i]) * half.z;
		out_low[i] = at[i] - reach, out_high[i] = at[i] + reach;
	}
}

static ob_pose pose_of(const ob_universe *u, uint32_t terrain)
{
	const ob_motion *m = ob_newest_motion(u, terrain);
	return (ob_pose){ m->p, m->q };
}

static void find_box(const ob_universe *u, uint32_t terrain, uint32_t other, double low[3], double high[3])
{
	const float *b = ob_universe_step_data(u)->bounds[other];
	const double world_low[3] = { b[0], b[1], b[2] }, world_high[3] = { b[3], b[4], b[5] };
	turn_box(pose_of(u, terrain), world_low, world_high, low, high);
}

uint32_t ob_terrain_near(const ob_universe *u, uint32_t terrain, uint32_t other, uint32_t *out, uint32_t max)
{
	double low[3], high[3];
	find_box(u, terrain, other, low, high);
	return ob_terrain_find_regions(ob_terrain_of(u, ob_passport_of(u, terrain)), low, high, out, max);
}

// True if the surface in the box is the region's plane, or the box lies above that: all triangles near the box are the
// region's, none of them ends there, and one enters it.
static bool is_flat(const ob_terrain *t, uint32_t region, const double low[3], const double high[3])
{
	const ob_terrain_triangle *triangle = ob_terrain_triangles(t);
	const ob_terrain_region *r = &ob_terrain_regions(t)[region];
	const ob_vec3 middle = ob_v3(.5 * (low[0] + high[0]), .5 * (low[1] + high[1]), .5 * (low[2] + high[2])),
		      half = ob_sub(ob_v3(high[0], high[1], high[2]), middle);
	const double height = ob_dot(r->normal, middle) - r->offset,
		     reach = fabs(r->normal.x) * half.x + fabs(r->normal.y) * half.y + fabs(r->normal.z) * half.z;
	bool known = height > reach;
	ob_terrain_search s;
	uint32_t i;
	if (!t->solid && !(height > 0))
		return false;
	ob_terrain_begin(t, low, high, &s);
	while (ob_terrain_next(&s, &i)) {
		if (triangle[i].region != region || !triangle[i].across[0] || !triangle[i].across[1] ||
		    !triangle[i].across[2])
			return false;
		known = known || ob_terrain_enters(t, i, low, high);
	}
	return known;
}

bool ob_terrain_see(const ob_universe *u, const ob_pair_key *k, ob_terrain_view *out)
{
	const uint32_t id = ob_terrain_is_first(u, k) ? k->a : k->b, other = id == k->a ? k->b : k->a;
	const ob_terrain *t = ob_terrain_of(u, ob_passport_of(u, id));
	double low[3], high[3];
	*out = (ob_terrain_view){ .terrain = t, .region = k->region - 1u };
	if (!t || out->region >= t->regions) {
		ob_step_fail((ob_universe *)u, OB_STEP_DAMAGED, 0);
		return false;
	}
	find_box(u, id, other, low, high);
	out->flat = is_flat(t, out->region, low, high);
	if (!out->flat)
		return true;
	const ob_terrain_region *r = &ob_terrain_regions(t)[out->region];
	const ob_vec3 n = r->normal;
	const ob_quat up =
		n.z < -1 + 1e-12 ? (ob_quat){ 0, 1, 0, 0 } : ob_quat_normalize((ob_quat){ 1 + n.z, -n.y, n.x, 0 });
	const ob_pose pose = pose_of(u, id);
	const ob_mat3 turn = ob_quat_matrix(pose.q);
	out->plane.q = ob_quat_normalize(ob_quat_mul(pose.q, up));
	out->plane.p = ob_madd(pose.p, r->offset, ob_rotate(&turn, n));
	return true;
}

bool ob_terrain_region_bounds(const ob_universe *u, const ob_pair_key *k, double bounds[6])
{
	const uint32_t id = ob_terrain_is_first(u, k) ? k->a : k->b;
	const ob_terrain *t = ob_terrain_of(u, ob_passport_of(u, id));
	if (!t || k->region - 1u >= t->regions)
		return false;
	const ob_terrain_region *r = &ob_terrain_regions(t)[k->region - 1u];
	const ob_pose pose = pose_of(u, id);
	const ob_mat3 turn = ob_quat_matrix(pose.q);
	const ob_vec3 low = ob_v3(r->low[0], r->low[1], r->low[2]),
		      half = ob_scale(ob_sub(ob_v3(r->high[0], r->high[1], r->high[2]), low), .5),
		      middle = ob_add(pose.p, ob_rotate(&turn, ob_add(low, half)));
	const double at[3] = { middle.x, middle.y, middle.z };
	for (int i = 0; i < 3; i++) {
		const double reach =
			fabs(turn.m[i][0]) * half.x + fabs(turn.m[i][1]) * half.y + fabs(turn.m[i][2]) * half.z;
		bounds[i] = at[i] - reach, bounds[i + 3] = at[i] + reach;
	}
	return true;
}

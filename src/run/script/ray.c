// Rays against objects.
#include <math.h>

#include "motion/flight.h"
#include "script/runner.h"
#include "shape/shape.h"

static double enter(lua_State *L, const ob_universe *u, const ob_passport *o, ob_vec3 p, ob_vec3 d, double length,
		    ob_vec3 *n)
{
	const ob_terrain *terrain = ob_terrain_of(u, o);
	const ob_shape_kind *kind = ob_shape_kind_of((ob_shape)o->shape);
	if (!terrain)
		return kind->enter ? kind->enter(o->size, p, d, n) : INFINITY;
	uint32_t tests;
	const double t = ob_terrain_enter(terrain, p, d, length, n, &tests);
	ob_sandbox_spend(L, tests);
	return t;
}

// True if the ray intersects the object's fat AABB.
static bool may_meet(const float *b, ob_vec3 p, ob_vec3 d, double length)
{
	const double at[] = { p.x, p.y, p.z }, to[] = { d.x, d.y, d.z };
	double first = 0, last = length;
	for (int i = 0; i < 3; i++) {
		if (to[i] == 0) {
			if (at[i] < b[i] || at[i] > b[i + 3])
				return false;
			continue;
		}
		const double x = (b[i] - at[i]) / to[i], y = (b[i + 3] - at[i]) / to[i];
		first = fmax(first, fmin(x, y));
		last = fmin(last, fmax(x, y));
	}
	return first <= last;
}

bool ob_ray_cast(lua_State *L, const ob_universe *u, ob_vec3 from, ob_vec3 direction, double length, uint32_t but,
		 ob_ray_hit *hit)
{
	enum { LOOKED_AT = 64, SHAPE = 8 }; // objects whose bounds are charged at once; instructions of a shape
	const ob_step_data *data = ob_universe_step_data(u);
	const double time = (double)ob_step_count(u) * ob_universe_settings(u)->step_length;
	*hit = (ob_ray_hit){ .distance = length };
	bool found = false;
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		if (id % LOOKED_AT == 0)
			ob_sandbox_spend(L, LOOKED_AT / 2);
		if (id == but || data->schedule[id].state == OB_SCHEDULE_ABSENT ||
		    !may_meet(data->bounds[id], from, direction, hit->distance))
			continue;
		ob_sandbox_spend(L, SHAPE);
		const ob_passport *o = ob_passport_of(u, id);
		if (o->flags & OB_OBJECT_SENSOR)
			continue;
		const ob_state s = ob_published_at(ob_newest_motion(u, id), o, time);
		const ob_mat3 r = ob_quat_matrix(s.pose.q);
		ob_vec3 n = { 0 };
		const double t = enter(L, u, o, ob_rotate_back(&r, ob_sub(from, s.pose.p)),
				       ob_rotate_back(&r, direction), hit->distance, &n);
		if (!(t < hit->distance)) // at equal distances the lower id
			continue;
		*hit = (ob_ray_hit){ id, t, ob_rotate(&r, n) };
		found = true;
	}
	return found;
}

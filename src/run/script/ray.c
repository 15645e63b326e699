// Rays against objects.
#include <math.h>
#include <string.h>

#include "motion/flight.h"
#include "scene/sandbox.h"
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

// ---- sense

// Sensors, as scripts read them.

// Number of the sensor of the name at index 1; UINT32_MAX: there is none.
static uint32_t find(lua_State *L, const ob_script_runner *r)
{
	enum { NAMES_PER_INSTRUCTION = 4 };
	const char *name = lua_type(L, 1) == LUA_TSTRING ? lua_tostring(L, 1) : NULL;
	if (!r->turn)
		ob_sandbox_fail(L, "sense: sensors can be read in a function alone, as in function on_step() ... end");
	if (!name)
		ob_sandbox_fail(L, "sense: expected the name of a sensor");
	ob_sandbox_spend(L, r->data->sensors / NAMES_PER_INSTRUCTION);
	for (uint32_t i = 0; i < r->data->sensors; i++)
		if (strncmp(r->data->sensor[i].name, name, OB_NAME_MAX) == 0)
			return i;
	return UINT32_MAX;
}

int ob_script_call_sense(lua_State *L)
{
	const ob_script_runner *r = ob_sandbox_user(L);
	const uint32_t sensor = find(L, r);
	double value[OB_SENSOR_VALUES_MAX], time;
	uint64_t number;
	if (sensor != UINT32_MAX && r->data->sensor[sensor].kind == OB_SENSOR_CAMERA)
		ob_sandbox_fail(L, "sense: \"%s\" is a camera, whose pictures are for programs", lua_tostring(L, 1));
	if (sensor == UINT32_MAX || !ob_universe_get_samples(r->u, sensor, 0, &number, &time, value, 1))
		return 0;
	const uint32_t width = r->data->sensor[sensor].width;
	ob_sandbox_spend(L, width);
	lua_createtable(L, (int)width, 0);
	for (uint32_t i = 0; i < width; i++) {
		lua_pushnumber(L, value[i]);
		lua_rawseti(L, -2, (int)i + 1);
	}
	lua_pushnumber(L, time);
	return 2;
}

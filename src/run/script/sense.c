// Sensors, as scripts read them.
#include <string.h>

#include "scene/sandbox.h"
#include "script/runner.h"

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

// random(), random(low, high), random_rotation(), math.random: numbers from the scene's seed.
#include <math.h>

#include <lauxlib.h>

#include "scene/builder.h"
#include "scene/sandbox.h"

static ob_random *source(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	b->random_used = true;
	return &b->random;
}

int ob_scene_call_random(lua_State *L)
{
	int n = lua_gettop(L);
	if (n != 0 && n != 2)
		ob_sandbox_fail(L, "random: expected random() or random(low, high), got %d value%s", n,
				n == 1 ? "" : "s");
	double low = n ? luaL_checknumber(L, 1) : 0, high = n ? luaL_checknumber(L, 2) : 1;
	if (!isfinite(high - low) || !(low <= high))
		ob_sandbox_fail(L, "random: expected low <= high, got %.10g and %.10g", low, high);
	lua_pushnumber(L, low + (high - low) * ob_random_real(source(L)));
	return 1;
}

int ob_scene_call_random_rotation(lua_State *L)
{
	ob_quat q = ob_random_rotation(source(L));
	double x[4] = { q.w, q.x, q.y, q.z };
	lua_createtable(L, 4, 0);
	for (int i = 0; i < 4; i++) {
		lua_pushnumber(L, x[i]);
		lua_rawseti(L, -2, i + 1);
	}
	return 1;
}

int ob_scene_call_random_integer(lua_State *L)
{
	int n = lua_gettop(L);
	if (n == 0)
		return ob_scene_call_random(L);
	lua_Integer low = n > 1 ? luaL_checkinteger(L, 1) : 1, high = luaL_checkinteger(L, n > 1 ? 2 : 1);
	if (low > high)
		ob_sandbox_fail(L, "math.random: expected whole numbers low <= high, got %lld and %lld", (long long)low,
				(long long)high);
	uint64_t x = ob_random_up_to(source(L), (uint64_t)high - (uint64_t)low);
	lua_pushinteger(L, (lua_Integer)((uint64_t)low + x));
	return 1;
}

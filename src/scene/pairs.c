#include "scene/library.h"

#include <string.h>

#include <lauxlib.h>

#include "scene/sandbox.h"

static int rank(lua_State *L, int index)
{
	switch (lua_type(L, index)) {
	case LUA_TNUMBER:
		return 0;
	case LUA_TSTRING:
		return 1;
	default:
		return 2;
	}
}

// Bytes, not the collation of some locale.
static bool string_less(lua_State *L)
{
	size_t n, m;
	const char *a = lua_tolstring(L, 1, &n), *b = lua_tolstring(L, 2, &m);
	int order = memcmp(a, b, n < m ? n : m);
	return order < 0 || (order == 0 && n < m);
}

static int key_less(lua_State *L)
{
	ob_sandbox_spend(L, 1);
	int a = rank(L, 1), b = rank(L, 2);
	bool before = a < b;
	if (a == b && a == 0)
		before = lua_compare(L, 1, 2, LUA_OPLT);
	else if (a == b && a == 1)
		before = string_less(L);
	else if (a == b)
		before = lua_toboolean(L, 1) < lua_toboolean(L, 2);
	lua_pushboolean(L, before);
	return 1;
}

// Upvalues: the table, its sorted keys, how many have been given. A key that was removed meanwhile is left out.
static int next_pair(lua_State *L)
{
	lua_Integer i = lua_tointeger(L, lua_upvalueindex(3));
	do {
		i++;
		lua_settop(L, 0);
		if (lua_rawgeti(L, lua_upvalueindex(2), i) == LUA_TNIL)
			return 1;
		lua_pushvalue(L, 1);
	} while (lua_rawget(L, lua_upvalueindex(1)) == LUA_TNIL);
	lua_pushinteger(L, i);
	lua_replace(L, lua_upvalueindex(3));
	return 2;
}

int ob_library_pairs(lua_State *L)
{
	luaL_checktype(L, 1, LUA_TTABLE);
	lua_settop(L, 1);
	lua_newtable(L);
	lua_Integer n = 0;
	lua_pushnil(L);
	while (lua_next(L, 1)) {
		lua_pop(L, 1);
		int type = lua_type(L, -1);
		if (type != LUA_TNUMBER && type != LUA_TSTRING && type != LUA_TBOOLEAN)
			ob_sandbox_fail(L, "pairs: expected keys with an order (numbers, strings), got a %s",
					lua_typename(L, type));
		lua_pushvalue(L, -1);
		lua_rawseti(L, 2, ++n);
	}
	lua_pushvalue(L, lua_upvalueindex(1));
	lua_pushvalue(L, 2);
	lua_pushcfunction(L, key_less);
	lua_call(L, 2, 0);
	lua_pushinteger(L, 0);
	lua_pushcclosure(L, next_pair, 3);
	return 1;
}

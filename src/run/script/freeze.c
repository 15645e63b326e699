// Freezes all values that a text leaves behind once it has been read. So a script keeps only the state of its objects
// in self.state, and any worker, also a restarted one, can run it.
//
// A table is frozen in place: its contents move into another, from which its metatable, which scripts cannot access,
// reads them. An outer local cannot be guarded so; its value is noted, and compared after each call.

#include <lauxlib.h>

#include "base/allocate.h"
#include "script/runner.h"

#define FROZEN "script.frozen" // key in the registry: table -> its contents; weak in neither

static int refuse_change(lua_State *L)
{
	ob_sandbox_fail(L, "cannot set %.40s here: a script keeps values in self.state, for nothing else survives",
			lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "a value");
}

static int frozen_length(lua_State *L)
{
	lua_getfield(L, LUA_REGISTRYINDEX, FROZEN);
	lua_pushvalue(L, 1);
	lua_rawget(L, -2);
	lua_pushinteger(L, (lua_Integer)lua_rawlen(L, -1));
	return 1;
}

// Pushes the contents of the table at this index; false, and nothing: not frozen.
static bool push_contents(lua_State *L, int index)
{
	index = lua_absindex(L, index);
	lua_getfield(L, LUA_REGISTRYINDEX, FROZEN);
	lua_pushvalue(L, index);
	const bool frozen = lua_rawget(L, -2) == LUA_TTABLE;
	lua_remove(L, -2);
	if (!frozen)
		lua_pop(L, 1);
	return frozen;
}

static void visit(lua_State *L, ob_interpreter *p, int index);

// Replaces the table at the top by an empty one with its contents behind it, and leaves the contents at the top.
static void freeze_table(lua_State *L)
{
	const int table = lua_gettop(L);
	lua_newtable(L); // contents
	for (lua_pushnil(L); lua_next(L, table); lua_pop(L, 1)) {
		lua_pushvalue(L, -2);
		lua_pushvalue(L, -2);
		lua_rawset(L, table + 1);
	}
	for (lua_pushnil(L); lua_next(L, table + 1); lua_pop(L, 1)) {
		lua_pushvalue(L, -2);
		lua_pushnil(L);
		lua_rawset(L, table);
	}
	if (lua_getmetatable(L, table)) // globals have one for unknown names
		lua_setmetatable(L, table + 1);
	lua_newtable(L);
	lua_pushvalue(L, table + 1);
	lua_setfield(L, -2, "__index");
	lua_pushcfunction(L, refuse_change);
	lua_setfield(L, -2, "__newindex");
	lua_pushcfunction(L, frozen_length);
	lua_setfield(L, -2, "__len");
	lua_setmetatable(L, table);
	lua_getfield(L, LUA_REGISTRYINDEX, FROZEN);
	lua_pushvalue(L, table);
	lua_pushvalue(L, table + 1);
	lua_rawset(L, -3);
	lua_pop(L, 1);
	lua_remove(L, table);
}

static void visit_table(lua_State *L, ob_interpreter *p, int index)
{
	lua_pushvalue(L, index);
	freeze_table(L);
	const int contents = lua_gettop(L);
	for (lua_pushnil(L); lua_next(L, contents); lua_pop(L, 1)) {
		visit(L, p, -2);
		visit(L, p, -1);
	}
	lua_pop(L, 1);
}

// Watches the outer local whose value is at the top, and leaves it there.
static void watch(lua_State *L, ob_interpreter *p, int function, int upvalue)
{
	if (p->watched_count == p->watched_room) {
		const uint32_t room = 2 * p->watched_room + 16;
		if (!OB_GROW(p->watched, room))
			ob_sandbox_fail(L, "no memory left on this machine");
		p->watched_room = room;
	}
	ob_watched *w = &p->watched[p->watched_count];
	lua_pushvalue(L, function);
	w->function = luaL_ref(L, LUA_REGISTRYINDEX);
	lua_pushvalue(L, -1);
	w->value = luaL_ref(L, LUA_REGISTRYINDEX); // LUA_REFNIL for nil
	w->upvalue = upvalue;
	p->watched_count++;
}

// Watches the locals of a function. A local that several functions share is watched for each, and compared more often
// than necessary.
static void visit_function(lua_State *L, ob_interpreter *p, int index)
{
	const char *name;
	for (int i = 1; (name = lua_getupvalue(L, index, i)); i++) {
		lua_pushglobaltable(L);
		const bool environment = lua_rawequal(L, -1, -2);
		lua_pop(L, 1);
		if (*name && !environment) // names in C functions are empty
			watch(L, p, index, i);
		if (*name)
			visit(L, p, -1);
		lua_pop(L, 1);
	}
}

// Visits a value. Visited tables and functions are keys of the table at index 1 of the stack.
static void visit(lua_State *L, ob_interpreter *p, int index)
{
	index = lua_absindex(L, index);
	const int type = lua_type(L, index);
	if (type != LUA_TTABLE && type != LUA_TFUNCTION)
		return;
	luaL_checkstack(L, 12, "nested too deep");
	lua_pushvalue(L, index);
	const bool known = lua_rawget(L, 1) != LUA_TNIL;
	lua_pop(L, 1);
	if (known)
		return;
	lua_pushvalue(L, index);
	lua_pushboolean(L, true);
	lua_rawset(L, 1);
	if (type == LUA_TTABLE)
		visit_table(L, p, index);
	else
		visit_function(L, p, index);
}

void ob_script_freeze(lua_State *L, ob_interpreter *p)
{
	lua_newtable(L);
	lua_setfield(L, LUA_REGISTRYINDEX, FROZEN);
	lua_settop(L, 0);
	lua_newtable(L);
	for (int i = 0; i < OB_HANDLERS; i++)
		if (p->handler[i] != LUA_NOREF) {
			lua_rawgeti(L, LUA_REGISTRYINDEX, p->handler[i]);
			visit(L, p, -1);
			lua_pop(L, 1);
		}
	lua_pushglobaltable(L);
	visit(L, p, -1);
}

static _Noreturn void fail_changed(lua_State *L, const ob_watched *w, const char *name)
{
	lua_Debug d;
	lua_rawgeti(L, LUA_REGISTRYINDEX, w->function);
	lua_getinfo(L, ">S", &d);
	ob_sandbox_fail(L,
			"%.40s was set, which the function at line %d sees: a script keeps values in self.state, for "
			"nothing else survives",
			name, d.linedefined);
}

void ob_script_check_frozen(lua_State *L, const ob_interpreter *p)
{
	for (uint32_t i = 0; i < p->watched_count; i++) {
		const ob_watched *w = &p->watched[i];
		ob_sandbox_spend(L, 4);
		lua_rawgeti(L, LUA_REGISTRYINDEX, w->function);
		const char *name = lua_getupvalue(L, -1, w->upvalue);
		lua_rawgeti(L, LUA_REGISTRYINDEX, w->value);
		if (!lua_rawequal(L, -1, -2) && lua_rawequal(L, -1, -1) == lua_rawequal(L, -2, -2))
			fail_changed(L, w, name ? name : "?");
		lua_pop(L, 3);
	}
}

void ob_script_thaw(lua_State *L, int index)
{
	index = lua_absindex(L, index);
	if (!lua_istable(L, index))
		return;
	luaL_checkstack(L, 8, "nested too deep");
	lua_newtable(L);
	const int copy = lua_gettop(L);
	if (!push_contents(L, index))
		lua_pushvalue(L, index);
	for (lua_pushnil(L); lua_next(L, copy + 1);) {
		ob_sandbox_spend(L, 8);
		ob_script_thaw(L, -1);
		lua_pushvalue(L, -2);
		lua_insert(L, -2);
		lua_rawset(L, copy);
	}
	lua_settop(L, copy);
	lua_replace(L, index);
}

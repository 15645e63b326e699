#include "scene/vector.h"

#include <string.h>

#include <lauxlib.h>

#include "elementary/elementary.h"
#include "scene/sandbox.h"

static const char vector_kind[] = "vector", rotation_kind[] = "rotation";
enum { COST = 8 }; // instructions of the sandbox, for an operation

// Pushes a value of this kind with the methods of a metatable, which ob_vector_open has made.
static void push(lua_State *L, const char *kind, const void *value, size_t size)
{
	memcpy(lua_newuserdatauv(L, size, 0), value, size);
	luaL_setmetatable(L, kind);
}

void ob_vector_push(lua_State *L, ob_vec3 v)
{
	push(L, vector_kind, &v, sizeof v);
}

void ob_rotation_push(lua_State *L, ob_quat q)
{
	push(L, rotation_kind, &q, sizeof q);
}

const ob_vec3 *ob_vector_at(lua_State *L, int index)
{
	return luaL_testudata(L, index, vector_kind);
}

const ob_quat *ob_rotation_at(lua_State *L, int index)
{
	return luaL_testudata(L, index, rotation_kind);
}

static ob_vec3 vector_at(lua_State *L, int index)
{
	const ob_vec3 *v = ob_vector_at(L, index);
	ob_sandbox_spend(L, COST);
	if (!v)
		ob_sandbox_fail(L, "vector: expected a vector, got a %s", luaL_typename(L, index));
	return *v;
}

static ob_quat rotation_at(lua_State *L, int index)
{
	const ob_quat *q = ob_rotation_at(L, index);
	ob_sandbox_spend(L, COST);
	if (!q)
		ob_sandbox_fail(L, "rotation: expected a rotation, got a %s", luaL_typename(L, index));
	return *q;
}

static double number_at(lua_State *L, int index, const char *what)
{
	if (lua_type(L, index) != LUA_TNUMBER)
		ob_sandbox_fail(L, "%s: expected a number, got a %s", what, luaL_typename(L, index));
	return lua_tonumber(L, index);
}

static int give_vector(lua_State *L, ob_vec3 v)
{
	ob_vector_push(L, v);
	return 1;
}

static int give_number(lua_State *L, double x)
{
	lua_pushnumber(L, x);
	return 1;
}

static int give_rotation(lua_State *L, ob_quat q)
{
	ob_rotation_push(L, q);
	return 1;
}

// ---- vectors

static int vector(lua_State *L)
{
	ob_sandbox_spend(L, COST);
	return give_vector(L, ob_v3(number_at(L, 1, "vector"), number_at(L, 2, "vector"), number_at(L, 3, "vector")));
}

static int add(lua_State *L)
{
	return give_vector(L, ob_add(vector_at(L, 1), vector_at(L, 2)));
}

static int subtract(lua_State *L)
{
	return give_vector(L, ob_sub(vector_at(L, 1), vector_at(L, 2)));
}

static int negate(lua_State *L)
{
	return give_vector(L, ob_scale(vector_at(L, 1), -1));
}

static int scale(lua_State *L)
{
	const int first = lua_isnumber(L, 1) ? 1 : 2;
	return give_vector(L, ob_scale(vector_at(L, 3 - first), number_at(L, first, "vector")));
}

static int norm(lua_State *L)
{
	return give_number(L, ob_norm(vector_at(L, 1)));
}

static int aside(lua_State *L)
{
	const ob_vec3 v = vector_at(L, 1);
	return give_number(L, ob_hypot(v.x, v.y));
}

static int dot(lua_State *L)
{
	return give_number(L, ob_dot(vector_at(L, 1), vector_at(L, 2)));
}

static int cross(lua_State *L)
{
	return give_vector(L, ob_cross(vector_at(L, 1), vector_at(L, 2)));
}

// ---- rotations

// rotation(v): by a vector's length (rad) about it. rotation(w, x, y, z): of a quaternion, made a unit one.
static int rotation(lua_State *L)
{
	double q[4];
	if (lua_gettop(L) == 1)
		return give_rotation(L, ob_quat_turn(ob_quat_identity(), vector_at(L, 1)));
	for (int i = 0; i < 4; i++)
		q[i] = number_at(L, i + 1, "rotation");
	ob_sandbox_spend(L, COST);
	if (!(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] > 0))
		ob_sandbox_fail(L, "rotation: expected a vector, or four numbers that are not all 0");
	return give_rotation(L, ob_quat_normalize((ob_quat){ q[0], q[1], q[2], q[3] }));
}

static int turn(lua_State *L)
{
	return give_rotation(L, ob_quat_turn(rotation_at(L, 1), vector_at(L, 2)));
}

static int back(lua_State *L)
{
	const ob_mat3 r = ob_quat_matrix(rotation_at(L, 1));
	return give_vector(L, ob_rotate_back(&r, vector_at(L, 2)));
}

// A rotation times a vector, or times another rotation.
static int apply(lua_State *L)
{
	const ob_quat q = rotation_at(L, 1);
	const ob_mat3 r = ob_quat_matrix(q);
	const ob_vec3 *v = ob_vector_at(L, 2);
	return v ? give_vector(L, ob_rotate(&r, *v)) : give_rotation(L, ob_quat_mul(q, rotation_at(L, 2)));
}

static int axis(lua_State *L)
{
	const ob_mat3 r = ob_quat_matrix(rotation_at(L, 1));
	const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
	if (!*name || name[1] || !strchr("xyz", *name))
		ob_sandbox_fail(L, "rotation:axis: expected \"x\", \"y\" or \"z\"");
	return give_vector(L, ob_column(&r, *name - 'x'));
}

static int to_text(lua_State *L)
{
	const ob_vec3 v = vector_at(L, 1);
	lua_pushfstring(L, "{%f, %f, %f}", v.x, v.y, v.z);
	return 1;
}

// ---- fields and methods

// The method of this name, of upvalue 1; for a component, nothing.
static int method(lua_State *L, const char *kind, const char *components)
{
	lua_pushvalue(L, 2);
	if (lua_rawget(L, lua_upvalueindex(1)) == LUA_TNIL)
		ob_sandbox_fail(L, "%s: it has no \"%.40s\", only %s", kind,
				lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : luaL_typename(L, 2), components);
	return 1;
}

static int field_of(lua_State *L, const char *kind, const char *letters, const double *component, const char *all)
{
	const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
	const char *at = *name && !name[1] ? strchr(letters, *name) : NULL;
	return at ? give_number(L, component[at - letters]) : method(L, kind, all);
}

static int vector_index(lua_State *L)
{
	const ob_vec3 v = vector_at(L, 1);
	return field_of(L, vector_kind, "xyz", (double[]){ v.x, v.y, v.z }, "x, y, z, norm, aside, dot and cross");
}

static int rotation_index(lua_State *L)
{
	const ob_quat q = rotation_at(L, 1);
	return field_of(L, rotation_kind, "wxyz", (double[]){ q.w, q.x, q.y, q.z }, "w, x, y, z, turn, back and axis");
}

static void make_kind(lua_State *L, const char *kind, lua_CFunction index, const luaL_Reg *methods,
		      const luaL_Reg *events)
{
	luaL_newmetatable(L, kind);
	luaL_setfuncs(L, events, 0);
	lua_newtable(L);
	luaL_setfuncs(L, methods, 0);
	lua_pushcclosure(L, index, 1);
	lua_setfield(L, -2, "__index");
	lua_pop(L, 1);
}

void ob_vector_open(lua_State *L)
{
	static const luaL_Reg vector_methods[] = {
		{ "norm", norm }, { "aside", aside }, { "dot", dot }, { "cross", cross }, { NULL, NULL }
	};
	static const luaL_Reg vector_events[] = { { "__add", add },   { "__sub", subtract },     { "__unm", negate },
						  { "__mul", scale }, { "__tostring", to_text }, { NULL, NULL } };
	static const luaL_Reg rotation_methods[] = {
		{ "turn", turn }, { "back", back }, { "axis", axis }, { NULL, NULL }
	};
	static const luaL_Reg rotation_events[] = { { "__mul", apply }, { NULL, NULL } };
	make_kind(L, vector_kind, vector_index, vector_methods, vector_events);
	make_kind(L, rotation_kind, rotation_index, rotation_methods, rotation_events);
	lua_pushcfunction(L, vector);
	lua_setfield(L, -2, "vector");
	lua_pushcfunction(L, rotation);
	lua_setfield(L, -2, "rotation");
}

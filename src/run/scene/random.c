#include "scene/random.h"

#include <math.h>

#include <lauxlib.h>

#include "base/number.h"
#include "base/random.h"
#include "elementary/elementary.h"
#include "scene/builder.h"
#include "scene/sandbox.h"

void ob_random_seed(ob_random *r, uint64_t seed)
{
	for (int i = 0; i < 4; i++)
		r->s[i] = ob_splitmix(&seed);
}

static uint64_t rotate(uint64_t x, int n)
{
	return (x << n) | (x >> (64 - n));
}

uint64_t ob_random_next(ob_random *r)
{
	uint64_t *s = r->s, result = rotate(s[1] * 5, 7) * 9, t = s[1] << 17;
	s[2] ^= s[0];
	s[3] ^= s[1];
	s[1] ^= s[2];
	s[0] ^= s[3];
	s[2] ^= t;
	s[3] = rotate(s[3], 45);
	return result;
}

double ob_random_real(ob_random *r)
{
	return (double)(ob_random_next(r) >> 11) * 0x1p-53;
}

// Draws below the next power of two until one fits: at most two draws on average.
uint64_t ob_random_up_to(ob_random *r, uint64_t last)
{
	uint64_t mask = last;
	for (int shift = 1; shift < 64; shift *= 2)
		mask |= mask >> shift;
	uint64_t x;
	do
		x = ob_random_next(r) & mask;
	while (x > last);
	return x;
}

ob_quat ob_random_rotation(ob_random *r)
{
	double u = ob_random_real(r), a = 2 * M_PI * ob_random_real(r), b = 2 * M_PI * ob_random_real(r);
	return (ob_quat){ sqrt(u) * ob_cos(b), sqrt(1 - u) * ob_sin(a), sqrt(1 - u) * ob_cos(a), sqrt(u) * ob_sin(b) };
}

// ---- random(), random(low, high), random_rotation(), math.random: numbers from the scene's seed

static ob_random *scene_random(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	b->random_used = true;
	return &b->random;
}

// Arguments may be text, which is read as numbers.
static void spend_text(lua_State *L)
{
	for (int i = 1; i <= 2; i++)
		if (lua_type(L, i) == LUA_TSTRING)
			ob_sandbox_spend(L, (unsigned)lua_rawlen(L, i));
}

int ob_scene_call_random(lua_State *L)
{
	int n = lua_gettop(L);
	spend_text(L);
	if (n != 0 && n != 2)
		ob_sandbox_fail(L, "random: expected random() or random(low, high), got %d value%s", n,
				n == 1 ? "" : "s");
	double low = n ? luaL_checknumber(L, 1) : 0, high = n ? luaL_checknumber(L, 2) : 1;
	if (!isfinite(high - low) || !(low <= high))
		ob_sandbox_fail(L, "random: expected low <= high, got %s and %s", ob_number_text(low).text,
				ob_number_text(high).text);
	lua_pushnumber(L, low + (high - low) * ob_random_real(scene_random(L)));
	return 1;
}

int ob_scene_call_random_rotation(lua_State *L)
{
	ob_sandbox_spend(L, 24);
	ob_quat q = ob_random_rotation(scene_random(L));
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
	spend_text(L);
	if (n == 0)
		return ob_scene_call_random(L);
	lua_Integer low = n > 1 ? luaL_checkinteger(L, 1) : 1, high = luaL_checkinteger(L, n > 1 ? 2 : 1);
	if (low > high)
		ob_sandbox_fail(L, "math.random: expected whole numbers low <= high, got %lld and %lld", (long long)low,
				(long long)high);
	uint64_t x = ob_random_up_to(scene_random(L), (uint64_t)high - (uint64_t)low);
	lua_pushinteger(L, (lua_Integer)((uint64_t)low + x));
	return 1;
}

#include "scene/flat.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lauxlib.h>

#include "scene/sandbox.h"
#include "scene/scene.h"
#include "scene/text.h"

static void put_bytes(lua_State *L, ob_flat *f, char kind, const void *bytes, size_t n, const char *what)
{
	if (f->room - f->size < n + 1)
		ob_sandbox_fail(L, "%s: expected at most %u bytes of values", what, (unsigned)f->room);
	f->bytes[f->size] = (unsigned char)kind;
	if (n)
		memcpy(f->bytes + f->size + 1, bytes, n);
	f->size += (uint32_t)n + 1;
}

static void put_text(lua_State *L, int index, ob_flat *f, const char *what)
{
	size_t n;
	const char *text = lua_tolstring(L, index, &n);
	if (n > UINT16_MAX || f->room - f->size < n + 3)
		ob_sandbox_fail(L, "%s: expected at most %u bytes of values", what, (unsigned)f->room);
	put_bytes(L, f, 's', &(uint16_t){ (uint16_t)n }, 2, what);
	memcpy(f->bytes + f->size, text, n);
	f->size += (uint32_t)n;
}

void ob_flat_put(lua_State *L, int index, ob_flat *f, const char *what)
{
	const ob_flat_object *object;
	char got[OB_TEXT_VALUE];
	switch (lua_type(L, index)) {
	case LUA_TNUMBER:
		if (lua_isinteger(L, index))
			put_bytes(L, f, 'i', &(lua_Integer){ lua_tointeger(L, index) }, 8, what);
		else
			put_bytes(L, f, 'n', &(double){ lua_tonumber(L, index) }, 8, what);
		return;
	case LUA_TBOOLEAN:
		put_bytes(L, f, lua_toboolean(L, index) ? 't' : 'f', NULL, 0, what);
		return;
	case LUA_TSTRING:
		put_text(L, index, f, what);
		return;
	case LUA_TUSERDATA:
		object = luaL_testudata(L, index, OB_FLAT_OBJECT);
		if (object) {
			put_bytes(L, f, 'o', object, sizeof *object, what);
			return;
		}
		break;
	default:
		break;
	}
	ob_text_of_value(L, index, got);
	ob_sandbox_fail(L, "%s: expected a number, text, true, false or an object, got %s", what, got);
}

void ob_flat_put_table(lua_State *L, int index, ob_flat *f, const char *what)
{
	index = lua_absindex(L, index);
	for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1)) {
		if (lua_type(L, -2) != LUA_TSTRING && !lua_isinteger(L, -2))
			ob_sandbox_fail(L, "%s: expected text or whole numbers as keys, got a %s", what,
					luaL_typename(L, -2));
		ob_flat_put(L, -2, f, what);
		ob_flat_put(L, -1, f, what);
	}
}

uint32_t ob_flat_push(lua_State *L, const unsigned char *bytes, uint32_t size)
{
	lua_Integer whole;
	double number;
	uint16_t n;
	const uint32_t left = size ? size - 1 : 0;
	switch (size ? *bytes : 0) {
	case 'i':
		if (left < 8)
			return 0;
		memcpy(&whole, bytes + 1, 8);
		lua_pushinteger(L, whole);
		return 9;
	case 'n':
		if (left < 8)
			return 0;
		memcpy(&number, bytes + 1, 8);
		lua_pushnumber(L, number);
		return 9;
	case 't':
	case 'f':
		lua_pushboolean(L, *bytes == 't');
		return 1;
	case 's':
		if (left < 2)
			return 0;
		memcpy(&n, bytes + 1, 2);
		if (left - 2 < n)
			return 0;
		lua_pushlstring(L, (const char *)bytes + 3, n);
		return 3u + n;
	case 'o':
		if (left < sizeof(ob_flat_object))
			return 0;
		memcpy(lua_newuserdatauv(L, sizeof(ob_flat_object), 0), bytes + 1, sizeof(ob_flat_object));
		luaL_setmetatable(L, OB_FLAT_OBJECT);
		return 1 + (uint32_t)sizeof(ob_flat_object);
	default:
		return 0;
	}
}

void ob_flat_push_table(lua_State *L, const unsigned char *bytes, uint32_t size)
{
	lua_newtable(L);
	for (uint32_t at = 0; at < size;) {
		const uint32_t key = ob_flat_push(L, bytes + at, size - at);
		const bool named = key && (lua_type(L, -1) == LUA_TSTRING || lua_isinteger(L, -1));
		const uint32_t value = named ? ob_flat_push(L, bytes + at + key, size - at - key) : 0;
		if (!value) {
			lua_pop(L, key != 0);
			return;
		}
		lua_rawset(L, -3);
		at += key + value;
	}
}

// Bytes of the value that begins there; 0: invalid.
static uint32_t length(const unsigned char *bytes, uint32_t size)
{
	uint16_t n = 0;
	uint32_t whole = 0;
	switch (size ? *bytes : 0) {
	case 'i':
	case 'n':
	case 'o':
		whole = 9;
		break;
	case 't':
	case 'f':
		whole = 1;
		break;
	case 's':
		if (size >= 3)
			memcpy(&n, bytes + 1, 2);
		whole = 3u + n;
		break;
	default:
		return 0;
	}
	return whole <= size ? whole : 0;
}

enum { KEY_BYTES = 64 };

static uint32_t key_bytes(lua_State *L, int key, unsigned char to[KEY_BYTES], const char *what)
{
	ob_flat k = { to, 0, KEY_BYTES };
	if (lua_type(L, key) != LUA_TSTRING && !lua_isinteger(L, key))
		ob_sandbox_fail(L, "%s: expected text or whole numbers as keys, got a %s", what, luaL_typename(L, key));
	ob_flat_put(L, key, &k, "a key");
	return k.size;
}

// Offset of the key's value; 0: not found.
static uint32_t find(const ob_flat *f, const unsigned char *key, uint32_t n)
{
	for (uint32_t at = 0; at < f->size;) {
		const uint32_t k = length(f->bytes + at, f->size - at);
		const uint32_t v = k ? length(f->bytes + at + k, f->size - at - k) : 0;
		if (!v)
			return 0;
		if (k == n && memcmp(f->bytes + at, key, n) == 0)
			return at + k;
		at += k + v;
	}
	return 0;
}

void ob_flat_get(lua_State *L, const ob_flat *f, int key)
{
	unsigned char k[KEY_BYTES];
	const uint32_t n = key_bytes(L, key, k, "state"), at = find(f, k, n);
	if (!at || !ob_flat_push(L, f->bytes + at, f->size - at))
		lua_pushnil(L);
}

void ob_flat_set(lua_State *L, ob_flat *f, int key, int value, const char *what)
{
	unsigned char k[KEY_BYTES];
	const uint32_t n = key_bytes(L, key, k, what), at = find(f, k, n);
	const uint32_t before = f->size, old = at ? length(f->bytes + at, f->size - at) : 0;
	if (lua_isnil(L, value)) {
		if (at)
			memmove(f->bytes + at - n, f->bytes + at + old, f->size - at - old), f->size -= n + old;
		return;
	}
	if (at && old == 9 && lua_type(L, value) == LUA_TNUMBER) { // in place, the most frequent case
		ob_flat one = { f->bytes + at, 0, 9 };
		ob_flat_put(L, value, &one, what);
		return;
	}
	if (f->room - f->size < n)
		ob_sandbox_fail(L, "%s: expected at most %u bytes of values", what, (unsigned)f->room);
	memcpy(f->bytes + f->size, k, n);
	f->size += n;
	const uint32_t kept = f->size;
	f->size = before; // the old table, if the value does not fit
	ob_flat rest = { f->bytes + kept, 0, f->room - kept };
	ob_flat_put(L, value, &rest, what);
	f->size = kept + rest.size;
	if (at)
		memmove(f->bytes + at - n, f->bytes + at + old, f->size - at - old), f->size -= n + old;
}

bool ob_scene_put_value(const char *word, unsigned char *to, uint32_t *size, uint32_t room)
{
	char *end;
	const size_t n = strlen(word);
	const uint32_t left = room - *size;
	unsigned char *at = to + *size;
	const double number = strtod(word, &end);
	if (strcmp(word, "true") == 0 || strcmp(word, "false") == 0) {
		if (left < 1)
			return false;
		*at = *word == 't' ? 't' : 'f';
		*size += 1;
	} else if (n && !*end && isfinite(number)) {
		char *whole_end;
		errno = 0;
		const long long whole = strtoll(word, &whole_end, 10);
		const bool is_whole = !*whole_end && errno == 0;
		if (left < 9)
			return false;
		*at = is_whole ? 'i' : 'n';
		if (is_whole)
			memcpy(at + 1, &(lua_Integer){ whole }, 8);
		else
			memcpy(at + 1, &number, 8);
		*size += 9;
	} else {
		if (n > UINT16_MAX || left < n + 3)
			return false;
		*at = 's';
		memcpy(at + 1, &(uint16_t){ (uint16_t)n }, 2);
		memcpy(at + 3, word, n);
		*size += (uint32_t)n + 3;
	}
	return true;
}

#include "scene/text.h"

#include <stdio.h>
#include <string.h>

#include "base/number.h"
#include "base/utf8.h"

static size_t put_number(double x, char *out, size_t size)
{
	return (size_t)snprintf(out, size, "%s", ob_number_text(x).text);
}

// Short lists of numbers are shown whole: most mistakes are in vectors.
static bool put_list(lua_State *L, int index, char *out)
{
	size_t n = lua_rawlen(L, index), used = 1;
	if (n < 1 || n > 4)
		return false;
	out[0] = '{';
	for (size_t i = 1; i <= n; i++) {
		bool number = lua_rawgeti(L, index, (lua_Integer)i) == LUA_TNUMBER;
		if (number) {
			used += put_number(lua_tonumber(L, -1), out + used, OB_TEXT_VALUE - used);
			used += (size_t)snprintf(out + used, OB_TEXT_VALUE - used, i < n ? ", " : "}");
		}
		lua_pop(L, 1);
		if (!number)
			return false;
	}
	return true;
}

void ob_text_of_value(lua_State *L, int index, char out[OB_TEXT_VALUE])
{
	switch (lua_type(L, index)) {
	case LUA_TNONE:
	case LUA_TNIL:
		snprintf(out, OB_TEXT_VALUE, "nothing");
		break;
	case LUA_TBOOLEAN:
		snprintf(out, OB_TEXT_VALUE, lua_toboolean(L, index) ? "true" : "false");
		break;
	case LUA_TNUMBER:
		put_number(lua_tonumber(L, index), out, OB_TEXT_VALUE);
		break;
	case LUA_TSTRING:
		snprintf(out, OB_TEXT_VALUE, "\"%.48s\"%s", lua_tostring(L, index),
			 lua_rawlen(L, index) > 48 ? " ..." : "");
		break;
	case LUA_TTABLE:
		if (!put_list(L, index, out))
			snprintf(out, OB_TEXT_VALUE, "a table");
		break;
	default:
		snprintf(out, OB_TEXT_VALUE, "a %s", lua_typename(L, lua_type(L, index)));
	}
}

static const char *const synonym[][2] = {
	{ "color", "colour" },
	{ "position", "at" },
	{ "pos", "at" },
	{ "dimensions", "size" },
	{ "fixed", "static" },
	{ "omega", "spin" },
	{ "quaternion", "q" },
	{ "bounciness", "restitution" },
	{ "mu", "friction" },
	{ "timestep", "step" },
	{ "dt", "step" },
	{ "sphere_radius", "radius" },
	{ "height", "length" },
	{ "orientation", "rotation" },
	{ "angular_velocity", "spin" },
	{ "cube", "box" },
	{ "ball", "sphere" },
	{ "half_extents", "size" },
};

void ob_text_offer(ob_spelling *s, const char *known)
{
	for (size_t i = 0; i < sizeof synonym / sizeof *synonym; i++)
		if (strcmp(s->word, synonym[i][0]) == 0 && strcmp(known, synonym[i][1]) == 0) {
			s->best = known;
			s->distance = 0;
		}
	ob_spelling_offer(s, known);
}

bool ob_text_is_clean(const char *text, size_t size)
{
	for (size_t i = 0; i < size;) {
		size_t n = ob_utf8_length(text + i);
		size_t bytes;
		if (n == 0 || !ob_utf8_is_plain(ob_utf8_decode(text + i, &bytes)))
			return false;
		i += n;
	}
	return true;
}

// script: the scripts of objects, by name, from files beside the scene or from the scene itself.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lauxlib.h>

#include "base/allocate.h"
#include "base/file.h"
#include "base/spelling.h"
#include "scene/builder.h"
#include "scene/sandbox.h"
#include "scene/text.h"

enum { SCRIPTS_MAX = 64 }; // limit of a universe (table/step_data.h)

static bool is_file(const char *text)
{
	const size_t n = strlen(text);
	return n > 4 && strcmp(text + n - 4, ".lua") == 0 && !strpbrk(text, "\n\r");
}

static bool is_text(const char *text)
{
	return strchr(text, '\n') || strstr(text, "function");
}

static const char *last_part(const char *path)
{
	const char *slash = strrchr(path, '/');
	return slash ? slash + 1 : path;
}

// A scene can access only files in its own folder.
void ob_builder_find_file(lua_State *L, const ob_builder *b, const char *where, const char *field, const char *name,
			  char path[PATH_MAX])
{
	if (name[0] == '/' || strstr(name, ".."))
		ob_sandbox_fail(L, "%s.%s: expected a file in the folder of the scene, got \"%s\"", where, field, name);
	snprintf(path, PATH_MAX, "%.*s%s", (int)(last_part(b->path) - b->path), b->path, name);
}

// Reads a script into new memory.
static char *read_script(lua_State *L, const ob_builder *b, const char *where, const char *name)
{
	char path[PATH_MAX];
	ob_builder_find_file(L, b, where, "script", name, path);
	ob_error e;
	size_t size = 0;
	char *text = ob_file_load(path, OB_SCENE_SCRIPT_BYTES, &size, &e);
	if (!text)
		ob_sandbox_fail(L, "%s.script: cannot read %s: %s", where, path, e.text);
	if (!memchr(text, 0, size))
		return text;
	free(text);
	ob_sandbox_fail(L, "%s.script: cannot read %s: it is no text", where, path);
}

// Compiles the text with Lua, whose message names the line.
static void check_text(lua_State *L, const char *where, const ob_script_def *s)
{
	char chunk[OB_NAME_MAX + 1];
	snprintf(chunk, sizeof chunk, "=%s", s->name);
	if (s->text[0] == LUA_SIGNATURE[0])
		ob_sandbox_fail(L, "%s.script: %s:1: expected Lua text, got compiled Lua", where, s->name);
	if (luaL_loadbufferx(L, s->text, s->size, chunk, "t") != LUA_OK)
		ob_sandbox_fail(L, "%s.script: %s", where, lua_tostring(L, -1));
	lua_pop(L, 1);
}

uint32_t ob_builder_add_script(lua_State *L, ob_builder *b, const char *where, const char *name, char *text,
			       size_t size)
{
	ob_scene *s = b->scene;
	if (!text || s->scripts == SCRIPTS_MAX || !OB_GROW(s->script, s->scripts + 1)) {
		free(text);
		if (s->scripts == SCRIPTS_MAX)
			ob_sandbox_fail(L, "%s.script: expected at most %d scripts in a scene", where, SCRIPTS_MAX);
		ob_sandbox_fail(L, "%s.script: no memory left on this machine", where);
	}
	ob_script_def *added = &s->script[s->scripts++];
	*added = (ob_script_def){ .text = text, .size = (uint32_t)size };
	snprintf(added->name, sizeof added->name, "%s", name);
	return s->scripts;
}

// Takes ownership of text.
static uint32_t add_script(lua_State *L, ob_builder *b, const char *where, const char *name, char *text)
{
	const uint32_t script = ob_builder_add_script(L, b, where, name, text, text ? strlen(text) : 0);
	check_text(L, where, &b->scene->script[script - 1]);
	return script;
}

static uint32_t find_script(const ob_scene *s, const char *name)
{
	for (uint32_t i = 0; i < s->scripts; i++)
		if (strcmp(s->script[i].name, name) == 0)
			return i + 1;
	return 0;
}

// Finds a script by its text: the same text, declared in a loop, is one script.
static uint32_t find_text(const ob_scene *s, const char *text)
{
	for (uint32_t i = 0; i < s->scripts; i++)
		if (s->script[i].text && strcmp(s->script[i].text, text) == 0)
			return i + 1;
	return 0;
}

static _Noreturn void fail_unknown(lua_State *L, const ob_builder *b, const char *where, const char *script)
{
	ob_spelling spelling = ob_spelling_start(script);
	for (uint32_t i = 0; i < b->scene->scripts; i++)
		ob_spelling_offer(&spelling, b->scene->script[i].name);
	if (spelling.best)
		ob_sandbox_fail(L, "%s.script: unknown script \"%.40s\", did you mean \"%s\"?", where, script,
				spelling.best);
	ob_sandbox_fail(L, "%s.script: expected %s, got \"%.40s\"", where,
			b->path ? "the name of a script, of a file that ends with .lua, or a script as text"
				: "a script that the scene names, as in script \"spark.lua\"",
			script);
}

uint32_t ob_builder_script(lua_State *L, ob_builder *b, const char *where, const char *script)
{
	char name[OB_NAME_MAX];
	uint32_t found = find_script(b->scene, script);
	if (found)
		return found;
	if (b->path && is_file(script)) {
		if (strlen(script) >= OB_NAME_MAX)
			ob_sandbox_fail(L, "%s.script: expected a name of at most %d bytes, got \"%s\"", where,
					OB_NAME_MAX - 1, script);
		return add_script(L, b, where, script, read_script(L, b, where, script));
	}
	if (!b->path || !is_text(script))
		fail_unknown(L, b, where, script);
	found = find_text(b->scene, script);
	if (found)
		return found;
	snprintf(name, sizeof name, "%.30s script %u", last_part(b->path), b->scene->scripts + 1);
	return add_script(L, b, where, name, strdup(script));
}

uint32_t ob_builder_keep_state(lua_State *L, ob_builder *b, const unsigned char *bytes, uint32_t size)
{
	ob_scene *s = b->scene;
	const uint32_t at = s->states_bytes;
	if (!OB_RESERVE(s->states, at + size, b->states_room))
		ob_sandbox_fail(L, "state: no memory left on this machine");
	if (size)
		memcpy(s->states + at, bytes, size);
	s->states_bytes += size;
	return at;
}

// script "spark.lua", or script("spark", "text")
int ob_scene_call_script(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	const char *name = lua_type(L, 1) == LUA_TSTRING ? lua_tostring(L, 1) : "";
	const bool given = lua_gettop(L) > 1;
	if (!*name || strlen(name) >= OB_NAME_MAX || !ob_text_is_clean(name, strlen(name)))
		ob_sandbox_fail(L, "script: expected a name of 1 to %d bytes, as in script(\"spark\", [[ ... ]])",
				OB_NAME_MAX - 1);
	if (find_script(b->scene, name))
		ob_sandbox_fail(L, "script \"%s\": exists already", name);
	if (given && lua_type(L, 2) != LUA_TSTRING)
		ob_sandbox_fail(L, "script \"%s\": expected its text", name);
	if (given)
		add_script(L, b, "script", name, strdup(lua_tostring(L, 2)));
	else
		ob_builder_script(L, b, "script", name);
	return 0;
}

#include "scene/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/budget.h"
#include "base/file.h"
#include "scene/builder.h"
#include "scene/expect.h"
#include "scene/sandbox.h"
#include "scene/vector.h"
#include "shape/shape.h"

#define FILE_MAX ((size_t)4 << 20) // bytes of a scene file

// Reads the whole file; the caller frees it.
static char *read_file(const char *path, size_t *size, ob_error *e)
{
	ob_error why;
	char *text = ob_file_load(path, FILE_MAX, size, &why);
	if (!text)
		ob_fail(e, "%s: cannot read the scene: %s", path, why.text);
	return text;
}

// Blanks a byte order mark and "#!..." before the first line, which keeps line numbers.
static void blank_start(char *text, size_t size)
{
	size_t i = 0;
	if (size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0)
		for (; i < 3; i++)
			text[i] = ' ';
	if (i < size && text[i] == '#')
		while (i < size && text[i] != '\n')
			text[i++] = ' ';
}

// Upvalue 1 is the shape.
static int call_shape(lua_State *L)
{
	return ob_scene_add(L, (ob_shape)lua_tointeger(L, lua_upvalueindex(1)));
}

// Opens the library, and offers a call for each shape, and each kind of joint and of sensor.
static int open_library(lua_State *L)
{
	ob_library_open(L);
	lua_pushglobaltable(L);
	for (int shape = OB_SHAPE_NONE + 1; shape < OB_SHAPE_KINDS; shape++) {
		if (ob_shape_is((ob_shape)shape, OB_SURFACED)) // heightfields and meshes have calls of their own
			continue;
		lua_pushinteger(L, shape);
		lua_pushcclosure(L, call_shape, 1);
		lua_setfield(L, -2, ob_shape_name((ob_shape)shape));
	}
	for (uint32_t kind = 0; kind < OB_JOINT_KINDS; kind++) {
		lua_pushinteger(L, kind);
		lua_pushcclosure(L, ob_scene_call_joint, 1);
		lua_setfield(L, -2, ob_joint_kind_name(kind));
	}
	for (uint32_t kind = 0; kind < OB_SENSOR_KINDS; kind++) {
		lua_pushinteger(L, kind);
		lua_pushcclosure(L, ob_scene_call_sensor, 1);
		lua_setfield(L, -2, ob_sensor_kind_name(kind));
	}
	ob_vector_open(L);
	ob_expected_open(L);
	return 0;
}

static bool offer_calls(ob_sandbox *s, ob_error *e)
{
	static const struct {
		const char *library, *name;
		lua_CFunction f;
	} call[] = {
		{ NULL, "scene", ob_scene_call_scene },
		{ NULL, "record", ob_scene_call_record },
		{ NULL, "sky", ob_scene_call_sky },
		{ NULL, "sun", ob_scene_call_sun },
		{ NULL, "ground", ob_scene_call_ground },
		{ NULL, "compound", ob_scene_call_compound },
		{ NULL, "heightfield", ob_scene_call_heightfield },
		{ NULL, "mesh", ob_scene_call_mesh },
		{ NULL, "material", ob_scene_call_material },
		{ NULL, "script", ob_scene_call_script },
		{ NULL, "param", ob_scene_call_param },
		{ NULL, "controls", ob_scene_call_controls },
		{ NULL, "case", ob_scene_call_case },
		{ NULL, "expect", ob_scene_call_expect },
		{ NULL, "watch", ob_scene_call_watch },
		{ NULL, "random", ob_scene_call_random },
		{ NULL, "random_rotation", ob_scene_call_random_rotation },
		{ "math", "random", ob_scene_call_random_integer },
	};
	for (size_t i = 0; i < sizeof call / sizeof *call; i++)
		if (!ob_sandbox_offer(s, call[i].library, call[i].name, call[i].f, e))
			return false;
	return true;
}

static void set_colour(float to[3], const char *hex)
{
	float linear[4];
	ob_colour_from_hex(hex, linear);
	memcpy(to, linear, 3 * sizeof *to);
}

static void set_defaults(ob_scene *s, const char *path, const ob_scene_options *o)
{
	const char *slash = strrchr(path, '/'), *stem = slash ? slash + 1 : path;
	snprintf(s->title, sizeof s->title, "%.*s", (int)strcspn(stem, "."), stem);
	s->run = ob_run_settings_default();
	s->duration = 10;
	s->seed = o->has_seed ? o->seed : 1;
	s->record_every = 1;
	s->room = 64;
	set_colour(s->look.sky_top, "#5f93c9");
	set_colour(s->look.sky_horizon, "#dce8f1");
	set_colour(s->look.ground_colour, "#a9aeab");
	s->look.grid = true;
	ob_vec3 sun = ob_v3(-.85, -.22, .7);
	s->look.sun = ob_scale(sun, 1 / ob_norm(sun));
}

// The sandbox lives on where functions of expectations are called in it.
static bool run(ob_builder *b, char *text, size_t size, ob_error *e)
{
	ob_scene *s = b->scene;
	blank_start(text, size);
	ob_sandbox *sandbox = ob_sandbox_create(s->path, open_library, b, e);
	bool good = sandbox && offer_calls(sandbox, e) && ob_sandbox_run(sandbox, text, size, e);
	if (good && s->expected) {
		ob_sandbox_release_user(sandbox);
		s->expected->sandbox = sandbox;
		s->expected->scene = s;
	} else {
		ob_sandbox_destroy(sandbox);
	}
	return good;
}

static bool build(ob_builder *b, const char *path, ob_error *e)
{
	ob_scene *s = b->scene;
	if (!run(b, s->text, s->text_size, e) || !ob_builder_check_defines(b, path, e))
		return false;
	if (s->objects == 0 && s->joints == 0)
		return ob_fail(e, "%s:1: expected at least one object (box, sphere, ground ...)", path);
	for (uint32_t i = 0; i < s->sensors; i++)
		s->sensor[i].seed = s->seed ^ (i + 1) * UINT64_C(0x9e3779b97f4a7c15);
	return ob_builder_resolve_tolerance(b, path, e) && ob_builder_place_cameras(b, path, e) &&
	       ob_builder_check_controls(b, path, e);
}

// Makes a scene of this text and takes ownership of it; NULL: the text could not be read, and e explains it.
static ob_scene *make_scene(const char *path, char *text, size_t size, const ob_scene_options *o, ob_error *e)
{
	static const ob_scene_options none = { 0 };
	if (!text)
		return NULL;
	if (size > FILE_MAX) {
		free(text);
		return ob_fail(e, "%s: cannot read the scene: it is larger than %zu MiB", path, FILE_MAX >> 20), NULL;
	}
	ob_builder *b = calloc(1, sizeof *b);
	ob_scene *s = calloc(1, sizeof *s);
	bool good = false;
	if (s)
		s->path = strdup(path);
	if (b && s && s->path) {
		s->text = text;
		s->text_size = size;
		b->scene = s;
		b->path = path;
		b->options = o ? o : &none;
		set_defaults(s, path, b->options);
		ob_random_seed(&b->random, s->seed);
		good = build(b, path, e);
	} else {
		free(text);
		ob_fail(e, "%s: no memory", path);
	}
	for (uint32_t i = 0; b && i < b->fmus; i++)
		ob_fmu_finish(&b->fmu[i].file);
	if (b)
		free(b->hull_points);
	free(b);
	if (good)
		return s;
	ob_scene_free(s);
	return NULL;
}

ob_scene *ob_scene_load(const char *path, const ob_scene_options *o, ob_error *e)
{
	size_t size = 0;
	ob_budget_begin();
	char *text = read_file(path, &size, e);
	ob_scene *s = make_scene(path, text, size, o, e);
	ob_budget_end();
	return s;
}

ob_scene *ob_scene_load_text(const char *path, const char *text, size_t size, const ob_scene_options *o, ob_error *e)
{
	ob_budget_begin();
	char *copy = malloc(size + 1);
	if (copy)
		memcpy(copy, text, size);
	else
		ob_fail(e, "%s: no memory", path);
	ob_scene *s = make_scene(path, copy, size, o, e);
	ob_budget_end();
	return s;
}

void ob_scene_free(ob_scene *s)
{
	if (!s)
		return;
	for (uint32_t i = 0; i < s->objects; i++)
		free(s->object[i].path), free(s->object[i].force);
	ob_expected_free(s->expected);
	free(s->path);
	free(s->object);
	free(s->joint);
	free(s->sensor);
	free(s->hull);
	free(s->hull_corners);
	free(s->terrains);
	for (uint32_t i = 0; i < s->meshes; i++)
		ob_mesh_finish(&s->mesh[i]);
	free(s->mesh);
	free(s->camera);
	for (uint32_t i = 0; i < s->scripts; i++)
		free(s->script[i].text);
	free(s->script);
	free(s->states);
	free(s->avatar);
	free(s->param);
	free(s->control);
	free(s->text);
	free(s);
}

// FMUs as simulators of objects: the file, and the connections of its variables. An FMU with its connections is a
// script like others; starts of its parameters are an object's own.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lauxlib.h>

#include "base/file.h"
#include "base/spelling.h"
#include "scene/builder.h"
#include "scene/sandbox.h"
#include "scene/text.h"

// Instructions for reading an FMU, plus one for each FMU_BYTES, and for an object that has one.
enum { FMU_INSTRUCTIONS = 10000, FMU_BYTES = 64, CALL_INSTRUCTIONS = 1000 };

static const char *const quantities[OB_FMU_QUANTITIES] = {
	[OB_FMU_POSITION] = "position.x",
	"position.y",
	"position.z",
	[OB_FMU_VELOCITY] = "velocity.x",
	"velocity.y",
	"velocity.z",
	[OB_FMU_SPIN] = "spin.x",
	"spin.y",
	"spin.z",
	[OB_FMU_ATTITUDE] = "attitude.w",
	"attitude.x",
	"attitude.y",
	"attitude.z",
	[OB_FMU_MASS] = "mass",
	[OB_FMU_TIME] = "time",
	[OB_FMU_FORCE] = "force.x",
	"force.y",
	"force.z",
	[OB_FMU_TORQUE] = "torque.x",
	"torque.y",
	"torque.z",
};

static const ob_fmu_file *read_file(lua_State *L, ob_builder *b, const char *where, const char *name)
{
	char path[PATH_MAX];
	size_t size;
	ob_error e;
	for (uint32_t i = 0; i < b->fmus; i++)
		if (strcmp(b->fmu[i].name, name) == 0)
			return &b->fmu[i].file;
	if (!b->path)
		ob_sandbox_fail(L, "%s.fmu: expected none here: only a scene's own objects have one", where);
	if (b->fmus == OB_SCENE_FMUS_MAX)
		ob_sandbox_fail(L, "%s.fmu: expected at most %d files in a scene", where, OB_SCENE_FMUS_MAX);
	ob_builder_find_file(L, b, where, "fmu", name, path);
	char *bytes = ob_file_load(path, OB_SCENE_FMU_BYTES, &size, &e);
	if (!bytes)
		ob_sandbox_fail(L, "%s.fmu: cannot read %s: %s", where, path, e.text);
	ob_fmu_file *f = &b->fmu[b->fmus].file;
	const bool good = ob_fmu_read((const unsigned char *)bytes, size, f, &e);
	free(bytes);
	if (!good)
		ob_sandbox_fail(L, "%s.fmu: cannot read %s: %s", where, path, e.text);
	strcpy(b->fmu[b->fmus++].name, name); // no longer than a field of text
	ob_sandbox_spend(L, FMU_INSTRUCTIONS + (unsigned)(size / FMU_BYTES));
	return f;
}

// The variable whose name is the key below the top of the stack.
static const ob_fmu_variable *variable_at(lua_State *L, const ob_fmu_file *f, const char *where, const char *field)
{
	const char *name = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "";
	ob_spelling near = ob_spelling_start(name);
	for (uint32_t i = 0; i < f->variables; i++) {
		if (strcmp(f->variable[i].name, name) == 0)
			return &f->variable[i];
		ob_spelling_offer(&near, f->variable[i].name);
	}
	if (near.best)
		ob_sandbox_fail(L, "%s.%s: the FMU has no real variable \"%.40s\", did you mean \"%.60s\"?", where,
				field, name, near.best);
	ob_sandbox_fail(L, "%s.%s: expected names of real variables of the FMU, got \"%.40s\"", where, field, name);
}

static uint32_t quantity_at(lua_State *L, const char *where, const char *field, uint32_t first, uint32_t end)
{
	const char *text = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
	char got[OB_TEXT_VALUE];
	ob_spelling near = ob_spelling_start(text);
	for (uint32_t i = first; i < end; i++) {
		if (strcmp(quantities[i], text) == 0)
			return i;
		ob_spelling_offer(&near, quantities[i]);
	}
	ob_text_of_value(L, -1, got);
	ob_sandbox_fail(L, "%s.%s: expected a quantity, as \"%s\" or \"%s\", got %s", where, field, quantities[first],
			near.best ? near.best : quantities[first + 3], got);
}

// Reads connections from a table of the object; ordered by reference, as the order of a table differs from run to run.
static uint8_t read_ports(lua_State *L, const ob_fmu_file *f, const char *where, const char *field, ob_fmu_port *port,
			  uint8_t most)
{
	const bool in = strcmp(field, "inputs") == 0;
	const ob_fmu_causality takes = in ? OB_FMU_INPUT : OB_FMU_OUTPUT;
	uint8_t n = 0;
	if (lua_getfield(L, 1, field) != LUA_TTABLE) {
		lua_pop(L, 1);
		return 0;
	}
	for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1), n++) {
		const ob_fmu_variable *v = variable_at(L, f, where, field);
		if (v->causality != takes)
			ob_sandbox_fail(L, "%s.%s: \"%.60s\" is no %.*s of the FMU", where, field, v->name,
					(int)strlen(field) - 1, field);
		if (n == most)
			ob_sandbox_fail(L, "%s.%s: expected at most %d", where, field, most);
		const uint32_t quantity =
			quantity_at(L, where, field, in ? 0 : OB_FMU_FORCE, in ? OB_FMU_FORCE : OB_FMU_QUANTITIES);
		uint8_t at = n;
		for (; at > 0 && port[at - 1].reference > v->reference; at--)
			port[at] = port[at - 1];
		port[at] = (ob_fmu_port){ v->reference, quantity };
		for (uint8_t i = 0; i <= n && !in; i++)
			if (i != at && port[i].quantity == quantity)
				ob_sandbox_fail(L, "%s.%s: %s is set twice", where, field, quantities[quantity]);
	}
	lua_pop(L, 1);
	return n;
}

static uint32_t read_starts(lua_State *L, const ob_fmu_file *f, const char *where, ob_fmu_start *start, uint32_t most)
{
	static const char field[] = "parameters";
	uint32_t n = 0;
	if (lua_getfield(L, 1, field) != LUA_TTABLE) {
		lua_pop(L, 1);
		return 0;
	}
	for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1), n++) {
		const ob_fmu_variable *v = variable_at(L, f, where, field);
		if (v->causality != OB_FMU_PARAMETER)
			ob_sandbox_fail(L, "%s.%s: \"%.60s\" is no parameter of the FMU", where, field, v->name);
		if (lua_type(L, -1) != LUA_TNUMBER || !isfinite(lua_tonumber(L, -1)))
			ob_sandbox_fail(L, "%s.%s: expected a number for \"%.60s\"", where, field, v->name);
		if (n == most)
			ob_sandbox_fail(L, "%s.%s: expected at most %u", where, field, most);
		uint32_t at = n;
		for (; at > 0 && start[at - 1].reference > v->reference; at--)
			start[at] = start[at - 1];
		start[at] = (ob_fmu_start){ v->reference, 0, lua_tonumber(L, -1) };
	}
	lua_pop(L, 1);
	return n;
}

// Number of the script with this head and library; 0: there is none.
static uint32_t find(const ob_scene *s, const ob_fmu_model *m, const ob_fmu_file *f)
{
	for (uint32_t i = 0; i < s->scripts; i++)
		if (s->script[i].size == sizeof *m + f->library_bytes && memcmp(s->script[i].text, m, sizeof *m) == 0 &&
		    memcmp(s->script[i].text + sizeof *m, f->library, f->library_bytes) == 0)
			return i + 1;
	return 0;
}

uint32_t ob_builder_fmu(lua_State *L, ob_builder *b, const char *where, const char *name, uint32_t *state_at,
			uint32_t *state_bytes)
{
	enum { STARTS = 1024 / sizeof(ob_fmu_start) }; // as many as an object's state holds
	ob_fmu_start start[STARTS];
	const ob_fmu_file *f = read_file(L, b, where, name);
	ob_fmu_model m = { .mark = OB_FMU_MARK, .standard = (uint8_t)f->standard, .library_bytes = f->library_bytes };
	m.inputs = read_ports(L, f, where, "inputs", m.input, OB_FMU_INPUTS_MAX);
	m.outputs = read_ports(L, f, where, "outputs", m.output, OB_FMU_OUTPUTS_MAX);
	strcpy(m.identifier, f->identifier);
	strcpy(m.token, f->token);
	*state_bytes = read_starts(L, f, where, start, STARTS) * (uint32_t)sizeof *start;
	*state_at = ob_builder_keep_state(L, b, (const unsigned char *)start, *state_bytes);
	ob_sandbox_spend(L, CALL_INSTRUCTIONS);
	const uint32_t found = find(b->scene, &m, f);
	if (found)
		return found;
	char *text = malloc(sizeof m + f->library_bytes);
	if (text) {
		memcpy(text, &m, sizeof m);
		memcpy(text + sizeof m, f->library, f->library_bytes);
	}
	return ob_builder_add_script(L, b, where, name, text, sizeof m + f->library_bytes);
}

// material "wood" { friction = .5, density = 600 }: what several objects have in common.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/builder.h"
#include "scene/sandbox.h"
#include "scene/text.h"

static const ob_field fields[] = {
	OB_FIELD(ob_material, friction, .name = "friction", .kind = OB_FIELD_NUMBER, .low = 0, .high = 1000),
	OB_FIELD(ob_material, restitution, .name = "restitution", .kind = OB_FIELD_NUMBER, .low = 0, .high = 1),
	OB_FIELD(ob_material, density, .name = "density", .kind = OB_FIELD_NUMBER, .low = 0, .above = true,
		 .high = 1e9),
	OB_FIELD(ob_material, colour, .name = "colour", .kind = OB_FIELD_COLOUR),
};

const ob_material *ob_builder_material(const ob_builder *b, const char *name)
{
	for (uint32_t i = 0; i < b->materials; i++)
		if (strcmp(b->material[i].name, name) == 0)
			return &b->material[i];
	return NULL;
}

// The second half of material "name" { ... }; upvalue 1 is the name.
static int define(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	const char *name = lua_tostring(L, lua_upvalueindex(1));
	if (ob_builder_material(b, name))
		ob_sandbox_fail(L, "material \"%s\": exists already", name);
	if (b->materials == OB_SCENE_MATERIALS_MAX)
		ob_sandbox_fail(L, "material: expected at most %d materials", OB_SCENE_MATERIALS_MAX);
	ob_material m = { .friction = NAN, .restitution = NAN, .density = NAN, .colour = { NAN } };
	snprintf(m.name, sizeof m.name, "%s", name);
	char where[OB_NAME_MAX + 16];
	snprintf(where, sizeof where, "material \"%s\"", name);
	ob_fields_read(L, 1, where, fields, sizeof fields / sizeof *fields, &m);
	b->material[b->materials++] = m;
	return 0;
}

int ob_scene_call_material(lua_State *L)
{
	size_t size;
	const char *name = lua_type(L, 1) == LUA_TSTRING ? lua_tolstring(L, 1, &size) : NULL;
	if (!name || size == 0 || size >= OB_NAME_MAX || !ob_text_is_clean(name, size))
		ob_sandbox_fail(L, "material: expected a name of 1 to %d bytes, as in material \"wood\" { ... }",
				OB_NAME_MAX - 1);
	lua_settop(L, 1);
	lua_pushcclosure(L, define, 1);
	return 1;
}

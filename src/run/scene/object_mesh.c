// Looks of objects: meshes from files beside the scene.
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "scene/builder.h"
#include "scene/sandbox.h"

enum { MESH_INSTRUCTIONS = 10000, MESH_BYTES = 64 }; // cost of reading one, plus one instruction for each MESH_BYTES

void ob_builder_check_looks(lua_State *L, const ob_scene *s, const char *where)
{
	size_t bytes = 0;
	for (uint32_t i = 0; i < s->meshes; i++)
		bytes += ob_mesh_bytes(&s->mesh[i]);
	if (bytes > OB_SCENE_MESH_BYTES)
		ob_sandbox_fail(L, "%s: all meshes of the scene are larger than %u MiB", where,
				OB_SCENE_MESH_BYTES >> 20);
}

void ob_builder_allow(lua_State *L, const char *where, uint64_t bytes)
{
	ob_error e;
	if (!ob_budget_allows(bytes, &e))
		ob_sandbox_fail(L, "%s: %s", where, e.text);
}

static void make_room(lua_State *L, ob_builder *b, const char *where, const char *field)
{
	ob_scene *s = b->scene;
	if (s->meshes == OB_SCENE_MESHES_MAX)
		ob_sandbox_fail(L, "%s.%s: expected at most %d different meshes in a scene", where, field,
				OB_SCENE_MESHES_MAX);
	if (!OB_GROW(s->mesh, s->meshes + 1))
		ob_sandbox_fail(L, "%s.%s: no memory left on this machine", where, field);
}

uint8_t ob_builder_mesh(lua_State *L, ob_builder *b, const char *where, const char *field, const ob_mesh_source *source)
{
	ob_scene *s = b->scene;
	char path[PATH_MAX];
	ob_error e;
	const uint64_t key = ob_mesh_key(source->file, source->scale, source->pose);
	for (uint32_t i = 0; i < s->meshes; i++)
		if (s->mesh[i].key == key)
			return (uint8_t)(i + 1);
	ob_builder_find_file(L, b, where, field, source->file, path);
	make_room(L, b, where, field);
	ob_mesh *m = &s->mesh[s->meshes];
	if (!ob_mesh_load(m, path, &e))
		ob_sandbox_fail(L, "%s.%s: cannot read %s: %s", where, field, path, e.text);
	m->key = key;
	s->meshes++; // from now on it is freed with the scene
	ob_sandbox_spend(L, MESH_INSTRUCTIONS + (unsigned)(ob_mesh_bytes(m) / MESH_BYTES));
	if (!ob_mesh_place(m, source->scale, source->pose, &e))
		ob_sandbox_fail(L, "%s.%s: cannot place %s: %s", where, field, path, e.text);
	ob_builder_check_looks(L, s, where);
	return (uint8_t)s->meshes;
}

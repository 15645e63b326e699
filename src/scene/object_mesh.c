// What objects look like: meshes from files beside the scene.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/builder.h"
#include "scene/sandbox.h"

static bool is_same(const ob_mesh_source *a, const ob_mesh_source *b)
{
	const ob_vec3 p = ob_sub(a->pose.p, b->pose.p);
	const ob_quat q = a->pose.q, r = b->pose.q;
	return strcmp(a->file, b->file) == 0 && a->scale == b->scale && ob_norm2(p) == 0 && q.w == r.w && q.x == r.x &&
	       q.y == r.y && q.z == r.z;
}

static size_t bytes_of_all(const ob_scene *s)
{
	size_t bytes = 0;
	for (uint32_t i = 0; i < s->meshes; i++)
		bytes += ob_mesh_bytes(&s->mesh[i]);
	return bytes;
}

static void make_room(lua_State *L, ob_builder *b, const char *where)
{
	ob_scene *s = b->scene;
	if (s->meshes == OB_SCENE_MESHES_MAX)
		ob_sandbox_fail(L, "%s.mesh: expected at most %d different meshes in a scene", where,
				OB_SCENE_MESHES_MAX);
	ob_mesh *mesh = realloc(s->mesh, (s->meshes + 1) * sizeof *mesh);
	if (mesh)
		s->mesh = mesh;
	ob_mesh_source *source = realloc(b->mesh_source, (s->meshes + 1) * sizeof *source);
	if (source)
		b->mesh_source = source;
	if (!mesh || !source)
		ob_sandbox_fail(L, "%s.mesh: no memory left on this machine", where);
}

uint8_t ob_builder_mesh(lua_State *L, ob_builder *b, const char *where, const ob_mesh_source *source)
{
	ob_scene *s = b->scene;
	char path[PATH_MAX];
	ob_error e;
	if (!b->path)
		ob_sandbox_fail(L, "%s.mesh: expected none: only objects of the scene have one", where);
	for (uint32_t i = 0; i < s->meshes; i++)
		if (is_same(&b->mesh_source[i], source))
			return (uint8_t)(i + 1);
	ob_builder_find_file(L, b, where, "mesh", source->file, path);
	make_room(L, b, where);
	ob_mesh *m = &s->mesh[s->meshes];
	if (!ob_mesh_load(m, path, &e))
		ob_sandbox_fail(L, "%s.mesh: cannot read %s: %s", where, path, e.text);
	b->mesh_source[s->meshes++] = *source; // from here on it is freed with the scene
	if (!ob_mesh_place(m, source->scale, source->pose, &e))
		ob_sandbox_fail(L, "%s.mesh: cannot place %s: %s", where, path, e.text);
	if (bytes_of_all(s) > OB_SCENE_MESH_BYTES)
		ob_sandbox_fail(L, "%s.mesh: all meshes of the scene are larger than %u MiB", where,
				OB_SCENE_MESH_BYTES >> 20);
	return (uint8_t)s->meshes;
}

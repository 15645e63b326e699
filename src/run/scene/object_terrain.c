// Terrains of a scene: heightfields of a function, and meshes of a file. Both have a look.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "scene/builder.h"
#include "scene/sandbox.h"

#include <lauxlib.h>

enum { CELLS_MAX = OB_TERRAIN_TRIANGLES_MAX / 2 };
enum { TRIANGLE_INSTRUCTIONS = 10 }; // cost of one, beside its heights

// ---- heightfields

// Reads the two numbers of a field of the table at index 1, within low .. high.
static void read_two(lua_State *L, const char *name, double low, double high, bool whole, double out[2])
{
	lua_getfield(L, 1, name);
	bool good = lua_type(L, -1) == LUA_TTABLE && lua_rawlen(L, -1) == 2;
	for (int i = 0; i < 2 && good; i++) {
		int is_number;
		lua_rawgeti(L, -1, i + 1);
		out[i] = lua_tonumberx(L, -1, &is_number);
		good = is_number && lua_type(L, -1) == LUA_TNUMBER && out[i] >= low && out[i] <= high &&
		       (!whole || out[i] == floor(out[i]));
		lua_pop(L, 1);
	}
	lua_pop(L, 1);
	if (!good)
		ob_sandbox_fail(L, "heightfield.%s: expected two %snumbers {x, y}, each from %.10g to %.10g", name,
				whole ? "whole " : "", low, high);
}

// Height at a place of the field (m), from the function at the top of the stack.
static double height_at(lua_State *L, double x, double y)
{
	int is_number;
	lua_pushvalue(L, -1);
	lua_pushnumber(L, x);
	lua_pushnumber(L, y);
	lua_call(L, 2, 1);
	const double z = lua_tonumberx(L, -1, &is_number);
	if (!is_number || lua_type(L, -1) != LUA_TNUMBER || !(fabs(z) <= OB_TERRAIN_FARTHEST))
		ob_sandbox_fail(
			L,
			"heightfield.height: expected a number from -%.10g to %.10g m, got %s at x = %.10g, y = "
			"%.10g",
			OB_TERRAIN_FARTHEST, OB_TERRAIN_FARTHEST,
			is_number ? lua_tostring(L, -1) : luaL_typename(L, -1), x, y);
	lua_pop(L, 1);
	return z;
}

ob_terrain *ob_builder_heights(lua_State *L)
{
	double size[2], counts[2];
	ob_error e;
	read_two(L, "size", 1e-3, 1e6, false, size);
	read_two(L, "cells", 1, CELLS_MAX, true, counts);
	if (counts[0] * counts[1] > CELLS_MAX)
		ob_sandbox_fail(L, "heightfield.cells: expected at most %d, got %.10g times %.10g", CELLS_MAX,
				counts[0], counts[1]);
	const uint32_t cells[2] = { (uint32_t)counts[0], (uint32_t)counts[1] }, row = cells[0] + 1,
		       all = row * (cells[1] + 1);
	if (lua_getfield(L, 1, "height") != LUA_TFUNCTION)
		ob_sandbox_fail(
			L, "heightfield.height: expected a function of x and y, as function(x, y) return .1 * x end");
	double *height = lua_newuserdatauv(L, all * sizeof *height, 0);
	lua_insert(L, -2);
	for (uint32_t i = 0; i < all; i++)
		height[i] = height_at(L, size[0] * ((double)(i % row) / cells[0] - .5),
				      size[1] * ((double)(i / row) / cells[1] - .5));
	ob_terrain *t = ob_terrain_of_heights(height, cells, size, &e);
	lua_pop(L, 2);
	if (!t)
		ob_sandbox_fail(L, "heightfield: %s", e.text);
	return t;
}

// ---- meshes of files

// Vertex of a look, by its place.
typedef struct place {
	float p[3];
	uint32_t vertex;
} place;

static int by_place(const void *x, const void *y)
{
	const place *a = x, *b = y;
	for (int i = 0; i < 3; i++)
		if (a->p[i] != b->p[i])
			return a->p[i] < b->p[i] ? -1 : 1;
	return a->vertex < b->vertex ? -1 : a->vertex > b->vertex;
}

// Joins the vertices of a look that are at one place. joined: [vertices], the new number of each; returns how many there
// are.
static uint32_t join_vertices(const ob_mesh *m, place *all, ob_vec3 *vertex, uint32_t *joined)
{
	uint32_t n = 0;
	for (uint32_t i = 0; i < m->vertices; i++) {
		for (int k = 0; k < 3; k++)
			all[i].p[k] = m->vertex[i].position[k] + 0.f; // -0 is 0
		all[i].vertex = i;
	}
	qsort(all, m->vertices, sizeof *all, by_place);
	for (uint32_t i = 0; i < m->vertices; i++) {
		if (i && memcmp(all[i].p, all[i - 1].p, sizeof all[i].p) != 0)
			n++;
		vertex[n] = ob_v3(all[i].p[0], all[i].p[1], all[i].p[2]);
		joined[all[i].vertex] = n;
	}
	return n + 1;
}

static ob_terrain *terrain_of(const ob_mesh *m, ob_error *e)
{
	const uint32_t triangles = m->indices / 3;
	place *all = malloc(m->vertices * sizeof *all);
	ob_vec3 *vertex = malloc(m->vertices * sizeof *vertex);
	uint32_t *joined = malloc(m->vertices * sizeof *joined), (*corner)[3] = malloc(triangles * sizeof *corner);
	ob_terrain *t = NULL;
	if (all && vertex && joined && corner) {
		const uint32_t vertices = join_vertices(m, all, vertex, joined);
		const uint32_t side = (uint32_t)ceil(sqrt(.5 * triangles)), cells[2] = { side, side };
		for (uint32_t i = 0; i < m->indices; i++)
			corner[i / 3][i % 3] = joined[m->index[i]];
		t = ob_terrain_build(vertex, vertices, (const uint32_t(*)[3])corner, triangles, cells, false, e);
	} else {
		ob_fail(e, "no memory left on this machine");
	}
	free(all);
	free(vertex);
	free(joined);
	free(corner);
	return t;
}

ob_terrain *ob_builder_triangles(lua_State *L, ob_builder *b, const char *file, double scale, uint8_t *look)
{
	const ob_mesh_source source = { .file = file, .scale = scale, .pose = { .q = ob_quat_identity() } };
	ob_error e;
	*look = ob_builder_mesh(L, b, "mesh", "file", &source);
	ob_terrain *t = terrain_of(&b->scene->mesh[*look - 1], &e);
	if (!t)
		ob_sandbox_fail(L, "mesh.file: %s: %s", file, e.text);
	return t;
}

// ---- both

// Normals of the vertices: those of the triangles around each, by their areas.
static void find_normals(ob_mesh *m)
{
	for (uint32_t i = 0; i < m->indices; i += 3) {
		ob_vec3 p[3];
		for (int k = 0; k < 3; k++) {
			const float *x = m->vertex[m->index[i + (uint32_t)k]].position;
			p[k] = ob_v3(x[0], x[1], x[2]);
		}
		const ob_vec3 n = ob_cross(ob_sub(p[1], p[0]), ob_sub(p[2], p[0]));
		for (int k = 0; k < 3; k++) {
			float *sum = m->vertex[m->index[i + (uint32_t)k]].normal;
			sum[0] += (float)n.x, sum[1] += (float)n.y, sum[2] += (float)n.z;
		}
	}
	for (uint32_t i = 0; i < m->vertices; i++) {
		float *n = m->vertex[i].normal;
		const float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
		for (int k = 0; k < 3; k++)
			n[k] = length > 0 ? n[k] / length : k == 2;
	}
}

// Makes the look of a terrain. false and e: no memory.
static bool make_look(const ob_terrain *t, ob_mesh *m, ob_error *e)
{
	*m = (ob_mesh){ .vertices = t->vertices, .indices = 3 * t->triangles };
	if (!ob_budget_allows(ob_mesh_bytes(m), e))
		return false;
	m->vertex = calloc(m->vertices, sizeof *m->vertex);
	m->index = malloc(m->indices * sizeof *m->index);
	if (!m->vertex || !m->index) {
		ob_mesh_finish(m);
		return ob_fail(e, "no memory left on this machine");
	}
	for (uint32_t i = 0; i < m->vertices; i++) {
		const ob_vec3 p = ob_terrain_vertices(t)[i];
		m->vertex[i] = (ob_mesh_vertex){ .position = { (float)p.x, (float)p.y, (float)p.z },
						 .colour = { -1, -1, -1 },
						 .surface = -1 };
	}
	for (uint32_t i = 0; i < m->indices; i++)
		m->index[i] = ob_terrain_triangles(t)[i / 3].corner[i % 3];
	find_normals(m);
	return ob_mesh_makes_sense(m) || ob_fail(e, "its numbers are out of range");
}

uint32_t ob_builder_terrain(lua_State *L, ob_builder *b, const char *kind, ob_terrain *t, uint8_t *look)
{
	ob_scene *s = b->scene;
	const uint32_t number = s->terrains ? (uint32_t)s->terrains->count : 0;
	const uint32_t triangles = t->triangles;
	ob_error e = { "no memory left on this machine" };
	bool fine = ob_terrain_set_add(&s->terrains, t, &e);
	if (fine && !*look && s->meshes < OB_SCENE_MESHES_MAX) {
		fine = OB_GROW(s->mesh, s->meshes + 1) && make_look(t, &s->mesh[s->meshes], &e);
		*look = fine ? (uint8_t)++s->meshes : 0;
	}
	free(t);
	if (!fine)
		ob_sandbox_fail(L, "%s: %s", kind, e.text);
	ob_builder_check_looks(L, s, kind);
	ob_sandbox_spend(L, triangles * TRIANGLE_INSTRUCTIONS);
	return number;
}

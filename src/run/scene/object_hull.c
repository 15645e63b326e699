// The hulls of a scene: of points, and of compounds with their parts. Equal ones are made once.
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/hash.h"
#include "hull/hull.h"
#include "scene/builder.h"
#include "scene/object_limits.h"
#include "scene/sandbox.h"
#include "shape/shape.h"

// Makes room for so many more hulls.
static void grow_hulls(lua_State *L, ob_builder *b, const char *kind, uint32_t more)
{
	ob_scene *s = b->scene;
	if (s->hulls + more > OB_SCENE_HULLS_MAX)
		ob_sandbox_fail(L, "%s: expected at most %d different hulls in a scene", kind, OB_SCENE_HULLS_MAX);
	if (s->hulls + more <= b->hulls_room)
		return;
	const uint32_t room = 2 * b->hulls_room + 1 + OB_HULL_PARTS_MAX;
	if (!OB_GROW(s->hull, room) || !OB_GROW(s->hull_corners, room) || !OB_GROW(b->hull_points, room))
		ob_sandbox_fail(L, "%s: no memory left on this machine", kind);
	b->hulls_room = room;
}

static uint64_t hash_inertia(uint64_t hash, ob_vec3 inertia)
{
	return isnan(inertia.x) ? hash : ob_hash_on(hash, &inertia, sizeof inertia);
}

// NULL: there is none of this hash.
static const ob_hull *find(const ob_builder *b, uint64_t hash)
{
	for (uint32_t i = 0; i < b->scene->hulls; i++)
		if (b->hull_points[i] == hash)
			return &b->scene->hull[i];
	return NULL;
}

const ob_hull *ob_builder_hull(lua_State *L, ob_builder *b, const ob_points *p, ob_vec3 inertia)
{
	ob_scene *s = b->scene;
	const uint64_t hash = hash_inertia(ob_hash_on(OB_HASH_BEGIN, p->at, p->count * sizeof *p->at), inertia);
	const ob_hull *known = find(b, hash);
	ob_error e;
	if (known)
		return known;
	grow_hulls(L, b, "hull.points", 1);
	ob_hull *h = &s->hull[s->hulls];
	if (!ob_hull_build(p->at, p->count, h, &e))
		ob_sandbox_fail(L, "hull.points: %s", e.text);
	ob_hull_find_corners(h, p->at, p->count, &s->hull_corners[s->hulls]);
	if (!isnan(inertia.x) && b->options->joining) // hulls are handed over as their corners
		ob_sandbox_fail(L, "hull.inertia: expected none: only hulls of the scene have it");
	if (!isnan(inertia.x) && !ob_hull_set_inertia(h, inertia, &e))
		ob_sandbox_fail(L, "hull.%s", e.text);
	b->hull_points[s->hulls++] = hash;
	return h;
}

// ---- compounds

enum { SPHERE, CAPSULE, CYLINDER, UNSAID }; // numbers of the choices of shape

// Fields of a part; NaN = not set.
typedef struct part {
	ob_vec3 size, at;
	ob_points points;
	uint32_t shape;
	double radius, length;
	ob_quat q, rotation;
	double density;
} part;

#define F(member, ...) OB_FIELD(part, member, .name = #member, __VA_ARGS__)

static const ob_field part_fields[] = {
	F(size, .kind = OB_FIELD_VECTOR, .low = OB_LENGTH_LEAST, .high = OB_LENGTH_MOST),
	F(points, .kind = OB_FIELD_POINTS, .low = -OB_LENGTH_MOST, .high = OB_LENGTH_MOST),
	F(shape, .kind = OB_FIELD_CHOICE, .choices = "sphere|capsule|cylinder"),
	F(radius, .kind = OB_FIELD_NUMBER, .low = OB_LENGTH_LEAST, .high = OB_LENGTH_MOST),
	F(length, .kind = OB_FIELD_NUMBER, .low = OB_LENGTH_LEAST, .high = OB_LENGTH_MOST),
	F(at, .kind = OB_FIELD_VECTOR, .low = -OB_LENGTH_MOST, .high = OB_LENGTH_MOST),
	F(q, .kind = OB_FIELD_QUATERNION),
	F(rotation, .kind = OB_FIELD_ROTATION),
	F(density, .kind = OB_FIELD_NUMBER, .low = 0, .above = true, .high = 1e9),
};

static const part no_part = { .size = { NAN, NAN, NAN },
			      .shape = UNSAID,
			      .radius = NAN,
			      .length = NAN,
			      .q = { .w = NAN },
			      .rotation = { .w = NAN },
			      .density = NAN };

// Parts as they are read. Their points are Lua's memory, so that an error leaves nothing behind.
typedef struct parts_read {
	uint32_t count;
	ob_hull_part part[OB_HULL_PARTS_MAX];
	uint32_t densities; // number of parts that have one
} parts_read;

static ob_quat attitude_of(const part *p)
{
	return !isnan(p->q.w) ? p->q : !isnan(p->rotation.w) ? p->rotation : ob_quat_identity();
}

// Turns the part's points into the compound's frame; to: room for them.
static void place_points(const part *p, const ob_vec3 *from, uint32_t count, ob_vec3 *to)
{
	const ob_mat3 r = ob_quat_matrix(attitude_of(p));
	for (uint32_t i = 0; i < count; i++)
		to[i] = ob_add(p->at, ob_rotate(&r, from[i]));
}

// Takes a part with a radius.
static void take_round(lua_State *L, const char *where, const part *p, ob_hull_part *to)
{
	static const ob_shape shape[] = { OB_SHAPE_SPHERE, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER };
	if (p->shape == UNSAID && !isnan(p->length))
		ob_sandbox_fail(L, "%s.shape: expected \"capsule\" or \"cylinder\" with a length", where);
	const uint32_t at = p->shape == UNSAID ? SPHERE : p->shape;
	if (isnan(p->length) != (at == SPHERE))
		ob_sandbox_fail(L, "%s.length: expected %s", where, at == SPHERE ? "none for a sphere" : "one");
	to->round = shape[at];
	to->size = ob_v3(p->radius, at == SPHERE ? 0 : .5 * p->length, 0);
	to->pose = (ob_pose){ p->at, attitude_of(p) };
}

// Reads the part at the top of the stack. Its points stay below it, on the stack.
static void read_part(lua_State *L, parts_read *to)
{
	char where[32];
	part p = no_part;
	ob_vec3 corner[8];
	snprintf(where, sizeof where, "compound.parts[%u]", to->count + 1);
	ob_fields_read(L, -1, where, part_fields, sizeof part_fields / sizeof *part_fields, &p);
	if (!isnan(p.size.x) + (p.points.at != NULL) + !isnan(p.radius) != 1)
		ob_sandbox_fail(L, "%s: expected either size, of a box, or points, of a hull, or radius", where);
	if (isnan(p.radius) && (p.shape != UNSAID || !isnan(p.length)))
		ob_sandbox_fail(L, "%s.radius: expected one with a shape or a length", where);
	if (!isnan(p.q.w) && !isnan(p.rotation.w))
		ob_sandbox_fail(L, "%s.rotation: expected either q or rotation, got both", where);
	ob_hull_part *next = &to->part[to->count++];
	*next = (ob_hull_part){ .density = isnan(p.density) ? 1 : p.density };
	to->densities += !isnan(p.density);
	if (!isnan(p.radius)) {
		take_round(L, where, &p, next);
		lua_pushnil(L); // in place of points
		return;
	}
	for (uint32_t k = 0; !p.points.at && k < 8; k++)
		corner[k] = ob_box_corner(ob_scale(p.size, .5), k);
	const uint32_t count = p.points.at ? p.points.count : 8;
	ob_vec3 *points = lua_newuserdatauv(L, count * sizeof *points, 0);
	place_points(&p, p.points.at ? p.points.at : corner, count, points);
	next->point = points;
	next->points = count;
}

static void read_parts(lua_State *L, parts_read *to)
{
	const int list = lua_gettop(L);
	const lua_Unsigned count = lua_rawlen(L, list);
	if (!lua_checkstack(L, 2 * OB_HULL_PARTS_MAX + 8) || count < 1 || count > OB_HULL_PARTS_MAX)
		ob_sandbox_fail(L, "compound.parts: expected a list of 1 to %d parts, got %d", OB_HULL_PARTS_MAX,
				(int)(count < INT_MAX ? count : INT_MAX));
	for (lua_Unsigned i = 1; i <= count; i++) {
		if (lua_rawgeti(L, list, (lua_Integer)i) != LUA_TTABLE)
			ob_sandbox_fail(L, "compound.parts[%d]: expected a table, as { size = { 1, 1, 1 } }", (int)i);
		read_part(L, to);
	}
	if (to->densities > 0 && to->densities < to->count)
		ob_sandbox_fail(L, "compound.parts: expected a density of all of them, or of none");
}

static uint64_t hash_parts(const parts_read *x, ob_vec3 inertia)
{
	uint64_t hash = ob_hash_on(OB_HASH_BEGIN, &x->count, sizeof x->count);
	for (uint32_t i = 0; i < x->count; i++) {
		const ob_hull_part *p = &x->part[i];
		hash = ob_hash_on(hash, p->point, p->points * sizeof *p->point);
		hash = ob_hash_on(hash, &p->round, sizeof p->round);
		hash = ob_hash_on(hash, &p->size, sizeof p->size);
		hash = ob_hash_on(hash, &p->pose, sizeof p->pose);
		hash = ob_hash_on(hash, &p->density, sizeof p->density);
	}
	return hash_inertia(hash, inertia);
}

// Adds the hull of the parts, and theirs.
static const ob_hull *add_compound(lua_State *L, ob_builder *b, const parts_read *x, ob_vec3 inertia, uint64_t hash)
{
	ob_scene *s = b->scene;
	uint32_t failed;
	ob_error e;
	grow_hulls(L, b, "compound", 1 + x->count);
	ob_hull *h = &s->hull[s->hulls];
	const bool built = ob_hull_build_compound(x->part, x->count, inertia, h, &failed, &e);
	if (!built && failed)
		ob_sandbox_fail(L, "compound.parts[%u]: %s", failed, e.text);
	if (!built)
		ob_sandbox_fail(L, "compound.parts: %s", e.text);
	for (uint32_t i = 0; i <= x->count; i++) {
		s->hull_corners[s->hulls] = (ob_hull_corners){ .count = 0 }; // they are never handed over
		b->hull_points[s->hulls++] = i ? 0 : hash; // a part is no object's hull
	}
	return h;
}

const ob_hull *ob_builder_compound(lua_State *L, ob_builder *b, ob_vec3 inertia, double *density)
{
	const int top = lua_gettop(L);
	parts_read x = { 0 };
	double mass = 0;
	if (b->options->joining)
		ob_sandbox_fail(L, "compound: expected in a scene: what is added to a run has one shape");
	read_parts(L, &x);
	const uint64_t hash = hash_parts(&x, inertia);
	const ob_hull *known = find(b, hash), *h = known ? known : add_compound(L, b, &x, inertia, hash);
	for (uint32_t i = 0; i < x.count; i++)
		mass += x.part[i].density * h[1 + i].volume;
	*density = x.densities ? mass / h->volume : NAN;
	lua_settop(L, top);
	return h;
}

// ---- object mesh

// Looks of objects: meshes from files beside the scene.

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

void ob_builder_make_room(lua_State *L, const char *where, void *array, uint32_t count, uint32_t *room, size_t size)
{
	const uint32_t more = *room ? 2 * *room : 64;
	if (count < *room)
		return;
	ob_builder_allow(L, where, more * size);
	if (!ob_grow(array, more, more, size))
		ob_sandbox_fail(L, "%s: no memory left on this machine", where);
	*room = more;
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

// material, ground, and a call for each shape: the objects, and their shared code.
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/number.h"
#include "base/spelling.h"
#include "hull/hull.h"
#include "scene/builder.h"
#include "scene/flat.h"
#include "scene/object_limits.h"
#include "scene/sandbox.h"
#include "scene/text.h"
#include "shape/shape.h"

#define PATTERN_NAMES "plain|tiles|slabs|bricks|planks|checker" // by ob_pattern

// ---- material "wood" { friction = .5, density = 600 }

// Fields of a material, which an object may have itself. in: "own." in a body
#define SURFACE_OF(type, in) \
	OB_FIELD(type, in friction, .name = "friction", .kind = OB_FIELD_NUMBER, .low = 0, .high = OB_FRICTION_MOST), \
		OB_FIELD(type, in restitution, .name = "restitution", .kind = OB_FIELD_NUMBER, .low = 0, .high = 1), \
		OB_FIELD(type, in colour, .name = "colour", .kind = OB_FIELD_COLOUR), \
		OB_FIELD(type, in roughness, .name = "roughness", .kind = OB_FIELD_NUMBER, .low = 0, .high = 1), \
		OB_FIELD(type, in metal, .name = "metal", .kind = OB_FIELD_NUMBER, .low = 0, .high = 1), \
		OB_FIELD(type, in pattern, .name = "pattern", .kind = OB_FIELD_CHOICE, .choices = PATTERN_NAMES)
#define MATTER_OF(type, in) \
	OB_FIELD(type, in density, .name = "density", .kind = OB_FIELD_NUMBER, .low = 0, .above = true, .high = 1e9), \
		OB_FIELD(type, in update_rate, .name = "update_rate", .kind = OB_FIELD_NUMBER, .low = 0, \
			 .above = true, .high = OB_UPDATE_RATE_MOST)

static const ob_field material_fields[] = { SURFACE_OF(ob_material, ), MATTER_OF(ob_material, ) };

#define NOT_GIVEN \
	{ \
		.friction = NAN, .restitution = NAN, .density = NAN, .update_rate = NAN, .colour = { NAN }, \
		.roughness = NAN, .metal = NAN, .pattern = OB_PATTERNS \
	}
static const ob_material not_given = NOT_GIVEN;

// Default finish of a surface, by a word in the name of its material.
static const struct finish {
	const char *word;
	double roughness, metal;
} finishes[] = {
	{ "steel", .32, 1 },   { "iron", .5, 1 },   { "chrome", .08, 1 },  { "aluminium", .38, 1 },
	{ "copper", .28, 1 },  { "brass", .26, 1 }, { "gold", .2, 1 },     { "silver", .18, 1 },
	{ "lead", .55, 1 },    { "metal", .35, 1 }, { "wood", .62, 0 },    { "rubber", .8, 0 },
	{ "plastic", .35, 0 }, { "stone", .85, 0 }, { "concrete", .9, 0 }, { "brick", .9, 0 },
	{ "ice", .1, 0 },      { "glass", .05, 0 }, { "billiard", .1, 0 }, { "porcelain", .12, 0 },
};
static const struct finish usual_finish = { NULL, OB_ROUGHNESS_USUAL, 0 };

static bool has_word(const char *name, const char *word)
{
	size_t n = strlen(word);
	for (const char *at = name; (at = strstr(at, word)); at += n)
		if ((at == name || !isalpha((unsigned char)at[-1])) && !isalpha((unsigned char)at[n]))
			return true;
	return false;
}

static void find_finish(ob_material *m)
{
	for (size_t i = 0; i < sizeof finishes / sizeof *finishes; i++) {
		if (!has_word(m->name, finishes[i].word))
			continue;
		m->roughness = isnan(m->roughness) ? finishes[i].roughness : m->roughness;
		m->metal = isnan(m->metal) ? finishes[i].metal : m->metal;
	}
}

const ob_material *ob_builder_material(const ob_builder *b, const char *name)
{
	for (uint32_t i = 0; i < b->materials; i++)
		if (strcmp(b->material[i].name, name) == 0)
			return &b->material[i];
	return NULL;
}

// The second half of material "name" { ... }; upvalue 1 is the name.
static int define_material(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	const char *name = lua_tostring(L, lua_upvalueindex(1));
	if (ob_builder_material(b, name))
		ob_sandbox_fail(L, "material \"%s\": exists already", name);
	if (b->materials == OB_SCENE_MATERIALS_MAX)
		ob_sandbox_fail(L, "material: expected at most %d materials", OB_SCENE_MATERIALS_MAX);
	ob_material m = not_given;
	snprintf(m.name, sizeof m.name, "%s", name);
	char where[OB_NAME_MAX + 16];
	snprintf(where, sizeof where, "material \"%s\"", name);
	ob_fields_read(L, 1, where, material_fields, sizeof material_fields / sizeof *material_fields, &m);
	find_finish(&m);
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
	lua_pushcclosure(L, define_material, 1);
	return 1;
}

enum { UNSAID = UINT32_MAX, DYNAMIC = 0, STATIC, KINEMATIC }; // UNSAID: not set; others: indices in choices

#define DENSITY 1000. // kg/m^3

// Fields of a call; NaN = not set.
typedef struct body {
	const char *name, *material, *script, *fmu;
	ob_flat state; // the script's
	ob_vec3 given[OB_SHAPE_KEYS]; // numbers of the shape's size; a single one is in x
	ob_vec3 at, velocity, spin, force, normal, surface_velocity, inertia;
	uint32_t kind;
	ob_material own; // without a name
	double height, mass, born, dies;
	ob_quat q, rotation, mesh_rotation;
	const char *mesh;
	ob_vec3 mesh_at;
	double mesh_scale;
	ob_points points;
	const ob_hull *hull; // in the scene; NULL: another shape
	const char *file; // a mesh that collides
	double scale;
	uint8_t look; // 1 + that of its mesh; 0: the object has the field mesh, or none
	bool cells, sides, heights;
	bool fixed, grid, path, varying_force, avatar, inputs, outputs, parameters, parts;
	bool own_colour, own_surface; // set by the object or its material
	uint32_t group, hits; // hits: bit g, group g
	bool sensor, visible;
} body;

#define F(member, ...) OB_FIELD(body, member, .name = #member, __VA_ARGS__)
#define WITHIN(member, most) F(member, .kind = OB_FIELD_VECTOR, .low = -(most), .high = most)
#define GROUPS \
	F(group, .kind = OB_FIELD_COUNT, .low = 0, .high = OB_GROUPS - 1), \
		F(hits, .kind = OB_FIELD_SET, .low = 0, .high = OB_GROUPS - 1)
#define SURFACE \
	GROUPS, F(material, .kind = OB_FIELD_TEXT, .high = OB_NAME_MAX - 1), WITHIN(surface_velocity, OB_SPEED_MOST), \
		SURFACE_OF(body, own.), F(visible, .kind = OB_FIELD_BOOLEAN)
#define EXISTS \
	F(name, .kind = OB_FIELD_TEXT, .high = OB_NAME_MAX - 1), WITHIN(at, OB_PLACE_MOST), \
		F(born, .kind = OB_FIELD_NUMBER, .low = 0, .high = 1e9), \
		F(dies, .kind = OB_FIELD_NUMBER, .low = 0, .above = true, .high = 1e9)
#define PLACE \
	EXISTS, F(script, .kind = OB_FIELD_SOURCE, .high = OB_SCENE_SCRIPT_BYTES), F(state, .kind = OB_FIELD_FLAT), \
		F(fmu, .kind = OB_FIELD_TEXT, .high = OB_NAME_MAX - 1), F(inputs, .kind = OB_FIELD_TABLE), \
		F(outputs, .kind = OB_FIELD_TABLE), F(parameters, .kind = OB_FIELD_TABLE), \
		F(sensor, .kind = OB_FIELD_BOOLEAN)
#define MOVING \
	F(mass, .kind = OB_FIELD_NUMBER, .low = OB_MASS_LEAST, .high = OB_MASS_MOST), MATTER_OF(body, own.), \
		F(inertia, .kind = OB_FIELD_VECTOR, .low = 0, .above = true, .high = 1e24), \
		F(q, .kind = OB_FIELD_QUATERNION), F(rotation, .kind = OB_FIELD_ROTATION), \
		WITHIN(velocity, OB_SPEED_MOST), WITHIN(spin, OB_SPIN_MOST), WITHIN(force, OB_FORCE_MOST), \
		F(kind, .kind = OB_FIELD_CHOICE, .choices = "dynamic|static|kinematic"), \
		F(path, .kind = OB_FIELD_TABLE), F(varying_force, .kind = OB_FIELD_TABLE), \
		OB_FIELD(body, fixed, .name = "static", .kind = OB_FIELD_BOOLEAN), F(avatar, .kind = OB_FIELD_BOOLEAN)
#define LOOKS \
	F(mesh, .kind = OB_FIELD_TEXT, .high = OB_SCENE_MESH_NAME_MAX - 1), \
		F(mesh_scale, .kind = OB_FIELD_NUMBER, .low = 0, .above = true, .high = 1e6), \
		F(mesh_at, .kind = OB_FIELD_VECTOR, .low = -1e6, .high = 1e6), \
		F(mesh_rotation, .kind = OB_FIELD_ROTATION)

static const ob_field body_fields[] = { PLACE, MOVING, SURFACE, LOOKS };
static const ob_field endless_fields[] = { F(normal, .kind = OB_FIELD_DIRECTION), F(q, .kind = OB_FIELD_QUATERNION),
					   PLACE, SURFACE };
static const ob_field points_field =
	F(points, .kind = OB_FIELD_POINTS, .low = -OB_LENGTH_MOST, .high = OB_LENGTH_MOST, .required = true);
static const ob_field ground_fields[] = {
	F(height, .kind = OB_FIELD_NUMBER, .low = -OB_PLACE_MOST, .high = OB_PLACE_MOST),
	F(grid, .kind = OB_FIELD_BOOLEAN),
	SURFACE,
};
#define STANDING \
	EXISTS, F(q, .kind = OB_FIELD_QUATERNION), F(rotation, .kind = OB_FIELD_ROTATION), \
		OB_FIELD(body, fixed, .name = "static", .kind = OB_FIELD_BOOLEAN), SURFACE
static const ob_field heightfield_fields[] = {
	OB_FIELD(body, sides, .name = "size", .kind = OB_FIELD_TABLE, .required = true),
	OB_FIELD(body, heights, .name = "height", .kind = OB_FIELD_FUNCTION, .required = true),
	F(cells, .kind = OB_FIELD_TABLE, .required = true),
	STANDING,
};
static const ob_field mesh_fields[] = {
	F(file, .kind = OB_FIELD_TEXT, .high = OB_SCENE_MESH_NAME_MAX - 1, .required = true),
	F(scale, .kind = OB_FIELD_NUMBER, .low = 0, .above = true, .high = 1e6),
	STANDING,
};
#define STATE_BYTES 1024 // the universe's size for an object's state (table/step_data.h)

static const body nothing = {
	.normal = { 0, 0, 1 },
	.inertia = { NAN, NAN, NAN },
	.kind = UNSAID,
	.mass = NAN,
	.own = NOT_GIVEN,
	.dies = INFINITY,
	.q = { .w = NAN },
	.rotation = { .w = NAN },
	.mesh_rotation = { .w = NAN },
	.mesh_at = { NAN, NAN, NAN },
	.mesh_scale = NAN,
	.grid = true,
	.visible = true,
	.hits = UINT32_MAX,
	.scale = 1,
};

// Objects without a colour take these in turn (sRGB).
static const char *const palette[] = { "#e4572e", "#f3a712", "#29a19c", "#3f7cac", "#a8c686",
				       "#d1495b", "#edae49", "#66a182", "#8d6a9f", "#c8b8a6" };
static const char static_colour[] = "#9a9fa5";

// Registers a name, with the line of its object, in a table of the registry.
static void take_name(lua_State *L, const char *kind, const char *name)
{
	if (strchr(name, '#'))
		ob_sandbox_fail(L, "%s.name: expected text without #, which is for objects without a name, got \"%s\"",
				kind, name);
	if (lua_getfield(L, LUA_REGISTRYINDEX, "scene.names") != LUA_TTABLE) {
		lua_pop(L, 1);
		lua_newtable(L);
		lua_pushvalue(L, -1);
		lua_setfield(L, LUA_REGISTRYINDEX, "scene.names");
	}
	if (lua_getfield(L, -1, name) != LUA_TNIL)
		ob_sandbox_fail(L, "%s.name: expected a name of its own, got \"%s\" as in line %d", kind, name,
				(int)lua_tointeger(L, -1));
	lua_pushinteger(L, ob_sandbox_line(L));
	lua_setfield(L, -3, name);
	lua_pop(L, 2);
}

ob_object_def *ob_builder_add(lua_State *L, ob_builder *b, const char *kind, const char *name)
{
	ob_scene *s = b->scene;
	if (s->objects == OB_SCENE_OBJECTS_MAX)
		ob_sandbox_fail(L, "%s: expected at most %d objects in a scene", kind, OB_SCENE_OBJECTS_MAX);
	if (name)
		take_name(L, kind, name);
	OB_BUILDER_MAKE_ROOM(L, kind, s->object, s->objects, b->objects_room);
	ob_object_def *o = &s->object[s->objects];
	*o = (ob_object_def){ .passport = { .id = s->objects, .flags = OB_OBJECT_PRESENT } };
	if (name)
		snprintf(o->passport.name, sizeof o->passport.name, "%s", name);
	else
		snprintf(o->passport.name, sizeof o->passport.name, "%s#%u", kind, (unsigned)s->objects);
	s->objects++;
	ob_sandbox_extend(L, OB_SCENE_OBJECT_INSTRUCTIONS);
	return o;
}

static _Noreturn void fail_material(lua_State *L, const ob_builder *b, const char *kind, const char *name)
{
	ob_spelling spelling = ob_spelling_start(name);
	for (uint32_t i = 0; i < b->materials; i++)
		ob_spelling_offer(&spelling, b->material[i].name);
	if (spelling.best)
		ob_sandbox_fail(L, "%s.material: unknown material \"%s\", did you mean \"%s\"?", kind, name,
				spelling.best);
	ob_sandbox_fail(L, "%s.material: expected a material declared before, got \"%s\"", kind, name);
}

// Takes the object's own pattern, or its material's, if its shape shows any.
static void apply_pattern(lua_State *L, const char *kind, ob_shape shape, const ob_material *m, body *d)
{
	const bool shows = (ob_shape_is(shape, OB_SIDED) || ob_shape_is(shape, OB_UNBOUNDED)) && !d->mesh;
	if (d->own.pattern != OB_PATTERNS && !shows)
		ob_sandbox_fail(L, "%s.pattern: expected with a box, a plane or the ground, and without a mesh", kind);
	if (d->own.pattern == OB_PATTERNS)
		d->own.pattern = shows && m->pattern != OB_PATTERNS ? m->pattern : OB_PATTERN_PLAIN;
}

static void apply(double *own, double of_material, double usual)
{
	if (isnan(*own))
		*own = isnan(of_material) ? usual : of_material;
}

// Applies the object's own values first, then its material's, then the default.
static void apply_material(lua_State *L, const ob_builder *b, const char *kind, ob_shape shape, body *d)
{
	const ob_material *m = d->material ? ob_builder_material(b, d->material) : &not_given;
	ob_material *own = &d->own;
	if (!m)
		fail_material(L, b, kind, d->material);
	apply_pattern(L, kind, shape, m, d);
	apply(&own->friction, m->friction, OB_FRICTION_USUAL);
	apply(&own->restitution, m->restitution, 0);
	if (isnan(d->mass))
		apply(&own->density, m->density, DENSITY);
	apply(&own->update_rate, m->update_rate, 0);
	d->own_surface = !isnan(own->roughness) || !isnan(own->metal) || !isnan(m->roughness) || !isnan(m->metal);
	apply(&own->roughness, m->roughness, usual_finish.roughness);
	apply(&own->metal, m->metal, usual_finish.metal);
	if (isnan(own->colour[0]))
		memcpy(own->colour, m->colour, sizeof own->colour);
	d->own_colour = !isnan(own->colour[0]);
	if (!d->own_colour) {
		size_t i = b->scene->objects % (sizeof palette / sizeof *palette);
		ob_colour_from_hex(d->kind == DYNAMIC ? palette[i] : static_colour, own->colour);
	}
}

static void refuse_together(lua_State *L, const char *kind, const char *a, const char *b)
{
	ob_sandbox_fail(L, "%s.%s: expected either %s or %s, got both", kind, b, a, b);
}

static void check_together(lua_State *L, const char *kind, const body *d)
{
	if (!isnan(d->mass) && !isnan(d->own.density))
		refuse_together(L, kind, "mass", "density");
	if (!isnan(d->inertia.x) && isnan(d->mass))
		ob_sandbox_fail(L, "%s.inertia: expected mass with it", kind);
	if (!isnan(d->q.w) && !isnan(d->rotation.w))
		refuse_together(L, kind, "q", "rotation");
	const char *named = d->kind == STATIC ? "static" : "kinematic";
	if (d->kind != DYNAMIC && !isnan(d->mass))
		ob_sandbox_fail(L, "%s.mass: expected none for a %s object, got %s", kind, named,
				ob_number_text(d->mass).text);
	if (d->kind != DYNAMIC && !isnan(d->own.update_rate))
		ob_sandbox_fail(L, "%s.update_rate: expected none for a %s object, which has no steps", kind, named);
	const struct {
		const char *name;
		ob_vec3 value;
	} moves[] = { { "velocity", d->velocity }, { "spin", d->spin }, { "force", d->force } };
	for (int i = 0; i < 3; i++)
		if (ob_norm2(moves[i].value) > 0 && (d->kind == STATIC || (d->kind == KINEMATIC && i == 2)))
			ob_sandbox_fail(L, "%s.%s: expected none for a %s object", kind, moves[i].name, named);
	if (d->kind == DYNAMIC && ob_norm2(d->surface_velocity) > 0)
		ob_sandbox_fail(L, "%s.surface_velocity: expected a static or kinematic object", kind);
	if (d->kind != DYNAMIC && d->varying_force)
		ob_sandbox_fail(L, "%s.varying_force: expected none for a %s object", kind, named);
	if (d->script && d->varying_force)
		refuse_together(L, kind, "script", "varying_force");
	if (d->fmu && (d->script || d->varying_force))
		refuse_together(L, kind, "fmu", d->script ? "script" : "varying_force");
	if (d->kind != DYNAMIC && d->fmu)
		ob_sandbox_fail(L, "%s.fmu: expected none for a %s object", kind, named);
	if (d->kind != KINEMATIC && d->path)
		ob_sandbox_fail(L, "%s.path: expected kind = \"kinematic\" with it", kind);
	if (d->path && ob_norm2(d->velocity) > 0)
		refuse_together(L, kind, "velocity", "path");
	if (!d->mesh && (!isnan(d->mesh_scale) || !isnan(d->mesh_at.x) || !isnan(d->mesh_rotation.w)))
		ob_sandbox_fail(L, "%s.%s: expected mesh = \"FILE.glb\" with it", kind,
				!isnan(d->mesh_scale)  ? "mesh_scale"
				: !isnan(d->mesh_at.x) ? "mesh_at"
						       : "mesh_rotation");
	if (d->avatar && (d->kind != DYNAMIC || !d->script || !d->name || d->born > 0 || isfinite(d->dies)))
		ob_sandbox_fail(
			L, "%s.avatar: expected a name, a script and kind = \"dynamic\" with it, and not born or dies",
			kind);
	if (d->dies <= d->born)
		ob_sandbox_fail(L, "%s.dies: expected a time after born = %s, got %s", kind,
				ob_number_text(d->born).text, ob_number_text(d->dies).text);
}

static void find_kind(lua_State *L, const char *kind, body *d)
{
	if (d->fixed && d->kind != UNSAID && d->kind != STATIC)
		refuse_together(L, kind, "static", "kind");
	if (d->kind == UNSAID)
		d->kind = d->fixed ? STATIC : DYNAMIC;
}

// Sets the body's frame, at its centre of mass along its principal axes. "at" is the place of the points' origin.
static void take_hull_frame(const ob_scene *s, const ob_hull *h, ob_object_def *o)
{
	const ob_mat3 r = ob_quat_matrix(o->state.pose.q);
	o->passport.hull = (uint16_t)(h - s->hull);
	o->state.pose.p = ob_add(o->state.pose.p, ob_rotate(&r, h->centre));
	o->state.pose.q = ob_quat_mul(o->state.pose.q, h->frame);
}

// Source of a mesh in the frame of the scene's author. The body frame of a hull is another.
static ob_mesh_source source_of_mesh(const body *d)
{
	ob_mesh_source source = { .file = d->mesh, .scale = isnan(d->mesh_scale) ? 1 : d->mesh_scale };
	source.pose.p = isnan(d->mesh_at.x) ? ob_v3(0, 0, 0) : d->mesh_at;
	source.pose.q = isnan(d->mesh_rotation.w) ? ob_quat_identity() : d->mesh_rotation;
	if (d->hull) {
		const ob_quat f = d->hull->frame;
		const ob_mat3 r = ob_quat_matrix(f);
		source.pose.p = ob_rotate_back(&r, ob_sub(source.pose.p, d->hull->centre));
		source.pose.q = ob_quat_mul(ob_quat_conjugate(f), source.pose.q);
	}
	return source;
}

// Takes the object that was added last out of the scene again: each viewer will have one of its kind.
static void make_template(lua_State *L, ob_scene *s, const char *kind)
{
	if (s->avatar)
		ob_sandbox_fail(L, "%s.avatar: expected one object with it, got a second", kind);
	s->avatar = malloc(sizeof *s->avatar);
	if (!s->avatar)
		ob_sandbox_fail(L, "%s: no memory left on this machine", kind);
	*s->avatar = s->object[--s->objects];
}

static ob_object_def *add(lua_State *L, const char *kind, ob_shape shape, ob_vec3 size, body *d)
{
	ob_builder *b = ob_sandbox_user(L);
	ob_error e;
	find_kind(L, kind, d);
	check_together(L, kind, d);
	apply_material(L, b, kind, shape, d);
	double mass = d->kind != DYNAMIC ? 0
		      : isnan(d->mass)   ? d->own.density * ob_shape_volume(shape, size, d->hull)
					 : d->mass;
	const ob_mesh_source source = source_of_mesh(d);
	if (d->mesh && !b->options->joining)
		d->look = ob_builder_mesh(L, b, kind, "mesh", &source);
	ob_object_def *o = ob_builder_add(L, b, kind, d->name);
	ob_passport *p = &o->passport;
	p->mesh = d->look;
	o->look = d->mesh && !d->look ? ob_mesh_key(source.file, source.scale, source.pose) : 0;
	p->flags |= (d->mesh || d->file) && !d->own_colour ? OB_OBJECT_MESH_COLOUR : 0;
	p->flags |= (d->mesh || d->file) && !d->own_surface ? OB_OBJECT_MESH_SURFACE : 0;
	p->flags |= d->kind == STATIC ? OB_OBJECT_STATIC : d->kind == KINEMATIC ? OB_OBJECT_KINEMATIC : 0;
	p->flags |= (d->sensor ? OB_OBJECT_SENSOR : 0) | (d->visible ? 0 : OB_OBJECT_HIDDEN);
	p->flags |= d->group << OB_OBJECT_GROUP | ~d->hits << OB_OBJECT_PASSES | d->own.pattern << OB_OBJECT_PATTERN;
	p->shape = (uint8_t)shape;
	p->size = size;
	p->mass = mass;
	if (d->kind == DYNAMIC)
		p->force = d->force;
	else
		p->surface_velocity = d->surface_velocity;
	if (!isnan(d->inertia.x))
		p->inertia = d->inertia;
	p->friction = d->own.friction;
	p->restitution = d->own.restitution;
	p->roughness = (float)d->own.roughness;
	p->metal = (float)d->own.metal;
	memcpy(p->colour, d->own.colour, sizeof p->colour);
	o->state.pose.p = d->at;
	o->state.pose.q = !isnan(d->q.w) ? d->q : !isnan(d->rotation.w) ? d->rotation : ob_quat_identity();
	if (d->hull)
		take_hull_frame(b->scene, d->hull, o);
	o->state.v = d->velocity;
	o->state.w = d->spin;
	if (!d->fmu && (d->inputs || d->outputs || d->parameters))
		ob_sandbox_fail(L, "%s.%s: expected none where there is no fmu", kind,
				d->inputs    ? "inputs"
				: d->outputs ? "outputs"
					     : "parameters");
	if (d->fmu) {
		uint32_t at, bytes;
		const uint32_t script = ob_builder_fmu(L, b, kind, d->fmu, &at, &bytes);
		o = &b->scene->object[b->scene->objects - 1];
		o->script = script, o->state_at = at, o->state_bytes = bytes;
	}
	if (d->state.size && !d->script)
		ob_sandbox_fail(L, "%s.state: expected none where there is no script", kind);
	if (d->script) {
		const uint32_t script = ob_builder_script(L, b, kind, d->script);
		const uint32_t at = ob_builder_keep_state(L, b, d->state.bytes, d->state.size);
		o = &b->scene->object[b->scene->objects - 1];
		o->script = script;
		o->state_at = at, o->state_bytes = d->state.size;
	}
	o->update_rate = d->kind == DYNAMIC ? d->own.update_rate : 0;
	o->born = d->born;
	o->dies = d->dies;
	if (d->path) {
		lua_getfield(L, 1, "path");
		ob_builder_read_path(L, kind, o);
		lua_pop(L, 1);
	}
	if (d->varying_force) {
		lua_getfield(L, 1, "varying_force");
		ob_builder_read_force(L, kind, o);
		lua_pop(L, 1);
	}
	if (!ob_object_def_check(o, &e))
		ob_sandbox_fail(L, "%s.%s", kind, e.text);
	if (d->avatar)
		make_template(L, b->scene, kind);
	return o;
}

ob_quat ob_scene_turn_to(ob_vec3 n)
{
	if (n.z < -1 + 1e-12)
		return (ob_quat){ 0, 1, 0, 0 };
	return ob_quat_normalize((ob_quat){ 1 + n.z, -n.y, n.x, 0 });
}

// Reads the numbers of the shape's size by their keys, and the fields that all such objects have.
static void read_shape(lua_State *L, ob_shape shape, body *d)
{
	enum { MOST = OB_SHAPE_KEYS + sizeof body_fields / sizeof *body_fields + 1 };
	const ob_shape_kind *kind = ob_shape_kind_of(shape);
	ob_field field[MOST];
	size_t n = 0;
	if (ob_shape_is(shape, OB_UNBOUNDED)) {
		const uint64_t given = ob_fields_read(L, 1, kind->name, endless_fields,
						      sizeof endless_fields / sizeof *endless_fields, d);
		d->fixed = true;
		if (given & 1 && !isnan(d->q.w))
			refuse_together(L, kind->name, "normal", "q");
		if (isnan(d->q.w))
			d->q = ob_scene_turn_to(d->normal);
		return;
	}
	for (size_t k = 0; k < OB_SHAPE_KEYS && kind->key[k].name; k++)
		field[n++] = (ob_field){ .name = kind->key[k].name,
					 .kind = kind->key[k].component < 0 ? OB_FIELD_VECTOR : OB_FIELD_NUMBER,
					 .offset = offsetof(body, given) + k * sizeof *d->given,
					 .low = OB_LENGTH_LEAST,
					 .high = OB_LENGTH_MOST,
					 .required = true };
	if (ob_shape_is(shape, OB_HULLED))
		field[n++] = points_field;
	memcpy(field + n, body_fields, sizeof body_fields);
	ob_fields_read(L, 1, kind->name, field, n + sizeof body_fields / sizeof *body_fields, d);
}

static ob_vec3 size_of(ob_shape shape, const body *d)
{
	const ob_shape_key *key = ob_shape_kind_of(shape)->key;
	double size[3] = { 0 };
	if (d->hull)
		return ob_hull_size(d->hull);
	if (key->name && key->component == OB_SHAPE_SIDES)
		return ob_scale(d->given[0], key->share);
	for (size_t k = 0; k < OB_SHAPE_KEYS && key[k].name; k++)
		size[key[k].component] = key[k].share * d->given[k].x;
	return ob_v3(size[0], size[1], size[2]);
}

// Pushes the name of an object, as the result of its call.
static int give_name(lua_State *L, const ob_object_def *o)
{
	lua_pushstring(L, o->passport.name);
	return 1;
}

int ob_scene_add(lua_State *L, ob_shape shape)
{
	unsigned char state_bytes[STATE_BYTES];
	body d = nothing;
	d.state = (ob_flat){ state_bytes, 0, sizeof state_bytes };
	read_shape(L, shape, &d);
	if (ob_shape_is(shape, OB_HULLED))
		d.hull = ob_builder_hull(L, ob_sandbox_user(L), &d.points, ob_scale(d.inertia, 1 / d.mass));
	return give_name(L, add(L, ob_shape_name(shape), shape, size_of(shape, &d), &d));
}

// compound { parts = { { size = {...}, at = {...} }, { points = {...} } }, ... }
int ob_scene_call_compound(lua_State *L)
{
	static const ob_field fields[] = { F(parts, .kind = OB_FIELD_TABLE, .required = true), PLACE, MOVING, SURFACE,
					   LOOKS };
	unsigned char state_bytes[STATE_BYTES];
	body d = nothing;
	double density;
	d.state = (ob_flat){ state_bytes, 0, sizeof state_bytes };
	ob_fields_read(L, 1, "compound", fields, sizeof fields / sizeof *fields, &d);
	lua_getfield(L, 1, "parts");
	d.hull = ob_builder_compound(L, ob_sandbox_user(L), ob_scale(d.inertia, 1 / d.mass), &density);
	lua_pop(L, 1);
	if (!isnan(density) && !isnan(d.own.density))
		ob_sandbox_fail(L, "compound.density: expected none where its parts have one");
	if (isnan(d.mass) && !isnan(density))
		d.own.density = density;
	return give_name(L, add(L, "compound", OB_SHAPE_HULL, ob_hull_size(d.hull), &d));
}

// Adds an object of a terrain, which is made of the table at index 1.
static void add_terrain(lua_State *L, const char *kind, const ob_field *field, size_t fields)
{
	ob_builder *b = ob_sandbox_user(L);
	body d = nothing;
	d.fixed = true;
	ob_fields_read(L, 1, kind, field, fields, &d);
	if (!d.fixed)
		ob_sandbox_fail(L, "%s.static: expected true or nothing: it never moves", kind);
	if (b->options->joining)
		ob_sandbox_fail(L, "%s: expected in a scene: what is added to a run has a shape that can move", kind);
	ob_terrain *t = d.file ? ob_builder_triangles(L, b, d.file, d.scale, &d.look) : ob_builder_heights(L);
	const ob_vec3 size = ob_terrain_size(t);
	const uint32_t terrain = ob_builder_terrain(L, b, kind, t, &d.look);
	add(L, kind, OB_SHAPE_TERRAIN, size, &d)->passport.hull = (uint16_t)terrain;
}

// heightfield { size = {..}, cells = {..}, height = function(x, y) .. end, ... }
int ob_scene_call_heightfield(lua_State *L)
{
	add_terrain(L, "heightfield", heightfield_fields, sizeof heightfield_fields / sizeof *heightfield_fields);
	return 0;
}

// mesh { file = "floor.glb", ... }
int ob_scene_call_mesh(lua_State *L)
{
	add_terrain(L, "mesh", mesh_fields, sizeof mesh_fields / sizeof *mesh_fields);
	return 0;
}

int ob_scene_call_ground(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	ob_look_def *look = &b->scene->look;
	body d = nothing;
	d.name = "ground";
	d.fixed = true;
	ob_fields_read(L, 1, "ground", ground_fields, sizeof ground_fields / sizeof *ground_fields, &d);
	const ob_material *m = d.material ? ob_builder_material(b, d.material) : NULL;
	if (isnan(d.own.colour[0]) && (!m || isnan(m->colour[0])))
		for (int i = 0; i < 4; i++)
			d.own.colour[i] = i < 3 ? look->ground_colour[i] : 1;
	d.at.z = d.height;
	const ob_object_def *o = add(L, "ground", OB_SHAPE_PLANE, ob_v3(0, 0, 0), &d);
	memcpy(look->ground_colour, o->passport.colour, sizeof look->ground_colour);
	look->grid = d.grid && ob_passport_pattern(&o->passport) == OB_PATTERN_PLAIN;
	return give_name(L, o);
}

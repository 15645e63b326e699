// camera "main" { eye = ..., target = ... }, and the place of a camera that frames all objects.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "elementary/elementary.h"
#include "scene/builder.h"
#include "scene/sandbox.h"
#include "scene/text.h"
#include "shape/shape.h"

#define RADIANS (M_PI / 180)
#define ASPECT (16. / 9) // picture for which a framing camera is placed
#define MARGIN 1.06 // space around the objects, as a factor of their size in the picture
#define SPREAD .2 // m to the side that an object may move, for each metre of its fall

typedef struct camera_fields {
	ob_vec3 eye, target, from, velocity;
	double fov, pan, tilt; // degrees, degrees/s
	const char *follow, *on;
} camera_fields;

#define F(member, ...) OB_FIELD(camera_fields, member, .name = #member, __VA_ARGS__)
static const ob_field fields[] = {
	F(eye, .kind = OB_FIELD_VECTOR, .low = -1e7, .high = 1e7),
	F(target, .kind = OB_FIELD_VECTOR, .low = -1e7, .high = 1e7),
	F(from, .kind = OB_FIELD_DIRECTION),
	F(fov, .kind = OB_FIELD_NUMBER, .low = 1, .high = 170),
	F(velocity, .kind = OB_FIELD_VECTOR, .low = -1e6, .high = 1e6),
	F(pan, .kind = OB_FIELD_NUMBER, .low = -36000, .high = 36000),
	F(tilt, .kind = OB_FIELD_NUMBER, .low = -36000, .high = 36000),
	F(follow, .kind = OB_FIELD_TEXT, .high = OB_NAME_MAX - 1),
	F(on, .kind = OB_FIELD_TEXT, .high = OB_NAME_MAX - 1),
};
#undef F

static const camera_fields usual = {
	.eye = { .x = NAN },
	.target = { .x = NAN },
	.from = { .x = NAN },
	.fov = 40,
};
static const ob_vec3 usual_from = { -.5, -.78, .53 };

static void check_place(lua_State *L, const char *where, const camera_fields *f)
{
	bool eye = !isnan(f->eye.x), target = !isnan(f->target.x), from = !isnan(f->from.x);
	if (from && (eye || target))
		ob_sandbox_fail(L, "%s.from: expected either from, or eye and target, got both", where);
	if (eye != target)
		ob_sandbox_fail(L, "%s.%s: expected eye and target together, got nothing", where,
				eye ? "target" : "eye");
	if (eye && ob_norm(ob_sub(f->eye, f->target)) < 1e-6)
		ob_sandbox_fail(L, "%s.target: expected a point away from the eye", where);
	if (f->on && (f->follow || !eye))
		ob_sandbox_fail(L, "%s.on: expected eye and target in the object's axes, and not follow, too", where);
}

static void check_new(lua_State *L, const ob_builder *b, const char *name)
{
	if (b->cameras == OB_SCENE_CAMERAS_MAX)
		ob_sandbox_fail(L, "camera: expected at most %d cameras", OB_SCENE_CAMERAS_MAX);
	for (uint32_t i = 0; i < b->cameras; i++)
		if (strcmp(b->camera[i].def.name, name) == 0)
			ob_sandbox_fail(L, "camera \"%s\": exists already", name);
}

static ob_camera_draft draft(const char *name, const camera_fields *f)
{
	ob_camera_draft c = {
		.def = { .eye = f->eye,
			 .target = f->target,
			 .velocity = f->velocity,
			 .pan = f->pan * RADIANS,
			 .tilt = f->tilt * RADIANS,
			 .fov = f->fov * RADIANS },
		.framed = isnan(f->eye.x),
		.from = isnan(f->from.x) ? ob_scale(usual_from, 1 / ob_norm(usual_from)) : f->from,
	};
	snprintf(c.def.name, sizeof c.def.name, "%s", name);
	c.def.aboard = f->on != NULL;
	if (f->on || f->follow)
		snprintf(c.def.follow, sizeof c.def.follow, "%s", f->on ? f->on : f->follow);
	return c;
}

// The second half of camera "name" { ... }; upvalue 1 is the name.
static int define(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	const char *name = lua_tostring(L, lua_upvalueindex(1));
	char where[OB_NAME_MAX + 16];
	snprintf(where, sizeof where, "camera \"%s\"", name);
	check_new(L, b, name);
	camera_fields f = usual;
	ob_fields_read(L, 1, where, fields, sizeof fields / sizeof *fields, &f);
	check_place(L, where, &f);
	b->camera[b->cameras++] = draft(name, &f);
	return 0;
}

int ob_scene_call_camera(lua_State *L)
{
	size_t size;
	const char *name = lua_type(L, 1) == LUA_TSTRING ? lua_tolstring(L, 1, &size) : NULL;
	if (!name || size == 0 || size >= OB_NAME_MAX || !ob_text_is_clean(name, size))
		ob_sandbox_fail(L, "camera: expected a name of 1 to %d bytes, as in camera \"main\" { ... }",
				OB_NAME_MAX - 1);
	lua_settop(L, 1);
	lua_pushcclosure(L, define, 1);
	return 1;
}

typedef struct view {
	ob_vec3 right, up, forward; // unit
	double tan_x, tan_y; // half the usable angles
} view;

static view look(ob_vec3 from, double fov)
{
	double tangent = ob_tan(.5 * fov) / MARGIN;
	view v = { .forward = ob_scale(from, -1), .tan_x = ASPECT * tangent, .tan_y = tangent };
	ob_vec3 vertical = fabs(from.z) > .9999 ? ob_v3(0, 1, 0) : ob_v3(0, 0, 1);
	v.right = ob_cross(v.forward, vertical);
	v.right = ob_scale(v.right, 1 / ob_norm(v.right));
	v.up = ob_cross(v.right, v.forward);
	return v;
}

// A pyramid of view with its apex (x, y, z) in the view's axes holds a sphere if the sphere is inside each of its four
// sides: right <= x - z tan_x, left <= -x - z tan_x, above <= y - z tan_y, below <= -y - z tan_y.
typedef struct fit {
	double left, right, below, above; // m, the largest so far
	double near, far; // m, depths between which the spheres lie
} fit;

static void fit_sphere(fit *f, const view *v, ob_vec3 p, double r)
{
	double x = ob_dot(p, v->right), y = ob_dot(p, v->up), z = ob_dot(p, v->forward);
	double rx = r * sqrt(1 + v->tan_x * v->tan_x), ry = r * sqrt(1 + v->tan_y * v->tan_y);
	f->right = fmax(f->right, x - z * v->tan_x + rx);
	f->left = fmax(f->left, -x - z * v->tan_x + rx);
	f->above = fmax(f->above, y - z * v->tan_y + ry);
	f->below = fmax(f->below, -y - z * v->tan_y + ry);
	f->near = fmin(f->near, z - r);
	f->far = fmax(f->far, z + r);
}

// Height of the highest level ground, where falling objects end; -infinity without one, or if nothing falls.
static double ground_height(const ob_scene *s)
{
	double height = -INFINITY;
	for (uint32_t i = 0; i < s->objects; i++) {
		const ob_object_def *o = &s->object[i];
		if (ob_shape_is(o->passport.shape, OB_UNBOUNDED) && o->state.pose.q.w > .999 && s->run.gravity.z < 0)
			height = fmax(height, o->state.pose.p.z);
	}
	return height;
}

// Fits all objects, and the places on the ground that they may reach.
static fit fit_objects(const ob_scene *s, const view *v)
{
	fit f = { -INFINITY, -INFINITY, -INFINITY, -INFINITY, INFINITY, -INFINITY };
	double ground = ground_height(s);
	for (uint32_t i = 0; i < s->objects; i++) {
		const ob_object_def *o = &s->object[i];
		if (ob_shape_is(o->passport.shape, OB_UNBOUNDED | OB_SURFACED))
			continue;
		ob_vec3 p = o->state.pose.p;
		double r = o->passport.mesh ? s->mesh[o->passport.mesh - 1].radius
					    : ob_shape_radius((ob_shape)o->passport.shape, o->passport.size);
		fit_sphere(&f, v, p, r);
		double fall = fmax(p.z - r - ground, 0);
		p.z -= fall;
		if (isfinite(p.z) && !(o->passport.flags & OB_OBJECT_STATIC))
			fit_sphere(&f, v, p, r + SPREAD * fall);
	}
	if (!isfinite(f.left))
		fit_sphere(&f, v, ob_v3(0, 0, 0), 5);
	return f;
}

// Puts the apex as near as opposite sides permit: at the limit of the pair that needs more room, midway between the
// others.
static void frame(const ob_scene *s, ob_camera_draft *c)
{
	view v = look(c->from, c->def.fov);
	fit f = fit_objects(s, &v);
	double x = .5 * (f.right - f.left), y = .5 * (f.above - f.below);
	double z = -fmax((f.right + f.left) / (2 * v.tan_x), (f.above + f.below) / (2 * v.tan_y));
	ob_vec3 side = ob_add(ob_scale(v.right, x), ob_scale(v.up, y));
	c->def.automatic = !*c->def.follow;
	c->def.eye = ob_madd(side, z, v.forward);
	c->def.target = ob_madd(c->def.eye, fmax(.5 * (f.near + f.far) - z, 1), v.forward);
}

// True if an object has this name, or a script may create one that does.
static bool may_exist(const ob_scene *s, const char *name)
{
	for (uint32_t i = 0; i < s->objects; i++)
		if (strcmp(s->object[i].passport.name, name) == 0)
			return true;
	return s->scripts > 0;
}

bool ob_builder_place_cameras(ob_builder *b, const char *path, ob_error *e)
{
	ob_scene *s = b->scene;
	if (b->cameras == 0)
		b->camera[b->cameras++] = draft("main", &usual);
	s->camera = calloc(b->cameras, sizeof *s->camera);
	if (!s->camera)
		return ob_fail(e, "%s: no memory", path);
	for (; s->cameras < b->cameras; s->cameras++) {
		ob_camera_draft *c = &b->camera[s->cameras];
		if (c->framed)
			frame(s, c);
		if (*c->def.follow && !may_exist(s, c->def.follow))
			return ob_fail(e, "%s:1: camera \"%s\".%s: expected the name of an object, got \"%s\"", path,
				       c->def.name, c->def.aboard ? "on" : "follow", c->def.follow);
		s->camera[s->cameras] = c->def;
	}
	return true;
}

// Functions that a script can call.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lauxlib.h>

#include "base/number.h"
#include "motion/depth.h"
#include "motion/flight.h"
#include "motion/joint_value.h"
#include "scene/object_limits.h"
#include "scene/text.h"
#include "script/runner.h"
#include "shape/shape.h"

void ob_script_warn(lua_State *L, const char *format, ...)
{
	ob_script_runner *r = ob_sandbox_user(L);
	if (!r->turn || *r->warning.text || r->turn->flags & OB_SCRIPT_WARNED)
		return;
	char text[sizeof r->warning.text];
	va_list args;
	va_start(args, format);
	vsnprintf(text, sizeof text, format, args);
	va_end(args);
	ob_fail(&r->warning, "%s:%d: %s", r->data->script_text->text[r->turn->script - 1].name, ob_sandbox_line(L),
		text);
}

// ---- arguments

static ob_script_runner *runner_of(lua_State *L)
{
	ob_script_runner *r = ob_sandbox_user(L);
	if (!r->turn)
		ob_sandbox_fail(L, "objects can be asked in a function alone, as in function on_start() ... end");
	return r;
}

static ob_flat_object *object_at(lua_State *L, int index, const char *call)
{
	ob_flat_object *o = luaL_testudata(L, index, OB_FLAT_OBJECT);
	if (!o)
		ob_sandbox_fail(L, "%s: expected an object before the colon, as in self:%s(...)", call, call);
	ob_sandbox_spend(L, 8); // a call of a method: its lookup, and what it reads
	return o;
}

// Checks that the argument is the script's own object: only that one takes orders.
static ob_script_runner *own(lua_State *L, const char *call)
{
	ob_script_runner *r = runner_of(L);
	const ob_flat_object *o = object_at(L, 1, call);
	if (o->id != r->turn->object || o->generation != r->turn->generation)
		ob_sandbox_fail(L, "%s: a script moves its own object, self; others can be sent a message", call);
	return r;
}

static double number_at(lua_State *L, int index, const char *call, double most)
{
	const double x = lua_tonumber(L, index);
	if (lua_type(L, index) != LUA_TNUMBER || !(fabs(x) <= most)) {
		char got[OB_TEXT_VALUE];
		ob_text_of_value(L, index, got);
		ob_sandbox_fail(L, "%s: expected a number, up to %g, got %s", call, most, got);
	}
	return x;
}

// Reads x, y, z from this index on, or a table {x, y, z} there. Returns the number of values taken.
static int vector_at(lua_State *L, int index, const char *call, double most, ob_vec3 *out)
{
	double x[3];
	if (!lua_istable(L, index)) {
		for (int i = 0; i < 3; i++)
			x[i] = number_at(L, index + i, call, most);
		*out = ob_v3(x[0], x[1], x[2]);
		return 3;
	}
	for (int i = 0; i < 3; i++) {
		lua_geti(L, index, i + 1);
		x[i] = number_at(L, -1, call, most);
		lua_pop(L, 1);
	}
	*out = ob_v3(x[0], x[1], x[2]);
	return 1;
}

static int push_vector(lua_State *L, ob_vec3 v)
{
	lua_pushnumber(L, v.x);
	lua_pushnumber(L, v.y);
	lua_pushnumber(L, v.z);
	return 3;
}

static void push_object(lua_State *L, const ob_script_runner *r, uint32_t id)
{
	ob_flat_object *o = lua_newuserdatauv(L, sizeof *o, 0);
	*o = (ob_flat_object){ id, ob_passport_of(r->u, id)->generation };
	luaL_setmetatable(L, OB_FLAT_OBJECT);
}

// Warns where the own object is one that no force moves.
static void warn_unmoved(lua_State *L, const ob_script_runner *r, const char *call)
{
	const uint32_t flags = ob_passport_of(r->u, r->turn->object)->flags;
	if (flags & OB_OBJECT_PRESCRIBED)
		ob_script_warn(L, "self:%s has no effect: the object is %s, did you mean kind = \"dynamic\"?", call,
			       flags & OB_OBJECT_KINEMATIC ? "kinematic" : "static");
}

// A getter that is given values was meant to set them.
static void warn_arguments(lua_State *L, const char *call, const char *instead)
{
	if (lua_gettop(L) > 1)
		ob_script_warn(L, "%s takes no values and sets nothing%s", call, instead);
}

// ---- reading any object

// Its passport; NULL: the object is gone.
static const ob_passport *passport_of(const ob_script_runner *r, const ob_flat_object *o)
{
	if (o->id >= ob_universe_ids(r->u) || r->data->schedule[o->id].state == OB_SCHEDULE_ABSENT)
		return NULL;
	const ob_passport *p = ob_passport_of(r->u, o->id);
	return p->flags & OB_OBJECT_PRESENT && p->generation == o->generation ? p : NULL;
}

static double now_of(const ob_script_runner *r)
{
	return (double)r->step * r->settings->step_length;
}

static int call_exists(lua_State *L)
{
	warn_arguments(L, "exists", "");
	lua_pushboolean(L, passport_of(runner_of(L), object_at(L, 1, "exists")) != NULL);
	return 1;
}

static int call_id(lua_State *L)
{
	warn_arguments(L, "id", "");
	lua_pushinteger(L, object_at(L, 1, "id")->id);
	return 1;
}

static int call_name(lua_State *L)
{
	warn_arguments(L, "name", "");
	const ob_passport *p = passport_of(runner_of(L), object_at(L, 1, "name"));
	if (p)
		lua_pushlstring(L, p->name, strnlen(p->name, OB_NAME_MAX));
	return p != NULL;
}

static int call_mass(lua_State *L)
{
	warn_arguments(L, "mass", "");
	const ob_passport *p = passport_of(runner_of(L), object_at(L, 1, "mass"));
	if (p)
		lua_pushnumber(L, p->mass);
	return p != NULL;
}

// Returns the centre alone, which needs no rotation.
static int call_position(lua_State *L)
{
	warn_arguments(L, "position", ": self:push moves an object");
	const ob_script_runner *r = runner_of(L);
	const ob_flat_object *o = object_at(L, 1, "position");
	const ob_passport *p = passport_of(r, o);
	if (!p)
		return 0;
	const ob_motion *m = ob_newest_motion(r->u, o->id);
	const double t = now_of(r), s = t - m->t0;
	return push_vector(L, ob_published_stands(m, p, t) ? m->p : ob_madd(ob_madd(m->p, s, m->v), .5 * s * s, m->a));
}

static int call_velocity(lua_State *L)
{
	warn_arguments(L, "velocity", ": self:push changes it, or self:set_velocity");
	const ob_script_runner *r = runner_of(L);
	const ob_flat_object *o = object_at(L, 1, "velocity");
	const ob_passport *p = passport_of(r, o);
	if (!p)
		return 0;
	const ob_motion *m = ob_newest_motion(r->u, o->id);
	const double t = now_of(r);
	return push_vector(L, ob_published_stands(m, p, t) ? m->v : ob_madd(m->v, t - m->t0, m->a));
}

static bool state_of(lua_State *L, const char *call, ob_state *out)
{
	const ob_script_runner *r = runner_of(L);
	const ob_flat_object *o = object_at(L, 1, call);
	const ob_passport *p = passport_of(r, o);
	ob_sandbox_spend(L, 8);
	if (p)
		*out = ob_published_at(ob_newest_motion(r->u, o->id), p, now_of(r));
	return p;
}

static int call_spin(lua_State *L)
{
	warn_arguments(L, "spin", ": self:twist changes it, or self:set_spin");
	ob_state s;
	return state_of(L, "spin", &s) ? push_vector(L, s.w) : 0;
}

static int call_attitude(lua_State *L)
{
	warn_arguments(L, "attitude", ": self:twist turns an object");
	ob_state s;
	if (!state_of(L, "attitude", &s))
		return 0;
	lua_pushnumber(L, s.pose.q.w);
	return 1 + push_vector(L, ob_v3(s.pose.q.x, s.pose.q.y, s.pose.q.z));
}

// Rotates from the object's axes to the world's.
static int call_turned(lua_State *L)
{
	ob_state s;
	ob_vec3 v;
	vector_at(L, 2, "turned", OB_FORCE_MOST, &v);
	if (!state_of(L, "turned", &s))
		return 0;
	const ob_mat3 m = ob_quat_matrix(s.pose.q);
	return push_vector(L, ob_rotate(&m, v));
}

// Solid of an object at the present time, or of a compound's part, from 1.
static ob_solid solid_of(const ob_script_runner *r, uint32_t id, uint32_t part)
{
	const ob_passport *p = ob_passport_of(r->u, id);
	const ob_state s = ob_published_at(ob_newest_motion(r->u, id), p, now_of(r));
	return ob_solid_of(p->shape, p->size, s.pose, ob_part_of(r->u, p, part));
}

// True if the two overlap, compounds by any of their parts. L is charged for it.
static bool overlap(lua_State *L, const ob_script_runner *r, uint32_t a, uint32_t b)
{
	enum { CLOSED_FORM = 16, SEARCH = 3000 }; // instructions of a depth
	const uint32_t of_a = ob_parts_of(r->u, ob_passport_of(r->u, a)),
		       of_b = ob_parts_of(r->u, ob_passport_of(r->u, b));
	for (uint32_t i = of_a > 0; i <= of_a; i++)
		for (uint32_t j = of_b > 0; j <= of_b; j++) {
			const ob_solid one = solid_of(r, a, i), other = solid_of(r, b, j);
			ob_sandbox_spend(L, ob_depth_needs_search(one.shape, other.shape) ? SEARCH : CLOSED_FORM);
			if (ob_depth(&one, &other) > 0)
				return true;
		}
	return false;
}

static bool boxes_overlap(const float *a, const float *b)
{
	return a[0] <= b[3] && b[0] <= a[3] && a[1] <= b[4] && b[1] <= a[4] && a[2] <= b[5] && b[2] <= a[5];
}

// o:inside(): the objects in a sensor, in the order of their ids.
static int call_inside(lua_State *L)
{
	enum { AT_ONCE = 64 }; // looked at between two charges
	const ob_script_runner *r = runner_of(L);
	const ob_flat_object *o = object_at(L, 1, "inside");
	const ob_passport *sensor = passport_of(r, o);
	warn_arguments(L, "inside", "");
	if (!sensor)
		return 0;
	if (!(sensor->flags & OB_OBJECT_SENSOR))
		ob_sandbox_fail(L, "inside: expected a sensor, as in sphere { radius = 1, sensor = true }");
	const float *box = r->data->bounds[o->id];
	lua_newtable(L);
	lua_Integer n = 0;
	for (uint32_t id = 0; id < ob_universe_ids(r->u); id++) {
		if (id % AT_ONCE == 0)
			ob_sandbox_spend(L, AT_ONCE / 4);
		if (r->data->schedule[id].state == OB_SCHEDULE_ABSENT || !boxes_overlap(box, r->data->bounds[id]) ||
		    !ob_sensor_finds(sensor, ob_passport_of(r->u, id)))
			continue;
		if (!overlap(L, r, o->id, id))
			continue;
		push_object(L, r, id);
		lua_rawseti(L, -2, ++n);
	}
	return 1;
}

// ---- orders to the own object

static int call_force(lua_State *L)
{
	ob_script_runner *r = own(L, "force");
	warn_unmoved(L, r, "force");
	vector_at(L, 2, "force", ob_force_most(ob_passport_of(r->u, r->turn->object)), &r->cell->force);
	r->cell->asks |= OB_SCRIPT_ASKS_FORCE;
	return 0;
}

static int call_torque(lua_State *L)
{
	ob_script_runner *r = own(L, "torque");
	warn_unmoved(L, r, "torque");
	vector_at(L, 2, "torque", ob_torque_most(ob_passport_of(r->u, r->turn->object)), &r->cell->next_torque);
	r->cell->asks |= OB_SCRIPT_ASKS_TORQUE;
	return 0;
}

// Adds to what pushes, or twists, the object in this step.
static void add_up(lua_State *L, const char *call, ob_vec3 more, double most, ob_vec3 *sum)
{
	const ob_vec3 all = ob_add(*sum, more);
	const double largest = fmax(fabs(all.x), fmax(fabs(all.y), fabs(all.z)));
	if (!(largest <= most))
		ob_sandbox_fail(L, "%s: expected at most %s along an axis in a step, got %s", call,
				ob_number_text(most).text, ob_number_text(largest).text);
	*sum = all;
}

// Pushes at the centre, or at a point, which also adds spin.
static int call_push(lua_State *L)
{
	ob_script_runner *r = own(L, "push");
	const ob_passport *p = ob_passport_of(r->u, r->turn->object);
	ob_vec3 push, at;
	ob_state s;
	warn_unmoved(L, r, "push");
	const int taken = vector_at(L, 2, "push", OB_FORCE_MOST, &push);
	if (!lua_isnoneornil(L, 2 + taken)) {
		vector_at(L, 2 + taken, "push", OB_PLACE_MOST, &at);
		if (state_of(L, "push", &s))
			add_up(L, "push", ob_cross(ob_sub(at, s.pose.p), push), ob_torque_most(p), &r->cell->twist);
	}
	add_up(L, "push", push, ob_force_most(p), &r->cell->push);
	r->cell->asks |= OB_SCRIPT_ASKS_PUSH;
	return 0;
}

static int call_twist(lua_State *L)
{
	ob_script_runner *r = own(L, "twist");
	ob_vec3 twist;
	warn_unmoved(L, r, "twist");
	vector_at(L, 2, "twist", OB_FORCE_MOST, &twist);
	add_up(L, "twist", twist, ob_torque_most(ob_passport_of(r->u, r->turn->object)), &r->cell->twist);
	r->cell->asks |= OB_SCRIPT_ASKS_PUSH;
	return 0;
}

static int call_colour(lua_State *L)
{
	static const ob_field field = { .name = "colour", .kind = OB_FIELD_COLOUR, .required = true };
	ob_script_runner *r = own(L, "colour");
	ob_sandbox_spend(L, 50);
	lua_settop(L, 2);
	ob_script_thaw(L, 2);
	lua_newtable(L);
	lua_insert(L, 2);
	lua_setfield(L, 2, "colour");
	ob_fields_read(L, 2, "self", &field, 1, r->cell->colour);
	r->cell->asks |= OB_SCRIPT_ASKS_COLOUR;
	return 0;
}

static int call_wake(lua_State *L)
{
	ob_script_runner *r = own(L, "wake");
	const double after = number_at(L, 2, "wake", 1e9), steps = ceil(after / r->settings->step_length - 1e-6);
	const double step = (double)r->step + fmax(1, steps);
	r->turn->wake = step < UINT32_MAX ? (uint32_t)step : UINT32_MAX;
	return 0;
}

// ---- requests for the step's end: messages, creations, removals

static ob_script_post *begin_post(lua_State *L, const ob_script_runner *r, ob_request_kind kind, uint32_t id,
				  uint32_t generation)
{
	ob_script_cell *c = r->cell;
	ob_script_post *post = (ob_script_post *)(void *)(c->outbox + c->outbox_bytes);
	if (c->outbox_bytes + sizeof *post > OB_SCRIPT_OUTBOX_BYTES)
		ob_sandbox_fail(L, "expected at most %d bytes of messages, creations and removals in a step",
				OB_SCRIPT_OUTBOX_BYTES);
	*post = (ob_script_post){
		.kind = kind, .line = (uint32_t)ob_sandbox_line(L), .object = id, .generation = generation
	};
	return post;
}

static ob_flat rest_of(const ob_script_cell *c)
{
	const uint32_t at = c->outbox_bytes + (uint32_t)sizeof(ob_script_post);
	return (ob_flat){ (unsigned char *)(uintptr_t)c->outbox + at, 0, OB_SCRIPT_OUTBOX_BYTES - at };
}

static void end_post(const ob_script_runner *r, ob_script_post *post, const ob_flat *f)
{
	post->used = f->size;
	post->bytes = (f->size + 7) / 8 * 8; // the outbox holds multiples of that
	memset(f->bytes + f->size, 0, post->bytes - f->size);
	r->cell->outbox_bytes += (uint32_t)sizeof *post + post->bytes;
	r->cell->asks |= OB_SCRIPT_ASKS_POST;
}

// Appends the contents of a post to the outbox.
static void post(lua_State *L, const ob_script_runner *r, ob_request_kind kind, uint32_t id, uint32_t generation,
		 const void *contents, size_t size)
{
	ob_script_post *p = begin_post(L, r, kind, id, generation);
	ob_flat f = rest_of(r->cell);
	if (f.room < size)
		ob_sandbox_fail(L, "expected at most %d bytes of requests in a step", OB_SCRIPT_OUTBOX_BYTES);
	memcpy(f.bytes, contents, size);
	f.size = (uint32_t)size;
	end_post(r, p, &f);
}

static int call_send(lua_State *L)
{
	const ob_script_runner *r = runner_of(L);
	const int values = lua_gettop(L);
	const ob_flat_object *to = luaL_testudata(L, 1, OB_FLAT_OBJECT);
	if (!to)
		ob_sandbox_fail(L, "send: expected an object to send to, as in send(find(\"lift\"), \"up\")");
	ob_script_post *post = begin_post(L, r, OB_REQUEST_MESSAGE, to->id, to->generation);
	ob_flat f = rest_of(r->cell);
	for (int i = 2; i <= values; i++)
		ob_flat_put(L, i, &f, "send");
	end_post(r, post, &f);
	return 0;
}

static int call_remove(lua_State *L)
{
	ob_script_runner *r = runner_of(L);
	const ob_flat_object *o = object_at(L, 1, "remove");
	if (o->id == r->turn->object && o->generation == r->turn->generation) {
		r->ended = true;
		return 0;
	}
	ob_flat none = rest_of(r->cell);
	ob_script_post *post = begin_post(L, r, OB_REQUEST_REMOVE, o->id, o->generation);
	end_post(r, post, &none);
	return 0;
}

// Cost of points: a hull takes longer than other objects, which have no points.
static unsigned cost_of_points(lua_State *L)
{
	enum { EACH = 100 };
	unsigned points = 0;
	if (lua_istable(L, 1)) {
		lua_getfield(L, 1, "points");
		points = (unsigned)lua_rawlen(L, -1);
		lua_pop(L, 1);
	}
	return EACH * points;
}

// Creates an object, at first in the runner's scene. Upvalue 1 is its shape.
static int call_create(lua_State *L)
{
	ob_script_runner *r = runner_of(L);
	const ob_shape shape = (ob_shape)lua_tointeger(L, lua_upvalueindex(1));
	const char *kind = ob_shape_name(shape);
	lua_settop(L, 1);
	ob_script_thaw(L, 1);
	const bool named = lua_istable(L, 1) && lua_getfield(L, 1, "name") != LUA_TNIL;
	lua_settop(L, 1);
	lua_pushnil(L);
	lua_setfield(L, LUA_REGISTRYINDEX, "scene.names"); // only the host assigns names
	r->scene.objects = r->scene.states_bytes = r->scene.hulls = 0;
	ob_sandbox_spend(L, 500 + cost_of_points(L));
	ob_scene_add(L, shape);
	ob_object_def *def = &r->scene.object[0];
	if (def->path || def->force) {
		free(def->path), free(def->force);
		ob_sandbox_fail(L, "%s: expected neither path nor varying_force: only objects of the scene have them",
				kind);
	}
	if (def->born > 0 || def->dies < INFINITY)
		ob_sandbox_fail(L, "%s: expected neither born nor dies: it is created now, and removed on request",
				kind);
	if (!named)
		snprintf(def->passport.name, sizeof def->passport.name, "%s#", kind); // the host appends its id
	ob_script_post *post = begin_post(L, r, OB_REQUEST_ADD, 0, 0);
	ob_flat f = rest_of(r->cell);
	const ob_hull_corners *corners = r->scene.hulls ? &r->scene.hull_corners[0] : NULL;
	const size_t corners_bytes = corners ? corners->count * sizeof *corners->at : 0;
	if (f.room < sizeof *def + def->state_bytes + corners_bytes)
		ob_sandbox_fail(L, "%s: expected at most %d bytes of messages, creations and removals in a step", kind,
				OB_SCRIPT_OUTBOX_BYTES);
	memcpy(f.bytes, def, sizeof *def);
	if (def->state_bytes)
		memcpy(f.bytes + sizeof *def, r->scene.states, def->state_bytes);
	f.size = (uint32_t)sizeof *def + def->state_bytes;
	if (corners)
		memcpy(f.bytes + f.size, corners->at, corners_bytes);
	f.size += (uint32_t)corners_bytes;
	end_post(r, post, &f);
	return 0;
}

// ---- steering the own kinematic object

// Checks that the own object is one to steer: kinematic, or static where that will do.
static ob_script_runner *steered(lua_State *L, const char *call, bool or_static)
{
	ob_script_runner *r = own(L, call);
	const uint32_t flags = ob_passport_of(r->u, r->turn->object)->flags;
	if (!(flags & OB_OBJECT_PRESCRIBED) || (flags & OB_OBJECT_STATIC && !or_static))
		ob_sandbox_fail(L, "%s: expected a %skinematic object, got a %s one", call,
				or_static ? "static or " : "", flags & OB_OBJECT_STATIC ? "static" : "dynamic");
	ob_sandbox_spend(L, 500); // the host looks through all pairs
	return r;
}

static void post_own(lua_State *L, const ob_script_runner *r, ob_request_kind kind, const void *contents, size_t size)
{
	post(L, r, kind, r->turn->object, r->turn->generation, contents, size);
}

// Velocity and spin; the rest of the state stays as it is.
static int post_state(lua_State *L, const ob_script_runner *r, ob_vec3 v, ob_vec3 w)
{
	const ob_state s = { { { NAN, NAN, NAN }, { NAN, NAN, NAN, NAN } }, v, w };
	post_own(L, r, OB_REQUEST_STATE, &s, sizeof s);
	return 0;
}

static int call_set_velocity(lua_State *L)
{
	const ob_script_runner *r = steered(L, "set_velocity", false);
	ob_vec3 v;
	vector_at(L, 2, "set_velocity", OB_SPEED_MOST, &v);
	return post_state(L, r, v, ob_v3(NAN, NAN, NAN));
}

static int call_set_spin(lua_State *L)
{
	const ob_script_runner *r = steered(L, "set_spin", false);
	ob_vec3 w;
	vector_at(L, 2, "set_spin", OB_SPIN_MOST, &w);
	return post_state(L, r, ob_v3(NAN, NAN, NAN), w);
}

static int call_set_surface_velocity(lua_State *L)
{
	const ob_script_runner *r = steered(L, "set_surface_velocity", true);
	ob_vec3 v;
	vector_at(L, 2, "set_surface_velocity", OB_SPEED_MOST, &v);
	post_own(L, r, OB_REQUEST_SURFACE, &v, sizeof v);
	return 0;
}

static int call_set_path(lua_State *L)
{
	typedef struct said {
		bool points, loop;
	} said;
	static const ob_field fields[] = {
		OB_FIELD(said, points, .name = "points", .kind = OB_FIELD_TABLE, .required = true),
		OB_FIELD(said, loop, .name = "loop", .kind = OB_FIELD_BOOLEAN),
	};
	const ob_script_runner *r = steered(L, "set_path", false);
	said path = { 0 };
	ob_path_point *point;
	bool turns;
	lua_settop(L, 2);
	ob_script_thaw(L, 2);
	ob_fields_read(L, 2, "set_path", fields, sizeof fields / sizeof *fields, &path);
	const size_t points = ob_builder_read_points(L, "set_path", false, &point, &turns),
		     bytes = points * sizeof *point;
	ob_script_path *p = lua_newuserdatauv(L, sizeof *p + bytes, 0);
	p->loop = path.loop, p->turns = turns;
	memcpy(p->point, point, bytes);
	post_own(L, r, OB_REQUEST_PATH, p, sizeof *p + bytes);
	return 0;
}

// ---- the environment

static int call_time(lua_State *L)
{
	lua_pushnumber(L, now_of(runner_of(L)));
	return 1;
}

static int call_find(lua_State *L)
{
	enum { FIND_AT_ONCE = 64 };
	const ob_script_runner *r = runner_of(L);
	const char *name = lua_type(L, 1) == LUA_TSTRING ? lua_tostring(L, 1) : NULL;
	if (!name)
		ob_sandbox_fail(L, "find: expected the name of an object");
	for (uint32_t id = 0; id < ob_universe_ids(r->u); id++) {
		if (id % FIND_AT_ONCE == 0)
			ob_sandbox_spend(L, FIND_AT_ONCE / 2);
		if (r->data->schedule[id].state == OB_SCHEDULE_ABSENT ||
		    strncmp(ob_passport_of(r->u, id)->name, name, OB_NAME_MAX) != 0)
			continue;
		push_object(L, r, id);
		return 1;
	}
	return 0;
}

// Number of the joint of this name, which holds. UINT32_MAX: it has ended, or there is none: warns of that if the call acts.
static uint32_t find_joint(lua_State *L, const ob_script_runner *r, const char *call, bool acts)
{
	enum { FIND_AT_ONCE = 64 };
	const char *name = lua_type(L, 1) == LUA_TSTRING ? lua_tostring(L, 1) : NULL;
	if (!name)
		ob_sandbox_fail(L, "%s: expected the name of a joint", call);
	bool ended = false;
	for (uint32_t i = 0; i < ob_joints_end(r->data); i++) {
		if (i % FIND_AT_ONCE == 0)
			ob_sandbox_spend(L, FIND_AT_ONCE / 2);
		if (strncmp(r->data->joint[i].name, name, OB_NAME_MAX) != 0)
			continue;
		if (ob_joint_holds(r->u, &r->data->joint[i]))
			return i;
		ended = true;
	}
	if (acts && !ended)
		ob_script_warn(L, "%s has no effect: there is no joint \"%s\"", call, name);
	return UINT32_MAX;
}

// Returns value and rate of a joint's axis, and the force along it; nothing if the joint has ended, or has none.
static int call_joint(lua_State *L)
{
	const ob_script_runner *r = runner_of(L);
	const uint32_t joint = find_joint(L, r, "joint", false);
	ob_state states[2] = { { .pose.q = ob_quat_identity() }, { .pose.q = ob_quat_identity() } };
	double value, rate;
	ob_sandbox_spend(L, 24);
	if (joint == UINT32_MAX)
		return 0;
	const ob_joint_passport *j = &r->data->joint[joint];
	for (int side = 0; side < 2; side++)
		if (j->object[side] != OB_JOINT_WORLD)
			states[side] = ob_published_at(ob_newest_motion(r->u, j->object[side]),
						       ob_passport_of(r->u, j->object[side]), now_of(r));
	if (!ob_joint_value(j, states, &value, &rate))
		return 0;
	lua_pushnumber(L, value);
	lua_pushnumber(L, rate);
	lua_pushnumber(L, ob_joint_load_now(r->u, joint).along);
	return 3;
}

// Returns force and torque of a joint on its first object, as x, y, z each; nothing if it has ended.
static int call_joint_load(lua_State *L)
{
	const ob_script_runner *r = runner_of(L);
	const uint32_t joint = find_joint(L, r, "joint_load", false);
	if (joint == UINT32_MAX)
		return 0;
	const ob_joint_load load = ob_joint_load_now(r->u, joint);
	const double x[] = { load.force.x, load.force.y, load.force.z, load.torque.x, load.torque.y, load.torque.z };
	for (int i = 0; i < 6; i++)
		lua_pushnumber(L, x[i]);
	return 6;
}

static void post_joint(lua_State *L, const ob_script_runner *r, ob_request_kind kind, const ob_joint_passport *j,
		       const void *contents, size_t size)
{
	post(L, r, kind, j->object[0], j->generation[0], contents, size);
}

static int call_motor(lua_State *L)
{
	const ob_script_runner *r = runner_of(L);
	ob_script_motor m = { .joint = find_joint(L, r, "motor", true),
			      .target = number_at(L, 2, "motor", OB_JOINT_MOST) };
	if (m.joint == UINT32_MAX)
		return 0;
	const ob_joint_passport *j = &r->data->joint[m.joint];
	if (j->axis.motor == OB_MOTOR_NONE)
		ob_sandbox_fail(L, "motor: joint \"%s\" has none", j->name);
	post_joint(L, r, OB_REQUEST_MOTOR, j, &m, sizeof m);
	return 0;
}

bool ob_script_find_joined(void *runner, const char *name, ob_joined *to)
{
	const ob_script_runner *r = runner;
	for (uint32_t id = 0; id < ob_universe_ids(r->u); id++) {
		const ob_passport *p = ob_passport_of(r->u, id);
		if (r->data->schedule[id].state == OB_SCHEDULE_ABSENT || strncmp(p->name, name, OB_NAME_MAX) != 0)
			continue;
		*to = (ob_joined){ id, p->generation, !(p->flags & OB_OBJECT_PRESCRIBED),
				   ob_published_at(ob_newest_motion(r->u, id), p, now_of(r)).pose };
		return true;
	}
	return false;
}

// Joins objects, at first in the runner's scene. Upvalue 1 is the kind of joint.
static int call_join(lua_State *L)
{
	enum { NAMES_PER_INSTRUCTION = 4 };
	ob_script_runner *r = runner_of(L);
	lua_settop(L, 1);
	ob_script_thaw(L, 1);
	r->scene.joints = 0;
	ob_sandbox_spend(L, 500 + ob_universe_ids(r->u) / NAMES_PER_INSTRUCTION);
	ob_scene_call_joint(L);
	post_joint(L, r, OB_REQUEST_JOIN, &r->scene.joint[0], &r->scene.joint[0], sizeof r->scene.joint[0]);
	return 0;
}

static int call_unjoin(lua_State *L)
{
	const ob_script_runner *r = runner_of(L);
	const uint32_t joint = find_joint(L, r, "unjoin", true);
	const ob_joint_passport *j = joint == UINT32_MAX ? NULL : &r->data->joint[joint];
	if (j)
		post_joint(L, r, OB_REQUEST_UNJOIN, j, j, sizeof *j);
	return 0;
}

typedef struct near_object {
	double distance2;
	uint32_t id;
} near_object;

enum { NEAR_MAX = 256, NEAR_AT_ONCE = 64 }; // listed; looked at between two charges

// Inserts into a list of the nearest, in the order of distance and id. work: grows by the number of moved entries.
static uint32_t insert(near_object *list, uint32_t n, near_object o, uint32_t *work)
{
	const uint32_t last = n < NEAR_MAX ? n : NEAR_MAX;
	uint32_t at = last;
	while (at > 0 && (list[at - 1].distance2 > o.distance2 ||
			  (list[at - 1].distance2 == o.distance2 && list[at - 1].id > o.id))) {
		if (at < NEAR_MAX)
			list[at] = list[at - 1];
		at--;
	}
	*work += last - at;
	if (at < NEAR_MAX)
		list[at] = o;
	return n < NEAR_MAX ? n + 1 : n;
}

static bool is_far(const float *b, ob_vec3 p, double radius)
{
	return b[0] > p.x + radius || b[3] < p.x - radius || b[1] > p.y + radius || b[4] < p.y - radius ||
	       b[2] > p.z + radius || b[5] < p.z - radius;
}

// Returns dynamic objects whose centres are within the radius, nearest first.
static int call_near(lua_State *L)
{
	const ob_script_runner *r = runner_of(L);
	const double radius = number_at(L, 1, "near", 1e9), t = now_of(r);
	const uint32_t own_id = r->turn->object, ids = ob_universe_ids(r->u);
	const ob_motion *m = ob_newest_motion(r->u, own_id);
	const ob_vec3 here = ob_published_at(m, ob_passport_of(r->u, own_id), t).pose.p;
	near_object list[NEAR_MAX];
	uint32_t n = 0, work = 0;
	for (uint32_t id = 0; id < ids; id++) {
		if (id % NEAR_AT_ONCE == 0)
			ob_sandbox_spend(L, NEAR_AT_ONCE / 8 + work / 8), work = 0;
		if (!ob_schedule_is_dynamic(&r->data->schedule[id]) || id == own_id ||
		    is_far(r->data->bounds[id], here, radius))
			continue;
		work += 16;
		m = ob_newest_motion(r->u, id);
		const double s = t - m->t0;
		const ob_vec3 there = ob_published_stands(m, ob_passport_of(r->u, id), t)
					      ? m->p
					      : ob_madd(ob_madd(m->p, s, m->v), .5 * s * s, m->a);
		const double d2 = ob_norm2(ob_sub(there, here));
		if (d2 <= radius * radius)
			n = insert(list, n, (near_object){ d2, id }, &work);
	}
	ob_sandbox_spend(L, work / 8 + 10 * n);
	lua_createtable(L, (int)n, 0);
	for (uint32_t i = 0; i < n; i++) {
		push_object(L, r, list[i].id);
		lua_rawseti(L, -2, (lua_Integer)i + 1);
	}
	return 1;
}

// ray(from, direction [, length]): the object, the distance, the normal; nothing without a hit.
static int call_ray(lua_State *L)
{
	const ob_script_runner *r = runner_of(L);
	ob_vec3 from, direction;
	int at = 1 + vector_at(L, 1, "ray", 1e9, &from);
	at += vector_at(L, at, "ray", 1e9, &direction);
	const double length = lua_isnoneornil(L, at) ? 1e9 : number_at(L, at, "ray", 1e9), n = ob_norm(direction);
	ob_ray_hit hit;
	if (!(n > 0))
		ob_sandbox_fail(L, "ray: expected a direction that is not 0");
	if (!ob_ray_cast(L, r->u, from, ob_scale(direction, 1 / n), length, r->turn->object, &hit))
		return 0;
	push_object(L, r, hit.id);
	lua_pushnumber(L, hit.distance);
	return 2 + push_vector(L, hit.normal);
}

// ---- self.state, and methods of all objects

// The bytes of the state are searched for the key.
static const ob_flat *searched_state(lua_State *L)
{
	const ob_flat *s = &runner_of(L)->state;
	ob_sandbox_spend(L, 4 + s->size / 32);
	return s;
}

static int state_get(lua_State *L)
{
	ob_flat_get(L, searched_state(L), 2);
	return 1;
}

static int state_set(lua_State *L)
{
	searched_state(L);
	ob_flat_set(L, &runner_of(L)->state, 2, 3, "self.state");
	return 0;
}

// pairs() of self.state and of frozen tables; upvalue 1 is the scene's.
static int call_pairs(lua_State *L)
{
	if (luaL_testudata(L, 1, "state")) {
		const ob_flat *s = searched_state(L);
		ob_flat_push_table(L, s->bytes, s->size);
		lua_replace(L, 1);
	} else {
		ob_script_thaw(L, 1);
	}
	lua_settop(L, 1);
	return lua_tocfunction(L, lua_upvalueindex(1)) ? (lua_pushvalue(L, lua_upvalueindex(1)), lua_insert(L, 1),
							  lua_call(L, 1, LUA_MULTRET), lua_gettop(L))
						       : 0;
}

// Upvalue 1: the methods; 2: the state.
static int object_index(lua_State *L)
{
	lua_pushvalue(L, 2);
	if (lua_rawget(L, lua_upvalueindex(1)) != LUA_TNIL)
		return 1;
	const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "?";
	if (strcmp(name, "state") != 0)
		ob_sandbox_fail(L, "%.40s: objects have none", name);
	own(L, "state");
	lua_pushvalue(L, lua_upvalueindex(2));
	return 1;
}

static int refuse_field(lua_State *L)
{
	ob_sandbox_fail(L, "cannot set %.40s of an object: values are kept in self.state",
			lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "a field");
}

static int object_equal(lua_State *L)
{
	const ob_flat_object *a = luaL_testudata(L, 1, OB_FLAT_OBJECT), *b = luaL_testudata(L, 2, OB_FLAT_OBJECT);
	lua_pushboolean(L, a && b && a->id == b->id && a->generation == b->generation);
	return 1;
}

static int object_text(lua_State *L)
{
	const ob_script_runner *r = ob_sandbox_user(L);
	const ob_flat_object *o = object_at(L, 1, "tostring");
	ob_sandbox_spend(L, 24);
	const ob_passport *p = r->turn ? passport_of(r, o) : NULL;
	lua_pushfstring(L, "object %d%s%s%s", (int)o->id, p ? " (" : "", p ? p->name : "", p ? ")" : "");
	return 1;
}

static const luaL_Reg methods[] = {
	{ "exists", call_exists },
	{ "id", call_id },
	{ "name", call_name },
	{ "mass", call_mass },
	{ "position", call_position },
	{ "velocity", call_velocity },
	{ "spin", call_spin },
	{ "attitude", call_attitude },
	{ "turned", call_turned },
	{ "inside", call_inside },
	{ "force", call_force },
	{ "torque", call_torque },
	{ "push", call_push },
	{ "twist", call_twist },
	{ "colour", call_colour },
	{ "wake", call_wake },
	{ "remove", call_remove },
	{ "set_velocity", call_set_velocity },
	{ "set_spin", call_set_spin },
	{ "set_path", call_set_path },
	{ "set_surface_velocity", call_set_surface_velocity },
	{ NULL, NULL },
};

static void open_objects(lua_State *L)
{
	luaL_newmetatable(L, "state");
	lua_pushcfunction(L, state_get);
	lua_setfield(L, -2, "__index");
	lua_pushcfunction(L, state_set);
	lua_setfield(L, -2, "__newindex");
	lua_pop(L, 1);
	luaL_newmetatable(L, OB_FLAT_OBJECT);
	luaL_newlib(L, methods);
	lua_newuserdatauv(L, 1, 0);
	luaL_setmetatable(L, "state");
	lua_pushcclosure(L, object_index, 2);
	lua_setfield(L, -2, "__index");
	lua_pushcfunction(L, refuse_field);
	lua_setfield(L, -2, "__newindex");
	lua_pushcfunction(L, object_equal);
	lua_setfield(L, -2, "__eq");
	lua_pushcfunction(L, object_text);
	lua_setfield(L, -2, "__tostring");
	lua_pop(L, 1);
}

int ob_script_calls_open(lua_State *L)
{
	static const luaL_Reg calls[] = {
		{ "time", call_time },
		{ "find", call_find },
		{ "near", call_near },
		{ "joint", call_joint },
		{ "unjoin", call_unjoin },
		{ "joint_load", call_joint_load },
		{ "motor", call_motor },
		{ "ray", call_ray },
		{ "sense", ob_script_call_sense },
		{ "send", call_send },
		{ "random", ob_scene_call_random },
		{ "random_rotation", ob_scene_call_random_rotation },
	};
	open_objects(L);
	lua_pushglobaltable(L);
	for (size_t i = 0; i < sizeof calls / sizeof *calls; i++) {
		lua_pushcfunction(L, calls[i].func);
		lua_setfield(L, -2, calls[i].name);
	}
	for (int shape = OB_SHAPE_NONE + 1; shape < OB_SHAPE_KINDS; shape++) {
		if (!ob_shape_is_bounded((ob_shape)shape))
			continue;
		lua_pushinteger(L, shape);
		lua_pushcclosure(L, call_create, 1);
		lua_setfield(L, -2, ob_shape_name((ob_shape)shape));
	}
	for (uint32_t kind = 0; kind < OB_JOINT_KINDS; kind++) {
		lua_pushinteger(L, kind);
		lua_pushcclosure(L, call_join, 1);
		lua_setfield(L, -2, ob_joint_kind_name(kind));
	}
	lua_getfield(L, -1, "pairs");
	lua_pushcclosure(L, call_pairs, 1);
	lua_setfield(L, -2, "pairs");
	lua_getfield(L, -1, "math");
	lua_pushcfunction(L, ob_scene_call_random_integer);
	lua_setfield(L, -2, "random");
	lua_pop(L, 1);
	ob_flat_object *self = lua_newuserdatauv(L, sizeof *self, 0);
	*self = (ob_flat_object){ UINT32_MAX, 0 };
	luaL_setmetatable(L, OB_FLAT_OBJECT);
	lua_setfield(L, -2, "self");
	return 0;
}

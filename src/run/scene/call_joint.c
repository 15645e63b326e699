// ball, hinge, slider, fixed, universal, distance: joints of two objects, or of one and the world. apart: two objects
// that pass through each other.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/number.h"
#include "base/spelling.h"
#include "scene/builder.h"
#include "scene/object_limits.h"
#include "scene/sandbox.h"

#define OB_SCENE_JOINTS_MAX 1000000
#define OB_TURN_MOST 6.2 // rad, between the limits of a hinge

// Fields of a call; NaN = not set.
typedef struct joint {
	ob_vec3 at, axis, across, from, to;
	ob_quat q;
	double length;
	const char *name;
	bool collide, motor, breaks_at, second;
	ob_joint_axis along; // low, high, rest and motor_target may be NaN
} joint;

#define F(member, ...) OB_FIELD(joint, member, .name = #member, __VA_ARGS__)
#define PLACE(member) F(member, .kind = OB_FIELD_VECTOR, .low = -OB_PLACE_MOST, .high = OB_PLACE_MOST)
#define REQUIRED_PLACE(member) \
	F(member, .kind = OB_FIELD_VECTOR, .low = -OB_PLACE_MOST, .high = OB_PLACE_MOST, .required = true)
#define DIRECTION(member) F(member, .kind = OB_FIELD_DIRECTION, .required = true)
#define AXIS_OR_FRAME F(axis, .kind = OB_FIELD_DIRECTION), F(q, .kind = OB_FIELD_QUATERNION)
#define ALONG(member, ...) OB_FIELD(joint, along.member, .name = #member, .kind = OB_FIELD_NUMBER, __VA_ARGS__)
#define AXIS(most_value) \
	ALONG(low, .low = -(most_value), .high = (most_value)), \
		ALONG(high, .low = -(most_value), .high = (most_value)), ALONG(restitution, .high = 1), \
		ALONG(stiffness, .high = OB_JOINT_MOST), ALONG(rest, .low = -(most_value), .high = (most_value)), \
		ALONG(damping, .high = OB_JOINT_MOST), ALONG(friction, .high = OB_JOINT_MOST), \
		ALONG(armature, .high = OB_JOINT_MOST), F(motor, .kind = OB_FIELD_TABLE)
#define COMMON \
	F(name, .kind = OB_FIELD_TEXT, .high = OB_NAME_MAX - 1), F(collide, .kind = OB_FIELD_BOOLEAN), \
		F(breaks_at, .kind = OB_FIELD_TABLE)

#define BALL_MOST 3 // rad

static const ob_field ball_fields[] = { REQUIRED_PLACE(at),
					ALONG(high, .high = BALL_MOST, .above = true),
					ALONG(restitution, .high = 1),
					ALONG(stiffness, .high = OB_JOINT_MOST),
					ALONG(damping, .high = OB_JOINT_MOST),
					ALONG(armature, .high = OB_JOINT_MOST),
					COMMON };
static const ob_field fixed_fields[] = { PLACE(at), COMMON };
static const ob_field hinge_fields[] = { REQUIRED_PLACE(at), AXIS_OR_FRAME, AXIS(2 * M_PI), COMMON };
static const ob_field slider_fields[] = { PLACE(at), AXIS_OR_FRAME, AXIS(2 * OB_PLACE_MOST), COMMON };
static const ob_field universal_fields[] = { REQUIRED_PLACE(at),
					     DIRECTION(axis),
					     DIRECTION(across),
					     AXIS(2 * M_PI),
					     F(second, .kind = OB_FIELD_TABLE),
					     COMMON };
static const ob_field second_fields[] = { AXIS(2 * M_PI) };
static const ob_field distance_fields[] = {
	PLACE(from), PLACE(to), F(length, .kind = OB_FIELD_NUMBER, .low = OB_LENGTH_LEAST, .high = 2 * OB_PLACE_MOST),
	AXIS(2 * OB_PLACE_MOST), COMMON
};

// Fields of a motor; NaN = not set.
typedef struct motor {
	double rate, to, most, stiffness, damping;
} motor;

#define MOTOR(member, ...) OB_FIELD(motor, member, .name = #member, .kind = OB_FIELD_NUMBER, __VA_ARGS__)
static const ob_field motor_fields[] = { MOTOR(rate, .low = -OB_JOINT_MOST, .high = OB_JOINT_MOST),
					 MOTOR(to, .low = -OB_JOINT_MOST, .high = OB_JOINT_MOST),
					 MOTOR(most, .high = OB_JOINT_MOST, .above = true),
					 MOTOR(stiffness, .high = OB_JOINT_MOST, .above = true),
					 MOTOR(damping, .high = OB_JOINT_MOST) };

// Fields of breaks_at.
typedef struct strength {
	double force, torque;
} strength;

#define STRENGTH(member) \
	OB_FIELD(strength, member, .name = #member, .kind = OB_FIELD_NUMBER, .high = OB_JOINT_MOST, .above = true)
static const ob_field strength_fields[] = { STRENGTH(force), STRENGTH(torque) };

// apart has none.
static const struct {
	const ob_field *field;
	size_t fields;
} calls[OB_JOINT_KINDS] = {
	[OB_JOINT_BALL] = { ball_fields, sizeof ball_fields / sizeof *ball_fields },
	[OB_JOINT_HINGE] = { hinge_fields, sizeof hinge_fields / sizeof *hinge_fields },
	[OB_JOINT_SLIDER] = { slider_fields, sizeof slider_fields / sizeof *slider_fields },
	[OB_JOINT_FIXED] = { fixed_fields, sizeof fixed_fields / sizeof *fixed_fields },
	[OB_JOINT_UNIVERSAL] = { universal_fields, sizeof universal_fields / sizeof *universal_fields },
	[OB_JOINT_DISTANCE] = { distance_fields, sizeof distance_fields / sizeof *distance_fields },
};

// ---- objects

static _Noreturn void fail_name(lua_State *L, const ob_scene *s, const char *kind, const char *name)
{
	ob_spelling spelling = ob_spelling_start(name);
	for (uint32_t i = 0; i < s->objects; i++)
		ob_spelling_offer(&spelling, s->object[i].passport.name);
	if (spelling.best)
		ob_sandbox_fail(L, "%s: unknown object \"%s\", did you mean \"%s\"?", kind, name, spelling.best);
	ob_sandbox_fail(L, "%s: expected the name of an object declared before, got \"%s\"", kind, name);
}

// The last ones are joined most often.
void ob_builder_find_object(lua_State *L, const ob_scene *s, const char *kind, const char *name, ob_joined *to)
{
	enum { NAMES_PER_INSTRUCTION = 4 };
	uint32_t i = s->objects;
	while (i > 0 && strcmp(s->object[i - 1].passport.name, name) != 0)
		i--;
	if (i-- == 0)
		fail_name(L, s, kind, name);
	const ob_object_def *o = &s->object[i];
	ob_sandbox_spend(L, (s->objects - i) / NAMES_PER_INSTRUCTION);
	if (o->born > 0)
		ob_sandbox_fail(L, "%s: expected objects that are there from the start, \"%s\" is born at %.10g", kind,
				name, o->born);
	*to = (ob_joined){ i, 1, !(o->passport.flags & OB_OBJECT_PRESCRIBED), o->state.pose };
}

static void read_object(lua_State *L, const ob_builder *b, const char *kind, int place, ob_joined *to)
{
	const ob_scene_options *o = b->options;
	const int type = lua_rawgeti(L, 1, place);
	*to = (ob_joined){ .id = OB_JOINT_WORLD, .generation = 1, .pose.q = ob_quat_identity() };
	if (type == LUA_TNIL && place == 2) {
		lua_pop(L, 1);
		return;
	}
	if (type != LUA_TSTRING)
		ob_sandbox_fail(L, "%s: expected names of one or two objects, as in %s { \"door\", \"frame\", ... }",
				kind, kind);
	const char *name = lua_tostring(L, -1);
	if (!o->find)
		ob_builder_find_object(L, b->scene, kind, name, to);
	else if (!o->find(o->with, name, to))
		ob_sandbox_fail(L, "%s: expected the name of an object, got \"%s\"", kind, name);
	lua_pop(L, 1);
}

// Reads the two names, and replaces the table by a copy without them.
static void read_objects(lua_State *L, const ob_builder *b, const char *kind, ob_joined end[2], ob_joint_passport *j)
{
	if (!lua_istable(L, 1))
		ob_sandbox_fail(L, "%s: expected a table, as in %s { \"door\", \"frame\", ... }", kind, kind);
	for (int side = 0; side < 2; side++) {
		read_object(L, b, kind, 1 + side, &end[side]);
		j->object[side] = end[side].id, j->generation[side] = end[side].generation;
	}
	if (j->kind == OB_JOINT_APART && j->object[1] == OB_JOINT_WORLD)
		ob_sandbox_fail(L, "%s: expected names of two objects", kind);
	if (!ob_joint_exists(j)) {
		lua_rawgeti(L, 1, 1);
		ob_sandbox_fail(L, "%s: expected two different objects, got \"%s\" twice", kind, lua_tostring(L, -1));
	}
	if (!end[0].moved && !end[1].moved)
		ob_sandbox_fail(L, "%s: expected an object that is neither static nor kinematic", kind);
	lua_newtable(L);
	for (lua_pushnil(L); lua_next(L, 1);) {
		lua_pushvalue(L, -2);
		lua_insert(L, -2);
		if (lua_isinteger(L, -2) && (lua_tointeger(L, -2) == 1 || lua_tointeger(L, -2) == 2))
			lua_pop(L, 2);
		else
			lua_rawset(L, -4);
	}
	lua_replace(L, 1);
}

// ---- frames

// Frame in that of the object, as it is.
static ob_pose in_object(const ob_joined *o, ob_pose frame)
{
	const ob_mat3 r = ob_quat_matrix(o->pose.q);
	if (o->id == OB_JOINT_WORLD)
		return frame;
	return (ob_pose){ ob_rotate_back(&r, ob_sub(frame.p, o->pose.p)),
			  ob_quat_mul(ob_quat_conjugate(o->pose.q), frame.q) };
}

// Attitude of a frame with its x axis along the first, and its y axis along the second, as far as that is across.
static ob_quat cross_frame(lua_State *L, ob_vec3 x, ob_vec3 y)
{
	const ob_vec3 across = ob_madd(y, -ob_dot(x, y), x), normal = ob_cross(x, y);
	const double least = 1e-3, length = ob_norm(normal);
	if (!(ob_norm(across) > least))
		ob_sandbox_fail(L, "universal.across: expected a direction across axis");
	const ob_vec3 z = ob_scale(normal, 1 / length);
	const ob_quat q = ob_scene_turn_to(z);
	const ob_mat3 r = ob_quat_matrix(q);
	const double c = ob_dot(ob_column(&r, 0), x), s = ob_dot(ob_column(&r, 1), x);
	const double w = sqrt(ob_max(0, .5 * (1 + c))), turn = copysign(sqrt(ob_max(0, .5 * (1 - c))), s);
	return ob_quat_normalize(ob_quat_mul(q, (ob_quat){ w, 0, 0, turn }));
}

static void set_frames(lua_State *L, const ob_joined end[2], const joint *d, ob_joint_passport *j)
{
	const ob_vec3 first = end[0].pose.p, second = end[1].id == OB_JOINT_WORLD ? first : end[1].pose.p;
	ob_pose frame[2] = { { first, ob_quat_identity() }, { second, ob_quat_identity() } };
	if (j->kind == OB_JOINT_DISTANCE) {
		frame[0].p = isnan(d->from.x) ? first : d->from;
		frame[1].p = isnan(d->to.x) ? second : d->to;
		const double apart = ob_norm(ob_sub(frame[0].p, frame[1].p));
		j->length = isnan(d->length) ? apart : d->length;
		if (!(apart >= OB_LENGTH_LEAST))
			ob_sandbox_fail(L, "distance: expected two points that are apart: give it from and to");
		if (fabs(j->length - apart) > 1e-6 * apart)
			ob_sandbox_fail(L, "distance.length: expected %.10g, as far as its points are apart, got %.10g",
					apart, j->length);
	} else {
		frame[0].p = isnan(d->at.x) ? first : d->at;
		frame[0].q = j->kind == OB_JOINT_UNIVERSAL ? cross_frame(L, d->axis, d->across)
			     : !isnan(d->q.w)              ? d->q
			     : isnan(d->axis.x)            ? ob_quat_identity()
							   : ob_scene_turn_to(d->axis);
		frame[1] = frame[0];
	}
	for (int side = 0; side < 2; side++)
		j->frame[side] = in_object(&end[side], frame[side]);
}

// ---- the axis

// Reads the motor's table, of the table at the top of the stack.
static void read_motor(lua_State *L, const char *kind, ob_joint_axis *a)
{
	enum { NAME = 40 };
	char where[NAME];
	motor m = { NAN, NAN, INFINITY, NAN, 0 };
	snprintf(where, sizeof where, "%s.motor", kind);
	lua_getfield(L, -1, "motor");
	ob_fields_read(L, lua_gettop(L), where, motor_fields, sizeof motor_fields / sizeof *motor_fields, &m);
	lua_pop(L, 1);
	if (isnan(m.rate) == isnan(m.to))
		ob_sandbox_fail(L, "%s: expected the rate that it holds, or the value that it pulls to", where);
	if (isnan(m.to) != isnan(m.stiffness))
		ob_sandbox_fail(L, "%s: expected a stiffness where it pulls to a value, and only there", where);
	if (!isnan(m.rate) && m.damping > 0)
		ob_sandbox_fail(L, "%s: expected damping only where it pulls to a value", where);
	a->motor = isnan(m.to) ? OB_MOTOR_RATE : OB_MOTOR_VALUE;
	a->target = isnan(m.to) ? m.rate : m.to;
	a->most = m.most;
	a->motor_stiffness = isnan(m.to) ? 0 : m.stiffness;
	a->motor_damping = m.damping;
}

// Reads the table of breaks_at, of the call's table at place 1.
static void set_strength(lua_State *L, const char *kind, const joint *d, ob_joint_passport *j)
{
	enum { NAME = 40 };
	char where[NAME];
	strength s = { INFINITY, INFINITY };
	if (d->breaks_at) {
		snprintf(where, sizeof where, "%s.breaks_at", kind);
		lua_getfield(L, 1, "breaks_at");
		ob_fields_read(L, lua_gettop(L), where, strength_fields,
			       sizeof strength_fields / sizeof *strength_fields, &s);
		lua_pop(L, 1);
		if (isinf(s.force) && isinf(s.torque))
			ob_sandbox_fail(L, "%s: expected a force (N), a torque (N m), or both", where);
	}
	j->breaks_force = s.force, j->breaks_torque = s.torque;
}

// Sets an axis that the table at the top of the stack has, and that has been read.
static void set_axis(lua_State *L, const char *kind, const joint *d, ob_joint_passport *j, ob_joint_axis *a)
{
	const bool turns = j->kind == OB_JOINT_HINGE || j->kind == OB_JOINT_UNIVERSAL;
	*a = d->along;
	const bool limited = !isnan(a->low) || !isnan(a->high);
	a->low = isnan(a->low) ? -INFINITY : a->low;
	a->high = isnan(a->high) ? INFINITY : a->high;
	if (isnan(a->rest))
		a->rest = j->kind == OB_JOINT_DISTANCE ? j->length : 0;
	if (!(a->low <= a->high))
		ob_sandbox_fail(L, "%s.high: expected at least low, %s, got %s", kind, ob_number_text(a->low).text,
				ob_number_text(a->high).text);
	if (turns && limited && isfinite(a->high - a->low) && !(a->high - a->low <= OB_TURN_MOST))
		ob_sandbox_fail(L, "%s.high: expected at most %s (rad) above low, got %s", kind,
				ob_number_text(OB_TURN_MOST).text, ob_number_text(a->high - a->low).text);
	if (d->motor)
		read_motor(L, kind, a);
	if (limited || a->stiffness > 0 || a->damping > 0 || a->friction > 0 || a->armature > 0 || d->motor)
		j->flags |= OB_JOINT_DRIVEN;
	if (j->flags & OB_JOINT_DRIVEN && j->kind == OB_JOINT_DISTANCE && !isnan(d->length))
		ob_sandbox_fail(L, "distance.length: expected rest, low and high in its place where a spring, limits, "
				   "friction or a motor let the distance change");
}

// Sets the axes of both arms of a universal, or the only one.
static void set_axes(lua_State *L, const char *kind, const joint *d, ob_joint_passport *j)
{
	static const char second[] = "universal.second";
	joint other = { .length = NAN, .along = { .low = NAN, .high = NAN, .rest = NAN } };
	set_axis(L, kind, d, j, &j->axis);
	if (d->second) {
		lua_getfield(L, 1, "second");
		ob_fields_read(L, lua_gettop(L), second, second_fields, sizeof second_fields / sizeof *second_fields,
			       &other);
	}
	set_axis(L, second, &other, j, &j->second);
	lua_settop(L, 1);
}

static void set_name(lua_State *L, const ob_builder *b, const char *kind, const char *name, ob_joint_passport *j)
{
	enum { NAMES_PER_INSTRUCTION = 4 };
	const ob_scene *s = b->scene;
	if (!name && b->options->find) {
		snprintf(j->name, sizeof j->name, "%s#", kind); // the host appends its number
		return;
	}
	if (!name) {
		snprintf(j->name, sizeof j->name, "%s#%u", kind, s->joints);
		return;
	}
	ob_sandbox_spend(L, s->joints / NAMES_PER_INSTRUCTION);
	for (uint32_t i = 0; i < s->joints; i++)
		if (strcmp(s->joint[i].name, name) == 0)
			ob_sandbox_fail(L, "%s.name: \"%s\" is already the name of another joint", kind, name);
	snprintf(j->name, sizeof j->name, "%s", name);
}

static void add(lua_State *L, ob_builder *b, const char *kind, const ob_joint_passport *j)
{
	ob_scene *s = b->scene;
	if (s->joints == OB_SCENE_JOINTS_MAX)
		ob_sandbox_fail(L, "%s: expected at most %d joints in a scene", kind, OB_SCENE_JOINTS_MAX);
	OB_BUILDER_MAKE_ROOM(L, kind, s->joint, s->joints, b->joints_room);
	s->joint[s->joints++] = *j;
	ob_sandbox_extend(L, OB_SCENE_OBJECT_INSTRUCTIONS);
}

int ob_scene_call_joint(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	ob_joint_passport j = { .kind = (uint32_t)lua_tointeger(L, lua_upvalueindex(1)) };
	ob_joined end[2];
	const ob_vec3 none = { NAN, NAN, NAN };
	joint d = { .at = none, .axis = none, .across = none, .from = none, .to = none };
	d.q.w = d.length = d.along.low = d.along.high = d.along.rest = NAN;
	const char *kind = ob_joint_kind_name(j.kind);
	lua_settop(L, 1);
	read_objects(L, b, kind, end, &j);
	ob_fields_read(L, 1, kind, calls[j.kind].field, calls[j.kind].fields, &d);
	if ((j.kind == OB_JOINT_HINGE || j.kind == OB_JOINT_SLIDER) && isnan(d.axis.x) == isnan(d.q.w))
		ob_sandbox_fail(L,
				"%s.axis: expected a direction {x, y, z}, or q, the attitude of a frame whose z is the "
				"axis, got %s",
				kind, isnan(d.q.w) ? "nothing" : "both");
	j.flags = d.collide ? OB_JOINT_COLLIDES : 0;
	set_frames(L, end, &d, &j);
	set_axes(L, kind, &d, &j);
	set_strength(L, kind, &d, &j);
	set_name(L, b, kind, d.name, &j);
	add(L, b, kind, &j);
	lua_pushstring(L, j.name);
	return 1;
}

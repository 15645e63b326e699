// Prescribed behaviour of an object in time: the path of a kinematic one, { kind = "sine", amplitude = {.1, 0, 0},
// frequency = 2 } and so on; and forces that change.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <lauxlib.h>

#include "base/number.h"
#include "scene/builder.h"
#include "scene/object_limits.h"
#include "scene/sandbox.h"

enum { SINE, CIRCLE, SPLINE }; // numbers of the choices

// Fields of the table; NaN = not set.
typedef struct draft {
	uint32_t kind;
	ob_vec3 amplitude, centre, axis;
	double frequency, rate, phase; // rate: rad/s
	bool points, loop;
} draft;

#define F(member, ...) OB_FIELD(draft, member, .name = #member, __VA_ARGS__)
static const ob_field path_fields[] = {
	F(kind, .kind = OB_FIELD_CHOICE, .choices = "sine|circle|spline", .required = true),
	F(amplitude, .kind = OB_FIELD_VECTOR, .low = -1e6, .high = 1e6),
	F(frequency, .kind = OB_FIELD_NUMBER, .low = 0, .above = true, .high = 1e4),
	F(rate, .kind = OB_FIELD_NUMBER, .low = 0, .above = true, .high = 6e4),
	F(phase, .kind = OB_FIELD_NUMBER, .low = -1e3, .high = 1e3),
	F(centre, .kind = OB_FIELD_VECTOR, .low = -OB_PLACE_MOST, .high = OB_PLACE_MOST),
	F(axis, .kind = OB_FIELD_DIRECTION),
	F(points, .kind = OB_FIELD_TABLE),
	F(loop, .kind = OB_FIELD_BOOLEAN),
};

typedef struct said_field {
	const char *name;
	bool said;
	unsigned needed, allowed; // bit per kind
} said_field;

// Checks the fields of a kind: required ones are set, and others are not.
static void check_for_kind(lua_State *L, const char *where, int kind, const char *name, const said_field *fields,
			   size_t n)
{
	for (size_t i = 0; i < n; i++) {
		if (fields[i].needed >> kind & 1 && !fields[i].said)
			ob_sandbox_fail(L, "%s.%s: expected for kind = \"%s\", got nothing", where, fields[i].name,
					name);
		if (fields[i].said && !(fields[i].allowed >> kind & 1))
			ob_sandbox_fail(L, "%s.%s: expected none for kind = \"%s\"", where, fields[i].name, name);
	}
}

static void check_said(lua_State *L, const char *where, const draft *d)
{
	static const char *const kinds[] = { "sine", "circle", "spline" };
	const said_field fields[] = {
		{ "amplitude", !isnan(d->amplitude.x), 1 << SINE, 1 << SINE },
		{ "frequency", !isnan(d->frequency) || !isnan(d->rate), 1 << SINE | 1 << CIRCLE,
		  1 << SINE | 1 << CIRCLE },
		{ "phase", !isnan(d->phase), 0, 1 << SINE },
		{ "centre", !isnan(d->centre.x), 1 << CIRCLE, 1 << CIRCLE },
		{ "axis", !isnan(d->axis.x), 0, 1 << CIRCLE },
		{ "points", d->points, 1 << SPLINE, 1 << SPLINE },
		{ "loop", d->loop, 0, 1 << SPLINE },
	};
	check_for_kind(L, where, d->kind, kinds[d->kind], fields, sizeof fields / sizeof *fields);
}

static void keep_path(lua_State *L, const char *where, ob_object_def *o, const ob_path *path)
{
	o->path = ob_path_copy(path);
	if (!o->path)
		ob_sandbox_fail(L, "%s: no memory left on this machine", where);
}

static void make_sine(lua_State *L, const char *where, const draft *d, ob_object_def *o)
{
	const ob_path path = ob_path_sine(&o->state, d->amplitude, d->rate, isnan(d->phase) ? 0 : d->phase);
	keep_path(L, where, o, &path);
}

static void make_circle(lua_State *L, const char *where, const draft *d, ob_object_def *o)
{
	const ob_vec3 axis = isnan(d->axis.x) ? ob_v3(0, 0, 1) : d->axis, r = ob_sub(o->state.pose.p, d->centre);
	if (!(ob_norm(ob_cross(axis, r)) > 1e-9))
		ob_sandbox_fail(L, "%s.centre: expected a point that the axis does not lead from to the object's place",
				where);
	const ob_path path = ob_path_circle(&o->state, d->centre, axis, d->rate);
	keep_path(L, where, o, &path);
}

enum { PLACED = 4, TURNED = 8 }; // numbers of a point: time and place; with attitude

// {t, x, y, z} at the top of the stack, or with {.., qw, qx, qy, qz}; each of x, y, z up to "most"
static bool read_point(lua_State *L, double most, int numbers, ob_path_point *out)
{
	double x[TURNED] = { 0 };
	bool good = lua_istable(L, -1) && lua_rawlen(L, -1) == (size_t)numbers;
	for (int i = 0; i < numbers && good; i++) {
		good = lua_rawgeti(L, -1, i + 1) == LUA_TNUMBER;
		x[i] = lua_tonumber(L, -1);
		good = good && fabs(x[i]) <= (i ? most : OB_TIME_MOST);
		lua_pop(L, 1);
	}
	const ob_quat q = { x[4], x[5], x[6], x[7] };
	good = good && (numbers == PLACED || q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z > 1e-12);
	if (good)
		*out = (ob_path_point){ x[0], ob_v3(x[1], x[2], x[3]),
					numbers == PLACED ? ob_quat_identity() : ob_quat_normalize(q) };
	return good;
}

// Reads points as ob_builder_read_points does, each number of a place up to "most". turns: set if they have attitudes; NULL:
// attitudes are errors.
static uint32_t read_points(lua_State *L, const char *where, bool begins, double most, ob_path_point **out, bool *turns)
{
	const size_t least = begins ? 2 : 1;
	int numbers = PLACED;
	lua_getfield(L, -1, "points");
	const size_t n = lua_rawlen(L, -1);
	if (n < least || n > OB_PATH_POINTS_MAX)
		ob_sandbox_fail(L, "%s.points: expected %d to %d points {t, x, y, z}, got %d", where, (int)least,
				OB_PATH_POINTS_MAX, (int)n);
	ob_path_point *point = *out = lua_newuserdatauv(L, n * sizeof *point, 0);
	lua_insert(L, -2);
	for (size_t i = 0; i < n; i++) {
		lua_rawgeti(L, -1, (lua_Integer)i + 1);
		if (i == 0 && turns && lua_istable(L, -1) && lua_rawlen(L, -1) == TURNED)
			numbers = TURNED;
		if (!read_point(L, most, numbers, &point[i]))
			ob_sandbox_fail(L, "%s.points: expected %s as point %d", where,
					numbers == PLACED
						? "four numbers {t, x, y, z}"
						: "eight numbers {t, x, y, z, qw, qx, qy, qz}, as point 1 has,",
					(int)i + 1);
		if (i == 0 && begins ? point[0].t != 0 : !(point[i].t > (i ? point[i - 1].t : 0)))
			ob_sandbox_fail(L, "%s.points: expected times that %s and grow, got %s at point %d", where,
					begins ? "begin with 0" : "are after 0", ob_number_text(point[i].t).text,
					(int)i + 1);
		lua_pop(L, 1);
	}
	lua_pop(L, 1);
	if (turns)
		*turns = numbers == TURNED;
	return (uint32_t)n;
}

uint32_t ob_builder_read_points(lua_State *L, const char *where, bool begins, ob_path_point **out, bool *turns)
{
	return read_points(L, where, begins, OB_PLACE_MOST, out, turns);
}

// Makes rotations from the object's initial attitude, at which it must be at rest.
static void make_turns(lua_State *L, const char *where, ob_object_def *o, const ob_path *path)
{
	if (ob_norm2(o->state.w) > 0)
		ob_sandbox_fail(L, "%s.points: expected no attitudes beside a spin", where);
	for (uint32_t i = 0; i < path->points; i++)
		path->point[i].q = ob_quat_mul(path->point[i].q, o->state.pose.q);
	o->state.pose.q = path->point[0].q;
}

static void make_spline(lua_State *L, const char *where, const draft *d, ob_object_def *o)
{
	ob_path path = { .loop = d->loop };
	ob_error e;
	path.points = ob_builder_read_points(L, where, true, &path.point, &path.turns);
	if (!ob_path_check_turns(&path, &e))
		ob_sandbox_fail(L, "%s.%s", where, e.text);
	for (uint32_t i = 0; i < path.points; i++)
		path.point[i].p = ob_add(path.point[i].p, o->state.pose.p);
	if (path.turns)
		make_turns(L, where, o, &path);
	keep_path(L, where, o, &path);
	o->state.pose.p = path.point[0].p;
	lua_pop(L, 1);
}

void ob_builder_read_path(lua_State *L, const char *kind, ob_object_def *o)
{
	char where[64];
	const ob_vec3 unsaid = { NAN, NAN, NAN };
	draft d = {
		.amplitude = unsaid, .centre = unsaid, .axis = unsaid, .frequency = NAN, .rate = NAN, .phase = NAN
	};
	snprintf(where, sizeof where, "%s.path", kind);
	luaL_checkstack(L, 8, "nested too deep");
	ob_fields_read(L, -1, where, path_fields, sizeof path_fields / sizeof *path_fields, &d);
	check_said(L, where, &d);
	if (!isnan(d.rate) && !isnan(d.frequency))
		ob_sandbox_fail(L, "%s.rate: expected either frequency or rate, got both", where);
	if (isnan(d.rate))
		d.rate = 2 * M_PI * d.frequency;
	if (d.kind == SINE)
		make_sine(L, where, &d, o);
	else if (d.kind == CIRCLE)
		make_circle(L, where, &d, o);
	else
		make_spline(L, where, &d, o);
}

// ---- forces that change in time

typedef struct force_draft {
	uint32_t kind; // ob_force_kind
	ob_vec3 force;
	double frequency, phase, from, to;
	bool points;
} force_draft;

#define G(member, ...) OB_FIELD(force_draft, member, .name = #member, __VA_ARGS__)
static const ob_field force_fields[] = {
	G(kind, .kind = OB_FIELD_CHOICE, .choices = "sine|pulse|linear", .required = true),
	G(force, .kind = OB_FIELD_VECTOR, .low = -OB_FORCE_MOST, .high = OB_FORCE_MOST),
	G(frequency, .kind = OB_FIELD_NUMBER, .low = 0, .above = true, .high = 1e4),
	G(phase, .kind = OB_FIELD_NUMBER, .low = -1e3, .high = 1e3),
	G(from, .kind = OB_FIELD_NUMBER, .low = 0, .high = 1e9),
	G(to, .kind = OB_FIELD_NUMBER, .low = 0, .above = true, .high = 1e9),
	G(points, .kind = OB_FIELD_TABLE),
};

static void check_force(lua_State *L, const char *where, const force_draft *d)
{
	static const char *const kinds[] = { "sine", "pulse", "linear" };
	const said_field fields[] = {
		{ "force", !isnan(d->force.x), 3, 3 },
		{ "frequency", !isnan(d->frequency), 1 << OB_FORCE_SINE, 1 << OB_FORCE_SINE },
		{ "phase", !isnan(d->phase), 0, 1 << OB_FORCE_SINE },
		{ "from", !isnan(d->from), 0, 1 << OB_FORCE_PULSE },
		{ "to", !isnan(d->to), 1 << OB_FORCE_PULSE, 1 << OB_FORCE_PULSE },
		{ "points", d->points, 1 << OB_FORCE_LINEAR, 1 << OB_FORCE_LINEAR },
	};
	check_for_kind(L, where, d->kind, kinds[d->kind], fields, sizeof fields / sizeof *fields);
	if (d->kind == OB_FORCE_PULSE && !(d->to > (isnan(d->from) ? 0 : d->from)))
		ob_sandbox_fail(L, "%s.to: expected a time after from, got %s", where, ob_number_text(d->to).text);
}

void ob_builder_read_force(lua_State *L, const char *kind, ob_object_def *o)
{
	char where[64];
	force_draft d = { .force = { NAN, NAN, NAN }, .frequency = NAN, .phase = NAN, .from = NAN, .to = NAN };
	ob_path_point *point = NULL;
	snprintf(where, sizeof where, "%s.varying_force", kind);
	luaL_checkstack(L, 8, "nested too deep");
	ob_fields_read(L, -1, where, force_fields, sizeof force_fields / sizeof *force_fields, &d);
	check_force(L, where, &d);
	const uint32_t points =
		d.kind == OB_FORCE_LINEAR ? read_points(L, where, true, OB_FORCE_MOST, &point, NULL) : 0;
	const ob_force f = { .kind = (ob_force_kind)d.kind,
			     .force = points ? ob_v3(0, 0, 0) : d.force,
			     .frequency = isnan(d.frequency) ? 0 : 2 * M_PI * d.frequency,
			     .phase = isnan(d.phase) ? 0 : d.phase,
			     .from = isnan(d.from) ? 0 : d.from,
			     .until = isnan(d.to) ? 0 : d.to,
			     .points = points,
			     .point = point };
	o->force = ob_force_copy(&f);
	lua_pop(L, points ? 1 : 0);
	if (!o->force)
		ob_sandbox_fail(L, "%s: no memory left on this machine", where);
}

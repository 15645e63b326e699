#include "host/request_table.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/number.h"
#include "host/pull.h"

#define FIELDS(...) \
	(const ob_request_field[]) \
	{ \
		__VA_ARGS__, \
		{ \
			.name = NULL \
		} \
	}
#define NO_FIELDS FIELDS({ .name = NULL })
#define FIELD(kind, n, member) .type = OB_AS_##kind, .count = n, .at = offsetof(ob_request, member)
#define OPTIONAL .optional = true, .otherwise
#define XYZ(n) n "-X " n "-Y " n "-Z"

enum { TAKE_PART = OB_ROLE_TAKE_PART, OPERATE = OB_ROLE_OPERATE, NONE = OB_CONTROL_HELLO };

// clang-format off
const ob_request_row ob_request_rows[] = {
	// obsim send, viewers, help; fields; kind, target, role, obsim control
	{ "create", NULL, "as a scene says it",
	  FIELDS({ "text", "'sphere { radius = .3, at = { 0, 0, 5 } }'", "", FIELD(TEXT, 0, values) }),
	  OB_REQUEST_ADD, OB_TO_RUN, TAKE_PART, NONE },
	{ NULL, "create", "",
	  FIELDS({ "shape", NULL, "", FIELD(SHAPE, 1, def.passport.shape) },
		 { "size", NULL, "m", FIELD(REALS, 3, def.passport.size) },
		 { "at", NULL, "m", FIELD(REALS, 3, def.state.pose.p) },
		 { "mass", NULL, "kg", FIELD(REALS, 1, def.passport.mass) },
		 { "attitude", NULL, "w x y z", FIELD(ATTITUDE, 4, def.state.pose.q), OPTIONAL = NAN },
		 { "velocity", NULL, "m/s", FIELD(REALS, 3, def.state.v), OPTIONAL = 0 },
		 { "spin", NULL, "rad/s", FIELD(REALS, 3, def.state.w), OPTIONAL = 0 },
		 { "colour", NULL, "linear RGB", FIELD(COLOUR, 4, def.passport.colour), OPTIONAL = .6 },
		 { "friction", NULL, "", FIELD(REALS, 1, def.passport.friction), OPTIONAL = .5 },
		 { "restitution", NULL, "", FIELD(REALS, 1, def.passport.restitution), OPTIONAL = 0 },
		 { "roughness", NULL, "", FIELD(FLOATS, 1, def.passport.roughness), OPTIONAL = .45 },
		 { "metal", NULL, "", FIELD(FLOATS, 1, def.passport.metal), OPTIONAL = 0 },
		 { "name", NULL, "", FIELD(TEXT, OB_NAME_MAX, def.passport.name), OPTIONAL = 0 }),
	  OB_REQUEST_ADD, OB_TO_RUN, TAKE_PART, NONE },
	{ NULL, NULL, "", NO_FIELDS, OB_REQUEST_AVATAR, OB_TO_RUN, TAKE_PART, NONE },
	{ "remove", "remove", "by its name or number", NO_FIELDS, OB_REQUEST_REMOVE, OB_TO_OBJECT, OPERATE, OB_CONTROL_REMOVE },
	{ "colour", "edit", "", FIELDS({ "colour", "'#rrggbb'", "linear RGB", FIELD(COLOUR, 4, colour), .otherwise = 1 }),
	  OB_REQUEST_COLOUR, OB_TO_OBJECT, OPERATE, OB_CONTROL_COLOUR },
	{ "message", "message", "for its on_message", FIELDS({ "text", "VALUE ...", "words", FIELD(WORDS, 0, values) }),
	  OB_REQUEST_MESSAGE, OB_TO_OBJECT, TAKE_PART, NONE },
	{ "kick", "kick", "N s; and N m s",
	  FIELDS({ "impulse", "X Y Z", "N s", FIELD(REALS, 3, force) },
		 { "twist", XYZ("TWIST"), "N m s", FIELD(REALS, 3, twist), OPTIONAL = 0 }),
	  OB_REQUEST_KICK, OB_TO_OBJECT, OPERATE, OB_CONTROL_KICK },
	{ "torque", "turn", "N m, from now on", FIELDS({ "torque", "X Y Z", "N m", FIELD(REALS, 3, twist) }),
	  OB_REQUEST_TORQUE, OB_TO_OBJECT, TAKE_PART, OB_CONTROL_TORQUE },
	{ "push", "push", "N, at a point of it (m)",
	  FIELDS({ "force", "X Y Z", "N", FIELD(REALS, 3, force) },
		 { "point", XYZ("POINT"), "m, body frame", FIELD(REALS, 3, point), OPTIONAL = 0 }),
	  OB_REQUEST_PUSH, OB_TO_OBJECT, TAKE_PART, OB_CONTROL_PUSH },
	{ "drag", "drag", "to a place (m), by a point of it",
	  FIELDS({ "target", "X Y Z", "m", FIELD(REALS, 3, target) },
		 { "point", XYZ("POINT"), "m, body frame", FIELD(REALS, 3, point), OPTIONAL = 0 },
		 { "frequency", "HZ", "Hz", FIELD(REALS, 1, frequency), OPTIONAL = OB_PULL_FREQUENCY }),
	  OB_REQUEST_DRAG, OB_TO_OBJECT, TAKE_PART, OB_CONTROL_DRAG },
	{ "release", "release", "ends torque, push and drag", NO_FIELDS,
	  OB_REQUEST_RELEASE, OB_TO_SOME, TAKE_PART, OB_CONTROL_RELEASE },
	{ "place", "edit", "m", FIELDS({ "at", "X Y Z", "m", FIELD(REALS, 3, state.pose.p), .otherwise = NAN }),
	  OB_REQUEST_STATE, OB_TO_OBJECT, OPERATE, OB_CONTROL_STATE },
	{ "attitude", "edit", "a unit quaternion",
	  FIELDS({ "attitude", "W X Y Z", "w x y z", FIELD(ATTITUDE, 4, state.pose.q), .otherwise = NAN }),
	  OB_REQUEST_STATE, OB_TO_OBJECT, OPERATE, OB_CONTROL_STATE },
	{ "velocity", "edit", "m/s", FIELDS({ "velocity", "X Y Z", "m/s", FIELD(REALS, 3, state.v), .otherwise = NAN }),
	  OB_REQUEST_STATE, OB_TO_OBJECT, OPERATE, OB_CONTROL_STATE },
	{ "spin", "edit", "rad/s", FIELDS({ "spin", "X Y Z", "rad/s", FIELD(REALS, 3, state.w), .otherwise = NAN }),
	  OB_REQUEST_STATE, OB_TO_OBJECT, OPERATE, OB_CONTROL_STATE },
	{ "friction", "edit", "", FIELDS({ "friction", "NUMBER", "", FIELD(REALS, 1, friction) }),
	  OB_REQUEST_FRICTION, OB_TO_OBJECT, OPERATE, OB_CONTROL_FRICTION },
	{ "surface", "edit", "m/s, of a belt", FIELDS({ "surface", "X Y Z", "m/s, body frame", FIELD(REALS, 3, surface_velocity) }),
	  OB_REQUEST_SURFACE, OB_TO_OBJECT, OPERATE, OB_CONTROL_SURFACE },
	{ "force", "edit", "N, from now on", FIELDS({ "force", "X Y Z", "N", FIELD(REALS, 3, force) }),
	  OB_REQUEST_FORCE, OB_TO_OBJECT, OPERATE, OB_CONTROL_FORCE },
	{ "path", "path", "of a kinematic object: s from now on, m",
	  FIELDS({ "points", "'T X Y Z [QW QX QY QZ]' ...", "s, m, m, m in turn", FIELD(PATH, 0, path) },
		 { "loop", "loop", "", FIELD(FLAG, 1, path.loop), OPTIONAL = 0 }),
	  OB_REQUEST_PATH, OB_TO_OBJECT, OPERATE, NONE },
	{ "motor", "motor", "of a joint, by its name", FIELDS({ "value", "TARGET", "m/s, rad/s, m or rad", FIELD(REALS, 1, motor) }),
	  OB_REQUEST_MOTOR, OB_TO_JOINT, OPERATE, OB_CONTROL_MOTOR },
	{ "unjoin", "unjoin", "removes a joint", NO_FIELDS, OB_REQUEST_UNJOIN, OB_TO_JOINT, OPERATE, OB_CONTROL_UNJOIN },
	{ NULL, NULL, "", NO_FIELDS, OB_REQUEST_JOIN, OB_TO_OBJECT, OPERATE, NONE },
	{ "move", NULL, "its simulator, to another worker", FIELDS({ "worker", "WORKER", "the number of a worker", FIELD(ID, 1, worker) }),
	  OB_REQUEST_MOVE, OB_TO_OBJECT, OPERATE, NONE },
	{ "kill", "kill", "its simulator", NO_FIELDS, OB_REQUEST_KILL, OB_TO_OBJECT, OPERATE, OB_CONTROL_KILL },
	{ "keep", "keep", "a snapshot of a served universe", NO_FIELDS, OB_REQUEST_KEEP, OB_TO_RUN, OPERATE, NONE },
	{ "return", "return", "to that snapshot, or to the start", NO_FIELDS, OB_REQUEST_RETURN, OB_TO_RUN, OPERATE, NONE },
	{ "restart", "restart", "to the start", NO_FIELDS, OB_REQUEST_RESTART, OB_TO_RUN, OPERATE, NONE },
	{ "set", "set", "starts anew with another parameter",
	  FIELDS({ "name", "PARAMETER", "", FIELD(TEXT, OB_NAME_MAX, values) },
		 { "value", "NUMBER", "", FIELD(ASSIGNED, 1, values) }),
	  OB_REQUEST_SET, OB_TO_RUN, OPERATE, NONE },
	{ "seed", "seed", "starts anew with another seed",
	  FIELDS({ "value", "NUMBER", "a whole number", FIELD(WHOLE, 1, seed) }),
	  OB_REQUEST_SEED, OB_TO_RUN, OPERATE, NONE },
	{ "save", NULL, "a served universe, as a checkpoint", FIELDS({ "path", "FILE", "", FIELD(TEXT, 0, values) }),
	  OB_REQUEST_SAVE, OB_TO_RUN, OPERATE, NONE },
	{ NULL, "save", "", NO_FIELDS, OB_REQUEST_SAVE, OB_TO_RUN, OPERATE, NONE },
	{ "pause", "pause", "a served universe", NO_FIELDS, OB_REQUEST_PAUSE, OB_TO_RUN, OPERATE, NONE },
	{ "resume", "resume", "", NO_FIELDS, OB_REQUEST_RESUME, OB_TO_RUN, OPERATE, NONE },
	{ "step", "step", "while time stands (1)",
	  FIELDS({ "steps", "STEPS", "a number of steps", 1, OB_REQUEST_STEPS, FIELD(WHOLE, 1, steps), OPTIONAL = 1 }),
	  OB_REQUEST_STEP, OB_TO_RUN, OPERATE, NONE },
	{ "until", "until", "this simulated time, and stands", FIELDS({ "value", "SECONDS", "s", FIELD(REALS, 1, until) }),
	  OB_REQUEST_UNTIL, OB_TO_RUN, OPERATE, NONE },
	{ "rate", "rate", "simulated seconds a second; 0: as fast as it can",
	  FIELDS({ "rate", "NUMBER", "s a s", 0, OB_REQUEST_RATE_MOST, FIELD(REALS, 1, rate) }),
	  OB_REQUEST_RATE, OB_TO_RUN, OPERATE, NONE },
	{ "wait", NULL, "until so many steps are complete", FIELDS({ "step", "STEP", "a whole number", FIELD(WHOLE, 1, steps) }),
	  OB_LOOK_WAIT, OB_TO_RUN, OB_ROLE_WATCH, NONE },
	{ "contacts", NULL, "prints those of the last step", FIELDS({ "object", "OBJECT", "", FIELD(TEXT, OB_NAME_MAX, values), OPTIONAL = 0 }),
	  OB_LOOK_POINTS, OB_TO_RUN, OB_ROLE_WATCH, NONE },
	{ "sensors", NULL, "prints their newest samples", FIELDS({ "sensor", "SENSOR", "", FIELD(TEXT, OB_NAME_MAX, values), OPTIONAL = 0 }),
	  OB_LOOK_SENSED, OB_TO_RUN, OB_ROLE_WATCH, NONE },
	{ NULL, "contacts", "", FIELDS({ "on", NULL, "", FIELD(FLAG, 1, on) }), OB_LOOK_CONTACTS, OB_TO_RUN, OB_ROLE_WATCH, NONE },
	{ NULL, "joints", "", FIELDS({ "on", NULL, "", FIELD(FLAG, 1, on) }), OB_LOOK_JOINTS, OB_TO_RUN, OB_ROLE_WATCH, NONE },
	{ NULL, "simulators", "", FIELDS({ "on", NULL, "", FIELD(FLAG, 1, on) }), OB_LOOK_SIMULATORS, OB_TO_RUN, OB_ROLE_WATCH, NONE },
	{ NULL, "energy", "", FIELDS({ "on", NULL, "", FIELD(FLAG, 1, on) }), OB_LOOK_ENERGY, OB_TO_RUN, OB_ROLE_WATCH, NONE },
	{ NULL, "anew", "", NO_FIELDS, OB_LOOK_ANEW, OB_TO_RUN, OB_ROLE_WATCH, NONE },
	{ NULL, "inspect", "", NO_FIELDS, OB_LOOK_INSPECT, OB_TO_SOME, OB_ROLE_WATCH, NONE },
	{ .kind = OB_REQUEST_ROWS_END },
};
// clang-format on

const ob_request_field *ob_request_target_fields(ob_request_target to)
{
	static const ob_request_field none = { .name = NULL },
				      object[] = { { "id", "", "", FIELD(ID, 1, id) },
						   { "generation", "", "", FIELD(ID, 1, generation) },
						   { .name = NULL } },
				      some[] = { { "id", "", "", FIELD(ID, 1, id), OPTIONAL = UINT32_MAX },
						 { .name = NULL } },
				      joint[] = { { "name", "", "", FIELD(TEXT, OB_NAME_MAX, values) },
						  { .name = NULL } };
	static const ob_request_field *const fields[OB_TARGETS] = { &none, object, some, joint };
	return fields[to];
}

const ob_request_row *ob_request_row_of(uint32_t kind)
{
	const ob_request_row *row = ob_request_rows;
	while (row->kind != OB_REQUEST_ROWS_END && row->kind != kind)
		row++;
	return row->kind == OB_REQUEST_ROWS_END ? NULL : row;
}

const ob_request_row *ob_request_row_of_control(uint32_t command)
{
	const ob_request_row *row = ob_request_rows;
	while (row->kind != OB_REQUEST_ROWS_END && (row->control == OB_CONTROL_HELLO || row->control != command))
		row++;
	return row->kind == OB_REQUEST_ROWS_END ? NULL : row;
}

void ob_request_begin(ob_request *r, const ob_request_row *row)
{
	*r = (ob_request){ .kind = row->kind, .id = row->to == OB_TO_SOME ? UINT32_MAX : 0 };
	for (row = ob_request_row_of(row->kind); row->kind == r->kind; row++)
		for (const ob_request_field *f = row->field; f->name; f++)
			for (uint32_t i = 0; i < f->count && f->otherwise != 0; i++)
				ob_request_put(r, f, i, f->type == OB_AS_COLOUR && i == 3 ? 1 : f->otherwise);
}

void ob_request_put(ob_request *r, const ob_request_field *f, uint32_t i, double value)
{
	char *const to = (char *)r + f->at;
	const float single = (float)value;
	const uint32_t id = value >= 0 && value < UINT32_MAX ? (uint32_t)value : UINT32_MAX, flag = value != 0;
	const uint64_t whole = value >= 0 && value < 0x1p64 ? (uint64_t)value : UINT64_MAX;
	switch (f->type) {
	case OB_AS_REALS:
	case OB_AS_ATTITUDE:
		memcpy(to + i * sizeof value, &value, sizeof value);
		break;
	case OB_AS_FLOATS:
	case OB_AS_COLOUR:
		memcpy(to + i * sizeof single, &single, sizeof single);
		break;
	case OB_AS_ID:
		memcpy(to, &id, sizeof id);
		break;
	case OB_AS_FLAG:
		memcpy(to, &flag, sizeof flag);
		break;
	case OB_AS_WHOLE:
		memcpy(to, &whole, sizeof whole);
		break;
	default:;
	}
}

uint32_t ob_request_put_numbers(ob_request *r, const double *value, uint32_t n)
{
	uint32_t at = 0;
	for (const ob_request_row *row = ob_request_row_of(r->kind); row->kind == r->kind; row++)
		for (const ob_request_field *f = row->field; f->name; f++)
			for (uint32_t i = 0; i < f->count; i++, at++)
				if (at < n && (value[at] != 0 || !f->optional))
					ob_request_put(r, f, i, value[at]);
	return at;
}

bool ob_request_check_bounds(const ob_request *r, const ob_request_row *row, ob_error *e)
{
	for (const ob_request_field *f = row->field; f->name; f++) {
		double value;
		uint64_t whole;
		if (f->least == f->most)
			continue;
		memcpy(&value, (const char *)r + f->at, sizeof value);
		memcpy(&whole, &value, sizeof whole);
		value = f->type == OB_AS_WHOLE ? (double)whole : value;
		if (!(value >= f->least && value <= f->most))
			return ob_fail(e, "%s: expected %s%.10g to %.10g, got %s", f->name,
				       f->type == OB_AS_WHOLE ? "" : "a number from ", f->least, f->most,
				       ob_number_text(value).text);
	}
	return true;
}

void ob_request_usage(const ob_request_row *row, char *to, size_t size)
{
	static const char *const target[OB_TARGETS] = { "", " OBJECT", " OBJECT", " JOINT" };
	size_t n = (size_t)snprintf(to, size, "%s%s", row->verb, target[row->to]);
	for (const ob_request_field *f = row->field; f->name && n < size; f++)
		n += (size_t)snprintf(to + n, size - n, f->optional ? " [%s]" : " %s", f->words);
}

#include "host/request_table.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "host/pull.h"
#include "scene/object_limits.h"
#include "shape/shape.h"

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
		 { "friction", NULL, "", FIELD(REALS, 1, def.passport.friction), OPTIONAL = OB_FRICTION_USUAL },
		 { "restitution", NULL, "", FIELD(REALS, 1, def.passport.restitution), OPTIONAL = 0 },
		 { "roughness", NULL, "", FIELD(FLOATS, 1, def.passport.roughness), OPTIONAL = OB_ROUGHNESS_USUAL },
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

// ---- role

const char *ob_role_name(ob_role role)
{
	static const char *const names[OB_ROLES] = { "watch", "take part", "operate" };
	return names[role];
}

bool ob_role_check(ob_role role, ob_role needed, ob_error *e)
{
	if (role >= needed)
		return true;
	if (role == OB_ROLE_WATCH)
		return ob_fail(e, "viewers of this universe may change nothing");
	return ob_fail(e,
		       "visitors may %s; this is for those who %s: the user whose universe it is, and holders of the "
		       "first address that obsim serve has printed",
		       ob_role_name(role), ob_role_name(needed));
}

// ---- request words

// Fields of requests from words: of a command line, and of a viewer's command.

static ob_words read_numbers(ob_request *r, const ob_request_field *f, uint32_t count, ob_words word, const char *what,
			     ob_error *e)
{
	static const char *const some[] = { "", "a number", "", "three numbers after the object",
					    "four numbers after the object" };
	for (uint32_t i = 0; i < count; i++, word++) {
		char *end;
		const char *text = *word ? *word : "";
		ob_request_put(r, f, i, strtod(text, &end));
		if (!*text || *end) {
			ob_fail(e, "%s: expected %s, got \"%s\"", what, some[count], text);
			return NULL;
		}
	}
	return word;
}

static bool read_colour(ob_request *r, const ob_request_field *f, const char *word, const char *what, ob_error *e)
{
	float colour[4];
	if (!ob_scene_read_colour(word, colour))
		return ob_fail(e, "%s: expected \"#rrggbb\", got \"%s\"", what, word);
	memcpy((char *)r + f->at, colour, sizeof colour);
	return true;
}

static bool read_whole(ob_request *r, const ob_request_field *f, const char *word, const char *what, ob_error *e)
{
	const uint64_t most = f->type == OB_AS_ID ? UINT32_MAX : UINT64_MAX;
	char *end;
	errno = 0;
	const uint64_t number = strtoull(word, &end, 10);
	const uint32_t id = (uint32_t)number;
	if (strspn(word, "0123456789") == 0 || *end || errno || number > most)
		return ob_fail(e, "%s: expected %s, got \"%s\"", what, *f->unit ? f->unit : "a whole number", word);
	memcpy((char *)r + f->at, f->type == OB_AS_ID ? (const void *)&id : &number,
	       f->type == OB_AS_ID ? sizeof id : sizeof number);
	return true;
}

// Appends text to a member of so many bytes, with the 0 that ends it.
static bool append(char *to, size_t room, const char *text, const char *what, ob_error *e)
{
	const size_t have = strlen(to);
	return snprintf(to + have, room - have, "%s", text) < (int)(room - have) ||
	       ob_fail(e, "%s: expected at most %zu bytes in all", what, room - 1);
}

// Reads "NUMBER" as "=NUMBER" behind the name.
static bool read_assigned(ob_request *r, const char *word, const char *what, ob_error *e)
{
	char *end, *const to = (char *)r->values;
	(void)strtod(word, &end);
	if (!*word || *end)
		return ob_fail(e, "%s: expected a number, got \"%s\"", what, word);
	return append(to, sizeof r->values, "=", what, e) && append(to, sizeof r->values, word, what, e);
}

// True for a shape whose size says all.
static bool is_offered(ob_shape shape)
{
	return ob_shape_is_bounded(shape) && !ob_shape_is(shape, OB_HULLED);
}

static bool read_shape(ob_request *r, const char *word, const char *what, ob_error *e)
{
	char text[128] = "";
	r->def.passport.shape = (uint8_t)ob_shape_named(word);
	if (is_offered((ob_shape)r->def.passport.shape))
		return true;
	for (int s = OB_SHAPE_NONE + 1; s < OB_SHAPE_KINDS; s++)
		if (is_offered((ob_shape)s))
			snprintf(text + strlen(text), sizeof text - strlen(text), " %s", ob_shape_name((ob_shape)s));
	return ob_fail(e, "%s: expected one of%s", what, text);
}

// Reads a point of a path from one word: "T X Y Z", or "T X Y Z QW QX QY QZ", as the first one has it.
static bool read_point(const char *word, ob_request_path *path, ob_error *e)
{
	enum { PLACED = 4, TURNED = 8 };
	double x[TURNED] = { [PLACED] = 1 };
	int n = 0;
	const char *at = word;
	for (char *end; n < TURNED; n++, at = end) {
		x[n] = strtod(at, &end);
		if (end == at)
			break;
	}
	const bool turns = n == TURNED;
	if (at[strspn(at, " ")] || (n != PLACED && !turns) || (path->points > 0 && turns != path->turns))
		return ob_fail(e,
			       "path: expected points as '1.5 0 0 2' or, each of them, '1.5 0 0 2 1 0 0 0', got \"%s\"",
			       word);
	if (path->points == OB_REQUEST_POINTS)
		return ob_fail(e, "path: expected at most %d points", OB_REQUEST_POINTS);
	path->turns = turns;
	path->point[path->points++] = (ob_path_point){ x[0], ob_v3(x[1], x[2], x[3]), { x[4], x[5], x[6], x[7] } };
	return true;
}

ob_words ob_request_read_field(ob_request *r, const ob_request_field *f, ob_words word, const char *what, ob_error *e)
{
	bool fine = true;
	switch (f->type) {
	case OB_AS_WORDS:
		for (; fine && *word; word++)
			fine = ob_scene_put_value(*word, r->values, &r->bytes, sizeof r->values) ||
			       ob_fail(e, "message: at most %zu bytes can be sent", sizeof r->values);
		return fine ? word : NULL;
	case OB_AS_PATH: // up to the last word, or to the one before it that says "loop"
		for (; fine && *word && (word[1] || strcmp(*word, "loop") != 0); word++)
			fine = read_point(*word, &r->path, e);
		return fine ? word : NULL;
	case OB_AS_COLOUR:
		if (word[1])
			return read_numbers(r, f, 3, word, what, e);
		fine = read_colour(r, f, *word, what, e);
		break;
	case OB_AS_ID:
	case OB_AS_WHOLE:
		fine = read_whole(r, f, *word, what, e);
		break;
	case OB_AS_FLAG:
		ob_request_put(r, f, 0, strcmp(*word, "false") != 0);
		break;
	case OB_AS_SHAPE:
		fine = read_shape(r, *word, what, e);
		break;
	case OB_AS_TEXT: // one without a length is read where it is used
		fine = f->count == 0 || append((char *)r + f->at, f->count, *word, what, e);
		break;
	case OB_AS_ASSIGNED:
		fine = read_assigned(r, *word, what, e);
		break;
	default:
		return read_numbers(r, f, f->count, word, what, e);
	}
	return fine ? word + 1 : NULL;
}

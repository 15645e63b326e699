#include "serve/command.h"

#include <float.h>
#include <libwebsockets.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"
#include "host/pull.h"
#include "scene/object_limits.h"
#include "shape/shape.h"

static const char *const kinds[OB_DO_KINDS] = {
	[OB_DO_CREATE] = "create",     [OB_DO_REMOVE] = "remove",
	[OB_DO_DRAG] = "drag",         [OB_DO_PUSH] = "push",
	[OB_DO_TURN] = "turn",         [OB_DO_RELEASE] = "release",
	[OB_DO_MESSAGE] = "message",   [OB_DO_EDIT] = "edit",
	[OB_DO_KICK] = "kick",         [OB_DO_PATH] = "path",
	[OB_DO_MOTOR] = "motor",       [OB_DO_UNJOIN] = "unjoin",
	[OB_DO_KILL] = "kill",         [OB_DO_KEEP] = "keep",
	[OB_DO_RETURN] = "return",     [OB_DO_RESTART] = "restart",
	[OB_DO_SET] = "set",           [OB_DO_SEED] = "seed",
	[OB_DO_SAVE] = "save",         [OB_DO_PAUSE] = "pause",
	[OB_DO_RESUME] = "resume",     [OB_DO_STEP] = "step",
	[OB_DO_UNTIL] = "until",       [OB_DO_RATE] = "rate",
	[OB_DO_CONTACTS] = "contacts", [OB_DO_JOINTS] = "joints",
	[OB_DO_INSPECT] = "inspect",   [OB_DO_SIMULATORS] = "simulators",
	[OB_DO_ENERGY] = "energy",     [OB_DO_ANEW] = "anew",
};

enum {
	DO,
	SHAPE,
	NAME,
	TEXT,
	WORDS,
	SIZE = WORDS,
	AT,
	ATTITUDE,
	VELOCITY,
	SPIN,
	COLOUR,
	MASS,
	FRICTION,
	RESTITUTION,
	ROUGHNESS,
	METAL,
	POINT,
	TARGET,
	FORCE,
	TORQUE,
	FREQUENCY,
	ID,
	GENERATION,
	STEPS,
	RATE,
	VALUE,
	SURFACE,
	IMPULSE,
	TWIST,
	POINTS,
	LOOP,
	ON,
	FIELDS
};

static const char *const names[FIELDS] = {
	[DO] = "do",
	[SHAPE] = "shape",
	[NAME] = "name",
	[TEXT] = "text",
	[SIZE] = "size",
	[AT] = "at",
	[ATTITUDE] = "attitude",
	[VELOCITY] = "velocity",
	[SPIN] = "spin",
	[COLOUR] = "colour",
	[MASS] = "mass",
	[FRICTION] = "friction",
	[RESTITUTION] = "restitution",
	[ROUGHNESS] = "roughness",
	[METAL] = "metal",
	[POINT] = "point",
	[TARGET] = "target",
	[FORCE] = "force",
	[TORQUE] = "torque",
	[FREQUENCY] = "frequency",
	[ID] = "id",
	[GENERATION] = "generation",
	[STEPS] = "steps",
	[RATE] = "rate",
	[VALUE] = "value",
	[SURFACE] = "surface",
	[IMPULSE] = "impulse",
	[TWIST] = "twist",
	[POINTS] = "points",
	[LOOP] = "loop",
	[ON] = "on",
};
// Numbers of a field (0: a word), and their range. Those of an object are limited as all objects are, and of requests
// by the host
static const struct {
	int count;
	double low, high;
} numbers[FIELDS] = {
	[SIZE] = { 3, -DBL_MAX, DBL_MAX },
	[AT] = { 3, -DBL_MAX, DBL_MAX },
	[ATTITUDE] = { 4, -1, 1 },
	[VELOCITY] = { 3, -DBL_MAX, DBL_MAX },
	[SPIN] = { 3, -DBL_MAX, DBL_MAX },
	[COLOUR] = { 3, -DBL_MAX, DBL_MAX },
	[MASS] = { 1, -DBL_MAX, DBL_MAX },
	[FRICTION] = { 1, -DBL_MAX, DBL_MAX },
	[RESTITUTION] = { 1, -DBL_MAX, DBL_MAX },
	[ROUGHNESS] = { 1, -DBL_MAX, DBL_MAX },
	[METAL] = { 1, -DBL_MAX, DBL_MAX },
	[POINT] = { 3, -DBL_MAX, DBL_MAX },
	[TARGET] = { 3, -DBL_MAX, DBL_MAX },
	[FORCE] = { 3, -DBL_MAX, DBL_MAX },
	[TORQUE] = { 3, -DBL_MAX, DBL_MAX },
	[FREQUENCY] = { 1, -DBL_MAX, DBL_MAX },
	[ID] = { 1, 0, 4294967294. },
	[GENERATION] = { 1, 0, 4294967295. },
	[STEPS] = { 1, 1, OB_REQUEST_STEPS },
	[RATE] = { 1, 0, OB_REQUEST_RATE_MOST },
	[VALUE] = { 1, -DBL_MAX, DBL_MAX },
	[SURFACE] = { 3, -DBL_MAX, DBL_MAX },
	[IMPULSE] = { 3, -DBL_MAX, DBL_MAX },
	[TWIST] = { 3, -DBL_MAX, DBL_MAX },
};

typedef struct reading {
	ob_error *e;
	bool failed;
	int depth; // of objects and lists
	int field; // -1: unknown
	unsigned given; // bits: fields
	char word[WORDS][OB_NAME_MAX];
	double value[FIELDS][4];
	int count[FIELDS];
	double points[4 * OB_REQUEST_POINTS];
	uint32_t point_numbers;
	bool on; // or loop
} reading;

static char fail(reading *r, const char *what, const char *field)
{
	if (!r->failed)
		ob_fail(r->e, "%s%s%s", field ? field : "", field ? ": " : "", what);
	r->failed = true;
	return -1;
}

static char begin_field(reading *r, const char *path)
{
	r->field = -1;
	for (int i = 0; i < FIELDS; i++) {
		if (strcmp(path, names[i]) == 0)
			r->field = i;
	}
	if (r->field < 0)
		return fail(r, "nothing of this name is known in a command", "a field");
	if (r->given & 1u << r->field)
		return fail(r, "given twice", names[r->field]);
	r->given |= 1u << r->field;
	return 0;
}

static char take_point_number(reading *r, const char *text)
{
	if (r->depth != 2 || r->point_numbers == 4 * OB_REQUEST_POINTS)
		return fail(r, "expected a list of 64 times four numbers at most", "points");
	r->points[r->point_numbers++] = strtod(text, NULL);
	return 0;
}

static char take_number(reading *r, const char *text)
{
	int f = r->field;
	if (f == POINTS)
		return take_point_number(r, text);
	if (f < 0 || numbers[f].count == 0)
		return fail(r, "a number was not expected here", f < 0 ? NULL : names[f]);
	if (r->count[f] >= numbers[f].count || (numbers[f].count == 1) != (r->depth == 1))
		return fail(r, "not as many numbers as expected", names[f]);
	double v = strtod(text, NULL);
	if (!(v >= numbers[f].low && v <= numbers[f].high))
		return fail(r, "out of range", names[f]);
	r->value[f][r->count[f]++] = v;
	return 0;
}

static char take_word(reading *r, const struct lejp_ctx *c, bool whole)
{
	if (r->field < 0 || r->field >= WORDS || r->depth != 1)
		return fail(r, "a word was not expected here", r->field < 0 ? NULL : names[r->field]);
	char *to = r->word[r->field];
	size_t have = strlen(to), more = c->npos;
	if (!whole || have + more >= OB_NAME_MAX || memchr(c->buf, 0, more))
		return fail(r, "too long, or no text", names[r->field]);
	memcpy(to + have, c->buf, more);
	to[have + more] = 0;
	return 0;
}

static signed char take(struct lejp_ctx *c, char reason)
{
	reading *r = c->user;
	switch (reason) {
	case LEJPCB_PAIR_NAME:
		c->ipos = 0; // libwebsockets 4.1 counts lists that have ended, and takes five at most
		return r->depth == 1 ? begin_field(r, c->path) : fail(r, "nothing lies deeper in a command", NULL);
	case LEJPCB_OBJECT_START:
	case LEJPCB_ARRAY_START:
		if ((reason == LEJPCB_OBJECT_START) != (r->depth == 0) || r->depth > 1)
			return fail(r, "expected one JSON object", NULL);
		r->depth++;
		return 0;
	case LEJPCB_OBJECT_END:
	case LEJPCB_ARRAY_END:
		r->depth--;
		return 0;
	case LEJPCB_VAL_NUM_INT:
	case LEJPCB_VAL_NUM_FLOAT:
		return take_number(r, c->buf);
	case LEJPCB_VAL_STR_CHUNK:
	case LEJPCB_VAL_STR_END:
		return take_word(r, c, reason == LEJPCB_VAL_STR_END);
	case LEJPCB_VAL_TRUE:
	case LEJPCB_VAL_FALSE:
		r->on = reason == LEJPCB_VAL_TRUE;
		return (r->field == ON || r->field == LOOP) && r->depth == 1
			       ? 0
			       : fail(r, "true and false were not expected here", NULL);
	case LEJPCB_VAL_NULL:
		return fail(r, "null was not expected here", NULL);
	default:
		return 0;
	}
}

static ob_vec3 vec3(const reading *r, int field)
{
	return ob_v3(r->value[field][0], r->value[field][1], r->value[field][2]);
}

static int find_word(const char *word, const char *const list[], int n)
{
	for (int i = 0; i < n; i++) {
		if (list[i] && strcmp(list[i], word) == 0)
			return i;
	}
	return 0;
}

static bool needs(reading *r, unsigned needed, unsigned allowed)
{
	for (int i = 0; i < FIELDS; i++) {
		if ((needed & 1u << i) && !(r->given & 1u << i))
			return fail(r, "missing", names[i]) == 0;
		if ((r->given & 1u << i) && !((needed | allowed) & 1u << i))
			return fail(r, "not for this command", names[i]) == 0;
		if ((r->given & 1u << i) && numbers[i].count > 0 && r->count[i] != numbers[i].count)
			return fail(r, "not as many numbers as expected", names[i]) == 0;
	}
	return true;
}

// True for a shape that viewers may create: its size says all.
static bool is_offered(ob_shape shape)
{
	return ob_shape_is_bounded(shape) && !ob_shape_is(shape, OB_HULLED);
}

static bool refuse_shape(reading *r)
{
	char text[128] = "expected one of";
	for (int s = OB_SHAPE_NONE + 1; s < OB_SHAPE_KINDS; s++)
		if (is_offered((ob_shape)s))
			snprintf(text + strlen(text), sizeof text - strlen(text), " %s", ob_shape_name((ob_shape)s));
	return fail(r, text, "shape") == 0;
}

static bool is_given(const reading *r, int field)
{
	return r->given & 1u << field;
}

static bool read_attitude(reading *r, ob_quat *out)
{
	const double *q = r->value[ATTITUDE];
	if (!(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] > .5))
		return fail(r, "expected a unit quaternion", "attitude") == 0;
	*out = ob_quat_normalize((ob_quat){ q[0], q[1], q[2], q[3] });
	return true;
}

static bool make_object(reading *r, ob_object_def *def)
{
	const ob_shape shape = ob_shape_named(r->word[SHAPE]);
	const double *c = r->value[COLOUR];
	if (!is_offered(shape))
		return refuse_shape(r);
	*def = (ob_object_def){
		.passport = { .shape = (uint16_t)shape,
			      .size = vec3(r, SIZE),
			      .mass = r->value[MASS][0],
			      .friction = r->given & 1u << FRICTION ? r->value[FRICTION][0] : .5,
			      .restitution = r->value[RESTITUTION][0],
			      .colour = { .6f, .6f, .6f, 1 },
			      .roughness = r->given & 1u << ROUGHNESS ? (float)r->value[ROUGHNESS][0] : .45f,
			      .metal = (float)r->value[METAL][0] },
		.state = { .pose = { vec3(r, AT), ob_quat_identity() }, .v = vec3(r, VELOCITY), .w = vec3(r, SPIN) },
		.dies = INFINITY
	};
	for (int i = 0; i < 3 && r->given & 1u << COLOUR; i++)
		def->passport.colour[i] = (float)c[i];
	if (is_given(r, ATTITUDE) && !read_attitude(r, &def->state.pose.q))
		return false;
	// names appear in terminals and pages
	for (const char *s = r->word[NAME]; *s;) {
		size_t bytes;
		uint32_t code = ob_utf8_decode(s, &bytes);
		if (ob_utf8_length(s) == 0 || code < 0x20 || (code >= 0x7f && code < 0xa0))
			return fail(r, "expected text without control characters", "name") == 0;
		s += bytes;
	}
	snprintf(def->passport.name, sizeof def->passport.name, "%s",
		 *r->word[NAME] ? r->word[NAME] : ob_shape_name((ob_shape)def->passport.shape));
	return ob_object_def_check(def, r->e);
}

static bool refuse_kind(reading *r)
{
	char text[256] = "expected one of";
	for (int i = 0; i < OB_DO_KINDS; i++)
		if (kinds[i])
			snprintf(text + strlen(text), sizeof text - strlen(text), " %s", kinds[i]);
	return fail(r, text, "do") == 0;
}

// Changes of the object's state, colour and friction, a request each.
static bool make_edit(reading *r, ob_command *c)
{
	const ob_request to = c->request[0];
	const ob_vec3 same = { NAN, NAN, NAN };
	c->requests = 0;
	if (is_given(r, AT) || is_given(r, ATTITUDE) || is_given(r, VELOCITY) || is_given(r, SPIN)) {
		ob_request *state = &c->request[c->requests++];
		*state = to;
		state->kind = OB_REQUEST_STATE;
		state->state = (ob_state){ { is_given(r, AT) ? vec3(r, AT) : same, { NAN, 0, 0, 0 } },
					   is_given(r, VELOCITY) ? vec3(r, VELOCITY) : same,
					   is_given(r, SPIN) ? vec3(r, SPIN) : same };
		if (is_given(r, ATTITUDE) && !read_attitude(r, &state->state.pose.q))
			return false;
	}
	if (is_given(r, COLOUR)) {
		ob_request *colour = &c->request[c->requests++];
		*colour = to;
		colour->kind = OB_REQUEST_COLOUR;
		for (int i = 0; i < 4; i++)
			colour->colour[i] = i < 3 ? (float)r->value[COLOUR][i] : 1;
	}
	if (is_given(r, FRICTION)) {
		ob_request *friction = &c->request[c->requests++];
		*friction = to;
		friction->kind = OB_REQUEST_FRICTION;
		friction->friction = r->value[FRICTION][0];
	}
	if (is_given(r, SURFACE)) {
		ob_request *surface = &c->request[c->requests++];
		*surface = to;
		surface->kind = OB_REQUEST_SURFACE;
		surface->surface_velocity = vec3(r, SURFACE);
	}
	if (is_given(r, FORCE)) {
		ob_request *force = &c->request[c->requests++];
		*force = to;
		force->kind = OB_REQUEST_FORCE;
	}
	return c->requests > 0 ||
	       fail(r, "expected some of at, attitude, velocity, spin, colour, friction, surface and force", "edit") ==
		       0;
}

static bool make_path(reading *r, ob_request_path *path)
{
	if (r->point_numbers == 0 || r->point_numbers % 4 != 0)
		return fail(r, "expected four numbers for each: s, x, y, z", "points") == 0;
	for (uint32_t i = 0; i < r->point_numbers; i += 4) {
		const double *x = &r->points[i];
		path->point[path->points++] = (ob_path_point){ x[0], ob_v3(x[1], x[2], x[3]), ob_quat_identity() };
	}
	path->loop = is_given(r, LOOP) && r->on;
	return true;
}

// Puts each word of the text into a message, as obsim send does.
static bool put_words(reading *r, ob_request *q)
{
	char *rest = NULL;
	for (char *word = strtok_r(r->word[TEXT], " \t", &rest); word; word = strtok_r(NULL, " \t", &rest))
		if (!ob_scene_put_value(word, q->values, &q->bytes, sizeof q->values))
			return fail(r, "too many words", "text") == 0;
	return q->bytes > 0 || fail(r, "expected words", "text") == 0;
}

static bool make_seed(reading *r, uint64_t *out)
{
	const double seed = r->value[VALUE][0], most = 9007199254740992; // 2^53: all whole numbers up to it are exact
	if (!(seed >= 0 && seed <= most && seed == floor(seed)))
		return fail(r, "expected a whole number from 0 to 2^53", "value") == 0;
	*out = (uint64_t)seed;
	return true;
}

// Makes the requests of a command that goes to the host.
static bool make_requests(reading *r, ob_command *c)
{
	static const ob_request_kind asks[OB_DO_KINDS] = {
		[OB_DO_CREATE] = OB_REQUEST_ADD,      [OB_DO_REMOVE] = OB_REQUEST_REMOVE,
		[OB_DO_DRAG] = OB_REQUEST_DRAG,       [OB_DO_PUSH] = OB_REQUEST_PUSH,
		[OB_DO_TURN] = OB_REQUEST_TORQUE,     [OB_DO_RELEASE] = OB_REQUEST_RELEASE,
		[OB_DO_MESSAGE] = OB_REQUEST_MESSAGE, [OB_DO_KILL] = OB_REQUEST_KILL,
		[OB_DO_KEEP] = OB_REQUEST_KEEP,       [OB_DO_RETURN] = OB_REQUEST_RETURN,
		[OB_DO_RESTART] = OB_REQUEST_RESTART, [OB_DO_KICK] = OB_REQUEST_KICK,
		[OB_DO_PATH] = OB_REQUEST_PATH,       [OB_DO_MOTOR] = OB_REQUEST_MOTOR,
		[OB_DO_UNJOIN] = OB_REQUEST_UNJOIN,   [OB_DO_PAUSE] = OB_REQUEST_PAUSE,
		[OB_DO_RESUME] = OB_REQUEST_RESUME,   [OB_DO_STEP] = OB_REQUEST_STEP,
		[OB_DO_UNTIL] = OB_REQUEST_UNTIL,     [OB_DO_RATE] = OB_REQUEST_RATE,
		[OB_DO_SET] = OB_REQUEST_SET,         [OB_DO_SEED] = OB_REQUEST_SEED,
		[OB_DO_SAVE] = OB_REQUEST_SAVE,
	};
	ob_request *q = &c->request[0];
	c->requests = 1;
	q->kind = asks[c->kind];
	q->id = c->id;
	q->generation = (uint32_t)r->value[GENERATION][0];
	q->point = vec3(r, POINT);
	q->target = vec3(r, TARGET);
	q->force = vec3(r, c->kind == OB_DO_KICK ? IMPULSE : FORCE);
	q->twist = vec3(r, c->kind == OB_DO_KICK ? TWIST : TORQUE);
	q->frequency = is_given(r, FREQUENCY) ? r->value[FREQUENCY][0] : OB_PULL_FREQUENCY;
	q->motor = q->until = r->value[VALUE][0];
	q->steps = is_given(r, STEPS) ? (uint64_t)r->value[STEPS][0] : 1;
	q->rate = r->value[RATE][0];
	if (c->kind == OB_DO_SET)
		snprintf((char *)q->values, sizeof q->values, "%s=%.10g", r->word[NAME], r->value[VALUE][0]);
	if (c->kind == OB_DO_SEED)
		return make_seed(r, &q->seed);
	if (c->kind == OB_DO_EDIT)
		return make_edit(r, c);
	if (c->kind == OB_DO_MESSAGE)
		return put_words(r, q);
	if (c->kind == OB_DO_PATH)
		return make_path(r, &q->path);
	return c->kind != OB_DO_CREATE || make_object(r, &q->def);
}

static bool make(reading *r, ob_command *c)
{
	static const unsigned needed[OB_DO_KINDS] = {
		[OB_DO_CREATE] = 1u << SHAPE | 1u << SIZE | 1u << AT | 1u << MASS,
		[OB_DO_REMOVE] = 1u << ID | 1u << GENERATION,
		[OB_DO_DRAG] = 1u << ID | 1u << GENERATION | 1u << TARGET,
		[OB_DO_PUSH] = 1u << ID | 1u << GENERATION | 1u << FORCE,
		[OB_DO_TURN] = 1u << ID | 1u << GENERATION | 1u << TORQUE,
		[OB_DO_MESSAGE] = 1u << ID | 1u << GENERATION | 1u << TEXT,
		[OB_DO_EDIT] = 1u << ID | 1u << GENERATION,
		[OB_DO_KICK] = 1u << ID | 1u << GENERATION | 1u << IMPULSE,
		[OB_DO_PATH] = 1u << ID | 1u << GENERATION | 1u << POINTS,
		[OB_DO_MOTOR] = 1u << NAME | 1u << VALUE,
		[OB_DO_UNJOIN] = 1u << NAME,
		[OB_DO_KILL] = 1u << ID | 1u << GENERATION,
		[OB_DO_UNTIL] = 1u << VALUE,
		[OB_DO_RATE] = 1u << RATE,
		[OB_DO_CONTACTS] = 1u << ON,
		[OB_DO_JOINTS] = 1u << ON,
		[OB_DO_SIMULATORS] = 1u << ON,
		[OB_DO_ENERGY] = 1u << ON,
		[OB_DO_SET] = 1u << NAME | 1u << VALUE,
		[OB_DO_SEED] = 1u << VALUE,
	};
	static const unsigned allowed[OB_DO_KINDS] = {
		[OB_DO_CREATE] = 1u << ATTITUDE | 1u << VELOCITY | 1u << SPIN | 1u << COLOUR | 1u << FRICTION |
				 1u << RESTITUTION | 1u << ROUGHNESS | 1u << METAL | 1u << NAME,
		[OB_DO_DRAG] = 1u << POINT | 1u << FREQUENCY,
		[OB_DO_PUSH] = 1u << POINT,
		[OB_DO_RELEASE] = 1u << ID,
		[OB_DO_EDIT] = 1u << AT | 1u << ATTITUDE | 1u << VELOCITY | 1u << SPIN | 1u << COLOUR | 1u << FRICTION |
			       1u << SURFACE | 1u << FORCE,
		[OB_DO_KICK] = 1u << TWIST,
		[OB_DO_PATH] = 1u << LOOP,
		[OB_DO_STEP] = 1u << STEPS,
		[OB_DO_INSPECT] = 1u << ID,
	};
	int kind = find_word(r->word[DO], kinds, OB_DO_KINDS);
	if (!kind)
		return refuse_kind(r);
	if (!needs(r, needed[kind] | 1u << DO, allowed[kind]))
		return false;
	*c = (ob_command){
		.kind = (ob_command_kind)kind,
		.id = r->given & 1u << ID ? (uint32_t)r->value[ID][0] : UINT32_MAX,
		.on = r->on,
	};
	snprintf(c->name, sizeof c->name, "%s", r->word[NAME]);
	if (kind <= OB_DO_RATE && !make_requests(r, c))
		c->kind = OB_DO_NOTHING;
	return c->kind != OB_DO_NOTHING;
}

// The parser takes numbers of at most twenty digits, with the exponent's; pages write small ones with more.
enum { DIGITS = 17 };

// Copies without the insignificant digits of long fractions; returns the copy's size.
static size_t shorten_fractions(char *to, const char *json, size_t size)
{
	size_t n = 0;
	unsigned digits = 0;
	bool word = false, escaped = false, fraction = false;
	for (size_t i = 0; i < size; i++) {
		const char at = json[i];
		const bool digit = !word && at >= '0' && at <= '9';
		fraction = !word && (at == '.' || (fraction && digit));
		digits = digit ? digits + 1 : at == '.' ? digits : 0;
		if (!(digit && fraction && digits > DIGITS))
			to[n++] = at;
		if (at == '"' && !escaped)
			word = !word;
		escaped = word && at == '\\' && !escaped;
	}
	return n;
}

bool ob_command_read(ob_command *c, const char *json, size_t size, ob_error *e)
{
	reading r = { .e = e, .field = -1 };
	struct lejp_ctx parser;
	char text[OB_COMMAND_BYTES_MAX];
	*c = (ob_command){ .kind = OB_DO_NOTHING };
	if (size > OB_COMMAND_BYTES_MAX)
		return ob_fail(e, "a command of %zu bytes: at most %d are read", size, OB_COMMAND_BYTES_MAX);
	while (size > 0 && strchr(" \t\r\n", json[size - 1]) && json[size - 1]) // the parser stops after the object
		size--;
	size = shorten_fractions(text, json, size);
	lejp_construct(&parser, take, &r, NULL, 0);
	int left = lejp_parse(&parser, (const unsigned char *)text, (int)size);
	lejp_destruct(&parser);
	if (r.failed)
		return false;
	if (left != 0)
		return ob_fail(e, "this is no JSON object");
	return make(&r, c);
}

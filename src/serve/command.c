#include "serve/command.h"

#include <libwebsockets.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"
#include "host/request_table.h"
#include "scene/object_limits.h"
#include "shape/shape.h"

enum { MEMBERS = 20, NAME = 16, NUMBERS = OB_COMMAND_BYTES_MAX / 2 }; // a number takes a byte, and one before it

typedef enum form { MISSING, NUMBER, LIST, WORD, FLAG } form;

// A member of the command: its numbers or its word lie behind those of the members before.
typedef struct member {
	char name[NAME];
	form form;
	uint32_t first, count;
	bool used;
} member;

typedef struct reading {
	ob_error *e;
	bool failed;
	int depth; // of objects and lists
	uint32_t members, numbers, bytes;
	member member[MEMBERS];
	double number[NUMBERS];
	char text[OB_COMMAND_BYTES_MAX]; // each word ends by 0
} reading;

static char fail(reading *r, const char *what, const char *field)
{
	if (!r->failed)
		ob_fail(r->e, "%s%s%s", field ? field : "", field ? ": " : "", what);
	r->failed = true;
	return -1;
}

// ---- from JSON to members

static member *find_member(reading *r, const char *name)
{
	for (uint32_t i = 0; i < r->members; i++)
		if (strcmp(r->member[i].name, name) == 0)
			return &r->member[i];
	return NULL;
}

static char begin_member(reading *r, const char *name)
{
	if (strlen(name) >= NAME || r->members == MEMBERS)
		return fail(r, "nothing of this name is known in a command", "a field");
	if (find_member(r, name))
		return fail(r, "given twice", name);
	member *m = &r->member[r->members++];
	*m = (member){ .form = MISSING };
	memcpy(m->name, name, strlen(name));
	return 0;
}

// Begins a value of the last member, or goes on with its list or its word.
static member *take_value(reading *r, form now, uint32_t first)
{
	member *m = r->members ? &r->member[r->members - 1] : NULL;
	if (!m || r->depth != (now == LIST ? 2 : 1) || (m->form != MISSING && m->form != now))
		return NULL;
	m->first = m->form == MISSING ? first : m->first;
	m->form = now;
	return m;
}

static char take_number(reading *r, const char *text)
{
	member *m = take_value(r, r->depth == 2 ? LIST : NUMBER, r->numbers);
	if (!m || r->numbers == NUMBERS)
		return fail(r, "a number was not expected here", m ? m->name : NULL);
	r->number[r->numbers++] = strtod(text, NULL);
	m->count++;
	return isfinite(r->number[r->numbers - 1]) ? 0 : fail(r, "out of range", m->name);
}

static char take_word(reading *r, const struct lejp_ctx *c, bool ends)
{
	member *m = take_value(r, WORD, r->bytes);
	if (!m || r->bytes + c->npos >= sizeof r->text || memchr(c->buf, 0, c->npos))
		return fail(r, "no text was expected here, or none as long", m ? m->name : NULL);
	memcpy(r->text + r->bytes, c->buf, c->npos);
	r->bytes += c->npos;
	r->text[r->bytes] = 0;
	r->bytes += ends;
	return 0;
}

static signed char take(struct lejp_ctx *c, char reason)
{
	reading *r = c->user;
	member *m;
	switch (reason) {
	case LEJPCB_PAIR_NAME:
		c->ipos = 0; // libwebsockets 4.1 counts lists that have ended, and takes five at most
		return r->depth == 1 ? begin_member(r, c->path) : fail(r, "nothing lies deeper in a command", NULL);
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
		if (!(m = take_value(r, FLAG, 0)))
			return fail(r, "true and false were not expected here", NULL);
		m->count = reason == LEJPCB_VAL_TRUE;
		return 0;
	case LEJPCB_VAL_NULL:
		return fail(r, "null was not expected here", NULL);
	default:
		return 0;
	}
}

// ---- from members to fields

static bool refuse(reading *r, const ob_request_field *f, const char *what)
{
	return fail(r, what, f->name) == 0;
}

// Reads numbers, as many as the field has; a colour is opaque.
static bool put_numbers(reading *r, ob_request *q, const ob_request_field *f, const member *m)
{
	const bool id = f->type == OB_AS_ID, whole = id || f->type == OB_AS_WHOLE;
	const uint32_t count = f->type == OB_AS_COLOUR ? 3 : f->count;
	if (m->form != (count == 1 ? NUMBER : LIST) || m->count != count)
		return refuse(r, f, "not as many numbers as expected");
	const double *x = r->number + m->first;
	if (whole && !(*x >= 0 && *x == floor(*x) && *x <= (id ? 0x1p32 - 1 : 0x1p53))) // exact
		return refuse(r, f, id ? "expected a whole number below 2^32" : "expected a whole number, up to 2^53");
	for (uint32_t i = 0; i < count; i++)
		ob_request_put(q, f, i, x[i]);
	return true;
}

static bool put_attitude(reading *r, ob_request *q, const ob_request_field *f, const member *m)
{
	ob_quat a;
	if (!put_numbers(r, q, f, m))
		return false;
	memcpy(&a, (char *)q + f->at, sizeof a);
	const double square = a.w * a.w + a.x * a.x + a.y * a.y + a.z * a.z;
	a = ob_quat_normalize(a);
	memcpy((char *)q + f->at, &a, sizeof a);
	return (square > .5 && square <= 4) || refuse(r, f, "expected a unit quaternion");
}

static bool put_path(reading *r, ob_request_path *path, const ob_request_field *f, const member *m)
{
	if (m->form != LIST || m->count == 0 || m->count % 4 != 0 || m->count > 4 * OB_REQUEST_POINTS)
		return refuse(r, f, "expected a list of four numbers for each of 64 points at most: s, x, y, z");
	for (const double *x = r->number + m->first; path->points < m->count / 4; x += 4)
		path->point[path->points++] = (ob_path_point){ x[0], ob_v3(x[1], x[2], x[3]), ob_quat_identity() };
	return true;
}

// Puts each word of the text into a message, as obsim send does.
static bool put_words(reading *r, ob_request *q, const ob_request_field *f, char *text)
{
	char *rest = NULL;
	for (char *word = strtok_r(text, " \t", &rest); word; word = strtok_r(NULL, " \t", &rest))
		if (!ob_scene_put_value(word, q->values, &q->bytes, sizeof q->values))
			return refuse(r, f, "too many words");
	return q->bytes > 0 || refuse(r, f, "expected words");
}

// True for a shape that viewers may create: its size says all.
static bool is_offered(ob_shape shape)
{
	return ob_shape_is_bounded(shape) && !ob_shape_is(shape, OB_HULLED);
}

static bool put_shape(reading *r, ob_request *q, const ob_request_field *f, const char *name)
{
	char text[128] = "expected one of";
	q->def.passport.shape = (uint8_t)ob_shape_named(name);
	if (is_offered((ob_shape)q->def.passport.shape))
		return true;
	for (int s = OB_SHAPE_NONE + 1; s < OB_SHAPE_KINDS; s++)
		if (is_offered((ob_shape)s))
			snprintf(text + strlen(text), sizeof text - strlen(text), " %s", ob_shape_name((ob_shape)s));
	return refuse(r, f, text);
}

static bool put(reading *r, ob_request *q, const ob_request_field *f, member *m)
{
	char *const to = (char *)q + f->at, *const text = m->form == WORD ? r->text + m->first : NULL;
	m->used = true;
	switch (f->type) {
	case OB_AS_FLAG:
		ob_request_put(q, f, 0, m->count);
		return m->form == FLAG || refuse(r, f, "expected true or false");
	case OB_AS_PATH:
		return put_path(r, &q->path, f, m);
	case OB_AS_ASSIGNED:
		return (m->form == NUMBER &&
			snprintf(to + strlen(to), OB_NAME_MAX, "=%.10g", r->number[m->first]) > 0) ||
		       refuse(r, f, "expected a number");
	case OB_AS_ATTITUDE:
		return put_attitude(r, q, f, m);
	case OB_AS_TEXT:
		return (text && snprintf(to, f->count, "%s", text) < f->count) || refuse(r, f, "too long, or no text");
	case OB_AS_SHAPE:
		return text ? put_shape(r, q, f, text) : refuse(r, f, "expected a word");
	case OB_AS_WORDS:
		return text ? put_words(r, q, f, text) : refuse(r, f, "expected words");
	default:
		return put_numbers(r, q, f, m);
	}
}

// ---- from fields to requests

static bool put_all(reading *r, ob_request *q, const ob_request_field *f)
{
	for (; f->name; f++) {
		member *m = find_member(r, f->name);
		if (!m && !f->optional)
			return refuse(r, f, "missing");
		if (m && !put(r, q, f, m))
			return false;
	}
	return true;
}

static bool finish_object(reading *r, ob_object_def *def)
{
	ob_passport *p = &def->passport;
	def->dies = INFINITY;
	if (isnan(def->state.pose.q.w))
		def->state.pose.q = ob_quat_identity();
	// names appear in terminals and pages
	for (const char *s = p->name; *s;) {
		size_t bytes;
		uint32_t code = ob_utf8_decode(s, &bytes);
		if (ob_utf8_length(s) == 0 || code < 0x20 || (code >= 0x7f && code < 0xa0))
			return fail(r, "expected text without control characters", "name") == 0;
		s += bytes;
	}
	if (!*p->name)
		snprintf(p->name, sizeof p->name, "%s", ob_shape_name((ob_shape)p->shape));
	return ob_object_def_check(def, r->e);
}

static bool has_any(reading *r, const ob_request_field *f)
{
	while (f->name && !find_member(r, f->name))
		f++;
	return f->name;
}

// Makes the request of a row, or a part of the last one.
static bool add(reading *r, ob_command *c, const ob_request_row *row)
{
	if (!c->requests || c->request[c->requests - 1].kind != row->kind)
		ob_request_begin(&c->request[c->requests++], row);
	ob_request *q = &c->request[c->requests - 1];
	return put_all(r, q, ob_request_target_fields((ob_request_target)row->to)) && put_all(r, q, row->field) &&
	       ob_request_check_bounds(q, row, r->e) && (row->kind != OB_REQUEST_ADD || finish_object(r, &q->def));
}

static bool is_of(const ob_request_row *row, const char *command)
{
	return row->command && strcmp(row->command, command) == 0;
}

// Lists the commands, or the fields of one whose parts are all left out.
static bool refuse_command(reading *r, const char *command)
{
	char text[512] = "expected one of";
	const char *last = "";
	for (const ob_request_row *row = ob_request_rows; row->kind != OB_REQUEST_ROWS_END; row++) {
		const char *word = !*command ? row->command : is_of(row, command) ? row->field->name : NULL;
		if (word && strcmp(word, last) != 0)
			snprintf(text + strlen(text), sizeof text - strlen(text), " %s", last = word);
	}
	return fail(r, text, *command ? command : "do") == 0;
}

static bool make(reading *r, ob_command *c)
{
	member *m = find_member(r, "do");
	const char *command = m && m->form == WORD ? r->text + m->first : "";
	const ob_request_row *const rows = ob_request_rows;
	uint32_t parts = 0;
	for (const ob_request_row *row = rows; row->kind != OB_REQUEST_ROWS_END; row++)
		parts += is_of(row, command);
	if (parts == 0)
		return refuse_command(r, "");
	m->used = true;
	for (const ob_request_row *row = rows; row->kind != OB_REQUEST_ROWS_END; row++)
		if (is_of(row, command) && (parts == 1 || has_any(r, row->field)) && !add(r, c, row))
			return false;
	if (!c->requests)
		return refuse_command(r, command);
	for (m = r->member; m < r->member + r->members; m++)
		if (!m->used)
			return fail(r, "not for this command", m->name) == 0;
	return true;
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
	reading r;
	struct lejp_ctx parser;
	char text[OB_COMMAND_BYTES_MAX];
	r.e = e, r.failed = false, r.depth = 0;
	r.members = r.numbers = r.bytes = 0;
	c->requests = 0;
	if (size > OB_COMMAND_BYTES_MAX)
		return ob_fail(e, "a command of %zu bytes: at most %d are read", size, OB_COMMAND_BYTES_MAX);
	while (size > 0 && strchr(" \t\r\n", json[size - 1]) && json[size - 1]) // the parser stops after the object
		size--;
	size = shorten_fractions(text, json, size);
	lejp_construct(&parser, take, &r, NULL, 0);
	int left = lejp_parse(&parser, (const unsigned char *)text, (int)size);
	lejp_destruct(&parser);
	if (!r.failed && left != 0)
		return ob_fail(e, "this is no JSON object");
	if (r.failed || !make(&r, c))
		c->requests = 0;
	return c->requests > 0;
}

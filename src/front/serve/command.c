#include "serve/command.h"

#include <libwebsockets.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"
#include "host/request_table.h"
#include "scene/object_limits.h"
#include "shape/shape.h"

enum { MEMBERS = 20, NAME = 16 };

typedef enum form { MISSING, NUMBER, LIST, WORD, FLAG } form;

// A member of the command: its values lie in the text, each with a 0 that ends it.
typedef struct member {
	char name[NAME];
	form form;
	uint32_t first, bytes, count;
	bool used;
} member;

typedef struct reading {
	ob_error *e;
	bool failed;
	int depth; // of objects and lists
	uint32_t members, bytes;
	member member[MEMBERS];
	char text[OB_COMMAND_BYTES_MAX];
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
	*m = (member){ .first = r->bytes };
	memcpy(m->name, name, strlen(name));
	return 0;
}

// Takes a value of the last member, or a part of it.
static char take_value(reading *r, form form_now, const char *text, size_t size, bool ends)
{
	member *m = r->members ? &r->member[r->members - 1] : NULL;
	if (!m || r->depth != (form_now == LIST ? 2 : 1) || (m->form != MISSING && m->form != form_now))
		return fail(r, "a value was not expected here", m ? m->name : NULL);
	if (r->bytes + size >= sizeof r->text || memchr(text, 0, size))
		return fail(r, "too long, or no text", m->name);
	memcpy(r->text + r->bytes, text, size);
	r->text[r->bytes + size] = 0;
	r->bytes += (uint32_t)size + ends;
	m->bytes = r->bytes - m->first;
	m->form = form_now;
	m->count += ends;
	return 0;
}

static char take_number(reading *r, const char *text)
{
	return isfinite(strtod(text, NULL)) ? take_value(r, r->depth == 2 ? LIST : NUMBER, text, strlen(text), true)
					    : fail(r, "out of range", "a number");
}

static signed char take(struct lejp_ctx *c, char reason)
{
	reading *r = c->user;
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
		return take_value(r, WORD, c->buf, c->npos, reason == LEJPCB_VAL_STR_END);
	case LEJPCB_VAL_TRUE:
		return take_value(r, FLAG, "true", 4, true);
	case LEJPCB_VAL_FALSE:
		return take_value(r, FLAG, "false", 5, true);
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

static form form_of(const ob_request_field *f)
{
	switch (f->type) {
	case OB_AS_FLAG:
		return FLAG;
	case OB_AS_TEXT:
	case OB_AS_WORDS:
	case OB_AS_SHAPE:
		return WORD;
	case OB_AS_PATH:
		return LIST;
	default:
		return f->count == 1 ? NUMBER : LIST;
	}
}

// Splits the text of a message at its blanks, and joins four numbers of a path each.
static void divide(const ob_request_field *f, member *m, char *text)
{
	char *const end = text + m->bytes;
	uint32_t numbers = 0;
	for (char *c = text; c < end; c++)
		if (f->type == OB_AS_WORDS && (*c == ' ' || *c == '\t'))
			*c = 0;
		else if (f->type == OB_AS_PATH && !*c && ++numbers % 4 != 0)
			*c = ' ';
}

// Attitudes of pages are rounded.
static bool make_unit(reading *r, const ob_request_field *f, char *at)
{
	ob_quat q;
	memcpy(&q, at, sizeof q);
	const double square = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
	q = ob_quat_normalize(q);
	memcpy(at, &q, sizeof q);
	return (square > .5 && square <= 4) || refuse(r, f, "expected a unit quaternion");
}

static bool put(reading *r, ob_request *q, const ob_request_field *f, member *m)
{
	const char *word[OB_COMMAND_BYTES_MAX / 2 + 1], *text = r->text + m->first;
	uint32_t n = 0;
	const uint32_t wanted = f->type == OB_AS_COLOUR ? 3 : f->type == OB_AS_PATH ? (m->count + 3) / 4 * 4 : f->count;
	m->used = true;
	if (m->form != form_of(f) || (m->form == LIST && m->count != wanted))
		return refuse(r, f,
			      f->type == OB_AS_PATH ? "expected four numbers for each: s, x, y, z"
						    : "not the kind of value, or not as many numbers as expected");
	divide(f, m, r->text + m->first);
	for (; text < r->text + m->first + m->bytes; text += strlen(text) + 1)
		if (*text || f->type != OB_AS_WORDS)
			word[n++] = text;
	word[n] = NULL;
	if (n == 0)
		return refuse(r, f, "expected words");
	return ob_request_read_field(q, f, word, f->name, r->e) &&
	       (f->type != OB_AS_ATTITUDE || make_unit(r, f, (char *)q + f->at));
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
	r.members = r.bytes = 0;
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

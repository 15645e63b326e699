// Fields of requests from words: of a command line, and of a viewer's command.
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "host/request_table.h"
#include "shape/shape.h"

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

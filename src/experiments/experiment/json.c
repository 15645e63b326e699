#include "experiment/json.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"

static void put_string(const ob_json *j, const char *text)
{
	FILE *f = j->f;
	fputc('"', f);
	for (const char *s = text; *s;) {
		size_t n = ob_utf8_length(s);
		if (*s == '"' || *s == '\\')
			fprintf(f, "\\%c", *s);
		else if (n == 0 || (unsigned char)*s < 0x20 || *s == 0x7f || (j->script && *s == '<'))
			fprintf(f, "\\u%04x", (unsigned char)*s);
		else
			fwrite(s, 1, n, f);
		s += n ? n : 1;
	}
	fputc('"', f);
}

static void begin_line(const ob_json *j)
{
	if (!j->script)
		fprintf(j->f, "\n%*s", 2 * j->depth, "");
}

static void begin(ob_json *j, const char *key)
{
	if (j->filled)
		fputc(',', j->f);
	if (j->depth > 0)
		begin_line(j);
	if (key) {
		put_string(j, key);
		fputs(": ", j->f);
	}
	j->filled = true;
}

void ob_json_open(ob_json *j, const char *key)
{
	begin(j, key);
	fputc('{', j->f);
	j->depth++;
	j->filled = false;
}

void ob_json_close(ob_json *j)
{
	j->depth--;
	if (j->filled)
		begin_line(j);
	fputc('}', j->f);
	if (j->depth == 0 && !j->script)
		fputc('\n', j->f);
	j->filled = true;
}

void ob_json_open_list(ob_json *j, const char *key)
{
	begin(j, key);
	fputc('[', j->f);
	j->depth++;
	j->filled = false;
}

void ob_json_close_list(ob_json *j)
{
	j->depth--;
	if (j->filled)
		begin_line(j);
	fputc(']', j->f);
	j->filled = true;
}

void ob_json_string(ob_json *j, const char *key, const char *value)
{
	begin(j, key);
	put_string(j, value);
}

void ob_json_number(ob_json *j, const char *key, double value)
{
	begin(j, key);
	if (isfinite(value))
		fprintf(j->f, "%.17g", value);
	else
		fputs("null", j->f);
}

void ob_json_count(ob_json *j, const char *key, uint64_t value)
{
	begin(j, key);
	fprintf(j->f, "%" PRIu64, value);
}

void ob_json_true(ob_json *j, const char *key, bool value)
{
	begin(j, key);
	fputs(value ? "true" : "false", j->f);
}

void ob_json_null(ob_json *j, const char *key)
{
	begin(j, key);
	fputs("null", j->f);
}

void ob_json_text(ob_json *j, const char *key, const char *value)
{
	if (*value)
		ob_json_string(j, key, value);
	else
		ob_json_null(j, key);
}

// Skips the string that opens at s; NULL if it does not end.
static const char *skip_string(const char *s)
{
	for (s++; *s && *s != '"'; s++) {
		if (*s == '\\' && s[1])
			s++;
	}
	return *s ? s + 1 : NULL;
}

const char *ob_json_find(const char *text, const char *key)
{
	size_t length = strlen(key);
	for (const char *s = text; s && *s;) {
		if (*s != '"') {
			s++;
			continue;
		}
		const char *name = s + 1;
		s = skip_string(s);
		if (!s || *s != ':')
			continue; // a value, or the end of a truncated text
		s += 1 + strspn(s + 1, " ");
		if (strncmp(name, key, length) == 0 && name[length] == '"')
			return s;
	}
	return NULL;
}

double ob_json_read_number(const char *text, const char *key)
{
	const char *at = ob_json_find(text, key);
	char *end = NULL;
	const double x = at ? strtod(at, &end) : NAN;
	return end != at ? x : NAN;
}

bool ob_json_read_string(const char *at, char *out, size_t size)
{
	if (!at || *at != '"' || size == 0)
		return false;
	size_t n = 0;
	for (at++; *at && *at != '"'; at++) {
		unsigned code = (unsigned char)*at;
		if (*at == '\\') {
			at++;
			if (*at == 'u' && sscanf(at + 1, "%4x", &code) == 1)
				at += 4;
			else
				code = (unsigned char)*at;
		}
		if (!*at || n + 1 >= size)
			return false;
		out[n++] = (char)code;
	}
	out[n] = 0;
	return *at == '"';
}

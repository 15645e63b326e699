#include "base/csv.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/number.h"

static void begin_cell(ob_csv *c)
{
	if (c->filled)
		putc(',', c->f);
	c->filled = true;
}

void ob_csv_text(ob_csv *c, const char *text)
{
	begin_cell(c);
	if (!strpbrk(text, ",\"\r\n")) {
		fputs(text, c->f);
		return;
	}
	putc('"', c->f);
	for (; *text; text++) {
		if (*text == '"')
			putc('"', c->f);
		putc(*text, c->f);
	}
	putc('"', c->f);
}

void ob_csv_count(ob_csv *c, uint64_t n)
{
	begin_cell(c);
	fprintf(c->f, "%" PRIu64, n);
}

void ob_csv_number(ob_csv *c, double v)
{
	ob_csv_numbers(c, &v, 1);
}

void ob_csv_numbers(ob_csv *c, const double *v, size_t count)
{
	begin_cell(c);
	for (size_t i = 0; i < count; i++)
		fprintf(c->f, "%s%s", i ? " " : "", isnan(v[i]) ? "" : ob_number_text(v[i]).text);
}

void ob_csv_end(ob_csv *c)
{
	putc('\n', c->f);
	c->filled = false;
}

// Returns the cell at r->at without its quotes. *more: another cell follows in the same record. NULL: not CSV.
static char *read_cell(ob_csv_reader *r, bool *more)
{
	char *begin = r->at, *to = r->at, *from = r->at;
	if (*from == '"') {
		bool closed = false;
		for (from++; *from && !closed; from++) {
			closed = *from == '"' && from[1] != '"';
			if (*from == '"' && !closed)
				from++;
			if (!closed)
				*to++ = *from;
		}
		if (!closed)
			return NULL;
	} else {
		from += strcspn(from, ",\r\n");
		to = from;
	}
	*more = *from == ',';
	if (*more)
		from++;
	else if (*from == '\r' || *from == '\n')
		from += from[0] == '\r' && from[1] == '\n' ? 2 : 1;
	else if (*from)
		return NULL;
	*to = 0;
	r->at = from;
	return begin;
}

size_t ob_csv_read(ob_csv_reader *r, char **cell, size_t max)
{
	size_t count = 0;
	r->record++;
	for (bool more = true; more; count++) {
		char *text = read_cell(r, &more);
		if (!text)
			return 0;
		if (count < max)
			cell[count] = text;
	}
	return count;
}

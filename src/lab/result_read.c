#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lab/result_file.h"

typedef struct reader {
	const char *path;
	char *at; // in the text, which is taken apart where it stands
	int line; // 1, 2, ..: of the record
	char *cell[OB_COLUMNS];
} reader;

// The cell at r->at without its quotes; *more tells whether another follows in the same record. NULL: quotes that do
// not end, or end in the midst of a cell.
static char *take_cell(reader *r, bool *more)
{
	char *begin = r->at, *to = r->at, *from = r->at;
	if (*from == '"') {
		for (from++; *from; from++) {
			if (*from == '"' && *++from != '"')
				break;
			*to++ = *from;
		}
		if (from[-1] != '"' || from == begin + 1)
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

static bool take_record(reader *r, ob_error *e)
{
	bool more = true;
	int count = 0;
	r->line++;
	while (more) {
		char *cell = take_cell(r, &more);
		if (!cell)
			return ob_fail(e, "%s:%d: not CSV", r->path, r->line);
		if (count < OB_COLUMNS)
			r->cell[count] = cell;
		count++;
	}
	return count == OB_COLUMNS || ob_fail(e, "%s:%d: %d cells, %d expected", r->path, r->line, count, OB_COLUMNS);
}

static bool check_head(const reader *r, ob_error *e)
{
	char made_up[32];
	for (int column = 0; column < OB_COLUMNS; column++) {
		const char *name = ob_result_column_name(column, made_up);
		if (strcmp(r->cell[column], name) != 0)
			return ob_fail(e, "%s:1: column '%s' instead of '%s'", r->path, r->cell[column], name);
	}
	return true;
}

// Nothing is not a number.
static bool number(const reader *r, int column, double *out, ob_error *e)
{
	char *text = r->cell[column], *end = text, made_up[32];
	*out = *text ? strtod(text, &end) : NAN;
	return !*end || ob_fail(e, "%s:%d: %s: '%s' is not a number", r->path, r->line,
				ob_result_column_name(column, made_up), text);
}

static bool count(const reader *r, int column, uint32_t *out, ob_error *e)
{
	double v;
	char made_up[32];
	if (!number(r, column, &v, e))
		return false;
	if (!(v >= 0 && v <= UINT32_MAX) || v != floor(v))
		return ob_fail(e, "%s:%d: %s: '%s' is not a count", r->path, r->line,
			       ob_result_column_name(column, made_up), r->cell[column]);
	*out = (uint32_t)v;
	return true;
}

static bool repeats(const reader *r, int column, uint32_t n, double *out, ob_error *e)
{
	char *at = r->cell[column], *end = at, made_up[32];
	uint32_t i = 0;
	for (; i < n; i++, at = end) {
		out[i] = strtod(at, &end);
		if (end == at)
			break;
	}
	return (i == n && !*end) ||
	       ob_fail(e, "%s:%d: %s: not %u numbers", r->path, r->line, ob_result_column_name(column, made_up), n);
}

static bool read_settings(const reader *r, ob_run_settings *s, ob_error *e)
{
	return number(r, OB_COLUMN_STEP, &s->step_length, e) && count(r, OB_COLUMN_SUBSTEPS, &s->substeps, e) &&
	       count(r, OB_COLUMN_ITERATIONS, &s->iterations, e) && number(r, OB_COLUMN_TOLERANCE, &s->tolerance, e) &&
	       count(r, OB_COLUMN_LAG, &s->lag, e) && count(r, OB_COLUMN_SLEEPING, &s->sleeping, e);
}

static bool read_outcome(const reader *r, ob_result *one, ob_error *e)
{
	ob_outcome *o = &one->outcome;
	snprintf(o->failed, sizeof o->failed, "%s", r->cell[OB_COLUMN_FAILED]);
	for (uint32_t i = 0; i < one->of->figures; i++)
		if (!number(r, OB_COLUMN_FIGURE + 4 * (int)i + 1, &o->figure[i], e))
			return false;
	if (!number(r, OB_COLUMN_CPU, &o->cpu_s, e) || !number(r, OB_COLUMN_WALL, &o->wall_s, e) ||
	    !number(r, OB_COLUMN_BODY_SECONDS, &o->body_seconds, e) || !count(r, OB_COLUMN_REPEATS, &one->repeats, e))
		return false;
	if (one->repeats > OB_REPEATS)
		return ob_fail(e, "%s:%d: %u repeats, at most %d", r->path, r->line, one->repeats, OB_REPEATS);
	return repeats(r, OB_COLUMN_CPU_EACH, one->repeats, one->cpu_s, e) &&
	       repeats(r, OB_COLUMN_WALL_EACH, one->repeats, one->wall_s, e);
}

static bool read_result(const reader *r, ob_results *to, ob_error *e)
{
	const char *name = r->cell[OB_COLUMN_CASE], *engine = r->cell[OB_COLUMN_ENGINE];
	ob_result one = { .of = ob_case_find(name), .engine = ob_engine_find(engine) };
	if (!one.of || !one.engine)
		return ob_fail(e, "%s:%d: this program has no %s '%s'", r->path, r->line, one.of ? "engine" : "case",
			       one.of ? engine : name);
	if (!read_settings(r, &one.settings, e) || !read_outcome(r, &one, e))
		return false;
	snprintf(one.commit, sizeof one.commit, "%s", r->cell[OB_COLUMN_COMMIT]);
	snprintf(to->commit, sizeof to->commit, "%s", r->cell[OB_COLUMN_COMMIT]);
	snprintf(to->machine, sizeof to->machine, "%s", r->cell[OB_COLUMN_MACHINE]);
	return ob_results_add(to, &one) || ob_fail(e, "no memory for the results in %s", r->path);
}

static bool read_text(ob_results *to, const char *path, char *text, ob_error *e)
{
	reader r = { .path = path, .at = text };
	if (!take_record(&r, e) || !check_head(&r, e))
		return false;
	while (*r.at)
		if (!take_record(&r, e) || !read_result(&r, to, e))
			return false;
	return true;
}

bool ob_results_read(ob_results *r, const char *path, ob_error *e)
{
	*r = (ob_results){ 0 };
	FILE *f = fopen(path, "re");
	if (!f)
		return errno == ENOENT || ob_fail(e, "%s cannot be read: %s", path, strerror(errno));
	char *text = NULL;
	size_t room = 0;
	errno = 0;
	ssize_t length = getdelim(&text, &room, 0, f); // there is no 0 in it
	bool fine = length >= 0 && !ferror(f);
	if (!fine)
		ob_fail(e, "%s cannot be read: %s", path, errno ? strerror(errno) : "it is empty");
	fine = fine && read_text(r, path, text, e);
	free(text);
	fclose(f);
	if (!fine)
		ob_results_finish(r);
	return fine;
}

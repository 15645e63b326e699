#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/csv.h"
#include "experiment/experiment.h"
#include "experiment/folder.h"
#include "experiment/json.h"

bool ob_records_add(ob_records *r, const ob_record *one)
{
	if (!OB_MAKE_ROOM(r->record, r->count, r->max))
		return false;
	r->record[r->count++] = *one;
	return true;
}

const ob_record *ob_records_find(const ob_records *r, const char *of, const char *configuration, uint32_t repeat,
				 uint64_t seed)
{
	for (size_t i = 0; i < r->count; i++) {
		const ob_record *one = &r->record[i];
		if (one->repeat == repeat && one->seed == seed && !strcmp(one->configuration, configuration) &&
		    !strcmp(one->of, of))
			return one;
	}
	return NULL;
}

void ob_record_read(ob_record *r, const ob_experiment *x, int kind, const char *report)
{
	for (size_t i = 0; i < x->metrics; i++) {
		const ob_metric *m = &x->metric[i];
		if (!m->from[0] || m->kind != kind)
			continue;
		r->metric[i] = ob_json_read_number(report, m->from[0]);
		for (int k = 1; k < 3 && m->from[k]; k++)
			r->metric[i] /= ob_json_read_number(report, m->from[k]);
	}
}

void ob_records_drop(ob_records *r, const ob_trials *s)
{
	size_t kept = 0;
	for (size_t i = 0; i < r->count; i++) {
		bool asked = false;
		for (size_t j = 0; j < s->count && !asked; j++)
			asked = !strcmp(r->record[i].configuration, s->trial[j].configuration) &&
				!strcmp(r->record[i].of, s->trial[j].of);
		if (!asked)
			r->record[kept++] = r->record[i];
	}
	r->count = kept;
}

void ob_records_finish(ob_records *r)
{
	free(r->record);
	r->record = NULL;
	r->count = r->max = 0;
}

// ---- the file

static const char *const failures[OB_FAILURES] = { "", "outcome", "error", "crash", "time" };

// Columns in front of the definition's own, and behind its metrics.
static const char *const first[] = { "experiment", "case", "configuration", "repeat", "seed" };
static const char *const last[] = { "note", "failure", "reason", "took_s", "took_cpu_s", "machine", "commit" };
enum { FIRST = sizeof first / sizeof *first, LAST = sizeof last / sizeof *last };

void ob_result_head_write(FILE *f, const ob_experiment *x)
{
	ob_csv w = { .f = f };
	for (size_t i = 0; i < FIRST; i++)
		ob_csv_text(&w, first[i]);
	for (size_t i = 0; i < x->columns; i++)
		ob_csv_text(&w, x->column[i]);
	for (size_t i = 0; i < x->metrics; i++)
		ob_csv_text(&w, x->metric[i].key);
	for (size_t i = 0; i < LAST; i++)
		ob_csv_text(&w, last[i]);
	ob_csv_end(&w);
}

void ob_result_line_write(FILE *f, const ob_experiment *x, const ob_record *r)
{
	ob_csv w = { .f = f };
	ob_csv_text(&w, x->name);
	ob_csv_text(&w, r->of);
	ob_csv_text(&w, r->configuration);
	ob_csv_count(&w, r->repeat);
	ob_csv_count(&w, r->seed);
	for (size_t i = 0; i < x->columns; i++) {
		char text[256] = "";
		x->describe(r, i, text, sizeof text);
		ob_csv_text(&w, text);
	}
	for (size_t i = 0; i < x->metrics; i++)
		ob_csv_number(&w, r->metric[i]);
	ob_csv_text(&w, r->note);
	ob_csv_text(&w, failures[r->failure]);
	ob_csv_text(&w, r->reason);
	ob_csv_number(&w, r->took_s);
	ob_csv_number(&w, r->took_cpu_s);
	ob_csv_text(&w, r->machine);
	ob_csv_text(&w, r->commit);
	ob_csv_end(&w);
}

typedef struct all {
	const ob_records *records;
	const ob_experiment *experiment;
} all;

static int by_order(const void *a, const void *b, void *with)
{
	const ob_record *p = *(const ob_record *const *)a, *q = *(const ob_record *const *)b;
	const ob_experiment *x = with;
	int order = x->order ? x->order(p, q) : 0;
	order = order || !x->order ? order : strcmp(p->configuration, q->configuration);
	order = order || !x->order ? order : (p->seed > q->seed) - (p->seed < q->seed);
	order = order || !x->order ? order : (p->repeat > q->repeat) - (p->repeat < q->repeat);
	return order ? order : (p > q) - (p < q);
}

static void put_all(FILE *f, const void *with)
{
	const all *a = with;
	size_t count = a->records->count;
	const ob_record **list = calloc(count + 1, sizeof *list);
	ob_result_head_write(f, a->experiment);
	for (size_t i = 0; list && i < count; i++)
		list[i] = &a->records->record[i];
	if (list)
		qsort_r(list, count, sizeof *list, by_order, (void *)a->experiment);
	for (size_t i = 0; i < count; i++)
		ob_result_line_write(f, a->experiment, list ? list[i] : &a->records->record[i]);
	free(list);
}

bool ob_records_write(const ob_records *r, const ob_experiment *x, const char *path, ob_error *e)
{
	return ob_file_replace(path, put_all, &(all){ r, x }, e);
}

// Reader of a file, record by record.
typedef struct reader {
	const char *path;
	ob_csv_reader csv;
	size_t cells;
	char *cell[FIRST + LAST + 2 * OB_METRICS];
} reader;

enum { CELLS_MAX = FIRST + LAST + 2 * OB_METRICS };

// Position of each column in the head of a file; -1: absent.
typedef struct head {
	int first[FIRST], metric[OB_METRICS], last[LAST];
} head;

static int column_named(const reader *r, const char *name)
{
	for (size_t i = 0; i < r->cells; i++)
		if (!strcmp(r->cell[i], name))
			return (int)i;
	return -1;
}

static bool read_head(const reader *r, const ob_experiment *x, head *h, ob_error *e)
{
	for (size_t i = 0; i < FIRST; i++)
		if ((h->first[i] = column_named(r, first[i])) < 0)
			return ob_fail(e, "%s:1: there is no column '%s'", r->path, first[i]);
	for (size_t i = 0; i < LAST; i++)
		if ((h->last[i] = column_named(r, last[i])) < 0)
			return ob_fail(e, "%s:1: there is no column '%s'", r->path, last[i]);
	for (size_t i = 0; i < x->metrics; i++)
		if ((h->metric[i] = column_named(r, x->metric[i].key)) < 0)
			return ob_fail(e, "%s:1: there is no column '%s'", r->path, x->metric[i].key);
	return true;
}

// An empty cell is NaN.
static bool number(const reader *r, int column, const char *name, double *out, ob_error *e)
{
	char *text = r->cell[column], *end = text;
	*out = *text ? strtod(text, &end) : NAN;
	return !*end || ob_fail(e, "%s:%d: %s: '%s' is not a number", r->path, r->csv.record, name, text);
}

static bool count(const reader *r, int column, const char *name, uint64_t *out, ob_error *e)
{
	const char *text = r->cell[column];
	if (!*text || strspn(text, "0123456789") != strlen(text))
		return ob_fail(e, "%s:%d: %s: '%s' is not a count", r->path, r->csv.record, name, text);
	*out = strtoull(text, NULL, 10);
	return true;
}

static bool copy(const reader *r, int column, char *to, size_t room, ob_error *e)
{
	size_t n = strlen(r->cell[column]);
	if (n >= room)
		return ob_fail(e, "%s:%d: '%.40s...' is too long", r->path, r->csv.record, r->cell[column]);
	memcpy(to, r->cell[column], n + 1);
	return true;
}

static bool read_record(const reader *r, const ob_experiment *x, const head *h, ob_record *one, ob_error *e)
{
	uint64_t repeat = 0;
	if (strcmp(r->cell[h->first[0]], x->name))
		return ob_fail(e, "%s:%d: of '%s', not of '%s'", r->path, r->csv.record, r->cell[h->first[0]], x->name);
	bool fine = copy(r, h->first[1], one->of, sizeof one->of, e) &&
		    copy(r, h->first[2], one->configuration, sizeof one->configuration, e) &&
		    count(r, h->first[3], first[3], &repeat, e) && count(r, h->first[4], first[4], &one->seed, e) &&
		    copy(r, h->last[0], one->note, sizeof one->note, e) &&
		    copy(r, h->last[2], one->reason, sizeof one->reason, e) &&
		    number(r, h->last[3], last[3], &one->took_s, e) &&
		    number(r, h->last[4], last[4], &one->took_cpu_s, e) &&
		    copy(r, h->last[5], one->machine, sizeof one->machine, e) &&
		    copy(r, h->last[6], one->commit, sizeof one->commit, e);
	for (size_t i = 0; fine && i < x->metrics; i++)
		fine = number(r, h->metric[i], x->metric[i].key, &one->metric[i], e);
	if (!fine)
		return false;
	one->repeat = (uint32_t)repeat;
	for (one->failure = 0; one->failure < OB_FAILURES; one->failure++)
		if (!strcmp(r->cell[h->last[1]], failures[one->failure]))
			return true;
	return ob_fail(e, "%s:%d: there is no failure '%s'", r->path, r->csv.record, r->cell[h->last[1]]);
}

static bool next(reader *r, ob_error *e)
{
	r->cells = ob_csv_read(&r->csv, r->cell, CELLS_MAX);
	if (r->cells == 0)
		return ob_fail(e, "%s:%d: not CSV", r->path, r->csv.record);
	return r->cells <= CELLS_MAX ||
	       ob_fail(e, "%s:%d: %zu cells, %d at most", r->path, r->csv.record, r->cells, CELLS_MAX);
}

static bool read_text(ob_records *to, const ob_experiment *x, const char *path, char *text, ob_error *e)
{
	reader r = { .path = path, .csv = { .at = text } };
	head h;
	if (!next(&r, e) || !read_head(&r, x, &h, e))
		return false;
	size_t cells = r.cells;
	while (*r.csv.at) {
		ob_record one = { .repeat = 0 };
		if (!next(&r, e))
			return false;
		if (r.cells != cells)
			return ob_fail(e, "%s:%d: %zu cells, %zu expected", path, r.csv.record, r.cells, cells);
		if (!read_record(&r, x, &h, &one, e))
			return false;
		if (!ob_records_add(to, &one))
			return ob_fail(e, "no memory for the results in %s", path);
	}
	return true;
}

// Ignores an unterminated last line. Cells contain no line ends, so each line is a record.
static char *read_whole_lines(const char *path, bool *missing, ob_error *e)
{
	FILE *f = fopen(path, "re");
	*missing = !f && errno == ENOENT;
	if (!f) {
		ob_fail(e, "%s cannot be read: %s", path, strerror(errno));
		return NULL;
	}
	char *text = NULL;
	size_t room = 0;
	errno = 0;
	ssize_t length = getdelim(&text, &room, 0, f); // it contains no 0
	bool fine = length >= 0 && !ferror(f);
	char *end = fine ? strrchr(text, '\n') : NULL;
	if (!fine)
		ob_fail(e, "%s cannot be read: %s", path, errno ? strerror(errno) : "it is empty");
	else if (end)
		end[1] = 0;
	else
		fine = ob_fail(e, "%s has no head", path);
	fclose(f);
	if (fine)
		return text;
	free(text);
	return NULL;
}

bool ob_records_read(ob_records *r, const ob_experiment *x, const char *path, ob_error *e)
{
	ob_error why = { "" };
	bool missing;
	char *text = read_whole_lines(path, &missing, &why);
	r->count = 0;
	bool fine = missing || (text && read_text(r, x, path, text, &why));
	free(text);
	if (!fine) {
		ob_records_finish(r);
		ob_fail(e, "%s", why.text);
	}
	return fine;
}

#include "experiment/table.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/utf8.h"

typedef struct cell {
	char *text, *small; // NULL = empty
	const char *class, *link;
	bool heading; // the only cell of its row
} cell;

struct ob_table {
	const char *align;
	size_t columns, count, max;
	cell *cell; // row by row
};

ob_table *ob_table_new(const char *align)
{
	ob_table *t = calloc(1, sizeof *t);
	char *copy = strdup(align);
	if (!t || !copy)
		abort();
	*t = (ob_table){ .align = copy, .columns = strlen(align) };
	return t;
}

static void free_table(ob_table *t)
{
	for (size_t i = 0; i < t->count; i++) {
		free(t->cell[i].text);
		free(t->cell[i].small);
	}
	free(t->cell);
	free((char *)t->align);
	free(t);
}

static void add_cell(ob_table *t, const char *format, va_list args)
{
	if (!OB_MAKE_ROOM(t->cell, t->count, t->max))
		return;
	cell *c = &t->cell[t->count++];
	*c = (cell){ 0 };
	if (vasprintf(&c->text, format, args) < 0)
		c->text = NULL;
}

void ob_table_add(ob_table *t, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	add_cell(t, format, args);
	va_end(args);
}

void ob_table_row(ob_table *t, const char *first, ...)
{
	va_list args;
	va_start(args, first);
	for (const char *text = first; text; text = va_arg(args, const char *))
		ob_table_add(t, "%s", text);
	va_end(args);
}

void ob_table_heading(ob_table *t, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	add_cell(t, format, args);
	va_end(args);
	if (t->count)
		t->cell[t->count - 1].heading = true;
	for (size_t i = 1; i < t->columns; i++)
		ob_table_add(t, "%s", "");
}

void ob_table_small(ob_table *t, const char *format, ...)
{
	if (!t->count)
		return;
	cell *c = &t->cell[t->count - 1];
	va_list args;
	va_start(args, format);
	free(c->small);
	if (vasprintf(&c->small, format, args) < 0)
		c->small = NULL;
	va_end(args);
}

void ob_table_class(ob_table *t, const char *class)
{
	if (t->count)
		t->cell[t->count - 1].class = class;
}

void ob_table_link(ob_table *t, const char *id)
{
	if (t->count)
		t->cell[t->count - 1].link = id;
}

void ob_table_add_median(ob_table *t, const ob_metric *m, const ob_statistics *s)
{
	ob_table_add(t, "%s", ob_word_metric(s->median, m).text);
	if (isfinite(s->median_low) && isfinite(s->median_high))
		ob_table_small(t, "%s to %s", ob_word_number(s->median_low * m->scale).text,
			       ob_word_number(s->median_high * m->scale).text);
}

// The cell as one text; malloc'd.
static char *text_of(const ob_table *t, size_t i)
{
	char *text = NULL;
	const cell *c = i < t->count ? &t->cell[i] : NULL;
	const char *body = c && c->text ? c->text : "";
	if (asprintf(&text, c && c->small ? "%s (%s)" : "%s", body, c && c->small ? c->small : "") < 0)
		abort();
	return text;
}

// Prints the first column, and those from "from" up to "to".
static void print_row(const ob_table *t, FILE *f, size_t row, size_t from, size_t to, const size_t *width)
{
	int trailing = 0; // pending spaces
	for (size_t i = 0; i < to; i = i + 1 < from ? from : i + 1) {
		char *text = text_of(t, row + i);
		int room = (int)(width[i] - ob_utf8_count(text)), before = t->align[i] == 'r' ? room : 0;
		trailing += (i ? 2 : 0) + before;
		if (*text)
			fprintf(f, "%*s%s", trailing, "", text);
		trailing = (*text ? 0 : trailing) + room - before;
		free(text);
	}
	putc('\n', f);
}

static size_t *measure(const ob_table *t, size_t least)
{
	size_t *width = calloc(t->columns + 1, sizeof *width);
	if (!width)
		abort();
	for (size_t i = 0; i < t->columns; i++)
		width[i] = least;
	for (size_t row = 0; row < t->count; row += t->columns)
		for (size_t i = 0; i < t->columns && row + i < t->count; i++) {
			char *text = text_of(t, row + i);
			const size_t w = ob_utf8_count(text);
			width[i] = w > width[i] && !t->cell[row + i].heading ? w : width[i];
			free(text);
		}
	return width;
}

void ob_table_print(ob_table *t, FILE *f, size_t limit)
{
	if (!t)
		return;
	size_t *width = measure(t, 0);
	for (size_t from = 1, to; from == 1 || from < t->columns; from = to) {
		size_t used = width[0];
		for (to = from; to < t->columns; to++) {
			used += 2 + width[to];
			if (limit && used > limit && to > from)
				break;
		}
		if (from > 1)
			putc('\n', f);
		for (size_t row = 0; row < t->count; row += t->columns)
			print_row(t, f, row, from, to, width);
		if (to <= from)
			break;
	}
	free(width);
	free_table(t);
}

void ob_table_markdown(ob_table *t, FILE *f)
{
	if (!t)
		return;
	size_t *width = measure(t, 3);
	for (size_t row = 0; row < t->count; row += t->columns) {
		for (size_t i = 0; i < t->columns; i++) {
			char *text = text_of(t, row + i);
			int room = (int)(width[i] - ob_utf8_count(text)), before = t->align[i] == 'r' ? room : 0;
			fprintf(f, "%s%*s%s%*s", i ? " | " : "| ", before, "", text, room - before, "");
			free(text);
		}
		fputs(" |\n", f);
		for (size_t i = 0; row == 0 && i < t->columns; i++) {
			fputs(i ? " | " : "| ", f);
			for (size_t j = 1; j < width[i]; j++)
				putc('-', f);
			putc(t->align[i] == 'r' ? ':' : '-', f);
		}
		if (row == 0)
			fputs(" |\n", f);
	}
	free(width);
	free_table(t);
}

static void write_cell(const ob_table *t, ob_page *p, size_t i)
{
	const cell *c = &t->cell[i];
	bool head = i < t->columns, right = t->align[i % t->columns] == 'r';
	const char *class = c->class ? c->class : "", *name = head ? "th scope=\"col\"" : "td";
	if (right || *class)
		ob_page_markup(p, "<%s class=\"%s%s%s\">", name, right ? "n" : "", right && *class ? " " : "", class);
	else
		ob_page_markup(p, "<%s>", name);
	if (c->link)
		ob_page_markup(p, "<a href=\"#%s\">", c->link);
	ob_page_text(p, c->text ? c->text : "");
	if (c->link)
		ob_page_markup(p, "</a>");
	if (c->small) {
		ob_page_markup(p, "<small>");
		ob_page_text(p, c->small);
		ob_page_markup(p, "</small>");
	}
	ob_page_markup(p, head ? "</th>" : "</td>");
}

void ob_table_html(ob_table *t, ob_page *p)
{
	if (!t)
		return;
	ob_page_markup(p, "<div class=\"scroll\"><table>\n<thead>");
	for (size_t row = 0; row < t->count; row += t->columns) {
		if (t->cell[row].heading) {
			ob_page_markup(p, "<tr><th colspan=\"%zu\" scope=\"rowgroup\">", t->columns);
			ob_page_text(p, t->cell[row].text ? t->cell[row].text : "");
			ob_page_markup(p, "</th></tr>\n");
			continue;
		}
		ob_page_markup(p, "<tr>");
		for (size_t i = row; i < row + t->columns && i < t->count; i++)
			write_cell(t, p, i);
		ob_page_markup(p, row ? "</tr>\n" : "</tr></thead>\n<tbody>\n");
	}
	ob_page_markup(p, "</tbody></table></div>\n");
	free_table(t);
}

// ---- words

void ob_say(char *to, size_t room, const char *format, ...)
{
	size_t used = strlen(to);
	va_list args;
	va_start(args, format);
	vsnprintf(to + used, room - used, format, args);
	va_end(args);
}

// True if v is easier to read as digits than with an exponent.
static bool is_plain(double v)
{
	return v == 0 || (fabs(v) >= 9.995e-4 && fabs(v) < 99950);
}

// Prints three digits, as "0.412", "35.9", "12400".
static void print_plain(char *to, size_t room, double v)
{
	int before = v == 0 ? 1 : (int)floor(log10(fabs(v) * 1.0005)) + 1; // digits before the point
	int behind = before >= 3 ? 0 : 3 - before;
	snprintf(to, room, "%.*f", behind, v);
	char *point = strchr(to, '.');
	for (char *end = to + strlen(to) - 1; point && (*end == '0' || *end == '.'); end--) {
		bool was_point = *end == '.';
		*end = 0;
		if (was_point)
			break;
	}
}

// Splits v into a mantissa and a power of ten, rounded to three digits.
static int split(double v, double *mantissa)
{
	char text[40];
	snprintf(text, sizeof text, "%.2e", v);
	char *e = strchr(text, 'e');
	int power = atoi(e + 1);
	*e = 0;
	*mantissa = atof(text);
	return power;
}

ob_word ob_word_unit(const char *unit)
{
	ob_word w = { "" };
	for (; *unit; unit++) {
		const bool raised = *unit == '^' && (unit[1] == '2' || unit[1] == '3');
		unit += raised;
		OB_SAY(w.text, "%.*s", raised ? 2 : 1, !raised ? unit : *unit == '2' ? "\u00b2" : "\u00b3");
	}
	return w;
}

// Prints "1e-6", not "1e-06".
static void print_short(char *to, size_t room, double v)
{
	double mantissa;
	if (isfinite(v)) {
		int power = split(v, &mantissa);
		snprintf(to, room, "%.3ge%d", mantissa, power);
	} else {
		snprintf(to, room, "%s", isnan(v) ? "\u2013" : "\u221e");
	}
}

ob_word ob_word_quantity(double v, const char *unit)
{
	ob_word w;
	if (is_plain(v))
		print_plain(w.text, sizeof w.text, v);
	else
		print_short(w.text, sizeof w.text, v);
	if (strcmp(unit, "1"))
		OB_SAY(w.text, " %s", ob_word_unit(unit).text);
	return w;
}

ob_word ob_word_number(double v)
{
	return ob_word_quantity(v, "1");
}

ob_word ob_word_metric(double v, const ob_metric *m)
{
	return ob_word_quantity(v * m->scale, m->unit);
}

void ob_word_wrap(FILE *f, const char *before, const char *text, size_t width)
{
	size_t used = 0;
	while (*(text += strspn(text, " "))) {
		const size_t bytes = strcspn(text, " ");
		size_t letters = 0;
		for (size_t i = 0; i < bytes; i++)
			letters += (text[i] & 0xc0) != 0x80; // UTF-8
		const bool on = used && used + 1 + letters <= width;
		fprintf(f, "%s%s%.*s", on ? " " : used ? "\n" : "", on ? "" : before, (int)bytes, text);
		used = (on ? used + 1 : 0) + letters;
		text += bytes;
	}
	if (used)
		fputc('\n', f);
}

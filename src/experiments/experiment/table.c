#include "experiment/table.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/utf8.h"
#include "experiment/words.h"

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

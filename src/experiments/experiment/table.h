// A table, built once cell by cell for all formats: text on a terminal, Markdown, HTML. One thread at a time per table.
#ifndef OB_EXPERIMENT_TABLE_H
#define OB_EXPERIMENT_TABLE_H

#include <stdbool.h>
#include <stdio.h>

#include "experiment/experiment.h"
#include "experiment/page.h"
#include "experiment/analysis.h"

typedef struct ob_table ob_table;

// align: a letter for each column, l or r. Ends the program if memory runs out.
ob_table *ob_table_new(const char *align);
// Adds the next cell; the first row is the head. A cell without memory stays empty.
void ob_table_add(ob_table *t, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Adds texts, up to a NULL.
void ob_table_row(ob_table *t, const char *first, ...) __attribute__((sentinel));

// Adds a row that is one heading, between complete rows.
void ob_table_heading(ob_table *t, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Adds a small text to the last cell: below it in HTML, in brackets behind it elsewhere.
void ob_table_small(ob_table *t, const char *format, ...) __attribute__((format(printf, 2, 3)));
void ob_table_class(ob_table *t, const char *class); // in HTML: "met", "missed", "best"; a static string
void ob_table_link(ob_table *t, const char *id); // in HTML: link to #id; a static string

// Adds a median in the metric's unit for people, with its interval, if there is one.
void ob_table_add_median(ob_table *t, const ob_metric *m, const ob_statistics *s);

// Each form writes the table, and frees it; NULL writes nothing.
//
// width: characters of a line; columns that do not fit follow in a further panel below, behind the first column again.
// 0 = no limit
void ob_table_print(ob_table *t, FILE *f, size_t width);
void ob_table_markdown(ob_table *t, FILE *f);
void ob_table_html(ob_table *t, ob_page *p);

// ---- words

// Texts of figures: numbers that people can read, with units; sentences made of them. Pure functions; any thread.

typedef struct ob_word {
	char text[80];
} ob_word;

// A number of three digits with its unit: "0.5 mm²" from "mm^2"; unit "1" = a bare number; a dash for NaN.
ob_word ob_word_quantity(double v, const char *unit);
ob_word ob_word_number(double v); // the same, bare
ob_word ob_word_metric(double v, const ob_metric *m); // in its unit for people
ob_word ob_word_unit(const char *unit); // alone, with superscript digits

// Appends to the text in an array, which is cut at its end.
#define OB_SAY(to, ...) ob_say(to, sizeof(to), __VA_ARGS__)
void ob_say(char *to, size_t room, const char *format, ...) __attribute__((format(printf, 3, 4)));

// Prints lines of at most this width behind "before", unless a word is longer.
void ob_word_wrap(FILE *f, const char *before, const char *text, size_t width);

#endif

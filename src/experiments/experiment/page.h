// HTML output of all reports: templates with slots, escaped texts, one style and one script, which draws
// the diagrams. A page needs no other file and no network. One thread at a time per page.
#ifndef OB_EXPERIMENT_PAGE_H
#define OB_EXPERIMENT_PAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "experiment/experiment.h"

typedef struct ob_page {
	FILE *out;
} ob_page;

// Value of {{name}} in a template.
typedef struct ob_page_slot {
	const char *name;
	void (*write)(ob_page *p, const void *with);
} ob_page_slot;

void ob_page_fill(ob_page *p, const char *template, const ob_page_slot *slot, size_t slots, const void *with);

typedef struct ob_report {
	const char *title, *style; // style: more of it, "" = none
	const char *body; // a template
	const ob_page_slot *slot;
	size_t slots;
} ob_report;

// Writes DIR/report.html, which replaces one that is there.
bool ob_report_write(const ob_report *r, const char *folder, const void *with, ob_error *e);

// printf of markup; the arguments must not need escaping.
void ob_page_markup(ob_page *p, const char *format, ...) __attribute__((format(printf, 2, 3)));
void ob_page_text(ob_page *p, const char *text);
// A paragraph; "" writes none. class: "" = none
void ob_page_paragraph(ob_page *p, const char *class, const char *text);
// Term of a list, and what it means; the name must not need escaping.
void ob_page_term(ob_page *p, const char *name, const char *text);

// Terms of a list: the machine and the program that the records are of. Returns the time that they took, s.
double ob_page_provenance(ob_page *p, const ob_records *r);
// Lists of the metrics' titles and meanings, with a heading above each group.
void ob_page_meanings(ob_page *p, const ob_metric *m, size_t count);

#endif

// The paper's tables with ours beside them, as rows of figures; for the page, for Markdown, for CSV.
#ifndef OB_PAPER_TABLE_H
#define OB_PAPER_TABLE_H

#include <stdio.h>

#include "paper/claims.h"

enum { OB_PAPER_COLUMNS = 6, OB_PAPER_TABLES = 7 };

typedef struct ob_paper_column {
	const char *head;
	bool paper; // as printed there, else measured here
	ob_paper_quantity quantity;
} ob_paper_column;

typedef struct ob_paper_table {
	const char *id, *title;
	ob_paper_scenario scenario;
	size_t columns;
	ob_paper_column column[OB_PAPER_COLUMNS];
} ob_paper_table;

// Tables 1 to 5 of the paper, then what it never ran
extern const ob_paper_table ob_paper_tables[OB_PAPER_TABLES];

// A report's matter
typedef struct ob_paper_matter {
	const ob_paper_results *here;
	ob_paper_results paper;
	ob_paper_claim claim[OB_PAPER_CLAIMS];
} ob_paper_matter;

ob_paper_matter ob_paper_matter_make(const ob_paper_results *r);
void ob_paper_matter_finish(ob_paper_matter *m);

const ob_paper_results *ob_paper_source(const ob_paper_matter *m, const ob_paper_column *c);
uint32_t ob_paper_rows(const ob_paper_matter *m);
double ob_paper_cell(const ob_paper_matter *m, const ob_paper_table *t, size_t column, uint32_t row); // in its unit
ob_statistics ob_paper_foot(const ob_paper_matter *m, const ob_paper_table *t, size_t column); // in its unit

// Claims, tables and means as Markdown; all runs as CSV
void ob_paper_write_markdown(const ob_paper_matter *m, FILE *f);
void ob_paper_write_csv(const ob_paper_results *r, FILE *f);

#endif

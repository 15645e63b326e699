// Report of the experiment: one self-contained page, its diagrams, Markdown, JSON.
#ifndef OB_PAPER_REPORT_H
#define OB_PAPER_REPORT_H

#include <stdio.h>

#include "experiment/chart.h"
#include "experiment/table.h"
#include "paper/claims.h"

// Writes DIR/report.html and tables.md into an existing DIR. The same results give the same files. One thread at a time per
// directory.
bool ob_paper_report(const ob_paper_results *r, const char *dir, ob_error *e);

// Writes claims, means and all runs as one object of JSON.
void ob_paper_write_json(const ob_paper_results *r, const char *version, FILE *f);

// ---- parts of the report, for its own files and their tests

// Measured results, the paper's, and verdicts.
typedef struct ob_paper_report_model {
	const ob_paper_results *here;
	ob_paper_results paper;
	ob_paper_claim claim[OB_PAPER_CLAIMS];
} ob_paper_report_model;

ob_paper_report_model ob_paper_report_model_make(const ob_paper_results *r);
void ob_paper_report_model_finish(ob_paper_report_model *m);

// Tables 1 to 5 of the paper with ours beside them, then scenarios that it never ran.
enum { OB_PAPER_TABLES = 7 };
// NULL: out of memory.
ob_table *ob_paper_table_make(const ob_paper_report_model *m, int table);

// The paper's figures, with ours added.
enum { OB_PAPER_CHARTS = 6 };
ob_chart *ob_paper_chart_make(const ob_paper_report_model *m, int chart);

#endif

// The lab's report: diagrams, and one self-contained page for readers new to obsim.
#ifndef OB_LAB_REPORT_H
#define OB_LAB_REPORT_H

#include <stdio.h>

#include "experiment/page.h"
#include "experiment/table.h"
#include "lab/analysis.h"

// Makes DIR, and writes report.html and the tables rows.md, conserved.md, audit.md, equal.md and equal.csv there. The same
// results give the same files. One thread at a time per directory.
bool ob_lab_report(const ob_results *r, const char *dir, ob_error *e);

// Writes the results for other programs. version: of this one
void ob_lab_write_json(const ob_results *r, const char *version, FILE *f);

// ---- chart

// Diagrams of the report, from results. One thread at a time per chart.

// NULL: nothing to show, or out of memory. Pass each to ob_chart_free.
ob_chart *ob_lab_chart_cost(const ob_lab_analysis *d, const ob_case *c); // error over cost, a curve an engine
ob_chart *ob_lab_chart_convergence(const ob_lab_analysis *d,
				   const ob_case *c); // error over substeps, with the observed order
ob_chart *ob_lab_chart_promises(const ob_lab_analysis *d); // all cases: error over target, obsim beside other engines
ob_chart *ob_lab_chart_ghost(const ob_lab_analysis *d); // all cases: neighbours of infinite mass
// Error of free simulators over the delay of what they publish, with its order. NULL: none was run.
ob_chart *ob_lab_chart_delay(const ob_lab_analysis *d, const ob_case *c);
ob_chart *ob_lab_chart_lag(const ob_lab_analysis *d); // error over the delay of reading partners

// Prints a setting as the label of its point: "8", "240 Hz", "0.5 mm".
void ob_lab_chart_setting(const ob_result *r, char *to, size_t room);

// ---- tables

// Tables of the lab: each is built once, for a terminal, for documents and for the report. Pure except for printing;
// any thread.

// All promised figures at usual settings beside their targets, and the best of another engine at its usual settings.
ob_table *ob_lab_table_rows(const ob_lab_analysis *d);
// Drift of momentum and angular momentum, and gain of energy, at usual settings, for every case whose world conserves
// any.
ob_table *ob_lab_table_conserved(const ob_lab_analysis *d);
// Cost at equal error of the compared cases. in_page: adds the least errors of engines that never reach it;
// short_names: engines as on the command line. NULL: no engine ran in one.
ob_table *ob_lab_table_equal(const ob_lab_analysis *d, bool in_page, bool short_names);
// One case: all engines at their usual settings; all settings.
ob_table *ob_lab_table_engines(const ob_lab_analysis *d, const ob_case *c);
ob_table *ob_lab_table_runs(const ob_lab_analysis *d, const ob_case *c);

size_t ob_lab_count_missed(const ob_lab_analysis *d); // missed targets

// Prints for a terminal or, as Markdown, for documents.
void ob_lab_print_rows(FILE *f, const ob_lab_analysis *d, bool markdown);
// with a line that names quantities that are not conserved
void ob_lab_print_conserved(FILE *f, const ob_lab_analysis *d, bool markdown);
void ob_lab_print_equal(FILE *f, const ob_lab_analysis *d, bool markdown);
void ob_lab_print_equal_csv(FILE *f, const ob_lab_analysis *d, bool markdown);

#endif

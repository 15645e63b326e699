// Tables of the lab: each is built once, for a terminal, for documents and for the report. Pure except for printing;
// any thread.
#ifndef OB_LAB_TABLES_H
#define OB_LAB_TABLES_H

#include <stdio.h>

#include "experiment/table.h"
#include "lab/analysis.h"

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

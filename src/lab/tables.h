// The tables of the lab: each made once, for people on a terminal, for documents and for the report. Pure but for
// printing; any thread.
#ifndef OB_LAB_TABLES_H
#define OB_LAB_TABLES_H

#include <stdio.h>

#include "experiment/table.h"
#include "lab/analysis.h"

// Every promised figure at usual settings beside its target, and the best that another engine reached at its own.
ob_table *ob_lab_table_rows(const ob_lab_analysis *d);
// Drift of momentum and angular momentum, gain of energy at usual settings: of every case whose world keeps any
ob_table *ob_lab_table_conserved(const ob_lab_analysis *d);
// Cost at equal error, of the cases that are compared. in_page: with what engines that never get there reach;
// short_names: of engines, as on the command line. NULL: no engine took part in one.
ob_table *ob_lab_table_equal(const ob_lab_analysis *d, bool in_page, bool short_names);
// One case: all engines at their usual settings; all settings
ob_table *ob_lab_table_engines(const ob_lab_analysis *d, const ob_case *c);
ob_table *ob_lab_table_runs(const ob_lab_analysis *d, const ob_case *c);

size_t ob_lab_count_missed(const ob_lab_analysis *d); // targets

// For a terminal or, as Markdown, for documents
void ob_lab_print_rows(FILE *f, const ob_lab_analysis *d, bool markdown);
void ob_lab_print_conserved(FILE *f, const ob_lab_analysis *d, bool markdown); // with a line that names what is not kept
void ob_lab_print_equal(FILE *f, const ob_lab_analysis *d, bool markdown);
void ob_lab_write_equal(FILE *f, const ob_lab_analysis *d); // CSV

#endif

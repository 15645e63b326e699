// The report of the paper's experiment: one page that explains itself, its diagrams, tables and figures.
#ifndef OB_PAPER_REPORT_H
#define OB_PAPER_REPORT_H

#include <ob/error.h>

#include "paper/sample.h"

// Writes DIR/report.html (self-contained: no script, no network), tables.md, results.csv, and plots/NAME.svg and .png.
// DIR is there; plots is made. The same results give the same files. One thread at a time per directory.
bool ob_paper_report(const ob_paper_results *r, const char *dir, ob_error *e);

#endif

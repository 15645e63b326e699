// Report of the experiment: one self-contained page, Markdown, JSON.
#ifndef OB_PAPER_REPORT_H
#define OB_PAPER_REPORT_H

#include <stdio.h>

#include "paper/results.h"

// Writes report.html and tables.md into an existing folder. The same results give the same files. One thread at a time per
// folder.
bool ob_paper_report(const ob_paper_results *r, const char *dir, ob_error *e);

// Writes claims, means and all runs as one object of JSON.
void ob_paper_write_json(const ob_paper_results *r, const char *version, FILE *f);

#endif

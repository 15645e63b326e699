// The lab's report: diagrams, and one self-contained page for readers new to obsim.
#ifndef OB_LAB_REPORT_H
#define OB_LAB_REPORT_H

#include <stdio.h>

#include "lab/result.h"

// Makes DIR, and writes report.html and the tables rows.md, conserved.md, audit.md, equal.md and equal.csv there. The same
// results give the same files. One thread at a time per directory.
bool ob_lab_report(const ob_results *r, const char *dir, ob_error *e);

// Writes the results for other programs. version: of this one
void ob_lab_write_json(const ob_results *r, const char *version, FILE *f);

#endif

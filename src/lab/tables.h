// The two tables of the lab, for people, for documents and for other programs. Pure but for printing; any thread.
#ifndef OB_LAB_TABLES_H
#define OB_LAB_TABLES_H

#include <stdio.h>

#include "lab/digest.h"

// Every promised figure at usual settings beside its target, and the best that another engine reached at its own.
void ob_lab_print_rows(FILE *f, const ob_digest *d, bool markdown);
size_t ob_lab_count_missed(const ob_digest *d); // targets
// Cost at equal error, of the cases that are compared.
void ob_lab_print_equal(FILE *f, const ob_digest *d, bool markdown);
void ob_lab_write_equal(FILE *f, const ob_digest *d); // CSV (RFC 4180)

#endif

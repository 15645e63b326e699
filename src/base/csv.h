// CSV (RFC 4180), but records end with a bare line feed: cells with commas, quotes or line ends are quoted, a quote
// inside is doubled. The only writer and the only reader of the tree. One thread at a time per writer or reader.
#ifndef OB_BASE_CSV_H
#define OB_BASE_CSV_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

// Starts as { .f = file }; each cell puts the comma before itself. Errors stay in the file (ferror).
typedef struct ob_csv {
	FILE *f;
	bool filled; // the record has a cell
} ob_csv;

void ob_csv_text(ob_csv *c, const char *text);
void ob_csv_count(ob_csv *c, uint64_t n);
// As many digits (15 to 17) as it takes to read the same bits back; NaN is an empty cell.
void ob_csv_number(ob_csv *c, double v);
// Several numbers in one cell, with a space between.
void ob_csv_numbers(ob_csv *c, const double *v, size_t count);
void ob_csv_end(ob_csv *c); // of the record

// Starts as { .at = text }. The text, which ends with 0, is taken apart where it stands.
typedef struct ob_csv_reader {
	char *at; // what has not been read; *at is 0 after the last record
	int record; // number of the record that was read last, from 1
} ob_csv_reader;

// Reads the next record (line ends: LF, CR or CR LF); cell[i], i < min(cells, max), point into the text. Returns how
// many cells the record has (may exceed max); 0 where it is not CSV: a quoted cell does not end, or goes on behind its
// quote.
size_t ob_csv_read(ob_csv_reader *r, char **cell, size_t max);

#endif

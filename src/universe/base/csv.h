// CSV (RFC 4180), but records end with a bare line feed: cells with commas, quotes or line ends are quoted, a quote
// inside is doubled. The only writer and the only reader of the tree. One thread at a time per writer or reader.
#ifndef OB_BASE_CSV_H
#define OB_BASE_CSV_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

// Start with { .f = file }; each cell writes the comma before itself. Errors stay in the file (ferror).
typedef struct ob_csv {
	FILE *f;
	bool filled; // the record has a cell
} ob_csv;

void ob_csv_text(ob_csv *c, const char *text);
void ob_csv_count(ob_csv *c, uint64_t n);
// Writes the fewest digits (15 to 17) that read back as the same bits; NaN is an empty cell.
void ob_csv_number(ob_csv *c, double v);
// Writes several numbers into one cell, with spaces between.
void ob_csv_numbers(ob_csv *c, const double *v, size_t count);
void ob_csv_end(ob_csv *c); // ends the record

// Start with { .at = text }. The text ends with 0 and is split in place.
typedef struct ob_csv_reader {
	char *at; // unread text; *at is 0 after the last record
	int record; // number of the last record read, from 1
} ob_csv_reader;

// Reads the next record (line ends: LF, CR or CR LF); cell[i], i < min(cells, max), point into the text. Returns the
// number of cells in the record (may exceed max); 0 if it is not CSV: an unterminated quoted cell, or text behind its
// closing quote.
size_t ob_csv_read(ob_csv_reader *r, char **cell, size_t max);

#endif

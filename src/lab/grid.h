// A table of texts, cell by cell: for people on a terminal, or as Markdown. One thread at a time per grid.
#ifndef OB_LAB_GRID_H
#define OB_LAB_GRID_H

#include <stdbool.h>
#include <stdio.h>

typedef struct ob_grid ob_grid;

// align: a letter for each column, l or r. NULL: no memory.
ob_grid *ob_grid_new(const char *align);
void ob_grid_free(ob_grid *g);
// The next cell; the first row is the head. A cell for which there is no memory stays empty.
void ob_grid_add(ob_grid *g, const char *format, ...) __attribute__((format(printf, 2, 3)));
void ob_grid_print(const ob_grid *g, FILE *f, bool markdown);

#endif

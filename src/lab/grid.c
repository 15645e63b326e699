#include "lab/grid.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"

struct ob_grid {
	const char *align;
	size_t columns, count, max;
	char **cell; // row by row; NULL = empty
};

ob_grid *ob_grid_new(const char *align)
{
	ob_grid *g = calloc(1, sizeof *g);
	if (g)
		*g = (ob_grid){ .align = align, .columns = strlen(align) };
	return g;
}

void ob_grid_free(ob_grid *g)
{
	for (size_t i = 0; g && i < g->count; i++)
		free(g->cell[i]);
	if (g)
		free(g->cell);
	free(g);
}

void ob_grid_add(ob_grid *g, const char *format, ...)
{
	if (g->count == g->max) {
		size_t max = g->max ? 2 * g->max : 64;
		char **more = reallocarray(g->cell, max, sizeof *more);
		if (!more)
			return;
		g->cell = more;
		g->max = max;
	}
	va_list args;
	va_start(args, format);
	if (vasprintf(&g->cell[g->count++], format, args) < 0)
		g->cell[g->count - 1] = NULL;
	va_end(args);
}

static const char *text_of(const ob_grid *g, size_t i)
{
	return i < g->count && g->cell[i] ? g->cell[i] : "";
}

static void print_row(const ob_grid *g, FILE *f, size_t first, const size_t *width, bool markdown)
{
	int trailing = 0; // spaces that nothing has followed yet
	for (size_t i = 0; i < g->columns; i++) {
		const char *text = text_of(g, first + i);
		int room = (int)(width[i] - ob_utf8_count(text)), before = g->align[i] == 'r' ? room : 0;
		trailing += (i && !markdown ? 2 : 0) + before;
		if (markdown)
			fprintf(f, "%s%*s%s%*s", i ? " | " : "| ", before, "", text, room - before, "");
		else if (*text)
			fprintf(f, "%*s%s", trailing, "", text);
		trailing = (*text || markdown ? 0 : trailing) + room - before;
	}
	fputs(markdown ? " |\n" : "\n", f);
}

static void print_rule(const ob_grid *g, FILE *f, const size_t *width)
{
	for (size_t i = 0; i < g->columns; i++) {
		fputs(i ? " | " : "| ", f);
		for (size_t j = 1; j < width[i]; j++)
			putc('-', f);
		putc(g->align[i] == 'r' ? ':' : '-', f);
	}
	fputs(" |\n", f);
}

void ob_grid_print(const ob_grid *g, FILE *f, bool markdown)
{
	size_t *width = calloc(g->columns, sizeof *width);
	for (size_t i = 0; width && i < g->columns; i++)
		width[i] = markdown ? 3 : 0;
	for (size_t i = 0; width && i < g->count; i++) {
		size_t w = ob_utf8_count(text_of(g, i)), *widest = &width[i % g->columns];
		*widest = w > *widest ? w : *widest;
	}
	for (size_t i = 0; width && i < g->count; i += g->columns) {
		print_row(g, f, i, width, markdown);
		if (markdown && i == 0)
			print_rule(g, f, width);
	}
	free(width);
}

#include "plot/legend.h"

#include <math.h>

#include "plot/letters.h"
#include "plot/palette.h"

enum { SAMPLE = 26, GAP = 7, BETWEEN = 20, ROW = 18, LINE = 14, LINES = 3, COLUMN = 168 }; // px, but for LINES
static const double font = 12; // px

static const char *entry_title(const ob_legend *l, size_t i)
{
	const ob_plot *p = l->frame->plot;
	return i == p->series_count ? "failed" : p->series[i].title;
}

// Draws (or with d NULL only measures) the lines of one entry; returns how many.
static int entry_lines(const ob_legend *l, size_t i, double width, ob_drawing *d, double x, double y, double *widest)
{
	const char *rest = entry_title(l, i);
	char line[160];
	int lines = 0, most = l->below ? 1 : LINES;
	while (lines < most && ob_letters_line(&rest, width, font, false, lines == most - 1, line, sizeof line)) {
		*widest = fmax(*widest, ob_letters_width(line, font, false));
		if (d)
			ob_draw_text(d, x, y + lines * LINE, line, "",
				     (ob_type){ .size = font, .paint = OB_PAINT_INK });
		lines++;
	}
	return lines;
}

static void draw_sample(const ob_legend *l, size_t i, ob_drawing *d, double x, double y)
{
	const ob_plot *p = l->frame->plot;
	ob_dot middle = { x + SAMPLE / 2., y };
	if (i == p->series_count) {
		ob_palette_cross(d, middle, &(ob_narrowphase_find){ .paint = OB_PAINT_INK });
		return;
	}
	ob_narrowphase_find look = ob_palette_look(p->series[i].style, p->series[i].hollow);
	if (p->series[i].line)
		ob_draw_line(d, x, y, x + SAMPLE, y,
			     (ob_pen){ .stroke = look.paint, .width = look.width, .dash = look.dash });
	ob_palette_marker(d, middle, &look);
}

// Walks over the entries as they are placed; draws them if d is not NULL. Returns the height.
static double walk(const ob_legend *l, double room, ob_drawing *d, double left, double top, double *widest)
{
	double x = 0, y = 0;
	for (size_t i = 0; i < l->entries; i++) {
		double text = 0;
		if (!entry_title(l, i))
			continue;
		int lines = entry_lines(l, i, room - SAMPLE - GAP, NULL, 0, 0, &text);
		double width = SAMPLE + GAP + text;
		if (l->below && x > 0 && x + width > room) {
			x = 0;
			y += ROW;
		}
		if (d) {
			draw_sample(l, i, d, left + x, top + y + ROW / 2.);
			entry_lines(l, i, room - SAMPLE - GAP, d, left + x + SAMPLE + GAP,
				    top + y + ROW / 2. + font * .36, &text);
		}
		*widest = fmax(*widest, x + width);
		if (l->below)
			x += width + BETWEEN;
		else
			y += ROW + (lines > 1 ? (lines - 1) * LINE : 0) + 3;
	}
	return l->entries ? y + (l->below ? ROW : 0) : 0;
}

ob_legend ob_legend_plan(const ob_frame *f, double width, double height)
{
	size_t count = f->plot->series_count;
	ob_legend l = { .frame = f, .entries = count > 1 || f->failed ? count + f->failed : 0 };
	l.height = walk(&l, COLUMN + SAMPLE + GAP, NULL, 0, 0, &l.width);
	if (l.width > width * .3 || l.height > height) {
		l.below = true;
		double widest = 0;
		l.height = walk(&l, width, NULL, 0, 0, &widest);
		l.width = width;
	}
	return l;
}

void ob_legend_draw(const ob_legend *l, ob_drawing *d, double x, double y)
{
	double widest = 0;
	walk(l, l->below ? l->width : COLUMN + SAMPLE + GAP, d, x, y, &widest);
}

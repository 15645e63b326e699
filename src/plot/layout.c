#include "plot/layout.h"

#include <math.h>

#include "plot/axes.h"
#include "plot/curves.h"
#include "plot/frame.h"
#include "plot/labels.h"
#include "plot/legend.h"
#include "plot/letters.h"

enum { RIM = 14, WIDTH = 760, HEIGHT = 480, WIDTH_LEAST = 240, AREA_LEAST = 130, HEADING_LINES = 3, GAP = 12 }; // px
static const double title_font = 15, subtitle_font = 11;

// Draws the lines of a heading from y on; returns where it ends.
static double draw_heading(ob_drawing *d, const char *text, double y, double size, bool bold, ob_paint paint)
{
	char line[400];
	for (int i = 0; text && i < HEADING_LINES; i++) {
		if (!ob_letters_line(&text, d->width - 2 * RIM, size, bold, i == HEADING_LINES - 1, line, sizeof line))
			break;
		y += size * 1.3;
		ob_draw_text(d, RIM, y - size * .3, line, "", (ob_type){ .size = size, .paint = paint, .bold = bold });
	}
	return y;
}

// Where the data go: margins as the labels of the axes need them, which in turn depend on the room that is left.
static void place(ob_frame *f, ob_drawing *d, const ob_legend *l, double top, double height)
{
	double right = l->entries && !l->below ? l->width + GAP + 4 : 0;
	ob_rect outer = { RIM + 60, top, d->width - RIM - right, top + height };
	for (int pass = 0; pass < 3; pass++) {
		ob_frame_place(f, outer);
		outer.x0 = RIM + ob_axes_left(f, d->width);
		outer.x1 = fmax(d->width - RIM - fmax(right, ob_axes_right(f)), outer.x0 + 60);
	}
	ob_frame_place(f, outer);
}

static bool compose(ob_frame *f, ob_drawing *d)
{
	const ob_plot *p = f->plot;
	double top = draw_heading(d, p->title, RIM, title_font, true, OB_PAINT_INK);
	top = draw_heading(d, p->subtitle, top + 2, subtitle_font, false, OB_PAINT_MUTED) + GAP;
	ob_legend l = ob_legend_plan(f, d->width - 2 * RIM, d->height - top - RIM);
	double below = ob_axes_bottom + (l.below ? l.height + GAP : 0) + RIM / 2.;
	double height = fmax(d->height - top - below, AREA_LEAST);
	d->height = top + height + below;
	place(f, d, &l, top, height);
	ob_axes_bands(f, d);
	ob_curves_tints(f, d);
	ob_axes_draw(f, d);
	if (!ob_curves_draw(f, d) || !ob_labels_draw(f, d))
		return false;
	if (l.entries)
		ob_legend_draw(&l, d, l.below ? RIM : d->width - RIM - l.width,
			       l.below ? top + height + ob_axes_bottom + GAP : top);
	return !d->broken;
}

bool ob_plot_layout(const ob_plot *p, ob_drawing *d, ob_error *e)
{
	ob_frame f;
	d->width = isfinite(p->width) && p->width > 0 ? fmin(fmax(p->width, WIDTH_LEAST), 8000) : WIDTH;
	d->height = isfinite(p->height) && p->height > 0 ? fmin(p->height, 8000) : HEIGHT;
	bool ok = ob_frame_begin(&f, p) && compose(&f, d);
	ob_frame_finish(&f);
	return ok || ob_fail(e, "no memory for a diagram");
}

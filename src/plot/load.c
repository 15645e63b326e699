// PNG and captions as the program sees them: loads the part that calls cairo.
#include <math.h>

#include "plot/caption.h"
#include "plot/part.h"

#define PACKAGE "libcairo2"

static const ob_plot_part *load(ob_error *e)
{
	return ob_part_load("cairo", sizeof(ob_plot_part), OB_PART_PROGRAM, PACKAGE, e);
}

bool ob_plot_check(ob_error *e)
{
	return ob_part_check("cairo", PACKAGE, e);
}

bool ob_plot_png(const ob_plot *p, const char *path, double zoom, ob_error *e)
{
	ob_drawing d = { 0 };
	const ob_plot_part *part = load(e);
	bool ok = part && ob_plot_layout(p, &d, e) && part->png(&d, path, zoom > 0 ? fmin(zoom, 8) : 1, e);
	ob_drawing_finish(&d);
	return ok;
}

bool ob_plot_caption(uint8_t *rgba, int width, int height, const char *title, const char *time, ob_error *e)
{
	const ob_plot_part *part = load(e);
	return part && part->caption(rgba, width, height, title, time, e);
}

bool ob_plot_strip(uint8_t *rgba, int width, int height, const ob_strip *s, ob_error *e)
{
	const ob_plot_part *part = load(e);
	return part && part->strip(rgba, width, height, s, e);
}

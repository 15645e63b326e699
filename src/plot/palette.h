// How things look: colours that people with any kind of colour vision tell apart (after Okabe and Ito 2008), markers
// and dashes, so that a curve is known by three signs. Pure; any thread.
#ifndef OB_PLOT_PALETTE_H
#define OB_PLOT_PALETTE_H

#include "plot/drawing.h"

typedef struct ob_narrowphase_find {
	ob_paint paint;
	int marker;
	int dash;
	double width; // px, of the line
	double size; // px, from the marker's middle to its rim
	bool hollow;
} ob_narrowphase_find;

// Of a style number; see ob_plot_series
ob_narrowphase_find ob_palette_look(int style, bool hollow);
void ob_palette_marker(ob_drawing *d, ob_dot at, const ob_narrowphase_find *look);
void ob_palette_cross(ob_drawing *d, ob_dot at, const ob_narrowphase_find *look);

const char *ob_palette_name(ob_paint paint); // "ink", as in the classes of an SVG
unsigned ob_palette_rgb(ob_paint paint); // 0xrrggbb
const double *ob_palette_dash(int dash, int *count); // px on, off, ..; count 0 = solid

#endif

// The part of obsim that paints diagrams as PNG, and writes on pictures, by cairo (base/part.h): obsim-cairo.so.
#ifndef OB_PLOT_PART_H
#define OB_PLOT_PART_H

#include "base/part.h"
#include "plot/caption.h"
#include "plot/drawing.h"

typedef struct ob_plot_part {
	ob_part_head head;
	bool (*png)(const ob_drawing *d, const char *path, double zoom, ob_error *e); // zoom: pixels of a unit of d
	bool (*caption)(uint8_t *rgba, int width, int height, const char *title, const char *time, ob_error *e);
	bool (*strip)(uint8_t *rgba, int width, int height, const ob_strip *s, ob_error *e);
} ob_plot_part;

// As ob_plot_caption and ob_plot_strip.
bool ob_cairo_caption(uint8_t *rgba, int width, int height, const char *title, const char *time, ob_error *e);
bool ob_cairo_strip(uint8_t *rgba, int width, int height, const ob_strip *s, ob_error *e);

#endif

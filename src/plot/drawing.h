// A diagram as a list of lines, discs and texts in pixels (y downwards), on paper of a given size: made by the layout,
// painted by the painters (svg.c, png.c). Also the palette. One thread at a time per drawing that is written.
#ifndef OB_PLOT_DRAWING_H
#define OB_PLOT_DRAWING_H

#include "plot/plot.h"

// Purpose of a colour. Series follow one another from OB_PAINT_SERIES on.
typedef enum ob_paint {
	OB_PAINT_NONE,
	OB_PAINT_PAPER,
	OB_PAINT_INK,
	OB_PAINT_MUTED, // secondary text, tick marks
	OB_PAINT_GRID,
	OB_PAINT_BAND, // behind failed points, and zeros of a logarithmic axis
	OB_PAINT_GOOD, // line of a target
	OB_PAINT_MEADOW, // the desirable side of a target
	OB_PAINT_SERIES,
	OB_PAINTS = OB_PAINT_SERIES + 8
} ob_paint;

typedef struct ob_dot {
	double x, y; // px
} ob_dot;

typedef struct ob_rect {
	double x0, y0, x1, y1; // px; x0 <= x1, y0 <= y1
} ob_rect;

enum { OB_DASHES = 4 };
typedef struct ob_pen {
	ob_paint stroke, fill;
	double width; // px
	int dash; // 0 = solid, up to OB_DASHES - 1
} ob_pen;

typedef struct ob_type {
	double size; // px
	ob_paint paint;
	double anchor; // share of the text's width left of its point: 0 = begins there, .5 = centred, 1 = ends there
	bool bold;
	bool turned; // reads upwards
} ob_type;

typedef enum ob_item_kind { OB_ITEM_PATH, OB_ITEM_DISC, OB_ITEM_TEXT } ob_item_kind;

typedef struct ob_item {
	ob_item_kind kind;
	ob_pen pen; // path, disc
	size_t first, count; // path: its dots; disc: its centre; text: start of its base line, or its anchor
	bool closed; // path
	double radius; // disc, px
	ob_type type; // text
	size_t text, super; // text: offsets into chars; super = a raised exponent behind the text
	ob_rect box; // text: upper bound of its extent
	size_t hint; // tooltip in a browser: offset into chars
} ob_item;

typedef struct ob_drawing {
	double width, height; // px
	size_t items, items_max, dots, dots_max, chars, chars_max;
	ob_item *item;
	ob_dot *dot;
	char *text; // chars[0] is "": an offset of 0 means none
	bool out_of_memory; // the drawing is incomplete
} ob_drawing;

void ob_drawing_finish(ob_drawing *d);

void ob_draw_path(ob_drawing *d, const ob_dot *dot, size_t count, bool closed, ob_pen pen);
void ob_draw_line(ob_drawing *d, double x0, double y0, double x1, double y1, ob_pen pen);
void ob_draw_rect(ob_drawing *d, ob_rect r, ob_pen pen);
void ob_draw_disc(ob_drawing *d, ob_dot centre, double radius, ob_pen pen);
// Adds a text; "super" may be "".
void ob_draw_text(ob_drawing *d, double x, double y, const char *text, const char *super, ob_type type);
// Sets the tooltip of the last item.
void ob_draw_hint(ob_drawing *d, const char *hint);

// Extent of a text, without drawing it.
ob_rect ob_drawing_box(double x, double y, const char *text, const char *super, ob_type type);
double ob_drawing_width(const char *text, const char *super, double size, bool bold);
#define OB_DRAWING_SUPER .72 // size of an exponent, relative to its text
#define OB_DRAWING_RAISE .42 // height of its base line above that of the text, relative to the text's size

static inline bool ob_rect_meet(ob_rect a, ob_rect b)
{
	return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

static inline bool ob_rect_within(ob_rect inner, ob_rect outer)
{
	return inner.x0 >= outer.x0 && inner.x1 <= outer.x1 && inner.y0 >= outer.y0 && inner.y1 <= outer.y1;
}

static inline ob_rect ob_rect_grown(ob_rect r, double by)
{
	return (ob_rect){ r.x0 - by, r.y0 - by, r.x1 + by, r.y1 + by };
}

// ---- palette: colours that people with any kind of colour vision can distinguish (after Okabe and Ito 2008), markers
// and dashes, so that three signs identify a curve

typedef struct ob_series_style {
	ob_paint paint;
	int marker;
	int dash;
	double width; // px, of the line
	double size; // px, from the marker's middle to its rim
	bool hollow;
} ob_series_style;

// Style of a number; see ob_plot_series.
ob_series_style ob_palette_style(int number, bool hollow);
void ob_palette_marker(ob_drawing *d, ob_dot at, const ob_series_style *style);
void ob_palette_cross(ob_drawing *d, ob_dot at, const ob_series_style *style);

const char *ob_palette_name(ob_paint paint); // "ink", as in the class names of an SVG
unsigned ob_palette_rgb(ob_paint paint); // 0xrrggbb
const double *ob_palette_dash(int dash, int *count); // px on, off, ..; count 0 = solid

// ---- layout

// Lays out a plot as a drawing. Fills d, which starts zeroed; call ob_drawing_finish in any case. Returns false and e
// if memory runs out.
bool ob_plot_layout(const ob_plot *p, ob_drawing *d, ob_error *e);

#endif

#include "plot/drawing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "plot/font.h"

// Makes room for "more" elements in *array; returns false if memory runs out.
static bool reserve_elements(ob_drawing *d, void **array, size_t size, size_t count, size_t more, size_t *max)
{
	if (count + more > *max) {
		size_t grown = (count + more) * 2;
		if (!ob_grow(array, grown, grown, size)) {
			d->out_of_memory = true;
			return false;
		}
		*max = grown;
	}
	return true;
}

void ob_drawing_finish(ob_drawing *d)
{
	free(d->item);
	free(d->dot);
	free(d->text);
	*d = (ob_drawing){ 0 };
}

static bool add_item(ob_drawing *d, ob_item item, const ob_dot *dot, size_t count)
{
	if (d->out_of_memory || !reserve_elements(d, (void **)&d->item, sizeof *d->item, d->items, 1, &d->items_max) ||
	    !reserve_elements(d, (void **)&d->dot, sizeof *d->dot, d->dots, count, &d->dots_max))
		return false;
	item.first = d->dots;
	item.count = count;
	memcpy(d->dot + d->dots, dot, count * sizeof *dot);
	d->dots += count;
	d->item[d->items++] = item;
	return true;
}

// Offset of a clean copy; 0 for "".
static size_t keep_text(ob_drawing *d, const char *text)
{
	size_t length = strlen(text);
	if (!length || d->out_of_memory ||
	    !reserve_elements(d, (void **)&d->text, 1, d->chars + 1, length + 1, &d->chars_max))
		return 0;
	if (!d->chars)
		d->text[d->chars++] = 0;
	size_t at = d->chars;
	ob_font_clean_text(text, d->text + at, length + 1);
	d->chars += strlen(d->text + at) + 1;
	return at;
}

void ob_draw_path(ob_drawing *d, const ob_dot *dot, size_t count, bool closed, ob_pen pen)
{
	add_item(d, (ob_item){ .kind = OB_ITEM_PATH, .pen = pen, .closed = closed }, dot, count);
}

void ob_draw_line(ob_drawing *d, double x0, double y0, double x1, double y1, ob_pen pen)
{
	ob_draw_path(d, (ob_dot[]){ { x0, y0 }, { x1, y1 } }, 2, false, pen);
}

void ob_draw_rect(ob_drawing *d, ob_rect r, ob_pen pen)
{
	ob_draw_path(d, (ob_dot[]){ { r.x0, r.y0 }, { r.x1, r.y0 }, { r.x1, r.y1 }, { r.x0, r.y1 } }, 4, true, pen);
}

void ob_draw_disc(ob_drawing *d, ob_dot centre, double radius, ob_pen pen)
{
	add_item(d, (ob_item){ .kind = OB_ITEM_DISC, .pen = pen, .radius = radius }, &centre, 1);
}

double ob_drawing_width(const char *text, const char *super, double size, bool bold)
{
	return ob_font_width(text, size, bold) + ob_font_width(super, size * OB_DRAWING_SUPER, bold);
}

ob_rect ob_drawing_box(double x, double y, const char *text, const char *super, ob_type type)
{
	double width = ob_drawing_width(text, super, type.size, type.bold), before = width * type.anchor;
	double up = type.size * OB_FONT_ASCENT, down = type.size * OB_FONT_DESCENT;
	if (*super)
		up = type.size * (OB_DRAWING_RAISE + OB_DRAWING_SUPER * OB_FONT_ASCENT);
	if (type.turned)
		return (ob_rect){ x - up, y - (width - before), x + down, y + before };
	return (ob_rect){ x - before, y - up, x + width - before, y + down };
}

void ob_draw_text(ob_drawing *d, double x, double y, const char *text, const char *super, ob_type type)
{
	ob_item item = { .kind = OB_ITEM_TEXT, .type = type, .text = keep_text(d, text), .super = keep_text(d, super) };
	if (!item.text || d->out_of_memory)
		return;
	item.box = ob_drawing_box(x, y, d->text + item.text, d->text + item.super, type);
	add_item(d, item, &(ob_dot){ x, y }, 1);
}

void ob_draw_hint(ob_drawing *d, const char *hint)
{
	size_t kept = keep_text(d, hint);
	if (kept && d->items)
		d->item[d->items - 1].hint = kept;
}

// ---- palette

static const struct {
	const char *name;
	unsigned rgb;
} paints[OB_PAINTS] = {
	[OB_PAINT_NONE] = { "none", 0 },
	[OB_PAINT_PAPER] = { "paper", 0xffffff },
	[OB_PAINT_INK] = { "ink", 0x1f2328 },
	[OB_PAINT_MUTED] = { "muted", 0x59626e },
	[OB_PAINT_GRID] = { "grid", 0xe4e7eb },
	[OB_PAINT_BAND] = { "band", 0xf3f4f6 },
	[OB_PAINT_GOOD] = { "good", 0x1a7f37 },
	[OB_PAINT_MEADOW] = { "meadow", 0xeef8f0 },
	[OB_PAINT_SERIES + 0] = { "c0", 0x0072b2 }, // blue
	[OB_PAINT_SERIES + 1] = { "c1", 0x56b4e9 }, // sky blue
	[OB_PAINT_SERIES + 2] = { "c2", 0x009e73 }, // bluish green
	[OB_PAINT_SERIES + 3] = { "c3", 0xcc79a7 }, // reddish purple
	[OB_PAINT_SERIES + 4] = { "c4", 0x7a7a7a }, // grey
	[OB_PAINT_SERIES + 5] = { "c5", 0xd55e00 }, // vermilion
	[OB_PAINT_SERIES + 6] = { "c6", 0xe69f00 }, // orange
	[OB_PAINT_SERIES + 7] = { "c7", 0x222222 }, // black
};

static const double dashes[OB_DASHES][4] = { { 0 }, { 6, 3 }, { 1.5, 2.5 }, { 8, 3, 1.5, 3 } };
enum { DASH_SOLID, DASH_DASHED, DASH_DOTTED, DASH_DOT_DASHED, COLOURS = OB_PAINTS - OB_PAINT_SERIES, MARKERS = 8 };

const char *ob_palette_name(ob_paint paint)
{
	return paints[paint].name;
}

unsigned ob_palette_rgb(ob_paint paint)
{
	return paints[paint].rgb;
}

const double *ob_palette_dash(int dash, int *count)
{
	*count = dash == DASH_SOLID ? 0 : dash == DASH_DOT_DASHED ? 4 : 2;
	return dashes[dash];
}

ob_series_style ob_palette_style(int number, bool hollow)
{
	if (number < 0)
		return (ob_series_style){ .paint = OB_PAINT_MUTED, .marker = -1, .dash = DASH_DASHED, .width = 1 };
	int colour = number % COLOURS, shape = number + number / COLOURS;
	ob_series_style style = { .paint = OB_PAINT_SERIES + colour, .marker = shape % MARKERS, .hollow = hollow };
	style.dash = hollow ? DASH_DOTTED : shape % 4 == 3 ? DASH_DOT_DASHED : shape % 2 ? DASH_DASHED : DASH_SOLID;
	style.width = number ? 1.4 : 2.2;
	style.size = number ? 3.6 : 4.4;
	return style;
}

// Corners of a regular figure, or of a star (every second corner lies nearer); the first at an angle (turns).
static void draw_polygon(ob_drawing *d, ob_dot at, int corners, double turn, double radius, double inner, ob_pen pen)
{
	ob_dot dot[12];
	for (int i = 0; i < corners; i++) {
		double angle = 2 * M_PI * (turn + (double)i / corners), r = i % 2 ? inner : radius;
		dot[i] = (ob_dot){ at.x + r * sin(angle), at.y - r * cos(angle) };
	}
	ob_draw_path(d, dot, (size_t)corners, true, pen);
}

void ob_palette_marker(ob_drawing *d, ob_dot at, const ob_series_style *style)
{
	double r = style->size;
	ob_pen pen = { .stroke = OB_PAINT_PAPER, .fill = style->paint, .width = .8 };
	if (style->hollow)
		pen = (ob_pen){ .stroke = style->paint, .fill = OB_PAINT_PAPER, .width = 1.4 };
	switch (style->marker) {
	case 0:
		ob_draw_disc(d, at, r, pen);
		break;
	case 1: // square
		draw_polygon(d, at, 4, .125, r * 1.25, r * 1.25, pen);
		break;
	case 2: // triangle
		draw_polygon(d, at, 3, 0, r * 1.35, r * 1.35, pen);
		break;
	case 3: // diamond
		draw_polygon(d, at, 4, 0, r * 1.35, r * 1.35, pen);
		break;
	case 4: // inverted triangle
		draw_polygon(d, at, 3, .5, r * 1.35, r * 1.35, pen);
		break;
	case 5: // pentagon
		draw_polygon(d, at, 5, 0, r * 1.2, r * 1.2, pen);
		break;
	case 6: // star
		draw_polygon(d, at, 10, 0, r * 1.5, r * .75, pen);
		break;
	case 7: // hexagon
		draw_polygon(d, at, 6, 0, r * 1.2, r * 1.2, pen);
		break;
	default: // a guide has none
		break;
	}
}

void ob_palette_cross(ob_drawing *d, ob_dot at, const ob_series_style *style)
{
	double r = 3.6;
	ob_pen pen = { .stroke = style->paint, .width = 1.8 };
	ob_dot one[] = { { at.x - r, at.y - r }, { at.x + r, at.y + r } };
	ob_dot two[] = { { at.x - r, at.y + r }, { at.x + r, at.y - r } };
	ob_draw_path(d, one, 2, false, pen);
	ob_draw_path(d, two, 2, false, pen);
}

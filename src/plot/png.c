// PNG painter, by cairo.
#include <cairo.h>
#include <math.h>

#include "plot/font.h"
#include "plot/part.h"

static void set_paint(cairo_t *c, ob_paint paint)
{
	unsigned rgb = ob_palette_rgb(paint);
	cairo_set_source_rgb(c, (rgb >> 16) / 255., (rgb >> 8 & 255) / 255., (rgb & 255) / 255.);
}

static void paint_shape(cairo_t *c, const ob_item *item, const ob_dot *dot)
{
	const ob_pen *pen = &item->pen;
	cairo_new_path(c);
	for (size_t i = 0; item->kind == OB_ITEM_PATH && i < item->count; i++)
		cairo_line_to(c, dot[i].x, dot[i].y);
	if (item->kind == OB_ITEM_DISC)
		cairo_arc(c, dot->x, dot->y, item->radius, 0, 2 * M_PI);
	if (item->kind == OB_ITEM_DISC || item->closed)
		cairo_close_path(c);
	if (pen->fill) {
		set_paint(c, pen->fill);
		cairo_fill_preserve(c);
	}
	if (pen->stroke && pen->width > 0) {
		int count;
		const double *dash = ob_palette_dash(pen->dash, &count);
		cairo_set_dash(c, dash, count, 0);
		cairo_set_line_width(c, pen->width);
		set_paint(c, pen->stroke);
		cairo_stroke(c);
	}
}

static double text_advance(cairo_t *c, const char *text, double size)
{
	cairo_text_extents_t extents;
	cairo_set_font_size(c, size);
	cairo_text_extents(c, text, &extents);
	return extents.x_advance;
}

// Paints a text in the local replacement of Liberation Sans. If that font is wider than the layout assumed, the text
// gets smaller, not squeezed.
static void paint_text(cairo_t *c, const ob_drawing *d, const ob_item *item)
{
	const ob_type *t = &item->type;
	const char *text = d->text + item->text, *super = d->text + item->super;
	cairo_save(c);
	cairo_translate(c, d->dot[item->first].x, d->dot[item->first].y);
	cairo_rotate(c, t->turned ? -M_PI / 2 : 0);
	cairo_select_font_face(c, "Liberation Sans", CAIRO_FONT_SLANT_NORMAL,
			       t->bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
	set_paint(c, t->paint);
	double width = text_advance(c, super, t->size * OB_DRAWING_SUPER) + text_advance(c, text, t->size);
	double room = ob_drawing_width(text, super, t->size, t->bold);
	if (width > room)
		cairo_scale(c, room / width, room / width);
	cairo_move_to(c, -t->anchor * width, 0);
	cairo_show_text(c, text);
	cairo_rel_move_to(c, 0, -t->size * OB_DRAWING_RAISE);
	cairo_set_font_size(c, t->size * OB_DRAWING_SUPER);
	cairo_show_text(c, super);
	cairo_restore(c);
}

static void paint(cairo_t *c, const ob_drawing *d)
{
	// no hinting to the pixel grid, so that glyphs have the same width at every zoom
	cairo_font_options_t *options = cairo_font_options_create();
	cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
	cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
	cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
	cairo_set_font_options(c, options);
	cairo_font_options_destroy(options);
	set_paint(c, OB_PAINT_PAPER);
	cairo_paint(c);
	cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
	for (size_t i = 0; i < d->items; i++) {
		if (d->item[i].kind == OB_ITEM_TEXT)
			paint_text(c, d, &d->item[i]);
		else
			paint_shape(c, &d->item[i], d->dot + d->item[i].first);
	}
}

static bool draw(const ob_drawing *d, const char *path, double zoom, ob_error *e)
{
	cairo_surface_t *surface =
		cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)ceil(d->width * zoom), (int)ceil(d->height * zoom));
	cairo_t *c = cairo_create(surface);
	cairo_scale(c, zoom, zoom);
	paint(c, d);
	cairo_status_t status = cairo_status(c);
	if (!status)
		status = cairo_surface_write_to_png(surface, path);
	cairo_destroy(c);
	cairo_surface_destroy(surface);
	return !status || ob_fail(e, "cannot write %s: %s", path, cairo_status_to_string(status));
}

OB_PART(ob_plot_part) = { OB_PART_HEAD(ob_plot_part), .png = draw, .caption = ob_cairo_caption,
			  .strip = ob_cairo_strip };

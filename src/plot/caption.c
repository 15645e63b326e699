#include <cairo.h>
#include <math.h>
#include <stddef.h>

#include "plot/part.h"

// Relative to the font size.
static const double pad_x = .75, pad_y = .45, gap = 1, margin = .9, corner = .35;

static void round_rectangle(cairo_t *c, double width, double height, double r)
{
	cairo_new_path(c);
	cairo_arc(c, width - r, r, r, -M_PI / 2, 0);
	cairo_arc(c, width - r, height - r, r, 0, M_PI / 2);
	cairo_arc(c, r, height - r, r, M_PI / 2, M_PI);
	cairo_arc(c, r, r, r, M_PI, 3 * M_PI / 2);
	cairo_close_path(c);
}

static double write(cairo_t *c, double x, double y, const char *text, cairo_font_weight_t weight)
{
	cairo_text_extents_t extents;
	cairo_select_font_face(c, "Liberation Sans", CAIRO_FONT_SLANT_NORMAL, weight);
	cairo_text_extents(c, text, &extents);
	cairo_move_to(c, x, y);
	cairo_show_text(c, text);
	return x + extents.x_advance;
}

static double paint(cairo_t *c, double size, const char *title, const char *time)
{
	cairo_set_font_size(c, size);
	cairo_set_source_rgb(c, 1, 1, 1);
	double y = size * (pad_y + .78), x = write(c, size * pad_x, y, title, CAIRO_FONT_WEIGHT_BOLD);
	cairo_set_source_rgb(c, .8, .85, .9);
	return write(c, x + gap * size, y, time, CAIRO_FONT_WEIGHT_NORMAL) + size * pad_x;
}

// surface: premultiplied, one word 0xaarrggbb per pixel
static void blend(uint8_t *rgba, int width, cairo_surface_t *surface, int left, int top)
{
	const uint8_t *data = cairo_image_surface_get_data(surface);
	int w = cairo_image_surface_get_width(surface), h = cairo_image_surface_get_height(surface);
	int stride = cairo_image_surface_get_stride(surface);
	for (int y = 0; y < h; y++) {
		const uint32_t *from = (const uint32_t *)(const void *)(data + (size_t)y * (size_t)stride);
		uint8_t *to = rgba + 4 * ((size_t)(top + y) * (size_t)width + (size_t)left);
		for (int x = 0; x < w; x++, to += 4)
			for (int k = 0; k < 3; k++)
				to[k] = (uint8_t)((from[x] >> (16 - 8 * k) & 255) +
						  (255 - (from[x] >> 24)) * to[k] / 255);
	}
}

bool ob_cairo_caption(uint8_t *rgba, int width, int height, const char *title, const char *time, ob_error *e)
{
	double size = fmax(11, .028 * height);
	int left = (int)(margin * size), room = width - left, high = (int)ceil(size * (1 + 2 * pad_y));
	int top = height - high - left;
	if (room < 1 || top < 0)
		return true; // any text would be illegible
	cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, room, high);
	cairo_t *c = cairo_create(surface);
	double wide = paint(c, size, title, time); // measures its width
	cairo_set_operator(c, CAIRO_OPERATOR_SOURCE);
	cairo_set_source_rgba(c, 0, 0, 0, 0);
	cairo_paint(c);
	cairo_set_source_rgba(c, .07, .09, .11, .72);
	round_rectangle(c, fmin(wide, room), high, corner * size);
	cairo_fill(c);
	cairo_set_operator(c, CAIRO_OPERATOR_OVER);
	paint(c, size, title, time);
	cairo_status_t status = cairo_status(c);
	cairo_surface_flush(surface);
	if (!status)
		blend(rgba, width, surface, left, top);
	cairo_destroy(c);
	cairo_surface_destroy(surface);
	return !status || ob_fail(e, "cannot write on a picture: %s", cairo_status_to_string(status));
}

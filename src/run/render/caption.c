#include <cairo.h>
#include <math.h>
#include <stddef.h>

#include "render/caption.h"

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

// Paints on a cleared surface, and lays it on the picture. Returns false and e if cairo has failed.
static bool lay(uint8_t *rgba, int width, cairo_surface_t *surface, cairo_t *c, int left, int top, ob_error *e)
{
	const cairo_status_t status = cairo_status(c);
	cairo_surface_flush(surface);
	if (!status)
		blend(rgba, width, surface, left, top);
	cairo_destroy(c);
	cairo_surface_destroy(surface);
	return !status || ob_fail(e, "cannot write on a picture: %s", cairo_status_to_string(status));
}

static void paint_ground(cairo_t *c, double width, double height, double r)
{
	cairo_set_source_rgba(c, .07, .09, .11, .72);
	round_rectangle(c, width, height, r);
	cairo_fill(c);
}

static bool write_caption(uint8_t *rgba, int width, int height, const char *title, const char *time, ob_error *e)
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
	paint_ground(c, fmin(wide, room), high, corner * size);
	cairo_set_operator(c, CAIRO_OPERATOR_OVER);
	paint(c, size, title, time);
	return lay(rgba, width, surface, c, left, top, e);
}

// ---- who simulates what. Relative to the font size

static const double line = 1.45, chip = .8, text_at = 1.3, bar_at = 11.5, bar = 4, tail_at = 16, strip_width = 22;
static const double ribbon = 2.2, ribbon_least = .3; // height of the highest place; of the lowest, relative to that

// Displayed (sRGB) share of a linear colour's channel.
static double displayed(double x)
{
	return x <= .0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - .055;
}

static void set_colour(cairo_t *c, const float colour[3])
{
	cairo_set_source_rgb(c, displayed(colour[0]), displayed(colour[1]), displayed(colour[2]));
}

static void paint_row(cairo_t *c, double size, double y, const ob_strip_row *r)
{
	set_colour(c, r->colour);
	cairo_rectangle(c, 0, y - .78 * size, chip * size, chip * size);
	cairo_fill(c);
	cairo_set_source_rgb(c, 1, 1, 1);
	write(c, text_at * size, y, r->text, CAIRO_FONT_WEIGHT_NORMAL);
	if (!isnan(r->share)) {
		cairo_set_source_rgba(c, 1, 1, 1, .22);
		cairo_rectangle(c, bar_at * size, y - .6 * size, bar * size, .5 * size);
		cairo_fill(c);
		cairo_set_source_rgb(c, .45, .85, .55);
		cairo_rectangle(c, bar_at * size, y - .6 * size, fmax(0, fmin(1, r->share)) * bar * size, .5 * size);
		cairo_fill(c);
	}
	cairo_set_source_rgb(c, .8, .85, .9);
	write(c, tail_at * size, y, r->tail, CAIRO_FONT_WEIGHT_NORMAL);
}

// Paints a bar for each place, the higher the more are there, by their square root.
static void paint_ribbon(cairo_t *c, double size, double y, const ob_strip *s)
{
	const double width = (strip_width - 2 * pad_x) * size, each = width / s->places, foot = y + ribbon * size;
	uint32_t most = 1;
	for (uint32_t i = 0; i < s->places; i++)
		most = s->place[i].count > most ? s->place[i].count : most;
	cairo_set_source_rgba(c, 1, 1, 1, .12);
	cairo_rectangle(c, 0, y, width, ribbon * size);
	cairo_fill(c);
	for (uint32_t i = 0; i < s->places; i++) {
		const ob_strip_place *p = &s->place[i];
		const double high = ribbon * size * (ribbon_least + (1 - ribbon_least) * sqrt((double)p->count / most));
		if (p->count == 0)
			continue;
		set_colour(c, p->colour);
		cairo_rectangle(c, i * each, foot - high, each, high);
		cairo_fill(c);
	}
	enum { TICKS = sizeof s->tick / sizeof *s->tick };
	for (int i = 0; i < TICKS; i++) {
		cairo_text_extents_t extents;
		cairo_text_extents(c, s->tick[i], &extents);
		cairo_set_source_rgb(c, .8, .85, .9);
		write(c, (width - extents.x_advance) * i / (TICKS - 1), foot + .95 * size, s->tick[i],
		      CAIRO_FONT_WEIGHT_NORMAL);
	}
}

static double strip_lines(const ob_strip *s)
{
	return s->rows + (*s->more ? 1 : 0) + (s->places ? 2.2 + ribbon / line : 0);
}

static bool paint_strip(uint8_t *rgba, int width, int height, const ob_strip *s, ob_error *e)
{
	const double size = fmax(11, .02 * height);
	const int left = (int)(margin * size), wide = (int)ceil(strip_width * size),
		  high = (int)ceil(size * (2 * pad_y + line * strip_lines(s)));
	if (left + wide > width || left + high > height)
		return true; // any text would be illegible
	cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, wide, high);
	cairo_t *c = cairo_create(surface);
	paint_ground(c, wide, high, corner * size);
	cairo_translate(c, pad_x * size, 0);
	cairo_set_font_size(c, size);
	double y = size * (pad_y + 1.05);
	for (uint32_t i = 0; i < s->rows; i++, y += line * size)
		paint_row(c, size, y, &s->row[i]);
	cairo_set_source_rgb(c, .8, .85, .9);
	write(c, text_at * size, y, s->more, CAIRO_FONT_WEIGHT_NORMAL);
	y += *s->more ? line * size : 0;
	if (s->places) {
		cairo_set_source_rgb(c, 1, 1, 1);
		write(c, 0, y, s->title, CAIRO_FONT_WEIGHT_NORMAL);
		paint_ribbon(c, size, y + .4 * size, s);
	}
	return lay(rgba, width, surface, c, left, left, e);
}

OB_PART(ob_caption_part) = { OB_PART_HEAD(ob_caption_part), .caption = write_caption, .strip = paint_strip };

#include "plot/axes.h"

#include <math.h>
#include <stdio.h>

#include "plot/letters.h"

static const double font = 11.5, label_font = 12.5, name_font = 12; // px: of ticks, of the axes' labels, of categories
enum { TICK = 5, MINOR = 3, AWAY = 4, ROW = 16 }; // px
const double ob_axes_bottom = TICK + AWAY + 12 + 22;

static const ob_pen rim = { .stroke = OB_PAINT_MUTED, .width = 1 };
static const ob_pen grid = { .stroke = OB_PAINT_GRID, .width = 1 };

static double snapped(double v) // lines of 1 px are sharp in the middle of a pixel
{
	return floor(v) + .5;
}

static const char *category(const ob_side *s, size_t i)
{
	return s->axis->category[i] ? s->axis->category[i] : "";
}

static double widest_tick(const ob_frame *f, double limit)
{
	const ob_side *s = &f->y;
	double widest = fmax(s->high.used ? ob_letters_width("failed", font, false) : 0, s->low.used ? font : 0);
	for (size_t i = 0; s->axis->scale == OB_SCALE_CATEGORY && i < s->axis->categories; i++)
		widest = fmax(widest, ob_letters_width(category(s, i), name_font, false));
	for (size_t i = 0; s->axis->scale != OB_SCALE_CATEGORY && i < s->ticks.count; i++)
		widest = fmax(widest, ob_drawing_width(s->ticks.tick[i].text, s->ticks.tick[i].super, font, false));
	return fmin(widest, limit);
}

double ob_axes_left(const ob_frame *f, double width)
{
	double label = f->plot->y.label && *f->plot->y.label ? label_font + 10 : 2;
	return label + widest_tick(f, width * .45) + TICK + AWAY;
}

double ob_axes_right(const ob_frame *f)
{
	double beyond = f->x.high.used ? 14 : 0;
	const ob_ticks *t = &f->x.ticks;
	for (size_t i = 0; i < t->count; i++) {
		double half = ob_drawing_width(t->tick[i].text, t->tick[i].super, font, false) / 2;
		beyond = fmax(beyond, f->x.begin + t->tick[i].at * (f->x.end - f->x.begin) + half - f->outer.x1);
	}
	return beyond + 4;
}

// Labels of one axis that the next one must not touch
enum { SEEN_LOW, SEEN_HIGH, SEEN_TICK, SEEN };

// A label beside its tick, unless it would touch one of those before.
static void draw_tick_label(ob_drawing *d, const ob_side *s, double at, const ob_tick *t, double rim_at, ob_rect *seen,
			    int what)
{
	ob_type type = { .size = font, .paint = OB_PAINT_MUTED, .anchor = s->vertical ? 1 : .5 };
	double x = s->vertical ? rim_at - TICK - AWAY : at;
	double y = s->vertical ? at + font * .36 : rim_at + TICK + AWAY + font * .78;
	ob_rect box = ob_drawing_box(x, y, t->text, t->super, type);
	for (int i = 0; i < SEEN; i++)
		if (!*t->text || ob_rect_meet(ob_rect_grown(box, s->vertical ? 0 : 3), seen[i]))
			return;
	ob_draw_text(d, x, y, t->text, t->super, type);
	seen[what] = box;
}

static ob_rect band_rect(const ob_frame *f, const ob_side *s, bool high)
{
	double inner, outer;
	ob_frame_band(s, high, &inner, &outer);
	double from = fmin(inner, outer), to = fmax(inner, outer);
	ob_rect o = f->outer;
	return s->vertical ? (ob_rect){ o.x0, from, o.x1, to } : (ob_rect){ from, o.y0, to, o.y1 };
}

void ob_axes_bands(const ob_frame *f, ob_drawing *d)
{
	const ob_side *sides[] = { &f->x, &f->y };
	for (int i = 0; i < 4; i++) {
		bool high = i % 2;
		if (high ? sides[i / 2]->high.used : sides[i / 2]->low.used)
			ob_draw_rect(d, band_rect(f, sides[i / 2], high), (ob_pen){ .fill = OB_PAINT_BAND });
	}
}

static void label_band(const ob_frame *f, ob_drawing *d, const ob_side *s, bool high, ob_rect *seen)
{
	if (!(high ? s->high.used : s->low.used))
		return;
	ob_rect r = band_rect(f, s, high);
	double at = s->vertical ? (r.y0 + r.y1) / 2 : (r.x0 + r.x1) / 2;
	ob_pen gap = { .stroke = OB_PAINT_PAPER, .width = 3 }; // between the band and the data, over any tint
	if (s->vertical)
		ob_draw_line(d, r.x0, high ? r.y1 + 1.5 : r.y0 - 1.5, r.x1, high ? r.y1 + 1.5 : r.y0 - 1.5, gap);
	else
		ob_draw_line(d, high ? r.x0 - 1.5 : r.x1 + 1.5, r.y0, high ? r.x0 - 1.5 : r.x1 + 1.5, r.y1, gap);
	ob_tick t = { .major = true };
	snprintf(t.text, sizeof t.text, "%s", high ? "failed" : "0");
	draw_tick_label(d, s, at, &t, s->vertical ? f->outer.x0 : f->outer.y1, seen, high ? SEEN_HIGH : SEEN_LOW);
}

static void draw_ticks(const ob_frame *f, ob_drawing *d, const ob_side *s, ob_rect *seen)
{
	ob_rect o = f->outer;
	for (size_t i = 0; i < s->ticks.count; i++) {
		const ob_tick *t = &s->ticks.tick[i];
		double at = snapped(s->begin + t->at * (s->end - s->begin)), length = t->major ? TICK : MINOR;
		if (s->vertical)
			ob_draw_line(d, o.x0 - length, at, o.x0, at, rim);
		else
			ob_draw_line(d, at, o.y1, at, o.y1 + length, rim);
		if (t->major)
			draw_tick_label(d, s, at, t, s->vertical ? o.x0 : o.y1, seen, SEEN_TICK);
	}
}

static void draw_categories(const ob_frame *f, ob_drawing *d)
{
	const ob_side *s = &f->y;
	double every = ceil(s->axis->categories * ROW / 1.4 / fmax(s->begin - s->end, 1)); // only where there is room
	for (size_t i = 0; i < s->axis->categories; i++) {
		double at = ob_frame_at(s, (double)i);
		ob_draw_line(d, f->area.x0, snapped(at), f->area.x1, snapped(at), grid);
		const char *rest = category(s, i);
		char line[200];
		double room = f->outer.x0 - TICK - AWAY - 2;
		if (fmod((double)i, fmax(every, 1)) == 0 &&
		    ob_letters_line(&rest, room, name_font, false, true, line, sizeof line))
			ob_draw_text(d, f->outer.x0 - TICK - AWAY, at + name_font * .36, line, "",
				     (ob_type){ .size = name_font, .paint = OB_PAINT_INK, .anchor = 1 });
	}
}

static void draw_grid(const ob_frame *f, ob_drawing *d)
{
	for (size_t i = 0; i < f->x.ticks.count; i++) {
		double at = snapped(f->x.begin + f->x.ticks.tick[i].at * (f->x.end - f->x.begin));
		if (f->x.ticks.tick[i].major)
			ob_draw_line(d, at, f->area.y0, at, f->area.y1, grid);
	}
	for (size_t i = 0; f->y.axis->scale != OB_SCALE_CATEGORY && i < f->y.ticks.count; i++) {
		double at = snapped(f->y.begin + f->y.ticks.tick[i].at * (f->y.end - f->y.begin));
		if (f->y.ticks.tick[i].major)
			ob_draw_line(d, f->area.x0, at, f->area.x1, at, grid);
	}
}

// Cut where it does not fit
static void draw_label(ob_drawing *d, const char *label, double x, double y, double room, bool turned)
{
	char line[200];
	if (label && ob_letters_line(&label, room, label_font, false, true, line, sizeof line))
		ob_draw_text(d, x, y, line, "",
			     (ob_type){ .size = label_font, .paint = OB_PAINT_INK, .anchor = .5, .turned = turned });
}

void ob_axes_draw(const ob_frame *f, ob_drawing *d)
{
	const ob_side *sides[] = { &f->y, &f->x };
	ob_rect o = f->outer, nowhere = { -9, -9, -9, -9 };
	ob_rect seen[2][SEEN] = { { nowhere, nowhere, nowhere }, { nowhere, nowhere, nowhere } };
	for (int i = 0; i < 4; i++)
		label_band(f, d, sides[i / 2], i % 2, seen[i / 2]);
	draw_grid(f, d);
	if (f->y.axis->scale == OB_SCALE_CATEGORY)
		draw_categories(f, d);
	else
		draw_ticks(f, d, &f->y, seen[0]);
	draw_ticks(f, d, &f->x, seen[1]);
	ob_draw_line(d, snapped(o.x0), o.y0, snapped(o.x0), snapped(o.y1), rim);
	ob_draw_line(d, snapped(o.x0), snapped(o.y1), o.x1, snapped(o.y1), rim);
	draw_label(d, f->plot->x.label, (o.x0 + o.x1) / 2, o.y1 + ob_axes_bottom - 6, o.x1 - o.x0, false);
	draw_label(d, f->plot->y.label, o.x0 - ob_axes_left(f, d->width) + label_font * .6, (o.y0 + o.y1) / 2,
		   o.y1 - o.y0, true);
}

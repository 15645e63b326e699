// Turns a plot into a drawing: headings, the legend's place, axes, data, labels.
#include <math.h>
#include <stdio.h>

#include "plot/frame.h"
#include "plot/font.h"

// ---- axes: surroundings and background of the data

static const double tick_font = 11.5, axis_font = 12.5, category_font = 12; // px
enum { TICK = 5, MINOR = 3, AWAY = 4, CATEGORY_ROW = 16 }; // px
static const double axes_bottom = TICK + AWAY + 12 + 22; // px below the frame

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
	double widest = fmax(s->high.used ? ob_font_width("failed", tick_font, false) : 0, s->low.used ? tick_font : 0);
	for (size_t i = 0; s->axis->scale == OB_SCALE_CATEGORY && i < s->axis->categories; i++)
		widest = fmax(widest, ob_font_width(category(s, i), category_font, false));
	for (size_t i = 0; s->axis->scale != OB_SCALE_CATEGORY && i < s->ticks.count; i++)
		widest =
			fmax(widest, ob_drawing_width(s->ticks.tick[i].text, s->ticks.tick[i].super, tick_font, false));
	return fmin(widest, limit);
}

// Width (px) needed by the labels of y at the left.
static double axes_left(const ob_frame *f, double width)
{
	double label = f->plot->y.label && *f->plot->y.label ? axis_font + 10 : 2;
	return label + widest_tick(f, width * .45) + TICK + AWAY;
}

// Width (px) needed by the labels of x beyond the right end.
static double axes_right(const ob_frame *f)
{
	double beyond = f->x.high.used ? 14 : 0;
	const ob_ticks *t = &f->x.ticks;
	for (size_t i = 0; i < t->count; i++) {
		double half = ob_drawing_width(t->tick[i].text, t->tick[i].super, tick_font, false) / 2;
		beyond = fmax(beyond, f->x.begin + t->tick[i].at * (f->x.end - f->x.begin) + half - f->outer.x1);
	}
	return beyond + 4;
}

// Labels of one axis that the next one must not touch.
enum { SEEN_LOW, SEEN_HIGH, SEEN_TICK, SEEN };

// Draws a label beside its tick, unless it would touch an earlier one.
static void draw_tick_label(ob_drawing *d, const ob_side *s, double at, const ob_tick *t, double rim_at, ob_rect *seen,
			    int what)
{
	ob_type type = { .size = tick_font, .paint = OB_PAINT_MUTED, .anchor = s->vertical ? 1 : .5 };
	double x = s->vertical ? rim_at - TICK - AWAY : at;
	double y = s->vertical ? at + tick_font * .36 : rim_at + TICK + AWAY + tick_font * .78;
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

// Draws the bands, behind all else.
static void draw_bands(const ob_frame *f, ob_drawing *d)
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
	double every =
		ceil(s->axis->categories * CATEGORY_ROW / 1.4 / fmax(s->begin - s->end, 1)); // only if there is room
	for (size_t i = 0; i < s->axis->categories; i++) {
		double at = ob_frame_at(s, (double)i);
		ob_draw_line(d, f->area.x0, snapped(at), f->area.x1, snapped(at), grid);
		const char *rest = category(s, i);
		char line[200];
		double room = f->outer.x0 - TICK - AWAY - 2;
		if (fmod((double)i, fmax(every, 1)) == 0 &&
		    ob_font_fit_line(&rest, room, category_font, false, true, line, sizeof line))
			ob_draw_text(d, f->outer.x0 - TICK - AWAY, at + category_font * .36, line, "",
				     (ob_type){ .size = category_font, .paint = OB_PAINT_INK, .anchor = 1 });
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

// Draws a label, cut if it does not fit.
static void draw_axis_label(ob_drawing *d, const char *label, double x, double y, double room, bool turned)
{
	char line[200];
	if (label && ob_font_fit_line(&label, room, axis_font, false, true, line, sizeof line))
		ob_draw_text(d, x, y, line, "",
			     (ob_type){ .size = axis_font, .paint = OB_PAINT_INK, .anchor = .5, .turned = turned });
}

static void draw_axes(const ob_frame *f, ob_drawing *d)
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
	draw_axis_label(d, f->plot->x.label, (o.x0 + o.x1) / 2, o.y1 + axes_bottom - 6, o.x1 - o.x0, false);
	draw_axis_label(d, f->plot->y.label, o.x0 - axes_left(f, d->width) + axis_font * .6, (o.y0 + o.y1) / 2,
			o.y1 - o.y0, true);
}

// ---- data

// Clips a line to a rectangle (Liang and Barsky 1984). Returns false if it lies outside.
static bool clip_line(ob_rect r, ob_dot *from, ob_dot *to)
{
	double dx = to->x - from->x, dy = to->y - from->y, enter = 0, leave = 1;
	const double along[] = { -dx, dx, -dy, dy };
	const double room[] = { from->x - r.x0, r.x1 - from->x, from->y - r.y0, r.y1 - from->y };
	for (int i = 0; i < 4; i++) {
		if (along[i] == 0 && room[i] < 0)
			return false;
		if (along[i] < 0)
			enter = fmax(enter, room[i] / along[i]);
		else if (along[i] > 0)
			leave = fmin(leave, room[i] / along[i]);
	}
	if (enter > leave)
		return false;
	ob_dot begin = *from;
	*from = (ob_dot){ begin.x + enter * dx, begin.y + enter * dy };
	*to = (ob_dot){ begin.x + leave * dx, begin.y + leave * dy };
	return true;
}

// Next point of the same series joined by a line; NULL: none.
static const ob_spot *next_joined(const ob_frame *f, size_t i)
{
	for (size_t j = i + 1; j < f->spots && f->spot[j].series == f->spot[i].series; j++) {
		const ob_plot_point *p = f->spot[j].point;
		if (!p->failed && isfinite(p->x) && isfinite(p->y))
			return &f->spot[j];
	}
	return NULL;
}

// True if both lie in the band of zeros: lanes there have no meaning, so no line joins them.
static bool are_zero(const ob_frame *f, const ob_spot *a, const ob_spot *b)
{
	return a->at.y > f->area.y1 && b->at.y > f->area.y1;
}

static void draw_lines(const ob_frame *f, ob_drawing *d, const ob_plot_series *s)
{
	ob_series_style style = ob_palette_style(s->style, s->hollow);
	ob_pen pen = { .stroke = style.paint, .width = style.width, .dash = style.dash };
	ob_dot run[128]; // consecutive pieces, so that dashes continue over their joints
	size_t length = 0;
	for (size_t i = 0; i < f->spots; i++) {
		const ob_plot_point *p = f->spot[i].point;
		if (f->spot[i].series != s || p->failed || !isfinite(p->x) || !isfinite(p->y))
			continue;
		const ob_spot *next = next_joined(f, i);
		ob_dot from = f->spot[i].at, to = next ? next->at : from;
		bool inside = next && !are_zero(f, &f->spot[i], next) && clip_line(f->outer, &from, &to);
		bool follows =
			inside && length && length < 128 && from.x == run[length - 1].x && from.y == run[length - 1].y;
		if (length > 1 && !follows)
			ob_draw_path(d, run, length, false, pen);
		if (inside && !follows) {
			run[0] = from;
			length = 1;
		}
		if (inside)
			run[length++] = to;
		else
			length = 0;
	}
	if (length > 1)
		ob_draw_path(d, run, length, false, pen);
}

static void draw_error_bar(const ob_frame *f, ob_drawing *d, const ob_spot *s, ob_paint paint)
{
	const ob_plot_point *p = s->point;
	if (!isfinite(p->low) || !isfinite(p->high) || (p->low == 0 && p->high == 0))
		return;
	ob_pen pen = { .stroke = paint, .width = 1.2 };
	double x = s->at.x, top = f->outer.y0, bottom = f->outer.y1;
	double low = fmin(fmax(ob_frame_at(&f->y, p->low), top), bottom);
	double high = fmin(fmax(ob_frame_at(&f->y, p->high), top), bottom);
	ob_draw_line(d, x, low, x, high, pen);
	ob_draw_line(d, x - 3.5, low, x + 3.5, low, pen);
	ob_draw_line(d, x - 3.5, high, x + 3.5, high, pen);
}

static void draw_hint(ob_drawing *d, const ob_spot *s)
{
	const ob_plot_point *p = s->point;
	const char *title = s->series->title ? s->series->title : "", *label = p->label ? p->label : "";
	char hint[300], values[60] = "failed";
	if (isfinite(p->x) && isfinite(p->y))
		snprintf(values, sizeof values, "%.4g, %.4g%s", p->x, p->y, p->failed ? ", failed" : "");
	snprintf(hint, sizeof hint, "%s%s%s: %s", title, *title && *label ? ", " : "", label, values);
	ob_draw_hint(d, p->hint ? p->hint : hint);
}

static bool draw_markers(ob_frame *f, ob_drawing *d, const ob_plot_series *series)
{
	ob_series_style style = ob_palette_style(series->style, series->hollow);
	for (size_t i = 0; i < f->spots; i++) {
		const ob_spot *s = &f->spot[i];
		if (s->series != series || !s->shown || (series->style < 0 && !s->point->failed))
			continue;
		if (s->point->failed) {
			ob_palette_cross(d, s->at, &style);
		} else {
			draw_error_bar(f, d, s, style.paint);
			ob_palette_marker(d, s->at, &style);
		}
		draw_hint(d, s);
		double r = style.size + 1;
		if (!ob_frame_take(f, (ob_rect){ s->at.x - r, s->at.y - r, s->at.x + r, s->at.y + r }))
			return false;
	}
	return true;
}

static void draw_mark(const ob_frame *f, ob_drawing *d, const ob_plot_mark *m)
{
	ob_pen pen = { .stroke = OB_PAINT_GOOD, .width = 1.3, .dash = 1 };
	ob_rect o = f->outer;
	double at = isfinite(m->at) ? ob_frame_mark(m->vertical ? &f->x : &f->y, m->at) : -1;
	if (m->vertical && at >= o.x0 && at <= o.x1)
		ob_draw_line(d, at, o.y0, at, o.y1, pen);
	else if (!m->vertical && at >= o.y0 && at <= o.y1)
		ob_draw_line(d, o.x0, at, o.x1, at, pen);
}

// Draws tints, behind the axes.
static void draw_tints(const ob_frame *f, ob_drawing *d)
{
	ob_rect o = f->outer;
	for (size_t i = 0; i < f->plot->marks; i++) {
		const ob_plot_mark *m = &f->plot->mark[i];
		if (!m->tinted || !isfinite(m->at))
			continue;
		ob_rect r = o;
		if (m->vertical)
			r.x1 = fmin(fmax(ob_frame_mark(&f->x, m->at), o.x0), o.x1);
		else
			r.y0 = fmin(fmax(ob_frame_mark(&f->y, m->at), o.y0), o.y1);
		ob_draw_rect(d, r, (ob_pen){ .fill = OB_PAINT_MEADOW });
	}
}

// Draws target lines, curves, markers, error bars, crosses: the series of style 0 last, so that nothing covers them.
// Records areas that labels must not cover. Returns false if memory runs out.
static bool draw_curves(ob_frame *f, ob_drawing *d)
{
	const ob_plot *p = f->plot;
	for (size_t i = 0; i < p->marks; i++)
		draw_mark(f, d, &p->mark[i]);
	for (int front = 0; front < 2; front++)
		for (size_t i = 0; i < p->series_count; i++)
			if ((p->series[i].style == 0) == front && p->series[i].line)
				draw_lines(f, d, &p->series[i]);
	for (int front = 0; front < 2; front++)
		for (size_t i = 0; i < p->series_count; i++)
			if ((p->series[i].style == 0) == front && !draw_markers(f, d, &p->series[i]))
				return false;
	return true;
}

// ---- labels within the data

static const double point_font = 10.5, mark_font = 11.5; // px

static bool is_taken(const ob_frame *f, ob_rect box)
{
	for (size_t i = 0; i < f->taken; i++)
		if (ob_rect_meet(f->take[i], box))
			return true;
	return false;
}

// Number of lines of curves and targets that cross a box.
static int crossings(const ob_frame *f, ob_rect box)
{
	int count = 0;
	for (size_t i = 0; i + 1 < f->spots; i++) {
		const ob_spot *a = &f->spot[i], *b = a + 1;
		if (a->series != b->series || !a->series->line || !a->shown || !b->shown || a->point->failed ||
		    b->point->failed)
			continue;
		ob_dot from = a->at, to = b->at;
		count += clip_line(box, &from, &to);
	}
	for (size_t i = 0; i < f->plot->marks; i++) {
		const ob_plot_mark *m = &f->plot->mark[i];
		double at = isfinite(m->at) ? ob_frame_mark(m->vertical ? &f->x : &f->y, m->at) : -1;
		count += m->vertical ? at > box.x0 && at < box.x1 : at > box.y0 && at < box.y1;
	}
	return count;
}

static bool put_label(ob_frame *f, ob_drawing *d, double x, double y, const char *text, ob_type type)
{
	ob_draw_text(d, x, y, text, "", type);
	return ob_frame_take(f, ob_drawing_box(x, y, text, "", type));
}

// Labels a target along its line, at the place that covers least; omits the label if it would cover a text or a marker.
static bool label_mark(ob_frame *f, ob_drawing *d, const ob_plot_mark *m)
{
	if (!m->label || !*m->label || !isfinite(m->at))
		return true;
	ob_rect o = f->outer;
	double at = ob_frame_mark(m->vertical ? &f->x : &f->y, m->at), best_x = 0, best_y = 0, best_anchor = 0;
	double from = m->vertical ? o.y0 : o.x0, to = m->vertical ? o.y1 : o.x1;
	int least = 1 << 20;
	char text[160];
	const char *rest = m->label;
	if (!ob_font_fit_line(&rest, (o.x1 - o.x0) * .8, mark_font, false, true, text, sizeof text))
		return true;
	ob_type type = { .size = mark_font, .paint = OB_PAINT_GOOD };
	for (int i = 0; i <= 10; i++) {
		for (int side = 0; side < 2; side++) {
			double along = to - (to - from) * i / 10;
			double x = m->vertical ? at + (side ? -5 : 5) : along - 4;
			double y = m->vertical ? from + to - along + mark_font : at + (side ? mark_font + 1.5 : -4.5);
			type.anchor = m->vertical ? side : 1;
			ob_rect box = ob_drawing_box(x, y, text, "", type);
			int cost = ob_rect_within(box, o) && !is_taken(f, box) ? crossings(f, box) : 1 << 20;
			if (cost < least) {
				least = cost;
				best_x = x;
				best_y = y;
				best_anchor = type.anchor;
			}
		}
	}
	type.anchor = best_anchor;
	return least == 1 << 20 || put_label(f, d, best_x, best_y, text, type);
}

// Area available to the label of a point: the band of the point, if it lies in one.
static ob_rect label_room(const ob_frame *f, const ob_spot *s)
{
	ob_rect r = f->outer, a = f->area;
	r.y1 = s->at.y < a.y0 ? a.y0 : s->at.y > a.y1 ? r.y1 : a.y1;
	r.y0 = s->at.y > a.y1 ? a.y1 : s->at.y < a.y0 ? r.y0 : a.y0;
	return r;
}

// Labels a point in the first of eight places that covers nothing.
static bool label_spot(ob_frame *f, ob_drawing *d, const ob_spot *s)
{
	static const struct {
		double x, y, anchor;
	} places[] = { { 1, -1, 0 }, { 0, -1, .5 }, { 1, 0, 0 },  { 0, 1, .5 },
		       { 1, 1, 0 },  { -1, -1, 1 }, { -1, 0, 1 }, { -1, 1, 1 } };
	ob_series_style style = ob_palette_style(s->series->style, s->series->hollow);
	ob_rect room = label_room(f, s);
	char text[64];
	const char *rest = s->point->label;
	if (!rest || !s->shown || !ob_font_fit_line(&rest, 120, point_font, false, true, text, sizeof text))
		return true;
	for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
		const double away = style.size + 2.5, diagonal = places[i].x != 0 && places[i].y != 0 ? .75 : 1;
		const double x = s->at.x + places[i].x * away * diagonal;
		const double y = s->at.y + places[i].y * away +
				 point_font * (places[i].y < 0   ? -OB_FONT_DESCENT
					       : places[i].y > 0 ? OB_FONT_ASCENT
								 : .36);
		ob_type type = { .size = point_font, .paint = OB_PAINT_MUTED, .anchor = places[i].anchor };
		ob_rect box = ob_rect_grown(ob_drawing_box(x, y, text, "", type), 1);
		if (ob_rect_within(box, room) && !is_taken(f, box) && !crossings(f, box))
			return put_label(f, d, x, y, text, type);
	}
	return true;
}

// Labels the ends of curves first, as they matter most; then all others.
static bool label_spots(ob_frame *f, ob_drawing *d, bool ends)
{
	for (size_t i = 0; i < f->spots; i++) {
		const ob_spot *s = &f->spot[i];
		bool end = i == 0 || i + 1 == f->spots || s[-1].series != s->series || s[1].series != s->series;
		if (end == ends && !label_spot(f, d, s))
			return false;
	}
	return true;
}

// Draws labels of targets and points as far as there is room. Returns false if memory runs out.
static bool draw_labels(ob_frame *f, ob_drawing *d)
{
	for (size_t i = 0; i < f->plot->marks; i++)
		if (!label_mark(f, d, &f->plot->mark[i]))
			return false;
	return label_spots(f, d, true) && label_spots(f, d, false);
}

// ---- legend

enum { SAMPLE = 26, SAMPLE_GAP = 7, BETWEEN = 20, ROW = 18, LINE = 14, LINES = 3, COLUMN = 186 }; // px, but for LINES
static const double legend_font = 12; // px

// Legend outside the data: at the right if there is room, else below.
typedef struct legend {
	const ob_frame *frame;
	size_t entries; // 0: none is needed; the last is for crosses, if there are any
	bool below;
	double width, height; // px
} legend;

static const char *entry_title(const legend *l, size_t i)
{
	const ob_plot *p = l->frame->plot;
	return i == p->series_count ? "failed" : p->series[i].title;
}

// Draws the lines of one entry (with d NULL, only measures them); returns their number.
static int entry_lines(const legend *l, size_t i, double width, ob_drawing *d, double x, double y, double *widest)
{
	const char *rest = entry_title(l, i);
	char line[160];
	int lines = 0, most = l->below ? 1 : LINES;
	while (lines < most &&
	       ob_font_fit_line(&rest, width, legend_font, false, lines == most - 1, line, sizeof line)) {
		*widest = fmax(*widest, ob_font_width(line, legend_font, false));
		if (d)
			ob_draw_text(d, x, y + lines * LINE, line, "",
				     (ob_type){ .size = legend_font, .paint = OB_PAINT_INK });
		lines++;
	}
	return lines;
}

static void draw_sample(const legend *l, size_t i, ob_drawing *d, double x, double y)
{
	const ob_plot *p = l->frame->plot;
	ob_dot middle = { x + SAMPLE / 2., y };
	if (i == p->series_count) {
		ob_palette_cross(d, middle, &(ob_series_style){ .paint = OB_PAINT_INK });
		return;
	}
	ob_series_style style = ob_palette_style(p->series[i].style, p->series[i].hollow);
	if (p->series[i].line)
		ob_draw_line(d, x, y, x + SAMPLE, y,
			     (ob_pen){ .stroke = style.paint, .width = style.width, .dash = style.dash });
	ob_palette_marker(d, middle, &style);
}

// Walks over the entries in their places; draws them if d is not NULL. Returns the height.
static double place_entries(const legend *l, double room, ob_drawing *d, double left, double top, double *widest)
{
	double x = 0, y = 0;
	for (size_t i = 0; i < l->entries; i++) {
		double text = 0;
		if (!entry_title(l, i))
			continue;
		int lines = entry_lines(l, i, room - SAMPLE - SAMPLE_GAP, NULL, 0, 0, &text);
		double width = SAMPLE + SAMPLE_GAP + text;
		if (l->below && x > 0 && x + width > room) {
			x = 0;
			y += ROW;
		}
		if (d) {
			draw_sample(l, i, d, left + x, top + y + ROW / 2.);
			entry_lines(l, i, room - SAMPLE - SAMPLE_GAP, d, left + x + SAMPLE + SAMPLE_GAP,
				    top + y + ROW / 2. + legend_font * .36, &text);
		}
		*widest = fmax(*widest, x + width);
		if (l->below)
			x += width + BETWEEN;
		else
			y += ROW + (lines > 1 ? (lines - 1) * LINE : 0) + 3;
	}
	return l->entries ? y + (l->below ? ROW : 0) : 0;
}

// Plans the legend for a diagram of this width, with data of about this height.
static legend plan_legend(const ob_frame *f, double width, double height)
{
	size_t count = f->plot->series_count;
	legend l = { .frame = f, .entries = count > 1 || f->failed ? count + f->failed : 0 };
	l.height = place_entries(&l, COLUMN + SAMPLE + SAMPLE_GAP, NULL, 0, 0, &l.width);
	if (l.width > width * .3 || l.height > height) {
		l.below = true;
		double widest = 0;
		l.height = place_entries(&l, width, NULL, 0, 0, &widest);
		l.width = width;
	}
	return l;
}

static void draw_legend(const legend *l, ob_drawing *d, double x, double y)
{
	double widest = 0;
	place_entries(l, l->below ? l->width : COLUMN + SAMPLE + SAMPLE_GAP, d, x, y, &widest);
}

// ---- the page

enum { RIM = 14, WIDTH = 760, HEIGHT = 480, WIDTH_LEAST = 240, AREA_LEAST = 130, HEADING_LINES = 3, GAP = 12 }; // px
static const double title_font = 15, subtitle_font = 11;

// Draws the lines of a heading from y on; returns the y of their end.
static double draw_heading(ob_drawing *d, const char *text, double y, double size, bool bold, ob_paint paint)
{
	char line[400];
	for (int i = 0; text && i < HEADING_LINES; i++) {
		if (!ob_font_fit_line(&text, d->width - 2 * RIM, size, bold, i == HEADING_LINES - 1, line, sizeof line))
			break;
		y += size * 1.3;
		ob_draw_text(d, RIM, y - size * .3, line, "", (ob_type){ .size = size, .paint = paint, .bold = bold });
	}
	return y;
}

// Places the data: margins depend on the axes' labels, and these on the remaining room.
static void place_frame(ob_frame *f, ob_drawing *d, const legend *l, double top, double height)
{
	double right = l->entries && !l->below ? l->width + GAP + 4 : 0;
	ob_rect outer = { RIM + 60, top, d->width - RIM - right, top + height };
	for (int pass = 0; pass < 3; pass++) {
		ob_frame_place(f, outer);
		outer.x0 = RIM + axes_left(f, d->width);
		outer.x1 = fmax(d->width - RIM - fmax(right, axes_right(f)), outer.x0 + 60);
	}
	ob_frame_place(f, outer);
}

static bool draw_diagram(ob_frame *f, ob_drawing *d)
{
	const ob_plot *p = f->plot;
	double top = draw_heading(d, p->title, RIM, title_font, true, OB_PAINT_INK);
	top = draw_heading(d, p->subtitle, top + 2, subtitle_font, false, OB_PAINT_MUTED) + GAP;
	legend l = plan_legend(f, d->width - 2 * RIM, d->height - top - RIM);
	double below = axes_bottom + (l.below ? l.height + GAP : 0) + RIM / 2.;
	double height = fmax(d->height - top - below, AREA_LEAST);
	d->height = top + height + below;
	place_frame(f, d, &l, top, height);
	draw_bands(f, d);
	draw_tints(f, d);
	draw_axes(f, d);
	if (!draw_curves(f, d) || !draw_labels(f, d))
		return false;
	if (l.entries)
		draw_legend(&l, d, l.below ? RIM : d->width - RIM - l.width,
			    l.below ? top + height + axes_bottom + GAP : top);
	return !d->out_of_memory;
}

bool ob_plot_layout(const ob_plot *p, ob_drawing *d, ob_error *e)
{
	ob_frame f;
	d->width = isfinite(p->width) && p->width > 0 ? fmin(fmax(p->width, WIDTH_LEAST), 8000) : WIDTH;
	d->height = isfinite(p->height) && p->height > 0 ? fmin(p->height, 8000) : HEIGHT;
	bool ok = ob_frame_begin(&f, p) && draw_diagram(&f, d);
	ob_frame_finish(&f);
	return ok || ob_fail(e, "no memory for a diagram");
}

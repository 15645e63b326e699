#include "plot/curves.h"

#include <math.h>
#include <stdio.h>

#include "plot/palette.h"

// Liang and Barsky 1984
bool ob_curves_cut(ob_rect r, ob_dot *from, ob_dot *to)
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

// The next point of the same series that a line goes to; NULL: there is none.
static const ob_spot *next_joined(const ob_frame *f, size_t i)
{
	for (size_t j = i + 1; j < f->spots && f->spot[j].series == f->spot[i].series; j++) {
		const ob_plot_point *p = f->spot[j].point;
		if (!p->failed && isfinite(p->x) && isfinite(p->y))
			return &f->spot[j];
	}
	return NULL;
}

// In the band of zeros points lie in lanes, which mean nothing: no line from one to the other
static bool are_zero(const ob_frame *f, const ob_spot *a, const ob_spot *b)
{
	return a->at.y > f->area.y1 && b->at.y > f->area.y1;
}

static void draw_lines(const ob_frame *f, ob_drawing *d, const ob_plot_series *s)
{
	ob_narrowphase_find look = ob_palette_look(s->style, s->hollow);
	ob_pen pen = { .stroke = look.paint, .width = look.width, .dash = look.dash };
	ob_dot run[128]; // pieces that follow one another, so that dashes go on over their joints
	size_t length = 0;
	for (size_t i = 0; i < f->spots; i++) {
		const ob_plot_point *p = f->spot[i].point;
		if (f->spot[i].series != s || p->failed || !isfinite(p->x) || !isfinite(p->y))
			continue;
		const ob_spot *next = next_joined(f, i);
		ob_dot from = f->spot[i].at, to = next ? next->at : from;
		bool inside = next && !are_zero(f, &f->spot[i], next) && ob_curves_cut(f->outer, &from, &to);
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

static void draw_bar(const ob_frame *f, ob_drawing *d, const ob_spot *s, ob_paint paint)
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
	ob_narrowphase_find look = ob_palette_look(series->style, series->hollow);
	for (size_t i = 0; i < f->spots; i++) {
		const ob_spot *s = &f->spot[i];
		if (s->series != series || !s->shown || (series->style < 0 && !s->point->failed))
			continue;
		if (s->point->failed) {
			ob_palette_cross(d, s->at, &look);
		} else {
			draw_bar(f, d, s, look.paint);
			ob_palette_marker(d, s->at, &look);
		}
		draw_hint(d, s);
		double r = look.size + 1;
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

void ob_curves_tints(const ob_frame *f, ob_drawing *d)
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

// The series of style 0 last, so that nothing covers them
bool ob_curves_draw(ob_frame *f, ob_drawing *d)
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

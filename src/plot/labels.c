#include "plot/labels.h"

#include <math.h>

#include "plot/curves.h"
#include "plot/letters.h"
#include "plot/palette.h"

static const double font = 10.5, mark_font = 11.5; // px

static bool is_taken(const ob_frame *f, ob_rect box)
{
	for (size_t i = 0; i < f->taken; i++)
		if (ob_rect_meet(f->take[i], box))
			return true;
	return false;
}

// How many lines of curves and targets cross a box
static int crossings(const ob_frame *f, ob_rect box)
{
	int count = 0;
	for (size_t i = 0; i + 1 < f->spots; i++) {
		const ob_spot *a = &f->spot[i], *b = a + 1;
		if (a->series != b->series || !a->series->line || !a->shown || !b->shown || a->point->failed ||
		    b->point->failed)
			continue;
		ob_dot from = a->at, to = b->at;
		count += ob_curves_cut(box, &from, &to);
	}
	for (size_t i = 0; i < f->plot->marks; i++) {
		const ob_plot_mark *m = &f->plot->mark[i];
		double at = isfinite(m->at) ? ob_frame_mark(m->vertical ? &f->x : &f->y, m->at) : -1;
		count += m->vertical ? at > box.x0 && at < box.x1 : at > box.y0 && at < box.y1;
	}
	return count;
}

static bool put(ob_frame *f, ob_drawing *d, double x, double y, const char *text, ob_type type)
{
	ob_draw_text(d, x, y, text, "", type);
	return ob_frame_take(f, ob_drawing_box(x, y, text, "", type));
}

// Along its line, where it covers least; where it would cover another text or a marker, not at all.
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
	if (!ob_letters_line(&rest, (o.x1 - o.x0) * .8, mark_font, false, true, text, sizeof text))
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
	return least == 1 << 20 || put(f, d, best_x, best_y, text, type);
}

// Where the label of a point may be: in the band that the point lies in, if it does.
static ob_rect room_of(const ob_frame *f, const ob_spot *s)
{
	ob_rect r = f->outer, a = f->area;
	r.y1 = s->at.y < a.y0 ? a.y0 : s->at.y > a.y1 ? r.y1 : a.y1;
	r.y0 = s->at.y > a.y1 ? a.y1 : s->at.y < a.y0 ? r.y0 : a.y0;
	return r;
}

// Beside a point, in the first of eight places where it covers nothing.
static bool label_spot(ob_frame *f, ob_drawing *d, const ob_spot *s)
{
	static const struct {
		double x, y, anchor;
	} places[] = { { 1, -1, 0 }, { 0, -1, .5 }, { 1, 0, 0 },  { 0, 1, .5 },
		       { 1, 1, 0 },  { -1, -1, 1 }, { -1, 0, 1 }, { -1, 1, 1 } };
	ob_narrowphase_find look = ob_palette_look(s->series->style, s->series->hollow);
	ob_rect room = room_of(f, s);
	char text[64];
	const char *rest = s->point->label;
	if (!rest || !s->shown || !ob_letters_line(&rest, 120, font, false, true, text, sizeof text))
		return true;
	for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
		double diagonal = places[i].x != 0 && places[i].y != 0 ? .75 : 1, away = (look.size + 2.5) * diagonal;
		double x = s->at.x + places[i].x * away, y = s->at.y + places[i].y * away;
		y += places[i].y < 0 ? 0 : places[i].y > 0 ? font * OB_LETTERS_ASCENT : font * .36;
		ob_type type = { .size = font, .paint = OB_PAINT_MUTED, .anchor = places[i].anchor };
		ob_rect box = ob_rect_grown(ob_drawing_box(x, y, text, "", type), 1);
		if (ob_rect_within(box, room) && !is_taken(f, box) && !crossings(f, box))
			return put(f, d, x, y, text, type);
	}
	return true;
}

// The ends of curves first, for they say the most; then all others.
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

bool ob_labels_draw(ob_frame *f, ob_drawing *d)
{
	for (size_t i = 0; i < f->plot->marks; i++)
		if (!label_mark(f, d, &f->plot->mark[i]))
			return false;
	return label_spots(f, d, true) && label_spots(f, d, false);
}

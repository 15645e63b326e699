#include "plot/drawing.h"

#include <stdlib.h>
#include <string.h>

#include "plot/letters.h"

// Room for "more" elements in *array; false and broken when there is no memory.
static bool reserve(ob_drawing *d, void **array, size_t size, size_t count, size_t more, size_t *max)
{
	if (count + more > *max) {
		size_t grown = (count + more) * 2;
		void *moved = realloc(*array, grown * size);
		if (!moved) {
			d->broken = true;
			return false;
		}
		*array = moved;
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

static bool add(ob_drawing *d, ob_item item, const ob_dot *dot, size_t count)
{
	if (d->broken || !reserve(d, (void **)&d->item, sizeof *d->item, d->items, 1, &d->items_max) ||
	    !reserve(d, (void **)&d->dot, sizeof *d->dot, d->dots, count, &d->dots_max))
		return false;
	item.first = d->dots;
	item.count = count;
	memcpy(d->dot + d->dots, dot, count * sizeof *dot);
	d->dots += count;
	d->item[d->items++] = item;
	return true;
}

// The offset of a copy, cleaned; 0 for "".
static size_t keep(ob_drawing *d, const char *text)
{
	size_t length = strlen(text);
	if (!length || d->broken || !reserve(d, (void **)&d->text, 1, d->chars + 1, length + 1, &d->chars_max))
		return 0;
	if (!d->chars)
		d->text[d->chars++] = 0;
	size_t at = d->chars;
	ob_letters_clean(text, d->text + at, length + 1);
	d->chars += strlen(d->text + at) + 1;
	return at;
}

void ob_draw_path(ob_drawing *d, const ob_dot *dot, size_t count, bool closed, ob_pen pen)
{
	add(d, (ob_item){ .kind = OB_ITEM_PATH, .pen = pen, .closed = closed }, dot, count);
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
	add(d, (ob_item){ .kind = OB_ITEM_DISC, .pen = pen, .radius = radius }, &centre, 1);
}

double ob_drawing_width(const char *text, const char *super, double size, bool bold)
{
	return ob_letters_width(text, size, bold) + ob_letters_width(super, size * OB_DRAWING_SUPER, bold);
}

ob_rect ob_drawing_box(double x, double y, const char *text, const char *super, ob_type type)
{
	double width = ob_drawing_width(text, super, type.size, type.bold), before = width * type.anchor;
	double up = type.size * OB_LETTERS_ASCENT, down = type.size * OB_LETTERS_DESCENT;
	if (*super)
		up = type.size * (OB_DRAWING_RAISE + OB_DRAWING_SUPER * OB_LETTERS_ASCENT);
	if (type.turned)
		return (ob_rect){ x - up, y - (width - before), x + down, y + before };
	return (ob_rect){ x - before, y - up, x + width - before, y + down };
}

void ob_draw_text(ob_drawing *d, double x, double y, const char *text, const char *super, ob_type type)
{
	ob_item item = { .kind = OB_ITEM_TEXT, .type = type, .text = keep(d, text), .super = keep(d, super) };
	if (!item.text || d->broken)
		return;
	item.width = ob_drawing_width(d->text + item.text, d->text + item.super, type.size, type.bold);
	item.box = ob_drawing_box(x, y, d->text + item.text, d->text + item.super, type);
	add(d, item, &(ob_dot){ x, y }, 1);
}

void ob_draw_hint(ob_drawing *d, const char *hint)
{
	size_t kept = keep(d, hint);
	if (kept && d->items)
		d->item[d->items - 1].hint = kept;
}

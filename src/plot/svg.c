// SVG painter: texts stay texts (selectable, searchable, readable aloud), in the reader's font and at its own width;
// the layout has left room for it.
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "plot/drawing.h"
#include "plot/font.h"

// A growing text. Numbers are formatted here, as printf depends on the locale.
typedef struct paper {
	FILE *out; // memory stream
	const ob_drawing *drawing;
} paper;

static void write_number(paper *p, double v)
{
	long long hundredths = llround(v * 100);
	char text[32];
	int length = snprintf(text, sizeof text, "%lld.%02lld", llabs(hundredths) / 100, llabs(hundredths) % 100);
	while (text[length - 1] == '0')
		text[--length] = 0;
	if (text[length - 1] == '.')
		text[--length] = 0;
	fprintf(p->out, "%s%s", hundredths < 0 ? "-" : "", text);
}

static void write_attribute(paper *p, const char *name, double v)
{
	fprintf(p->out, " %s=\"", name);
	write_number(p, v);
	fputc('"', p->out);
}

static void write_text(paper *p, const char *text)
{
	for (; *text; text++) {
		const char *entity = *text == '<'   ? "&lt;"
				     : *text == '>' ? "&gt;"
				     : *text == '&' ? "&amp;"
				     : *text == '"' ? "&quot;"
						    : NULL;
		if (entity)
			fputs(entity, p->out);
		else
			fputc(*text, p->out);
	}
}

static void write_pen(paper *p, ob_pen pen)
{
	bool stroked = pen.stroke && pen.width > 0;
	fprintf(p->out, " class=\"");
	if (pen.fill)
		fprintf(p->out, "f-%s", ob_palette_name(pen.fill));
	if (stroked)
		fprintf(p->out, "%ss-%s", pen.fill ? " " : "", ob_palette_name(pen.stroke));
	fputs(pen.fill ? "\"" : "\" fill=\"none\"", p->out);
	if (pen.fill)
		fprintf(p->out, " fill=\"#%06x\"", ob_palette_rgb(pen.fill));
	if (!stroked)
		return;
	fprintf(p->out, " stroke=\"#%06x\"", ob_palette_rgb(pen.stroke));
	write_attribute(p, "stroke-width", pen.width);
	int count;
	const double *dash = ob_palette_dash(pen.dash, &count);
	for (int i = 0; i < count; i++) {
		fputs(i ? " " : " stroke-dasharray=\"", p->out);
		write_number(p, dash[i]);
	}
	if (count)
		fputc('"', p->out);
}

static void write_end(paper *p, const ob_item *item, const char *element)
{
	if (!item->hint) {
		fputs("/>\n", p->out);
		return;
	}
	fputs("><title>", p->out);
	write_text(p, p->drawing->text + item->hint);
	fprintf(p->out, "</title></%s>\n", element);
}

static void write_dots(paper *p, const ob_item *item)
{
	const ob_dot *dot = p->drawing->dot + item->first;
	for (size_t i = 0; i < item->count; i++) {
		fputc(i ? 'L' : 'M', p->out);
		write_number(p, dot[i].x);
		fputc(' ', p->out);
		write_number(p, dot[i].y);
	}
	if (item->closed)
		fputc('Z', p->out);
}

static bool is_alike(const ob_item *a, const ob_item *b)
{
	return b->kind == OB_ITEM_PATH && !a->hint && a->pen.stroke == b->pen.stroke && a->pen.fill == b->pen.fill &&
	       a->pen.width == b->pen.width && a->pen.dash == b->pen.dash;
}

// Merges consecutive paths with the same pen into one element. Returns their number.
static size_t write_paths(paper *p, size_t i)
{
	size_t last = i;
	const ob_item *item = p->drawing->item;
	fputs("<path d=\"", p->out);
	write_dots(p, &item[i]);
	while (last + 1 < p->drawing->items && is_alike(&item[last], &item[last + 1]))
		write_dots(p, &item[++last]);
	fputc('"', p->out);
	write_pen(p, item[i].pen);
	write_end(p, &item[last], "path");
	return last - i + 1;
}

static void write_disc(paper *p, const ob_item *item)
{
	const ob_dot *at = p->drawing->dot + item->first;
	fputs("<circle", p->out);
	write_attribute(p, "cx", at->x);
	write_attribute(p, "cy", at->y);
	write_attribute(p, "r", item->radius);
	write_pen(p, item->pen);
	write_end(p, item, "circle");
}

static void write_words(paper *p, const ob_item *item)
{
	const ob_dot *at = p->drawing->dot + item->first;
	const ob_type *t = &item->type;
	fputs("<text", p->out);
	write_attribute(p, "x", at->x);
	write_attribute(p, "y", at->y);
	write_attribute(p, "font-size", t->size);
	if (t->anchor != 0)
		fprintf(p->out, " text-anchor=\"%s\"", t->anchor == 1 ? "end" : "middle");
	if (t->bold)
		fputs(" font-weight=\"bold\"", p->out);
	if (t->turned) {
		fputs(" transform=\"rotate(-90 ", p->out);
		write_number(p, at->x);
		fputc(' ', p->out);
		write_number(p, at->y);
		fputs(")\"", p->out);
	}
	fprintf(p->out, " class=\"f-%s\" fill=\"#%06x\">", ob_palette_name(t->paint), ob_palette_rgb(t->paint));
	write_text(p, p->drawing->text + item->text);
	if (item->super) {
		fputs("<tspan", p->out);
		write_attribute(p, "dy", -t->size * OB_DRAWING_RAISE);
		write_attribute(p, "font-size", t->size * OB_DRAWING_SUPER);
		fputc('>', p->out);
		write_text(p, p->drawing->text + item->super);
		fputs("</tspan>", p->out);
	}
	fputs("</text>\n", p->out);
}

static void write_drawing(paper *p, const char *title)
{
	const ob_drawing *d = p->drawing;
	char clean[400];
	ob_font_clean_text(title ? title : "", clean, sizeof clean);
	fputs("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 ", p->out);
	write_number(p, d->width);
	fputc(' ', p->out);
	write_number(p, d->height);
	fputc('"', p->out);
	write_attribute(p, "width", d->width);
	write_attribute(p, "height", d->height);
	fputs(" role=\"img\" aria-label=\"", p->out);
	write_text(p, clean);
	fputs("\" font-family=\"" OB_FONT_FAMILY "\" stroke-linejoin=\"round\">\n", p->out);
	fputs("<rect width=\"100%\" height=\"100%\"", p->out);
	write_pen(p, (ob_pen){ .fill = OB_PAINT_PAPER });
	fputs("/>\n", p->out);
	for (size_t i = 0; i < d->items;) {
		const ob_item *item = &d->item[i];
		if (item->kind == OB_ITEM_PATH) {
			i += write_paths(p, i);
			continue;
		}
		(item->kind == OB_ITEM_DISC ? write_disc : write_words)(p, item);
		i++;
	}
	fputs("</svg>\n", p->out);
}

char *ob_plot_svg_text(const ob_plot *p, ob_error *e)
{
	ob_drawing drawing = { 0 };
	char *text = NULL;
	size_t length;
	if (ob_plot_layout(p, &drawing, e)) {
		paper sheet = { .out = open_memstream(&text, &length), .drawing = &drawing };
		if (sheet.out)
			write_drawing(&sheet, p->title);
		if (!sheet.out || fclose(sheet.out)) {
			free(text);
			text = NULL;
			ob_fail(e, "no memory for a diagram");
		}
	}
	ob_drawing_finish(&drawing);
	return text;
}

bool ob_plot_svg(const ob_plot *p, const char *path, ob_error *e)
{
	char *text = ob_plot_svg_text(p, e);
	if (!text)
		return false;
	FILE *out = fopen(path, "w");
	bool ok = out && fputs(text, out) >= 0;
	ok = (!out || !fclose(out)) && ok;
	free(text);
	return ok || ob_fail(e, "cannot write %s: %m", path);
}

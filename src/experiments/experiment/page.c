#include "experiment/page.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "experiment/folder.h"
#include "experiment/json.h"
#include "page_texts.h"

void ob_page_fill(ob_page *p, const char *template, const ob_page_slot *slot, size_t slots, const void *with)
{
	for (const char *open; (open = strstr(template, "{{"));) {
		const char *name = open + 2, *close = strstr(name, "}}");
		if (!close)
			break;
		fwrite(template, 1, (size_t)(open - template), p->out);
		template = close + 2;
		for (size_t i = 0; i < slots; i++)
			if (strlen(slot[i].name) == (size_t)(close - name) &&
			    !strncmp(slot[i].name, name, (size_t)(close - name)))
				slot[i].write(p, with);
	}
	fputs(template, p->out);
}

typedef struct report {
	const ob_report *of;
	const void *with;
} report;

static void write_title(ob_page *p, const void *with)
{
	ob_page_text(p, ((const report *)with)->of->title);
}

static void write_style(ob_page *p, const void *with)
{
	fprintf(p->out, "%s%s", text_page_css, ((const report *)with)->of->style);
}

static void write_body(ob_page *p, const void *with)
{
	const report *r = with;
	ob_page_fill(p, r->of->body, r->of->slot, r->of->slots, r->with);
}

static void write_script(ob_page *p, const void *with)
{
	fputs(text_chart_js, p->out);
}

static void write_report(FILE *f, const void *with)
{
	static const ob_page_slot slots[] = {
		{ "title", write_title }, { "style", write_style }, { "body", write_body }, { "script", write_script }
	};
	ob_page_fill(&(ob_page){ f }, text_page_html, slots, sizeof slots / sizeof *slots, with);
}

bool ob_report_write(const ob_report *r, const char *folder, const void *with, ob_error *e)
{
	return ob_folder_write(folder, "report.html", write_report, &(report){ r, with }, e);
}

void ob_page_markup(ob_page *p, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	vfprintf(p->out, format, args);
	va_end(args);
}

void ob_page_text(ob_page *p, const char *text)
{
	for (; *text; text++) {
		switch (*text) {
		case '<':
			fputs("&lt;", p->out);
			break;
		case '>':
			fputs("&gt;", p->out);
			break;
		case '&':
			fputs("&amp;", p->out);
			break;
		case '"':
			fputs("&quot;", p->out);
			break;
		default:
			fputc(*text, p->out);
		}
	}
}

void ob_page_paragraph(ob_page *p, const char *class, const char *text)
{
	if (!*text)
		return;
	ob_page_markup(p, *class ? "<p class=\"%s\">" : "<p>", class);
	ob_page_text(p, text);
	ob_page_markup(p, "</p>\n");
}

void ob_page_term(ob_page *p, const char *name, const char *text)
{
	ob_page_markup(p, "<dt>%s</dt><dd>", name);
	ob_page_text(p, text);
	ob_page_markup(p, "</dd>\n");
}

double ob_page_provenance(ob_page *p, const ob_records *r)
{
	double took = 0;
	ob_page_term(p, "Machine", r->machine);
	ob_page_term(p, "Program", r->commit);
	for (size_t i = 0; i < r->count; i++)
		took += r->record[i].took_s;
	return took;
}

void ob_page_meanings(ob_page *p, const ob_metric *m, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		if (m[i].group)
			ob_page_markup(p, "%s<h3>%s</h3>\n", i ? "</dl>\n" : "", m[i].group);
		if (m[i].group || i == 0)
			ob_page_markup(p, "<dl>\n");
		ob_page_term(p, m[i].title, m[i].meaning);
	}
	ob_page_markup(p, "</dl>\n");
}

// ---- chart

ob_chart *ob_chart_new(void)
{
	ob_chart *c = calloc(1, sizeof *c);
	if (!c)
		abort();
	return c;
}

void ob_chart_free(ob_chart *c)
{
	if (c)
		free(c->point);
	free(c);
}

static void drop_empty(ob_chart *c)
{
	if (c->series_count && !c->series[c->series_count - 1].count)
		c->series_count--;
}

ob_chart_series *ob_chart_begin(ob_chart *c, int style, bool hollow, const char *title)
{
	drop_empty(c);
	ob_chart_series *s = &c->series[c->series_count < OB_CHART_SERIES ? c->series_count++ : OB_CHART_SERIES - 1];
	*s = (ob_chart_series){ .style = style, .hollow = hollow, .line = true, .first = c->points };
	snprintf(s->title, sizeof s->title, "%s", title);
	return s;
}

ob_chart_point *ob_chart_add(ob_chart *c, double x, double y, const char *label, const char *hint)
{
	static ob_chart_point spare;
	if (!c->series_count || !OB_MAKE_ROOM(c->point, c->points, c->points_max))
		return &spare;
	ob_chart_point *p = &c->point[c->points++];
	*p = (ob_chart_point){ .x = x, .y = y, .low = NAN, .high = NAN };
	snprintf(p->label, sizeof p->label, "%s", label);
	snprintf(p->hint, sizeof p->hint, "%s", hint);
	c->series[c->series_count - 1].count++;
	return p;
}

// ---- its description

static void put_axis(ob_json *j, const char *key, const ob_chart_axis *a)
{
	static const char *const scales[] = { "linear", "log", "log2" };
	ob_json_open(j, key);
	ob_json_string(j, "label", a->label);
	ob_json_string(j, "scale", scales[a->scale]);
	ob_json_close(j);
}

static void put_text(ob_json *j, const char *key, const char *text)
{
	if (*text)
		ob_json_string(j, key, text);
}

static void put_point(ob_json *j, const ob_chart_point *p)
{
	ob_json_open(j, NULL);
	ob_json_number(j, "x", p->x);
	ob_json_number(j, "y", p->y);
	if (isfinite(p->low) && isfinite(p->high)) {
		ob_json_number(j, "low", p->low);
		ob_json_number(j, "high", p->high);
	}
	if (p->failed)
		ob_json_true(j, "failed", true);
	put_text(j, "label", p->label);
	put_text(j, "hint", p->hint);
	ob_json_close(j);
}

static void put_series(ob_json *j, const ob_chart *c, const ob_chart_series *s)
{
	ob_json_open(j, NULL);
	put_text(j, "title", s->title);
	ob_json_number(j, "style", s->style);
	ob_json_true(j, "line", s->line);
	ob_json_true(j, "hollow", s->hollow);
	ob_json_open_list(j, "points");
	for (size_t i = s->first; i < s->first + s->count; i++)
		put_point(j, &c->point[i]);
	ob_json_close_list(j);
	ob_json_close(j);
}

static void put_chart(ob_json *j, const ob_chart *c)
{
	ob_json_open(j, NULL);
	ob_json_string(j, "name", c->name);
	ob_json_string(j, "title", c->title);
	ob_json_string(j, "subtitle", c->subtitle);
	ob_json_number(j, "width", c->width);
	ob_json_number(j, "height", c->height);
	put_axis(j, "x", &c->x);
	put_axis(j, "y", &c->y);
	if (c->categories)
		ob_json_open_list(j, "category");
	for (size_t i = 0; i < c->categories; i++)
		ob_json_string(j, NULL, c->category[i]);
	if (c->categories)
		ob_json_close_list(j);
	ob_json_open_list(j, "marks");
	for (size_t i = 0; i < c->marks; i++) {
		ob_json_open(j, NULL);
		ob_json_number(j, "at", c->mark[i].at);
		ob_json_string(j, "label", c->mark[i].label);
		ob_json_true(j, "vertical", c->mark[i].vertical);
		ob_json_true(j, "tinted", c->mark[i].tinted);
		ob_json_close(j);
	}
	ob_json_close_list(j);
	ob_json_open_list(j, "series");
	for (size_t i = 0; i < c->series_count; i++)
		put_series(j, c, &c->series[i]);
	ob_json_close_list(j);
	ob_json_close(j);
}

void ob_chart_html(ob_chart *c, ob_page *p, const char *caption)
{
	if (c && c->points) {
		ob_json j = { .f = p->out, .script = true };
		drop_empty(c);
		ob_page_markup(p, "<figure>\n<script class=\"chart\" type=\"application/json\">");
		put_chart(&j, c);
		ob_page_markup(p, "</script>\n");
		if (*caption)
			ob_page_markup(p, "<figcaption>%s</figcaption>\n", caption);
		ob_page_markup(p, "</figure>\n");
	}
	ob_chart_free(c);
}

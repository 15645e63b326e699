#include "experiment/page.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "experiment/folder.h"
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

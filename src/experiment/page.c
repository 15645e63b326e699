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

// True if v is easier to read as digits than with an exponent.
static bool is_plain(double v)
{
	return v == 0 || (fabs(v) >= 9.995e-4 && fabs(v) < 99950);
}

// Prints three digits, as "0.412", "35.9", "12400".
static void print_plain(char *to, size_t room, double v)
{
	int before = v == 0 ? 1 : (int)floor(log10(fabs(v) * 1.0005)) + 1; // digits before the point
	int behind = before >= 3 ? 0 : 3 - before;
	snprintf(to, room, "%.*f", behind, v);
	char *point = strchr(to, '.');
	for (char *end = to + strlen(to) - 1; point && (*end == '0' || *end == '.'); end--) {
		bool was_point = *end == '.';
		*end = 0;
		if (was_point)
			break;
	}
}

// Splits v into a mantissa and a power of ten, rounded to three digits.
static int split(double v, double *mantissa)
{
	char text[40];
	snprintf(text, sizeof text, "%.2e", v);
	char *e = strchr(text, 'e');
	int power = atoi(e + 1);
	*e = 0;
	*mantissa = atof(text);
	return power;
}

void ob_page_print_unit(char *to, size_t room, const char *unit)
{
	size_t used = 0;
	for (to[0] = 0; *unit && used + 4 < room; unit++) {
		bool raised = *unit == '^' && (unit[1] == '2' || unit[1] == '3');
		unit += raised;
		used += (size_t)snprintf(to + used, room - used, "%.*s", raised ? 2 : 1,
					 !raised        ? unit
					 : *unit == '2' ? "\u00b2"
							: "\u00b3");
	}
}

// Prints "1e-6", not "1e-06".
static void print_short(char *to, size_t room, double v)
{
	double mantissa;
	if (isfinite(v)) {
		int power = split(v, &mantissa);
		snprintf(to, room, "%.3ge%d", mantissa, power);
	} else {
		snprintf(to, room, "%s", isnan(v) ? "\u2013" : "\u221e");
	}
}

void ob_page_print_quantity(char *to, size_t room, double v, const char *unit)
{
	char text[40], printed[40] = "";
	if (is_plain(v))
		print_plain(text, sizeof text, v);
	else
		print_short(text, sizeof text, v);
	if (strcmp(unit, "1"))
		ob_page_print_unit(printed, sizeof printed, unit);
	snprintf(to, room, "%s%s%s", text, *printed ? " " : "", printed);
}

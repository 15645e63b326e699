// A comparison as a folder: one page that answers first and explains then, its diagrams, its figures.
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/compare.h"
#include "cli/compare_plots.h"
#include "experiment/folder.h"
#include "cli/quantity.h"
#include "cli/version.h"
#include "compare_texts.h"
#include "experiment/page.h"

static void write_style(ob_page *p, const void *with)
{
	ob_page_style(p);
}

static void paragraph(ob_page *p, const char *class, const char *text)
{
	if (!*text)
		return;
	ob_page_markup(p, "<p class=\"%s\">", class);
	ob_page_text(p, text);
	ob_page_markup(p, "</p>\n");
}

static const ob_section *last_section(const ob_comparison *c)
{
	return &c->section[c->sections - 1];
}

static void write_answer(ob_page *p, const void *with)
{
	const ob_comparison *c = with;
	ob_verdict v;
	ob_verdict_make(&v, c, last_section(c));
	if (*v.headline) {
		ob_page_markup(p, "<p class=\"lead\"><strong>");
		ob_page_text(p, v.headline);
		ob_page_markup(p, "</strong></p>\n");
	}
	paragraph(p, "", v.answer);
}

static void card(ob_page *p, const ob_cell *of, const ob_cell *to, const char *text)
{
	ob_spread r = ob_ratio_of(of, to, OB_FIGURE_COST);
	if (isnan(r.median))
		return;
	ob_page_markup(p, "<li><b>%.2f\u00d7</b><span>", r.median);
	ob_page_text(p, text);
	ob_page_markup(p, "<br>%.2f to %.2f over the repeats</span></li>\n", r.low, r.high);
}

static void write_cards(ob_page *p, const void *with)
{
	const ob_cell *cell = last_section(with)->cell, *pool = &cell[OB_WAY_THREADS];
	card(p, &cell[OB_WAY_PROCESSES], pool, "the CPU of the thread pool: a pool of processes");
	card(p, &cell[OB_WAY_GROUPS], pool, "process groups of 60 objects");
	card(p, &cell[OB_WAY_THREADS_EACH], pool, "a thread for each object");
	card(p, &cell[OB_WAY_PROCESSES_EACH], pool, "a process for each object");
	card(p, &cell[OB_WAY_MONOLITH], pool, "one world for all objects (ODE)");
}

static void write_setting(ob_page *p, const void *with)
{
	const ob_comparison *c = with;
	const struct {
		const char *name, *text;
	} lines[] = { { "Scene", c->scene },
		      { "Options", c->options },
		      { "Machine", c->machine },
		      { "Program", ob_version_commit } };
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
		ob_page_markup(p, "<dt>%s</dt><dd>", lines[i].name);
		ob_page_text(p, *lines[i].text ? lines[i].text : "\u2013");
		ob_page_markup(p, "</dd>\n");
	}
	ob_page_markup(p, "<dt>Runs</dt><dd>%" PRIu32 " of each, by turns, to and fro; %.0f s in all</dd>\n",
		       c->repeats, c->took_s);
}

static void put_spread(ob_page *p, ob_figure f, ob_spread x)
{
	ob_quantity median, low, high;
	const char *unit = ob_figure_table[f].unit;
	if (isnan(x.median)) {
		ob_page_markup(p, "<td class=\"n never\">\u2013</td>");
		return;
	}
	if (!*unit) {
		ob_page_markup(p, "<td class=\"n\">%.3g</td>", x.median);
		return;
	}
	ob_page_markup(p, "<td class=\"n\">%s", ob_quantity_text(&median, x.median, unit));
	if (x.low < x.high)
		ob_page_markup(p, "<small>%s \u2013 %s</small>", ob_quantity_text(&low, x.low, unit),
			       ob_quantity_text(&high, x.high, unit));
	ob_page_markup(p, "</td>");
}

static bool known(const ob_section *s, ob_figure f)
{
	for (int w = 0; w < OB_WAYS; w++)
		if (!isnan(ob_spread_of(&s->cell[w], f).median))
			return true;
	return false;
}

static void put_heads(ob_page *p, const ob_comparison *c, const ob_section *s)
{
	ob_page_markup(p, "<div class=\"scroll\"><table>\n<thead><tr><th></th>");
	for (int w = 0; w < OB_WAYS; w++) {
		if (!ob_cell_is_done(s, w))
			continue;
		ob_page_markup(p, "<th scope=\"col\" class=\"n\">%s<small>%s, %" PRIu32 " worker%s</small></th>",
			       ob_way_table[w].title, ob_way_table[w].other_narrow ? c->other : c->narrow,
			       s->cell[w].workers, s->cell[w].workers == 1 ? "" : "s");
	}
	ob_page_markup(p, "</tr></thead>\n<tbody>\n");
}

static void put_table(ob_page *p, const ob_comparison *c, const ob_section *s)
{
	const char *group = NULL, *shown = NULL;
	put_heads(p, c, s);
	for (int k = 0; k < OB_FIGURE_KINDS; k++) {
		group = ob_figure_table[k].group ? ob_figure_table[k].group : group;
		if (!known(s, k))
			continue;
		if (group != shown)
			ob_page_markup(p, "<tr><th colspan=\"%d\">%s</th></tr>\n", OB_WAYS + 1, group);
		shown = group;
		ob_page_markup(p, "<tr><th scope=\"row\" title=\"%s\">%s</th>", ob_figure_table[k].meaning,
			       ob_figure_table[k].title);
		for (int w = 0; w < OB_WAYS; w++)
			if (ob_cell_is_done(s, w))
				put_spread(p, k, ob_spread_of(&s->cell[w], k));
		ob_page_markup(p, "</tr>\n");
	}
	ob_page_markup(p, "</tbody></table></div>\n");
}

static void put_diagram(ob_page *p, ob_diagram *d)
{
	char *svg = d->series_count ? ob_plot_svg_text(&d->plot, NULL) : NULL;
	if (svg)
		ob_page_markup(p, "<figure>\n%s</figure>\n", svg);
	free(svg);
}

static void write_growth(ob_page *p, const void *with)
{
	ob_diagram *d = malloc(sizeof *d);
	if (d) {
		ob_diagram_growth(d, with);
		put_diagram(p, d);
	}
	free(d);
}

static void put_left_out(ob_page *p, const ob_section *s)
{
	for (int w = 0; w < OB_WAYS; w++) {
		if (s->cell[w].state == OB_WAY_DONE)
			continue;
		ob_page_markup(p, "<p class=\"note\">%s: %s: ", ob_way_table[w].title,
			       s->cell[w].state == OB_WAY_FAILED ? "failed" : "left out");
		ob_page_text(p, s->cell[w].why);
		ob_page_markup(p, "</p>\n");
	}
}

static void put_section(ob_page *p, const ob_comparison *c, const ob_section *s, ob_diagram *d)
{
	ob_verdict v;
	ob_verdict_make(&v, c, s);
	ob_page_markup(p, "<section>\n<h2>%" PRIu32 " objects ", s->objects);
	ob_page_text(p, s->define);
	ob_page_markup(p, "</h2>\n");
	if (s != last_section(c)) // which stands at the top
		paragraph(p, "", v.answer);
	paragraph(p, "", v.architecture);
	paragraph(p, "", v.narrow);
	paragraph(p, "", v.sum);
	paragraph(p, "",
		  ob_section_agrees(s) ? "All object simulators with the same narrow phase ended in the same bits."
				       : "The object simulators did NOT end in the same bits.");
	ob_diagram_cost(d, c, s);
	put_diagram(p, d);
	ob_diagram_latency(d, c, s);
	put_diagram(p, d);
	put_table(p, c, s);
	put_left_out(p, s);
	ob_page_markup(p, "</section>\n");
}

static void write_sections(ob_page *p, const void *with)
{
	const ob_comparison *c = with;
	ob_diagram *d = malloc(sizeof *d);
	for (uint32_t i = c->sections; d && i-- > 0;)
		put_section(p, c, &c->section[i], d);
	free(d);
}

static void write_meanings(ob_page *p, const void *with)
{
	for (int k = 0; k < OB_FIGURE_KINDS; k++)
		ob_page_markup(p, "<dt>%s</dt><dd>%s</dd>\n", ob_figure_table[k].title, ob_figure_table[k].meaning);
}

static void write_page(const ob_comparison *c, FILE *f)
{
	static const ob_page_slot slots[] = { { "style", write_style },      { "answer", write_answer },
					      { "cards", write_cards },      { "setting", write_setting },
					      { "growth", write_growth },    { "sections", write_sections },
					      { "meanings", write_meanings } };
	ob_page page = { f };
	ob_page_fill(&page, text_compare_html, slots, sizeof slots / sizeof *slots, c);
}

static bool write_file(const ob_comparison *c, const char *folder, const char *name,
		       void (*write)(const ob_comparison *, FILE *), ob_error *e)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *f = fopen(path, "we");
	if (!f)
		return ob_fail(e, "%s: %s", path, strerror(errno));
	write(c, f);
	bool broken = ferror(f);
	broken |= fclose(f) != 0;
	return !broken || ob_fail(e, "%s: %s", path, strerror(errno));
}

static bool write_plot(const ob_diagram *d, const char *folder, uint32_t objects, ob_error *e)
{
	char path[4096];
	if (!d->series_count)
		return true;
	snprintf(path, sizeof path, "%s/plots/%s-%" PRIu32 ".svg", folder, d->name, objects);
	if (!ob_plot_svg(&d->plot, path, e))
		return false;
	snprintf(path, sizeof path, "%s/plots/%s-%" PRIu32 ".png", folder, d->name, objects);
	return ob_plot_png(&d->plot, path, 2, e);
}

static bool write_plots(const ob_comparison *c, const char *folder, ob_diagram *d, ob_error *e)
{
	for (uint32_t i = 0; i < c->sections; i++) {
		ob_diagram_cost(d, c, &c->section[i]);
		if (!write_plot(d, folder, c->section[i].objects, e))
			return false;
		ob_diagram_latency(d, c, &c->section[i]);
		if (!write_plot(d, folder, c->section[i].objects, e))
			return false;
	}
	ob_diagram_growth(d, c);
	return write_plot(d, folder, last_section(c)->objects, e);
}

bool ob_comparison_write_folder(const ob_comparison *c, const char *folder, ob_error *e)
{
	char plots[4096];
	snprintf(plots, sizeof plots, "%s/plots", folder);
	ob_diagram *d = malloc(sizeof *d);
	bool fine = d ? true : ob_fail(e, "out of memory");
	fine = fine && ob_folder_make(plots, e) && write_file(c, folder, "report.html", write_page, e) &&
	       write_file(c, folder, "results.csv", ob_comparison_write_csv, e) &&
	       write_file(c, folder, "results.json", ob_comparison_write_json, e) && write_plots(c, folder, d, e);
	free(d);
	return fine;
}

// Comparison as a folder: one page with the answer first and explanations after it, its diagrams, its figures.
#include <inttypes.h>
#include <math.h>

#include "compare/compare.h"
#include "compare_texts.h"
#include "experiment/folder.h"
#include "experiment/page.h"
#include "experiment/table.h"

// ---- diagrams

// define: the point of a sweep; "" = none
static ob_chart *begin_chart(const ob_comparison *c, const char *name, const char *define)
{
	ob_chart *d = ob_chart_new();
	char runs[64];
	ob_comparison_print_runs(c, runs, sizeof runs);
	snprintf(d->name, sizeof d->name, "%.20s%s%.70s", name, *define ? "-" : "", define);
	snprintf(d->subtitle, sizeof d->subtitle, "%.150s %s%.150s; %s, medians; %.60s", c->scene, define, c->options,
		 runs, c->records.commit);
	return d;
}

// Lists the configurations that ran, downwards; returns their number.
static int list_configurations(ob_chart *d, const ob_comparison *c, const ob_sweep_point *p, int id[OB_CONFIGURATIONS])
{
	int n = 0;
	for (int w = 0; w < OB_CONFIGURATIONS; w++) {
		if (!ob_comparison_is_done(c, p, w))
			continue;
		snprintf(d->category[n], sizeof *d->category, "%s%s%s", ob_configuration_table[w].title,
			 ob_configuration_table[w].other_narrow ? ", " : "",
			 ob_configuration_table[w].other_narrow ? c->other : "");
		id[n++] = w;
	}
	d->categories = (size_t)n;
	d->height = 130 + 42 * n;
	return n;
}

static ob_chart *chart_cost(const ob_comparison *c, const ob_sweep_point *p)
{
	int id[OB_CONFIGURATIONS];
	ob_chart *d = begin_chart(c, "cost", p->define);
	int n = list_configurations(d, c, p, id);
	bool interval = false, several = false;
	snprintf(d->title, sizeof d->title, "Cost of a step per body, %" PRIu32 " objects", p->objects);
	snprintf(d->x.label, sizeof d->x.label, "CPU per body and step (µs)");
	d->x.scale = OB_SCALE_LOG;
	for (int i = 0; i < n; i++) { // the interval as a line behind the marker
		ob_estimate x = ob_comparison_spread(c, p, id[i], OB_COMPARE_COST);
		interval |= x.interval;
		if (isnan(x.low))
			continue;
		several = true;
		ob_chart_begin(d, -1, false, "");
		ob_chart_add(d, 1e6 * x.low, i, "", "");
		ob_chart_add(d, 1e6 * x.high, i, "", "");
	}
	ob_chart_begin(d, 0, false,
		       interval  ? "median, and its interval of 95 %"
		       : several ? "median; the line runs from the least to the most"
				 : "one run")
		->line = false;
	for (int i = 0; i < n; i++) {
		char label[32], hint[192];
		ob_estimate x = ob_comparison_spread(c, p, id[i], OB_COMPARE_COST);
		snprintf(label, sizeof label, "%.3g", 1e6 * x.value);
		snprintf(hint, sizeof hint, "%s: %.3g µs", d->category[i], 1e6 * x.value);
		ob_chart_add(d, 1e6 * x.value, i, label, hint);
	}
	return d;
}

static ob_chart *chart_latency(const ob_comparison *c, const ob_sweep_point *p)
{
	static const ob_compare_metric metrics[] = { OB_COMPARE_P50, OB_COMPARE_P90, OB_COMPARE_P99,
						     OB_COMPARE_LONGEST };
	int id[OB_CONFIGURATIONS];
	ob_chart *d = begin_chart(c, "latency", p->define);
	int n = list_configurations(d, c, p, id);
	snprintf(d->title, sizeof d->title, "How long a step takes, %" PRIu32 " objects", p->objects);
	snprintf(d->x.label, sizeof d->x.label, "wall-clock time of a step (ms)");
	d->x.scale = OB_SCALE_LOG;
	for (int k = 0; k < 4; k++) {
		const char *title = ob_compare_metric_table[metrics[k]].title;
		ob_chart_begin(d, k, false, title)->line = false;
		for (int i = 0; i < n; i++) {
			char hint[192];
			double ms = 1e3 * ob_comparison_spread(c, p, id[i], metrics[k]).value;
			snprintf(hint, sizeof hint, "%s, %s: %.3g ms", d->category[i], title, ms);
			ob_chart_add(d, ms, i, "", hint);
		}
	}
	return d;
}

// Cost over the number of objects; NULL if that does not vary.
static ob_chart *chart_growth(const ob_comparison *c)
{
	bool grows = false;
	for (uint32_t i = 1; i < c->points; i++)
		grows |= c->point[i].objects != c->point[0].objects;
	if (!grows)
		return NULL;
	ob_chart *d = begin_chart(c, "growth", "");
	snprintf(d->title, sizeof d->title, "Cost of a step per body over the number of objects");
	snprintf(d->x.label, sizeof d->x.label, "objects");
	snprintf(d->y.label, sizeof d->y.label, "CPU per body and step (µs)");
	d->x.scale = d->y.scale = OB_SCALE_LOG;
	for (int w = 0; w < OB_CONFIGURATION_MONOLITH_OTHER; w++) {
		ob_chart_begin(d, w, false, ob_configuration_table[w].title);
		for (uint32_t i = 0; i < c->points; i++) {
			ob_estimate x = ob_comparison_spread(c, &c->point[i], w, OB_COMPARE_COST);
			char hint[192];
			if (isnan(x.value))
				continue;
			snprintf(hint, sizeof hint, "%s, %" PRIu32 " objects: %.3g µs", ob_configuration_table[w].title,
				 c->point[i].objects, 1e6 * x.value);
			ob_chart_point *at = ob_chart_add(d, c->point[i].objects, 1e6 * x.value, "", hint);
			at->low = 1e6 * x.low;
			at->high = 1e6 * x.high;
		}
	}
	return d;
}

// ---- the page

static const ob_sweep_point *last_point(const ob_comparison *c)
{
	return &c->point[c->points - 1];
}

static void write_answer(ob_page *p, const void *with)
{
	const ob_comparison *c = with;
	ob_verdict v;
	ob_verdict_make(&v, c, last_point(c));
	ob_page_markup(p, "<p class=\"lead\"><strong>");
	ob_page_text(p, *v.headline ? v.headline : "Not measured.");
	ob_page_markup(p, "</strong></p>\n");
	ob_page_paragraph(p, "", v.answer);
	ob_page_paragraph(p, "", v.architecture);
}

static void write_card(ob_page *p, const ob_comparison *c, ob_configuration_id id, const char *text)
{
	ob_estimate r = ob_comparison_ratio(c, last_point(c), id, OB_CONFIGURATION_THREADS, OB_COMPARE_COST);
	if (isnan(r.value))
		return;
	ob_page_markup(p, "<li><b>%.2f×</b><span>", r.value);
	ob_page_text(p, text);
	if (!isnan(r.low))
		ob_page_markup(p, "<br>%.2f to %.2f, run by run", r.low, r.high);
	ob_page_markup(p, "</span></li>\n");
}

static void write_cards(ob_page *p, const void *with)
{
	write_card(p, with, OB_CONFIGURATION_PROCESSES, "the CPU of the thread pool: a pool of processes");
	write_card(p, with, OB_CONFIGURATION_GROUPS, "process groups of 60 objects");
	write_card(p, with, OB_CONFIGURATION_THREADS_EACH, "a thread for each object");
	write_card(p, with, OB_CONFIGURATION_PROCESSES_EACH, "a process for each object");
	write_card(p, with, OB_CONFIGURATION_MONOLITH, "one world for all objects (ODE)");
}

static void write_setting(ob_page *p, const void *with)
{
	const ob_comparison *c = with;
	char runs[64];
	ob_page_term(p, "Scene", c->scene);
	ob_page_term(p, "Options", *c->options ? c->options : "–");
	const double took = ob_page_provenance(p, &c->records);
	ob_comparison_print_runs(c, runs, sizeof runs);
	ob_page_markup(p, "<dt>Runs</dt><dd>%s, interleaved in both orders; %.0f s in all</dd>\n", runs, took);
}

static void write_growth(ob_page *p, const void *with)
{
	ob_chart_html(chart_growth(with), p, "");
}

static void write_point(ob_page *p, const ob_comparison *c, const ob_sweep_point *at)
{
	ob_verdict v;
	ob_verdict_make(&v, c, at);
	ob_page_markup(p, "<section>\n<h2>%" PRIu32 " objects%s", at->objects, *at->define ? ", " : "");
	ob_page_text(p, at->define);
	ob_page_markup(p, "</h2>\n");
	if (at != last_point(c)) { // its answer is at the top
		ob_page_paragraph(p, "", v.headline);
		ob_page_paragraph(p, "", v.answer);
		ob_page_paragraph(p, "", v.architecture);
	}
	ob_page_paragraph(p, "", v.narrow);
	ob_page_paragraph(p, "", v.sum);
	ob_page_paragraph(p, "",
			  ob_comparison_agrees(c, at)
				  ? "All object simulators with the same narrow phase ended in the same bits."
				  : "The object simulators did NOT end in the same bits.");
	ob_chart_html(chart_cost(c, at), p, "");
	ob_chart_html(chart_latency(c, at), p, "");
	ob_table_html(ob_comparison_table(c, at, true), p);
	ob_table_html(ob_comparison_prices(c, at), p);
	for (int w = 0; w < OB_CONFIGURATIONS; w++) {
		char line[640];
		if (ob_comparison_left_out(c, at, w, "left out", line, sizeof line))
			ob_page_paragraph(p, "note", line);
	}
	ob_page_markup(p, "</section>\n");
}

static void write_points(ob_page *p, const void *with)
{
	const ob_comparison *c = with;
	for (uint32_t i = c->points; i-- > 0;)
		write_point(p, c, &c->point[i]);
}

static void write_meanings(ob_page *p, const void *with)
{
	ob_page_meanings(p, ob_compare_metric_table, OB_COMPARE_SHOWN);
}

static void write_json(FILE *f, const void *with)
{
	ob_comparison_write_json(with, f);
}

bool ob_comparison_write_folder(const ob_comparison *c, const char *folder, ob_error *e)
{
	static const ob_page_slot slots[] = { { "answer", write_answer },   { "cards", write_cards },
					      { "setting", write_setting }, { "growth", write_growth },
					      { "points", write_points },   { "meanings", write_meanings } };
	const ob_report report = { "obsim: thread or process, one world or many simulators", "", text_compare_html,
				   slots, sizeof slots / sizeof *slots };
	return ob_report_write(&report, folder, c, e) && ob_folder_write(folder, "results.json", write_json, c, e);
}

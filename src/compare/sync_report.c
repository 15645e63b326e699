// A comparison of lockstep with free simulators as text, and as a folder with one page.
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "compare/sync.h"
#include "experiment/chart.h"
#include "experiment/folder.h"
#include "experiment/page.h"
#include "experiment/table.h"
#include "sync_texts.h"

#define BY_LAG_TITLE "Energy by late mail / energy at the start"

static const char *const coupling_title[OB_SYNC_COUPLINGS] = { "lockstep", "ledger", "own", "own, heavy", "own, ODE" };

static bool was_run(const ob_sync_comparison *c, const ob_sync_point *p, int w)
{
	return ob_sync_summarise(c, p, w, OB_SYNC_CPU).n > 0;
}

// True if any configuration measured it: momentum is measured only where nothing is fixed.
static bool was_measured(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_metric m)
{
	bool any = false;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++)
		any |= ob_sync_summarise(c, p, w, m).n > 0 && !isnan(ob_sync_summarise(c, p, w, m).median);
	return any;
}

static ob_table *table_of(const ob_sync_comparison *c, const ob_sync_point *p)
{
	char align[OB_SYNC_METRICS + 1] = "l";
	for (int m = 0; m < OB_SYNC_SHOWN; m++)
		strcat(align, was_measured(c, p, m) ? "r" : "");
	ob_table *t = ob_table_new(align);
	if (!t)
		return NULL;
	ob_table_add(t, "%s", "");
	for (int m = 0; m < OB_SYNC_SHOWN; m++) {
		const char *unit = ob_sync_metrics[m].unit;
		if (!was_measured(c, p, m))
			continue;
		ob_table_add(t, "%s", ob_sync_metrics[m].title);
		if (strcmp(unit, "1") != 0)
			ob_table_small(t, "%s", unit);
	}
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		if (!was_run(c, p, w))
			continue;
		ob_table_add(t, "%s", ob_sync_table[w].title);
		for (int m = 0; m < OB_SYNC_SHOWN; m++) {
			if (!was_measured(c, p, m))
				continue;
			const ob_statistics s = ob_sync_summarise(c, p, w, m);
			const double scale = ob_sync_metrics[m].scale;
			ob_table_add(t, isnan(s.median) ? "–" : "%.3g", scale * s.median);
			if (!isnan(s.median_low))
				ob_table_small(t, "%.3g to %.3g", scale * s.median_low, scale * s.median_high);
		}
	}
	return t;
}

// Failures of trials, a line each.
static const ob_record *next_failure(const ob_sync_comparison *c, const ob_sync_point *p, size_t *from)
{
	while (*from < c->records.count) {
		const ob_record *r = &c->records.record[(*from)++];
		if (r->failure && strcmp(r->of, p->key) == 0)
			return r;
	}
	return NULL;
}

void ob_sync_print(const ob_sync_comparison *c, FILE *f, size_t width)
{
	for (uint32_t i = 0; i < c->points; i++) {
		const ob_sync_point *p = &c->point[i];
		char text[2048];
		size_t from = 0;
		ob_table *t = table_of(c, p);
		fprintf(f, "%s%s%s, %" PRIu32 " objects, %" PRIu32 " seed%s\n\n", c->scene, *p->define ? ", " : "",
			p->define, p->objects, c->seeds, c->seeds == 1 ? "" : "s");
		if (t)
			ob_table_print(t, f, width);
		ob_table_free(t);
		for (const ob_record *r; (r = next_failure(c, p, &from));)
			fprintf(f, "%s failed: %s\n", r->configuration, r->reason);
		ob_sync_recommend(c, p, text, sizeof text);
		fprintf(f, "\n%s\n", text);
	}
}

// ---- diagrams

static ob_chart *begin_chart(const ob_sync_comparison *c, const ob_sync_point *p)
{
	ob_chart *d = ob_chart_new();
	if (d)
		snprintf(d->subtitle, sizeof d->subtitle,
			 "%.150s %s, %" PRIu32 " objects, medians of %" PRIu32 " seeds; %.60s", c->scene, p->define,
			 p->objects, c->seeds, c->records.commit);
	return d;
}

static void add_point(ob_chart *d, const ob_sync_comparison *c, const ob_sync_point *p, int w, ob_sync_metric along,
		      ob_sync_metric up)
{
	const ob_statistics x = ob_sync_summarise(c, p, w, along), y = ob_sync_summarise(c, p, w, up);
	const double sx = ob_sync_metrics[along].scale, sy = ob_sync_metrics[up].scale;
	char hint[192];
	if (isnan(x.median) || isnan(y.median))
		return;
	snprintf(hint, sizeof hint, "%s: %.3g, %.3g", ob_sync_table[w].title, sx * x.median, sy * y.median);
	ob_plot_point *at = ob_chart_add(d, sx * x.median, sy * y.median, "", hint);
	const bool known = !isnan(y.median_low);
	at->low = known ? sy * y.median_low : y.n > 1 ? sy * y.least : 0;
	at->high = known ? sy * y.median_high : y.n > 1 ? sy * y.most : 0;
}

// An error over lag x speed / size, a curve for each coupling, on two threads.
static ob_chart *chart_lags(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_metric up, const char *title,
			    bool slopes)
{
	ob_chart *d = begin_chart(c, p);
	if (!d)
		return NULL;
	snprintf(d->title, sizeof d->title, "%s over the lag", title);
	snprintf(d->x_label, sizeof d->x_label, "lag × speed / size");
	snprintf(d->y_label, sizeof d->y_label, "%s", title);
	d->plot.x.scale = d->plot.y.scale = OB_SCALE_LOG;
	for (int k = OB_SYNC_LEDGER; k < OB_SYNC_COUPLINGS; k++) {
		const ob_line order = ob_sync_order(c, p, k);
		char name[128];
		snprintf(name, sizeof name, slopes && !isnan(order.slope) ? "%s: slope %.2f" : "%s", coupling_title[k],
			 order.slope);
		ob_chart_begin(d, k - 1, false, name);
		for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
			const ob_sync_configuration *of = &ob_sync_table[w];
			if ((int)of->coupling == k && !of->processes && !of->each && of->rate == 0)
				add_point(d, c, p, w, OB_SYNC_LAG, up);
		}
	}
	return d;
}

// Worst penetration over the rate of steps, with the ledger on two threads and no injected lag; lockstep beside it.
static ob_chart *chart_rates(const ob_sync_comparison *c, const ob_sync_point *p)
{
	ob_chart *d = begin_chart(c, p);
	if (!d)
		return NULL;
	const ob_line order = ob_sync_order_of_step(c, p);
	const double exact = 1e3 * ob_sync_summarise(c, p, 0, OB_SYNC_WORST).median;
	char name[128];
	snprintf(d->title, sizeof d->title, "Worst penetration over the rate of steps");
	snprintf(d->x_label, sizeof d->x_label, "steps of a simulator in a second (Hz)");
	snprintf(d->y_label, sizeof d->y_label, "worst penetration (mm)");
	d->plot.x.scale = d->plot.y.scale = OB_SCALE_LOG;
	snprintf(name, sizeof name, isnan(order.slope) ? "ledger" : "ledger: order %.2f", order.slope);
	ob_chart_begin(d, OB_SYNC_LEDGER - 1, false, name);
	for (int pass = 0; pass < 2; pass++) // the usual rate's row stands before the others
		for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
			const double rate = ob_sync_table[w].rate > 0 ? ob_sync_table[w].rate : c->rate;
			const ob_statistics y = ob_sync_summarise(c, p, w, OB_SYNC_WORST);
			char hint[160];
			if (!ob_sync_is_of_rates(w) || isnan(y.median) || (rate >= c->rate) != pass)
				continue;
			snprintf(hint, sizeof hint, "%s: %.3g mm", ob_sync_table[w].title, 1e3 * y.median);
			ob_plot_point *at = ob_chart_add(d, rate, 1e3 * y.median, "", hint);
			at->low = 1e3 * (isnan(y.median_low) ? y.least : y.median_low);
			at->high = 1e3 * (isnan(y.median_high) ? y.most : y.median_high);
		}
	if (exact > 0) {
		snprintf(d->mark_label, sizeof d->mark_label, "lockstep %.2g mm", exact);
		d->mark[0] = (ob_plot_mark){ .at = exact, .label = d->mark_label };
		d->plot.marks = 1;
	}
	return d;
}

// CPU over the worst penetration, without injected lags.
static ob_chart *chart_cost(const ob_sync_comparison *c, const ob_sync_point *p)
{
	ob_chart *d = begin_chart(c, p);
	if (!d)
		return NULL;
	snprintf(d->title, sizeof d->title, "CPU over the worst penetration, no injected lag");
	snprintf(d->x_label, sizeof d->x_label, "worst penetration (mm)");
	snprintf(d->y_label, sizeof d->y_label, "CPU per body and simulated second (ms)");
	d->plot.x.scale = d->plot.y.scale = OB_SCALE_LOG;
	for (int k = 0; k < OB_SYNC_COUPLINGS; k++) {
		ob_chart_begin(d, k, false, coupling_title[k])->line = false;
		for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++)
			if ((int)ob_sync_table[w].coupling == k && ob_sync_table[w].delay == 0 &&
			    ob_sync_table[w].rate == 0)
				add_point(d, c, p, w, OB_SYNC_WORST, OB_SYNC_CPU);
	}
	return d;
}

// ---- the page

static void write_style(ob_page *p, const void *with)
{
	ob_page_style(p);
}

static void write_paragraph(ob_page *p, const char *class, const char *text)
{
	ob_page_markup(p, "<p class=\"%s\">", class);
	ob_page_text(p, text);
	ob_page_markup(p, "</p>\n");
}

static void write_recommendation(ob_page *p, const void *with)
{
	const ob_sync_comparison *c = with;
	char text[2048];
	ob_sync_recommend(c, &c->point[c->points - 1], text, sizeof text);
	write_paragraph(p, "lead", text);
}

static void write_hypotheses(ob_page *p, const void *with)
{
	const ob_sync_comparison *c = with;
	for (int i = 0; i < 3; i++) {
		char name[8], text[1024];
		snprintf(name, sizeof name, "H%d", i + 1);
		ob_sync_judge(c, &c->point[c->points - 1], i, text, sizeof text);
		ob_page_term(p, name, text);
	}
}

static void write_setting(ob_page *p, const void *with)
{
	const ob_sync_comparison *c = with;
	char text[256];
	double took = 0;
	for (size_t i = 0; i < c->records.count; i++)
		took += c->records.record[i].took_s;
	ob_page_term(p, "Scene", c->scene);
	ob_page_term(p, "Machine", c->records.machine);
	ob_page_term(p, "Program", c->records.commit);
	snprintf(text, sizeof text, "%g s simulated, %" PRIu32 " seeds of each configuration; %.0f s in all",
		 c->duration, c->seeds, took);
	ob_page_term(p, "Runs", text);
}

static void write_figure(ob_page *p, ob_chart *d)
{
	ob_page_markup(p, "<figure>\n");
	if (d)
		ob_chart_html(d, p);
	ob_page_markup(p, "</figure>\n");
}

static void write_slopes(ob_page *p, const ob_sync_comparison *c, const ob_sync_point *at)
{
	ob_page_markup(p, "<ul>\n");
	for (int k = OB_SYNC_LEDGER; k < OB_SYNC_COUPLINGS; k++) {
		const ob_line order = ob_sync_order(c, at, k);
		if (isnan(order.slope))
			continue;
		ob_page_markup(p, "<li>%s: error grows with the lag to the power of %.2f", coupling_title[k],
			       order.slope);
		if (!isnan(order.slope_low))
			ob_page_markup(p, " (%.2f to %.2f)", order.slope_low, order.slope_high);
		ob_page_markup(p, ", over %zu lags</li>\n", order.n);
	}
	ob_page_markup(p, "</ul>\n");
}

static void write_points(ob_page *p, const void *with)
{
	const ob_sync_comparison *c = with;
	for (uint32_t i = c->points; i-- > 0;) {
		const ob_sync_point *at = &c->point[i];
		size_t from = 0;
		char text[2048];
		ob_page_markup(p, "<section>\n<h3>%" PRIu32 " objects%s", at->objects, *at->define ? ", " : "");
		ob_page_text(p, at->define);
		ob_page_print_quantity(text, sizeof text, at->size, "m");
		ob_page_markup(p, "; size %s, ", text);
		ob_page_print_quantity(text, sizeof text, at->speed, "m/s");
		ob_page_markup(p, "speed %s</h3>\n", text);
		ob_table *t = table_of(c, at);
		if (t)
			ob_table_html(t, p);
		ob_table_free(t);
		write_figure(p, chart_lags(c, at, OB_SYNC_SIZES, "Worst penetration / size", true));
		write_slopes(p, c, at);
		write_figure(p, chart_rates(c, at));
		write_figure(p, chart_lags(c, at, OB_SYNC_ENERGY, "Energy gained / energy at the start", false));
		write_figure(p, chart_lags(c, at, OB_SYNC_BY_LAG, BY_LAG_TITLE, false));
		write_figure(p, chart_cost(c, at));
		ob_sync_recommend(c, at, text, sizeof text);
		write_paragraph(p, "note", text);
		for (const ob_record *r; (r = next_failure(c, at, &from));) {
			snprintf(text, sizeof text, "%s failed: %s", r->configuration, r->reason);
			write_paragraph(p, "note", text);
		}
		ob_page_markup(p, "</section>\n");
	}
}

static void write_rate(ob_page *p, const void *with)
{
	ob_page_markup(p, "%g", ((const ob_sync_comparison *)with)->rate);
}

static void write_jitter(ob_page *p, const void *with)
{
	ob_page_markup(p, "%g", 100 * ((const ob_sync_comparison *)with)->jitter);
}

// Threats that depend on what was run.
static void write_threats(ob_page *p, const void *with)
{
	enum { FEW = 6 };
	const ob_sync_comparison *c = with;
	if (c->seeds < FEW)
		ob_page_markup(p,
			       "<li><b>%" PRIu32
			       " seeds</b> give no interval of 95 %%, which takes %d: free runs of one scene differ by "
			       "a factor of up to two. The same command with the same --out adds seeds; bars of "
			       "diagrams go from the least to the most.</li>\n",
			       c->seeds, FEW);
	if (c->points < 2)
		ob_page_markup(
			p, "<li>One number of objects. --vary n=10,100,1000 compares several, where the scene has a "
			   "parameter for it.</li>\n");
	size_t from = 0, failed = 0;
	for (uint32_t i = 0; i < c->points; i++, from = 0)
		while (next_failure(c, &c->point[i], &from))
			failed++;
	if (failed)
		ob_page_markup(p, "<li>%zu runs failed; figures are those of the others.</li>\n", failed);
}

static void write_meanings(ob_page *p, const void *with)
{
	for (int m = 0; m <= OB_SYNC_LAG; m++)
		ob_page_term(p, ob_sync_metrics[m].title, ob_sync_metrics[m].meaning);
}

static void write_page(FILE *f, const void *with)
{
	static const ob_page_slot slots[] = {
		{ "style", write_style },           { "recommendation", write_recommendation },
		{ "hypotheses", write_hypotheses }, { "setting", write_setting },
		{ "points", write_points },         { "rate", write_rate },
		{ "jitter", write_jitter },         { "threats", write_threats },
		{ "meanings", write_meanings }
	};
	ob_page page = { f };
	ob_page_fill(&page, text_sync_html, slots, sizeof slots / sizeof *slots, with);
}

bool ob_sync_write_folder(const ob_sync_comparison *c, const char *folder, ob_error *e)
{
	bool fine = ob_folder_write(folder, "report.html", write_page, c, e);
	for (uint32_t i = 0; fine && i < c->points; i++) {
		const ob_sync_point *p = &c->point[i];
		fine = ob_chart_write_point(chart_lags(c, p, OB_SYNC_SIZES, "Worst penetration / size", true), folder,
					    "error", p->define, e) &&
		       ob_chart_write_point(
			       chart_lags(c, p, OB_SYNC_ENERGY, "Energy gained / energy at the start", false), folder,
			       "energy", p->define, e) &&
		       ob_chart_write_point(chart_lags(c, p, OB_SYNC_BY_LAG, BY_LAG_TITLE, false), folder, "by_lag",
					    p->define, e) &&
		       ob_chart_write_point(chart_rates(c, p), folder, "rate", p->define, e) &&
		       ob_chart_write_point(chart_cost(c, p), folder, "cost", p->define, e);
	}
	return fine;
}

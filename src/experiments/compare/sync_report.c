// A comparison of lockstep with free simulators as text, and as a folder with one page.
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "compare/sync.h"
#include "experiment/page.h"
#include "experiment/table.h"
#include "sync_texts.h"

static const char *const coupling_title[OB_SYNC_COUPLINGS] = { "lockstep", "group", "own", "own, heavy", "own, ODE" };

// True if any configuration measured it: momentum is measured only where nothing is fixed.
static bool was_measured(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_metric m)
{
	bool any = false;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++)
		any |= ob_sync_estimate(c, p, w, m).n > 0;
	return any;
}

static bool is_shown(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_metric m)
{
	return m != OB_SYNC_LATENCY_MOST && m != OB_SYNC_SIZES && was_measured(c, p, m);
}

static ob_table *table_of(const ob_sync_comparison *c, const ob_sync_point *p)
{
	char align[OB_SYNC_METRICS + 1] = "l";
	int shown[OB_SYNC_METRICS], count = 0;
	for (int m = 0; m < OB_SYNC_SHOWN; m++)
		if (is_shown(c, p, m))
			shown[count++] = m;
	memset(align + 1, 'r', (size_t)count);
	ob_table *t = ob_table_new(align);
	ob_table_add(t, "%s", "");
	for (int i = 0; i < count; i++) {
		ob_table_add(t, "%s", ob_sync_metrics[shown[i]].title);
		if (strcmp(ob_sync_metrics[shown[i]].unit, "1") != 0)
			ob_table_small(t, "%s", ob_sync_metrics[shown[i]].unit);
	}
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		if (!ob_sync_estimate(c, p, w, OB_SYNC_CPU).n)
			continue;
		ob_table_add(t, "%s", ob_sync_table[w].title);
		for (int i = 0; i < count; i++) {
			const ob_estimate e = ob_sync_estimate(c, p, w, shown[i]);
			const double scale = ob_sync_metrics[shown[i]].scale;
			ob_table_add(t, e.n ? "%.3g" : "–", scale * e.value);
			if (e.low < e.high)
				ob_table_small(t, "%.3g to %.3g", scale * e.low, scale * e.high);
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
		size_t from = 0;
		fprintf(f, "%s%s%s, %" PRIu32 " objects, %" PRIu32 " seed%s\n\n", c->scene, *p->define ? ", " : "",
			p->define, p->objects, p->seeds, p->seeds == 1 ? "" : "s");
		ob_table_print(table_of(c, p), f, width);
		for (const ob_record *r; (r = next_failure(c, p, &from));)
			fprintf(f, "%s failed: %s\n", r->configuration, r->reason);
		fprintf(f, "\n%s\n", ob_sync_recommend(c, p).words);
	}
}

// ---- diagrams

// p: NULL for all points.
static ob_chart *begin_chart(const ob_sync_comparison *c, const ob_sync_point *p, const char *name, const char *title,
			     const char *x, const char *y)
{
	ob_chart *d = ob_chart_new();
	OB_SAY(d->subtitle, "%.150s", c->scene);
	if (p)
		OB_SAY(d->subtitle, " %s, %" PRIu32 " objects, means of %" PRIu32 " seeds", p->define, p->objects,
		       p->seeds);
	else
		OB_SAY(d->subtitle, ", means over seeds");
	OB_SAY(d->subtitle, "; %.60s", c->records.commit);
	OB_SAY(d->name, "%s", name);
	OB_SAY(d->title, "%s", title);
	OB_SAY(d->x.label, "%s", x);
	OB_SAY(d->y.label, "%s", y);
	d->x.scale = d->y.scale = OB_SCALE_LOG;
	return d;
}

// Adds a point with its interval.
static void add_point(ob_chart *d, double x, ob_estimate y, double scale, const char *of)
{
	char hint[192];
	if (isnan(x) || isnan(y.value))
		return;
	snprintf(hint, sizeof hint, "%s: %.3g, %.3g", of, x, scale * y.value);
	ob_chart_point *at = ob_chart_add(d, x, scale * y.value, "", hint);
	at->low = scale * y.low, at->high = scale * y.high;
}

// Adds a curve of a coupling's configurations with two threads over the lag.
static void add_lags(ob_chart *d, const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_coupling coupling,
		     ob_sync_metric up)
{
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		const ob_sync_configuration *of = &ob_sync_table[w];
		if (of->coupling == coupling && !of->processes && !of->each && of->rate == 0)
			add_point(d, ob_sync_estimate(c, p, w, OB_SYNC_LAG).value, ob_sync_estimate(c, p, w, up), 1,
				  of->title);
	}
}

static ob_chart *chart_error(const ob_sync_comparison *c, const ob_sync_point *p)
{
	ob_chart *d = begin_chart(c, p, "error", "Worst penetration over the lag, two threads", "lag × speed / size",
				  "worst penetration / size");
	for (int k = OB_SYNC_OWN; k < OB_SYNC_COUPLINGS; k++) {
		const ob_line order = ob_sync_order(c, p, k);
		char name[128];
		snprintf(name, sizeof name, isnan(order.slope) ? "%s" : "%s: slope %.2f", coupling_title[k],
			 order.slope);
		ob_chart_begin(d, k - OB_SYNC_OWN, false, name);
		add_lags(d, c, p, k, OB_SYNC_SIZES);
	}
	return d;
}

static ob_chart *chart_energy(const ob_sync_comparison *c, const ob_sync_point *p)
{
	ob_chart *d = begin_chart(c, p, "energy", "Energy gained over the lag, two threads", "lag × speed / size",
				  "energy gained / energy at the start");
	d->y.scale = OB_SCALE_LINEAR;
	for (int k = OB_SYNC_OWN; k < OB_SYNC_COUPLINGS; k++) {
		ob_chart_begin(d, k - OB_SYNC_OWN, false, coupling_title[k]);
		add_lags(d, c, p, k, OB_SYNC_ENERGY);
	}
	return d;
}

// Worst penetration over the rate of steps, of own responses on two threads, without an injected lag; lockstep beside it.
static ob_chart *chart_rates(const ob_sync_comparison *c, const ob_sync_point *p)
{
	ob_chart *d = begin_chart(c, p, "rate", "Worst penetration over the rate of steps, two threads",
				  "steps of a simulator in a second (Hz)", "worst penetration (mm)");
	const ob_line order = ob_sync_order_of_step(c, p);
	const double exact = 1e3 * ob_sync_estimate(c, p, 0, OB_SYNC_WORST).value;
	char name[128];
	snprintf(name, sizeof name, isnan(order.slope) ? "own" : "own: order %.2f", order.slope);
	ob_chart_begin(d, 0, false, name);
	for (int pass = 0; pass < 2; pass++) // the usual rate's row stands before the others
		for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
			const double rate = ob_sync_table[w].rate > 0 ? ob_sync_table[w].rate : c->rate;
			if (ob_sync_is_of_rates(w) && (rate >= c->rate) == pass)
				add_point(d, rate, ob_sync_estimate(c, p, w, OB_SYNC_WORST), 1e3,
					  ob_sync_table[w].title);
		}
	if (exact > 0) {
		d->mark[0] = (ob_chart_mark){ .at = exact };
		snprintf(d->mark[0].label, sizeof d->mark[0].label, "lockstep %.2g mm", exact);
		d->marks = 1;
	}
	return d;
}

// CPU over the worst penetration, without injected lags.
static ob_chart *chart_cost(const ob_sync_comparison *c, const ob_sync_point *p)
{
	ob_chart *d = begin_chart(c, p, "cost", "CPU over the worst penetration, no injected lag",
				  "worst penetration (mm)", "CPU per body and simulated second (ms)");
	for (int k = 0; k < OB_SYNC_COUPLINGS; k++) {
		ob_chart_begin(d, k, false, coupling_title[k])->line = false;
		for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++)
			if ((int)ob_sync_table[w].coupling == k && ob_sync_table[w].delay == 0 &&
			    ob_sync_table[w].rate == 0)
				add_point(d, 1e3 * ob_sync_estimate(c, p, w, OB_SYNC_WORST).value,
					  ob_sync_estimate(c, p, w, OB_SYNC_CPU), 1e3, ob_sync_table[w].title);
	}
	return d;
}

// A metric over the number of simulators, if that varies.
static ob_chart *chart_objects(const ob_sync_comparison *c, ob_sync_metric up, const char *name, const char *title,
			       const char *y)
{
	if (c->points < 2)
		return NULL;
	ob_chart *d = begin_chart(c, NULL, name, title, "simulators", y);
	for (int w = 0, style = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		if (!ob_sync_table[w].swept)
			continue;
		ob_chart_begin(d, style++, false, ob_sync_table[w].title);
		for (uint32_t i = 0; i < c->points; i++)
			add_point(d, c->point[i].objects, ob_sync_estimate(c, &c->point[i], w, up),
				  ob_sync_metrics[up].scale, ob_sync_table[w].title);
	}
	return d;
}

// ---- the page

static void write_recommendation(ob_page *p, const void *with)
{
	const ob_sync_comparison *c = with;
	ob_page_paragraph(p, "lead", ob_sync_recommend(c, ob_sync_main_point(c)).words);
}

static void write_hypotheses(ob_page *p, const void *with)
{
	const ob_sync_comparison *c = with;
	for (int i = 0; i < OB_SYNC_HYPOTHESES; i++) {
		char name[16];
		snprintf(name, sizeof name, "H%d", i + 1);
		ob_page_term(p, name, ob_sync_judge(c, i).words);
	}
}

static void write_setting(ob_page *p, const void *with)
{
	const ob_sync_comparison *c = with;
	char text[1024] = "";
	ob_page_term(p, "Scene", c->scene);
	const double took = ob_page_provenance(p, &c->records);
	OB_SAY(text, "%zu of %g simulated seconds, %.0f s in all; seeds of each configuration:", c->records.count,
	       c->duration, took);
	for (uint32_t i = 0; i < c->points; i++)
		OB_SAY(text, "%s %" PRIu32 "%s%s%s", i ? "," : "", c->point[i].seeds, *c->point[i].define ? " (" : "",
		       c->point[i].define, *c->point[i].define ? ")" : "");
	ob_page_term(p, "Runs", text);
}

static void write_slopes(ob_page *p, const ob_sync_comparison *c, const ob_sync_point *at)
{
	ob_page_markup(p, "<ul>\n");
	for (int k = OB_SYNC_OWN; k < OB_SYNC_COUPLINGS; k++) {
		const ob_line order = ob_sync_order(c, at, k);
		if (isnan(order.slope_low))
			continue;
		ob_page_markup(p, "<li>%s: slope %.2f (%.2f to %.2f) over %zu injected lags</li>\n", coupling_title[k],
			       order.slope, order.slope_low, order.slope_high, order.n);
	}
	ob_page_markup(p, "</ul>\n");
}

static void write_diagrams(ob_page *p, const ob_sync_comparison *c, const ob_sync_point *at)
{
	ob_chart_html(chart_error(c, at), p,
		      "Bars: intervals of 95 % (Student). The first point of each curve has no injected lag. A slope "
		      "is that over the injected lags alone.");
	write_slopes(p, c, at);
	ob_chart_html(chart_rates(c, at), p, "Bars: intervals of 95 % (Student). No injected lag.");
	ob_chart_html(chart_energy(c, at), p,
		      "Bars: intervals of 95 % (Student). The most above the start, 0 if never.");
	ob_chart_html(chart_cost(c, at), p, "Bars: intervals of 95 % of the CPU (Student).");
}

static void write_point(ob_page *p, const ob_sync_comparison *c, const ob_sync_point *at)
{
	size_t from = 0;
	ob_page_markup(p, "<section>\n<h3>%" PRIu32 " objects%s", at->objects, *at->define ? ", " : "");
	ob_page_text(p, at->define);
	ob_page_markup(p, "; size %s, speed %s; %" PRIu32 " seed%s</h3>\n", ob_word_quantity(at->size, "m").text,
		       ob_word_quantity(at->speed, "m/s").text, at->seeds, at->seeds == 1 ? "" : "s");
	ob_table_html(table_of(c, at), p);
	if (at == ob_sync_main_point(c))
		write_diagrams(p, c, at);
	else
		ob_page_paragraph(p, "note", ob_sync_recommend(c, at).words);
	for (const ob_record *r; (r = next_failure(c, at, &from));) {
		char text[320];
		snprintf(text, sizeof text, "%s failed: %s", r->configuration, r->reason);
		ob_page_paragraph(p, "note", text);
	}
	ob_page_markup(p, "</section>\n");
}

static void write_points(ob_page *p, const void *with)
{
	static const char caption[] = "Bars: intervals of 95 % (Student), where there are three seeds.";
	const ob_sync_comparison *c = with;
	write_point(p, c, ob_sync_main_point(c));
	if (c->points > 1)
		ob_page_markup(p, "<h3>Number of simulators</h3>\n");
	ob_chart_html(chart_objects(c, OB_SYNC_CPU, "objects-cpu", "CPU over the number of simulators",
				    "CPU per body and simulated second (ms)"),
		      p, caption);
	ob_chart_html(chart_objects(c, OB_SYNC_WORST, "objects-error",
				    "Worst penetration over the number of simulators", "worst penetration (mm)"),
		      p, caption);
	for (uint32_t i = 0; i < c->points; i++)
		if (&c->point[i] != ob_sync_main_point(c))
			write_point(p, c, &c->point[i]);
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
	enum { FEW = 3 };
	const ob_sync_comparison *c = with;
	uint32_t least = UINT32_MAX;
	for (uint32_t i = 0; i < c->points; i++)
		least = least < c->point[i].seeds ? least : c->point[i].seeds;
	if (least < FEW)
		ob_page_markup(
			p,
			"<li><b>%" PRIu32
			" seed%s</b> of a configuration give no interval, which takes %d: free runs of one scene "
			"differ by a factor of up to two. The same command with the same --out adds seeds.</li>\n",
			least, least == 1 ? "" : "s", FEW);
	if (c->points < 2)
		ob_page_markup(p, "<li>One number of objects. --vary n=10,100,1000 compares several, where the scene "
				  "has a parameter for it.</li>\n");
	size_t from = 0, failed = 0;
	for (uint32_t i = 0; i < c->points; i++, from = 0)
		while (next_failure(c, &c->point[i], &from))
			failed++;
	if (failed)
		ob_page_markup(p, "<li>%zu runs failed; figures are those of the others.</li>\n", failed);
}

static void write_meanings(ob_page *p, const void *with)
{
	ob_page_meanings(p, ob_sync_metrics, OB_SYNC_LAG + 1);
}

bool ob_sync_write_folder(const ob_sync_comparison *c, const char *folder, ob_error *e)
{
	static const ob_page_slot slots[] = { { "recommendation", write_recommendation },
					      { "hypotheses", write_hypotheses },
					      { "setting", write_setting },
					      { "points", write_points },
					      { "rate", write_rate },
					      { "jitter", write_jitter },
					      { "threats", write_threats },
					      { "meanings", write_meanings } };
	const ob_report report = { "obsim: lockstep or free running",
				   "tbody td:first-child, tbody th { white-space: nowrap }\n", text_sync_html, slots,
				   sizeof slots / sizeof *slots };
	return ob_report_write(&report, folder, c, e);
}

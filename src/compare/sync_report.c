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

static const char *const coupling_title[OB_SYNC_COUPLINGS] = { "lockstep", "ledger", "own", "own, heavy", "own, ODE" };

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

// Adds a mean with its interval, in the metric's unit for people.
static void add_cell(ob_table *t, ob_estimate e, double scale)
{
	const double v = scale * e.value, low = scale * e.low, high = scale * e.high;
	if (!e.n)
		ob_table_add(t, "–");
	else
		ob_table_add(t, "%.3g", v);
	if (low < high)
		ob_table_small(t, "%.3g to %.3g", low, high);
}

static ob_table *table_of(const ob_sync_comparison *c, const ob_sync_point *p)
{
	char align[OB_SYNC_METRICS + 1] = "l";
	for (int m = 0; m < OB_SYNC_SHOWN; m++)
		strcat(align, is_shown(c, p, m) ? "r" : "");
	ob_table *t = ob_table_new(align);
	if (!t)
		return NULL;
	ob_table_add(t, "%s", "");
	for (int m = 0; m < OB_SYNC_SHOWN; m++) {
		const char *unit = ob_sync_metrics[m].unit;
		if (!is_shown(c, p, m))
			continue;
		ob_table_add(t, "%s", ob_sync_metrics[m].title);
		if (strcmp(unit, "1") != 0)
			ob_table_small(t, "%s", unit);
	}
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		if (!ob_sync_estimate(c, p, w, OB_SYNC_CPU).n)
			continue;
		ob_table_add(t, "%s", ob_sync_table[w].title);
		for (int m = 0; m < OB_SYNC_SHOWN; m++) {
			if (!is_shown(c, p, m))
				continue;
			add_cell(t, ob_sync_estimate(c, p, w, m), ob_sync_metrics[m].scale);
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
			p->define, p->objects, p->seeds, p->seeds == 1 ? "" : "s");
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

// p: NULL for all points.
static ob_chart *begin_chart(const ob_sync_comparison *c, const ob_sync_point *p, const char *name, const char *title,
			     const char *x, const char *y)
{
	ob_chart *d = ob_chart_new();
	size_t n = (size_t)snprintf(d->subtitle, sizeof d->subtitle, "%.150s", c->scene);
	if (p)
		snprintf(d->subtitle + n, sizeof d->subtitle - n,
			 " %s, %" PRIu32 " objects, means of %" PRIu32 " seeds; %.60s", p->define, p->objects, p->seeds,
			 c->records.commit);
	else
		snprintf(d->subtitle + n, sizeof d->subtitle - n, ", means over seeds; %.60s", c->records.commit);
	snprintf(d->name, sizeof d->name, "%s", name);
	snprintf(d->title, sizeof d->title, "%s", title);
	snprintf(d->x.label, sizeof d->x.label, "%s", x);
	snprintf(d->y.label, sizeof d->y.label, "%s", y);
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
	for (int k = OB_SYNC_LEDGER; k < OB_SYNC_COUPLINGS; k++) {
		const ob_line order = ob_sync_order(c, p, k);
		char name[128];
		snprintf(name, sizeof name, isnan(order.slope) ? "%s" : "%s: slope %.2f", coupling_title[k],
			 order.slope);
		ob_chart_begin(d, k - 1, false, name);
		add_lags(d, c, p, k, OB_SYNC_SIZES);
	}
	return d;
}

static ob_chart *chart_energy(const ob_sync_comparison *c, const ob_sync_point *p)
{
	ob_chart *d = begin_chart(c, p, "energy", "Energy over the lag, two threads", "lag × speed / size",
				  "energy / energy at the start");
	d->y.scale = OB_SCALE_LINEAR;
	ob_chart_begin(d, OB_SYNC_LEDGER - 1, false, "ledger: gained");
	add_lags(d, c, p, OB_SYNC_LEDGER, OB_SYNC_ENERGY);
	ob_chart_begin(d, OB_SYNC_LEDGER - 1, true, "ledger: by late mail");
	add_lags(d, c, p, OB_SYNC_LEDGER, OB_SYNC_BY_LAG);
	ob_chart_begin(d, OB_SYNC_OWN - 1, false, "own: gained");
	add_lags(d, c, p, OB_SYNC_OWN, OB_SYNC_ENERGY);
	return d;
}

// Worst penetration over the rate of steps, with the ledger on two threads and no injected lag; lockstep beside it.
static ob_chart *chart_rates(const ob_sync_comparison *c, const ob_sync_point *p)
{
	ob_chart *d = begin_chart(c, p, "rate", "Worst penetration over the rate of steps, two threads",
				  "steps of a simulator in a second (Hz)", "worst penetration (mm)");
	const ob_line order = ob_sync_order_of_step(c, p);
	const double exact = 1e3 * ob_sync_estimate(c, p, 0, OB_SYNC_WORST).value;
	char name[128];
	snprintf(name, sizeof name, isnan(order.slope) ? "ledger" : "ledger: order %.2f", order.slope);
	ob_chart_begin(d, OB_SYNC_LEDGER - 1, false, name);
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

static ob_chart *chart_objects_cpu(const ob_sync_comparison *c)
{
	return chart_objects(c, OB_SYNC_CPU, "objects-cpu", "CPU over the number of simulators",
			     "CPU per body and simulated second (ms)");
}

static ob_chart *chart_objects_error(const ob_sync_comparison *c)
{
	return chart_objects(c, OB_SYNC_WORST, "objects-error", "Worst penetration over the number of simulators",
			     "worst penetration (mm)");
}

// ---- the page

static void write_recommendation(ob_page *p, const void *with)
{
	const ob_sync_comparison *c = with;
	char text[2048];
	ob_sync_recommend(c, ob_sync_main_point(c), text, sizeof text);
	ob_page_paragraph(p, "lead", text);
}

static void write_hypotheses(ob_page *p, const void *with)
{
	const ob_sync_comparison *c = with;
	for (int i = 0; i < OB_SYNC_HYPOTHESES; i++) {
		char name[16], text[2048];
		snprintf(name, sizeof name, "H%d", i + 1);
		ob_sync_judge(c, i, text, sizeof text);
		ob_page_term(p, name, text);
	}
}

static void write_setting(ob_page *p, const void *with)
{
	const ob_sync_comparison *c = with;
	char text[1024];
	double took = 0;
	for (size_t i = 0; i < c->records.count; i++)
		took += c->records.record[i].took_s;
	ob_page_term(p, "Scene", c->scene);
	ob_page_term(p, "Machine", c->records.machine);
	ob_page_term(p, "Program", c->records.commit);
	size_t n = (size_t)snprintf(text, sizeof text,
				    "%zu of %g simulated seconds, %.0f s in all; seeds of each configuration:",
				    c->records.count, c->duration, took);
	for (uint32_t i = 0; i < c->points && n < sizeof text; i++)
		n += (size_t)snprintf(text + n, sizeof text - n, "%s %" PRIu32 "%s%s%s", i ? "," : "",
				      c->point[i].seeds, *c->point[i].define ? " (" : "", c->point[i].define,
				      *c->point[i].define ? ")" : "");
	ob_page_term(p, "Runs", text);
}

static void write_slopes(ob_page *p, const ob_sync_comparison *c, const ob_sync_point *at)
{
	ob_page_markup(p, "<ul>\n");
	for (int k = OB_SYNC_LEDGER; k < OB_SYNC_COUPLINGS; k++) {
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
		      "Bars: intervals of 95 % (Student). The first point of each curve has no injected "
		      "lag. A slope is that over the injected lags alone.");
	write_slopes(p, c, at);
	ob_chart_html(chart_rates(c, at), p, "Bars: intervals of 95 % (Student). No injected lag.");
	ob_chart_html(chart_energy(c, at), p,
		      "Bars: intervals of 95 % (Student). Gained: the most above the start, 0 if never. "
		      "By late mail: its work, at the end of the run.");
	ob_chart_html(chart_cost(c, at), p, "Bars: intervals of 95 % of the CPU (Student).");
}

static void write_point(ob_page *p, const ob_sync_comparison *c, const ob_sync_point *at)
{
	size_t from = 0;
	char text[2048];
	ob_page_markup(p, "<section>\n<h3>%" PRIu32 " objects%s", at->objects, *at->define ? ", " : "");
	ob_page_text(p, at->define);
	ob_page_print_quantity(text, sizeof text, at->size, "m");
	ob_page_markup(p, "; size %s, ", text);
	ob_page_print_quantity(text, sizeof text, at->speed, "m/s");
	ob_page_markup(p, "speed %s; %" PRIu32 " seed%s</h3>\n", text, at->seeds, at->seeds == 1 ? "" : "s");
	ob_table *t = table_of(c, at);
	if (t)
		ob_table_html(t, p);
	ob_table_free(t);
	if (at == ob_sync_main_point(c)) {
		write_diagrams(p, c, at);
	} else {
		ob_sync_recommend(c, at, text, sizeof text);
		ob_page_paragraph(p, "note", text);
	}
	for (const ob_record *r; (r = next_failure(c, at, &from));) {
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
	ob_chart_html(chart_objects_cpu(c), p, caption);
	ob_chart_html(chart_objects_error(c), p, caption);
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
			"<li><b>%" PRIu32 " seed%s</b> of a configuration give no interval, which takes %d: free runs "
			"of one scene differ by a factor of up to two. The same command with the same --out adds "
			"seeds.</li>\n",
			least, least == 1 ? "" : "s", FEW);
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

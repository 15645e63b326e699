// What a hurried reader sees: the verdict, cost at equal error, every promise.
#include <math.h>
#include <string.h>

#include "lab/report_parts.h"

typedef struct lead {
	int compared, ahead, within; // cases; those where obsim is not ahead, but within twice the cost of the best
} lead;

static double best_other_cost(const ob_digest *d, const ob_digest_equal *q)
{
	double best = INFINITY;
	for (size_t i = 0; i < d->engines; i++)
		if (!ob_digest_is_obsim(d->engine[i]) && q->cost[i] < best)
			best = q->cost[i];
	return best;
}

static lead measure_lead(const ob_digest *d)
{
	lead l = { 0 };
	for (const ob_case *const *c = ob_cases; *c; c++) {
		if (!(*c)->compared || !ob_digest_ran(d, *c))
			continue;
		ob_digest_equal q = ob_digest_compare(d, *c);
		l.compared++;
		l.ahead += q.ahead;
		l.within += !q.ahead && q.own <= 2 * best_other_cost(d, &q);
	}
	return l;
}

static void write_card(ob_page *p, int part, int whole, const char *what)
{
	ob_page_markup(p, "<li><b>%d of %d</b><span>%s</span></li>\n", part, whole, what);
}

void ob_report_cards(ob_page *p, const void *with)
{
	const ob_digest *d = with;
	ob_digest_rows rows = ob_digest_count_rows(d);
	lead l = measure_lead(d);
	if (rows.measured)
		write_card(p, rows.met, rows.measured,
			   "rows of hard cases: obsim meets every target, at 60 frames a second");
	size_t others = ob_digest_count_others(d), failed = 0, runs = 0;
	if (l.compared && others)
		write_card(p, l.ahead, l.compared, "cases: no other engine gets to the same error at less cost");
	for (size_t i = 0; i < d->results->count; i++) {
		runs++;
		failed += d->results->result[i].outcome.failed[0] != 0;
	}
	ob_page_markup(p, "<li><b>%zu</b><span>other engines, and %zu of obsim's couplings</span></li>\n", others,
		       d->engines - others);
	ob_page_markup(p, "<li><b>%zu</b><span>runs measured; %zu of them failed and are shown as such</span></li>\n",
		       runs, failed);
}

// Names of the rows that are missed, so that nobody has to look for them
static void write_missed(ob_page *p, const ob_digest *d)
{
	int missed = 0;
	for (const ob_case *const *c = ob_cases; *c; c++) {
		const ob_result *r = ob_digest_promised(d, *c);
		if (!r || ob_digest_meets_all(r))
			continue;
		ob_page_markup(p, "%s<a href=\"#%s\">", missed++ ? ", " : "<strong>Missed:</strong> ", (*c)->name);
		ob_page_text(p, (*c)->title);
		ob_page_markup(p, "</a>");
	}
	ob_page_markup(p, "%s", missed ? ". " : "No target is missed. ");
}

void ob_report_verdict(ob_page *p, const void *with)
{
	const ob_digest *d = with;
	lead l = measure_lead(d);
	if (!d->own) {
		ob_page_markup(p, "obsim itself did not take part in these runs.");
		return;
	}
	write_missed(p, d);
	if (l.compared > l.ahead && ob_digest_count_others(d))
		ob_page_markup(p,
			       "Of the %d cases where another engine is cheaper at equal error, obsim is within twice "
			       "its cost "
			       "in %d.",
			       l.compared - l.ahead, l.within);
}

// Has the engine a column in the table of costs?
static bool is_compared(const ob_digest *d, size_t engine)
{
	for (size_t i = 0; i < d->results->count; i++)
		if (d->results->result[i].engine == d->engine[engine] && d->results->result[i].of->compared)
			return true;
	return false;
}

// Variants of obsim's coupling are shown, not ranked.
static bool is_ranked(const ob_digest *d, const ob_engine_kind *k)
{
	return k == d->own || !ob_digest_is_obsim(k);
}

static void write_engine_heads(ob_page *p, const ob_digest *d)
{
	for (size_t i = 0; i < d->engines; i++) {
		if (!is_compared(d, i))
			continue;
		ob_page_markup(p, "<th scope=\"col\" class=\"n\">");
		ob_page_text(p, d->engine[i]->title);
		ob_page_markup(p, "</th>");
	}
}

// An engine that never gets there: how far it does, and at what cost beside obsim's for the same
static void write_never(ob_page *p, const ob_digest *d, const ob_case *c, const ob_engine_kind *k)
{
	const ob_result *finest = ob_digest_finest(d, c, k);
	if (!finest) {
		bool ran = false;
		for (size_t i = 0; i < d->results->count; i++)
			ran |= d->results->result[i].of == c && d->results->result[i].engine == k;
		ob_page_markup(p, "<td class=\"n never\">%s</td>", ran ? "never<small>always fails</small>" : "\u2013");
		return;
	}
	ob_page_markup(p, "<td class=\"n never\">never<small>at best ");
	ob_page_quantity(p, finest->outcome.figure[0], c->figure[0].unit);
	ob_page_markup(p, ",<br>");
	ob_page_number(p, ob_result_cost(finest) * 1e6);
	ob_page_markup(p, "&nbsp;\u00b5s</small></td>");
}

static void write_cost(ob_page *p, const ob_digest *d, const ob_digest_equal *q, size_t i, double best)
{
	ob_page_markup(p, "<td class=\"n%s\">", is_ranked(d, d->engine[i]) && q->cost[i] <= best ? " best" : "");
	ob_page_number(p, q->cost[i] * 1e6);
	ob_page_markup(p, "&nbsp;\u00b5s");
	if (d->engine[i] != d->own && isfinite(q->own)) {
		ob_page_markup(p, "<small>");
		ob_page_number(p, q->cost[i] / q->own);
		ob_page_markup(p, "\u00d7</small>");
	}
	ob_page_markup(p, "</td>");
}

static void write_equal_row(ob_page *p, const ob_digest *d, const ob_case *c)
{
	ob_digest_equal q = ob_digest_compare(d, c);
	double best = INFINITY;
	for (size_t i = 0; i < d->engines; i++)
		if (is_ranked(d, d->engine[i]) && q.cost[i] < best)
			best = q.cost[i];
	ob_page_markup(p, "<tr><th scope=\"row\"><a href=\"#%s\">", c->name);
	ob_page_text(p, c->title);
	ob_page_markup(p, "</a><small>");
	ob_page_text(p, c->figure[0].name);
	ob_page_markup(p, "</small></th><td class=\"n\">");
	ob_page_quantity(p, q.error, c->figure[0].unit);
	ob_page_markup(p, "<small>%s</small></td>", q.is_target ? "target" : "obsim\u2019s least");
	for (size_t i = 0; i < d->engines; i++) {
		if (!is_compared(d, i))
			continue;
		if (isnan(q.cost[i]))
			write_never(p, d, c, d->engine[i]);
		else
			write_cost(p, d, &q, i, best);
	}
	ob_page_markup(p, "</tr>\n");
}

void ob_report_equal(ob_page *p, const void *with)
{
	const ob_digest *d = with;
	ob_page_markup(p, "<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\">case</th>"
			  "<th scope=\"col\" class=\"n\">error</th>");
	write_engine_heads(p, d);
	ob_page_markup(p, "</tr></thead>\n<tbody>\n");
	for (const ob_case *const *c = ob_cases; *c; c++)
		if ((*c)->compared && ob_digest_ran(d, *c))
			write_equal_row(p, d, *c);
	ob_page_markup(p, "</tbody></table></div>\n<p class=\"note\">\u00b5s of CPU per body and simulated second. "
			  "\u201cnever\u201d: no setting that was tried gets there without failing. "
			  "Variants of obsim\u2019s coupling are shown, but not ranked.</p>\n");
}

static void write_best_other(ob_page *p, const ob_digest *d, const ob_case *c, uint32_t figure)
{
	const ob_result *best = ob_digest_best_other(d, c, figure);
	bool tried = false;
	for (size_t i = 0; i < d->engines; i++)
		tried |= !ob_digest_is_obsim(d->engine[i]) && ob_digest_usual(d, c, d->engine[i]);
	ob_page_markup(p, "<td class=\"n\">");
	if (!best) {
		ob_page_markup(p, tried ? "all failed</td>" : "\u2013</td>");
		return;
	}
	ob_page_quantity(p, best->outcome.figure[figure], c->figure[figure].unit);
	ob_page_markup(p, "<small>");
	ob_page_text(p, best->engine->title);
	ob_page_markup(p, "</small></td>");
}

static void write_promise(ob_page *p, const ob_digest *d, const ob_result *r, uint32_t i, bool first)
{
	const ob_figure_def *def = &r->of->figure[i];
	bool met = ob_digest_meets(r, i);
	ob_page_markup(p, "<tr>");
	if (first && r->of->row > 0)
		ob_page_markup(p, "<td class=\"n\">%d</td>", r->of->row);
	else
		ob_page_markup(p, "<td></td>");
	ob_page_markup(p, "<td>");
	if (first) {
		ob_page_markup(p, "<a href=\"#%s\">", r->of->name);
		ob_page_text(p, r->of->title);
		ob_page_markup(p, "</a>");
	}
	ob_page_markup(p, "</td><td>");
	ob_page_text(p, def->name);
	ob_page_markup(p, "</td><td class=\"n\">");
	ob_page_quantity(p, r->outcome.figure[i], def->unit);
	if (r->outcome.failed[0]) {
		ob_page_markup(p, "<small>");
		ob_page_text(p, r->outcome.failed);
		ob_page_markup(p, "</small>");
	}
	ob_page_markup(p, "</td><td class=\"n\">");
	ob_page_quantity(p, def->target, def->unit);
	ob_page_markup(p, "</td><td class=\"%s\">%s</td>", met ? "met" : "missed",
		       met ? "\u2713 met" : "\u2717 missed");
	write_best_other(p, d, r->of, i);
	ob_page_markup(p, "</tr>\n");
}

void ob_report_rows(ob_page *p, const void *with)
{
	const ob_digest *d = with;
	ob_page_markup(
		p,
		"<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\" class=\"n\">row</th><th scope=\"col\">case"
		"</th><th scope=\"col\">figure</th><th scope=\"col\" class=\"n\">obsim</th><th scope=\"col\" "
		"class=\"n\">target</th>"
		"<th></th><th scope=\"col\" class=\"n\">best other engine</th></tr></thead>\n<tbody>\n");
	for (const ob_case *const *c = ob_cases; *c; c++) {
		const ob_result *r = ob_digest_promised(d, *c);
		bool first = true;
		for (uint32_t i = 0; r && i < (*c)->figures; i++) {
			if (!ob_digest_has_target(*c, i))
				continue;
			write_promise(p, d, r, i, first);
			first = false;
		}
	}
	ob_page_markup(p, "</tbody></table></div>\n");
}


#include <math.h>
#include <string.h>

#include "base/csv.h"
#include "experiment/table.h"
#include "lab/report.h"

// ---- all promised figures

static bool others_ran(const ob_lab_analysis *d, const ob_case *c)
{
	for (size_t i = 0; i < d->engines; i++)
		if (!ob_lab_analysis_is_obsim(d->engine[i]) && ob_lab_analysis_usual(d, c, d->engine[i]))
			return true;
	return false;
}

static void add_promise(ob_table *t, const ob_lab_analysis *d, const ob_result *r, uint32_t figure, bool first)
{
	const ob_case *c = r->of;
	const ob_figure_def *def = &c->figure[figure];
	const ob_result *other = ob_lab_analysis_best_other(d, c, figure);
	bool met = ob_lab_analysis_meets(r, figure);
	if (first && c->row > 0)
		ob_table_add(t, "%d", c->row);
	else
		ob_table_add(t, "%s", "");
	ob_table_add(t, "%s", first ? c->title : "");
	if (first)
		ob_table_link(t, c->name);
	ob_table_add(t, "%s", def->name);
	if (*r->outcome.failed && !isfinite(r->outcome.figure[figure]))
		ob_table_add(t, "failed");
	else
		ob_table_add(t, "%s", ob_word_quantity(r->outcome.figure[figure], def->unit).text);
	ob_table_add(t, "\u2264 %s", ob_word_quantity(def->target, def->unit).text);
	if (met)
		ob_table_add(t, "met");
	else
		ob_table_add(t, "MISSED%s%s", *r->outcome.failed ? ": " : "", r->outcome.failed);
	ob_table_class(t, met ? "met" : "missed");
	if (other) {
		ob_table_add(t, "%s", ob_word_quantity(other->outcome.figure[figure], def->unit).text);
		ob_table_small(t, "%s", other->engine->title);
	} else {
		ob_table_add(t, "%s", others_ran(d, c) ? "all failed" : "\u2013");
	}
}

ob_table *ob_lab_table_rows(const ob_lab_analysis *d)
{
	ob_table *t = ob_table_new("rllrlll");
	ob_table_row(t, "Row", "Case", "Figure", "obsim", "Target", "", "Best other engine", NULL);
	for (const ob_case *const *c = ob_cases; *c; c++) {
		const ob_result *r = ob_lab_analysis_promised(d, *c);
		bool first = true;
		for (uint32_t i = 0; r && i < (*c)->figures; i++) {
			if (!ob_lab_analysis_has_target(*c, i))
				continue;
			add_promise(t, d, r, i, first);
			first = false;
		}
	}
	return t;
}

size_t ob_lab_count_missed(const ob_lab_analysis *d)
{
	size_t missed = 0;
	for (const ob_case *const *c = ob_cases; *c; c++) {
		const ob_result *r = ob_lab_analysis_promised(d, *c);
		for (uint32_t i = 0; r && i < (*c)->figures; i++)
			missed += ob_lab_analysis_has_target(*c, i) && !ob_lab_analysis_meets(r, i);
	}
	return missed;
}

static void print_table(FILE *f, ob_table *t, bool markdown)
{
	if (markdown)
		ob_table_markdown(t, f);
	else
		ob_table_print(t, f, 0);
}

void ob_lab_print_rows(FILE *f, const ob_lab_analysis *d, bool markdown)
{
	print_table(f, ob_lab_table_rows(d), markdown);
}

// ---- conserved quantities

static bool conserves_all(const ob_result *r)
{
	bool all = true;
	for (ob_conserved i = 0; i < OB_CONSERVED; i++)
		all &= ob_lab_analysis_conserves(r, i);
	return all;
}

ob_table *ob_lab_table_conserved(const ob_lab_analysis *d)
{
	ob_table *t = ob_table_new("rlrrrl");
	ob_table_add(t, "Row");
	ob_table_add(t, "Case");
	for (int i = 0; i < OB_CONSERVED; i++) {
		ob_table_add(t, "%s", ob_conserved_kinds[i].title);
		ob_table_small(t, "\u2264 %s", ob_word_quantity(ob_conserved_kinds[i].bound, "1").text);
	}
	ob_table_add(t, "%s", "");
	for (const ob_case *const *c = ob_cases; *c; c++) {
		const ob_result *r = ob_lab_analysis_promised(d, *c);
		if (!r)
			continue;
		if ((*c)->row > 0)
			ob_table_add(t, "%d", (*c)->row);
		else
			ob_table_add(t, "%s", "");
		ob_table_add(t, "%s", (*c)->title);
		ob_table_link(t, (*c)->name);
		for (ob_conserved i = 0; i < OB_CONSERVED; i++) {
			ob_table_add(t, "%s", ob_word_quantity(r->outcome.conserved[i], "1").text);
			if (!isnan(r->outcome.conserved[i]))
				ob_table_class(t, ob_lab_analysis_conserves(r, i) ? "met" : "missed");
		}
		ob_table_add(t, "%s", conserves_all(r) ? "kept" : "NOT KEPT");
		ob_table_class(t, conserves_all(r) ? "met" : "missed");
	}
	return t;
}

void ob_lab_print_conserved(FILE *f, const ob_lab_analysis *d, bool markdown)
{
	size_t watched = 0, broken = 0, named = 0;
	for (const ob_case *const *c = ob_cases; *c; c++) {
		const ob_result *r = ob_lab_analysis_promised(d, *c);
		watched += r != NULL;
		broken += r && !conserves_all(r);
	}
	if (!watched)
		return;
	print_table(f, ob_lab_table_conserved(d), markdown);
	fprintf(f, "\nNot kept in %zu of %zu cases", broken, watched);
	for (const ob_case *const *c = ob_cases; *c; c++) {
		const ob_result *r = ob_lab_analysis_promised(d, *c);
		if (r && !conserves_all(r))
			fprintf(f, "%s%s", named++ ? ", " : ": ", (*c)->name);
	}
	fputs(".\n", f);
}

// ---- cost at equal error

static bool is_shown(const ob_lab_analysis *d, const ob_case *c)
{
	return c->compared && ob_lab_analysis_next(d, c, NULL, NULL);
}

// Collects the engines in compared cases; obsim itself comes first.
static size_t gather(const ob_lab_analysis *d, size_t place[OB_LAB_ANALYSIS_ENGINES])
{
	size_t count = 0;
	for (int own = 1; own >= 0; own--) {
		for (size_t i = 0; i < d->engines; i++) {
			bool part = false;
			for (const ob_result *r = NULL; (r = ob_lab_analysis_next(d, NULL, d->engine[i], r));)
				part |= r->of->compared;
			if (part && (d->engine[i] == d->own) == own)
				place[count++] = i;
		}
	}
	return count;
}

// Variants of obsim's coupling are shown, but not ranked.
static bool is_ranked(const ob_lab_analysis *d, const ob_engine_kind *k)
{
	return k == d->own || !ob_lab_analysis_is_obsim(k);
}

// Adds an engine that never reaches the error; in a page: its least error, and the cost of that.
static void add_never(ob_table *t, const ob_lab_analysis *d, const ob_case *c, const ob_engine_kind *k, bool in_page)
{
	const ob_result *finest = ob_lab_analysis_finest(d, c, k);
	ob_table_add(t, "never");
	ob_table_class(t, "never");
	if (!in_page)
		return;
	if (finest)
		ob_table_small(t, "at best %s, %s", ob_word_quantity(finest->outcome.figure[0], c->figure[0].unit).text,
			       ob_word_quantity(ob_result_cost(finest) * 1e6, "\u00b5s").text);
	else
		ob_table_small(t, "no run without a failure");
}

static void add_cost(ob_table *t, const ob_lab_analysis *d, const ob_lab_analysis_equal *q, size_t engine, double best)
{
	ob_table_add(t, "%s", ob_word_quantity(q->cost[engine] * 1e6, "1").text);
	if (d->engine[engine] != d->own && !isnan(q->own))
		ob_table_small(t, "%.2g\u00d7", q->cost[engine] / q->own);
	if (is_ranked(d, d->engine[engine]) && q->cost[engine] <= best)
		ob_table_class(t, "best");
}

ob_table *ob_lab_table_equal(const ob_lab_analysis *d, bool in_page, bool short_names)
{
	size_t place[OB_LAB_ANALYSIS_ENGINES], engines = gather(d, place);
	char align[OB_LAB_ANALYSIS_ENGINES + 3] = "lr";
	if (!engines)
		return NULL;
	memset(align + 2, 'r', engines);
	align[2 + engines] = 0;
	ob_table *t = ob_table_new(align);
	ob_table_add(t, "Case");
	ob_table_add(t, "at an error of");
	for (size_t i = 0; i < engines; i++)
		ob_table_add(t, "%s", short_names ? d->engine[place[i]]->name : d->engine[place[i]]->title);
	for (const ob_case *const *c = ob_cases; *c; c++) {
		if (!is_shown(d, *c))
			continue;
		ob_lab_analysis_equal q = ob_lab_analysis_compare(d, *c);
		double best = INFINITY;
		for (size_t i = 0; i < d->engines; i++)
			if (is_ranked(d, d->engine[i]) && q.cost[i] < best)
				best = q.cost[i];
		ob_table_add(t, "%s", (*c)->title);
		ob_table_link(t, (*c)->name);
		ob_table_add(t, "%s%s",
			     isnan(q.error) ? "no engine's" : ob_word_quantity(q.error, (*c)->figure[0].unit).text,
			     q.is_target ? "" : " *");
		for (size_t i = 0; i < engines; i++)
			if (isnan(q.cost[place[i]]))
				add_never(t, d, *c, d->engine[place[i]], in_page);
			else
				add_cost(t, d, &q, place[i], best);
	}
	return t;
}

// Prints the number of cases with obsim ahead of all other engines, and its worst ratio otherwise.
static void print_sum(FILE *f, const ob_lab_analysis *d)
{
	const ob_lab_analysis_lead l = ob_lab_analysis_measure_lead(d);
	if (!ob_lab_analysis_count_others(d) || !d->own || !l.compared)
		return;
	fprintf(f, "\nobsim is ahead in %d of %d", l.ahead, l.compared);
	if (l.worst > 0)
		fprintf(f, "; at worst it takes %.2g times as long", l.worst);
	fprintf(f, "%s.\n", l.never ? "; there are errors that it does not reach" : "");
}

void ob_lab_print_equal(FILE *f, const ob_lab_analysis *d, bool markdown)
{
	ob_table *t = ob_lab_table_equal(d, false, !markdown);
	if (!t)
		return;
	fputs("Microseconds of CPU per body and simulated second; in brackets: over obsim's. The error is the\n"
	      "target or, where no engine reaches it (*), obsim's smallest.\n\n",
	      f);
	print_table(f, t, markdown);
	print_sum(f, d);
}

void ob_lab_print_equal_csv(FILE *f, const ob_lab_analysis *d, bool markdown)
{
	static const char *const heads[] = {
		"case", "error", "unit", "error_is_target", "engine", "cpu_s_per_body_and_simulated_s", "over_obsim"
	};
	size_t place[OB_LAB_ANALYSIS_ENGINES], engines = gather(d, place);
	ob_csv csv = { .f = f };
	for (size_t i = 0; i < sizeof heads / sizeof *heads; i++)
		ob_csv_text(&csv, heads[i]);
	ob_csv_end(&csv);
	for (const ob_case *const *c = ob_cases; *c; c++) {
		if (!is_shown(d, *c))
			continue;
		ob_lab_analysis_equal q = ob_lab_analysis_compare(d, *c);
		for (size_t i = 0; i < engines; i++) {
			double cost = q.cost[place[i]];
			ob_csv_text(&csv, (*c)->name);
			ob_csv_number(&csv, q.error);
			ob_csv_text(&csv, (*c)->figure[0].unit);
			ob_csv_count(&csv, q.is_target);
			ob_csv_text(&csv, d->engine[place[i]]->name);
			ob_csv_number(&csv, cost);
			ob_csv_number(&csv, cost / q.own);
			ob_csv_end(&csv);
		}
	}
}

// ---- one case

static ob_table *begin_case(const ob_case *c, const char *first, const char *second)
{
	char align[OB_FIGURES + 4] = "lr";
	memset(align + 2, 'r', c->figures + 1);
	ob_table *t = ob_table_new(align);
	ob_table_add(t, "%s", first);
	ob_table_add(t, "%s", second);
	for (uint32_t i = 0; i < c->figures; i++) {
		ob_table_add(t, "%s", c->figure[i].name);
		if (ob_lab_analysis_has_target(c, i))
			ob_table_small(t, "target %s", ob_word_quantity(c->figure[i].target, c->figure[i].unit).text);
	}
	ob_table_add(t, "CPU");
	ob_table_small(t, "\u00b5s per body and s");
	return t;
}

static void add_name(ob_table *t, const ob_result *r)
{
	ob_table_add(t, "%s", r->engine->title);
	if (r->outcome.failed[0]) {
		ob_table_small(t, "failed: %s", r->outcome.failed);
		ob_table_class(t, "failed");
	}
}

static void add_figures(ob_table *t, const ob_result *r)
{
	for (uint32_t i = 0; i < r->of->figures; i++) {
		ob_table_add(t, "%s", ob_word_quantity(r->outcome.figure[i], r->of->figure[i].unit).text);
		if (ob_lab_analysis_has_target(r->of, i) && !r->outcome.failed[0])
			ob_table_class(t, ob_lab_analysis_meets(r, i) ? "met" : "missed");
	}
	ob_table_add(t, "%s", ob_word_quantity(ob_result_cost(r) * 1e6, "1").text);
}

ob_table *ob_lab_table_engines(const ob_lab_analysis *d, const ob_case *c)
{
	const ob_result *promised = ob_lab_analysis_promised(d, c);
	ob_table *t = begin_case(c, "engine, at its usual settings", "steps a frame");
	for (size_t i = 0; i < d->engines; i++) {
		bool is_promised = promised && promised->engine == d->engine[i];
		const ob_result *r = is_promised ? promised : ob_lab_analysis_usual(d, c, d->engine[i]);
		if (!r)
			continue;
		add_name(t, r);
		ob_table_add(t, "%u", r->settings.substeps);
		add_figures(t, r);
	}
	return t;
}

ob_table *ob_lab_table_runs(const ob_lab_analysis *d, const ob_case *c)
{
	ob_table *t = begin_case(c, "engine", "setting");
	for (const ob_result *r = NULL; (r = ob_lab_analysis_next(d, c, NULL, r));) {
		char setting[32], lag[24] = "";
		ob_lab_chart_setting(r, setting, sizeof setting);
		if (r->settings.lag)
			snprintf(lag, sizeof lag, ", lag %u", r->settings.lag);
		add_name(t, r);
		ob_table_add(t, "%s", setting);
		ob_table_small(t, "%u iterations%s", r->settings.iterations, lag);
		add_figures(t, r);
	}
	return t;
}

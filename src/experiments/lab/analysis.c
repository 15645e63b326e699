#include "lab/analysis.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "experiment/analysis.h"
#include "experiment/table.h"

bool ob_lab_analysis_is_obsim(const ob_engine_kind *k)
{
	return k->free || !strncmp(k->name, "obsim", 5);
}

size_t ob_lab_analysis_count_others(const ob_lab_analysis *d)
{
	size_t n = 0;
	for (size_t i = 0; i < d->engines; i++)
		n += !ob_lab_analysis_is_obsim(d->engine[i]);
	return n;
}

ob_lab_analysis ob_lab_analyse(const ob_results *r)
{
	ob_lab_analysis d = { .results = r };
	for (size_t i = 0; i < r->count; i++) {
		const ob_engine_kind *k = r->result[i].engine;
		size_t at = 0;
		while (at < d.engines && d.engine[at] != k)
			at++;
		if (at == d.engines && d.engines < OB_LAB_ANALYSIS_ENGINES)
			d.engine[d.engines++] = k;
		if (!strcmp(k->name, "obsim"))
			d.own = k;
	}
	return d;
}

int ob_lab_analysis_style(const ob_lab_analysis *d, const ob_engine_kind *k)
{
	static const char *const known[] = { "obsim",       "obsim-jacobi", "obsim-ode", "obsim-ghost",
					     "obsim-lag",   "ode-quick",    "ode-world", "bullet",
					     "ode-advised", "mujoco",       "mujoco-rk4" };
	enum { KNOWN = sizeof known / sizeof *known };
	for (int i = 0; i < KNOWN; i++)
		if (!strcmp(k->name, known[i]))
			return i;
	for (size_t i = 0; i < d->engines; i++)
		if (d->engine[i] == k)
			return KNOWN + (int)i;
	return KNOWN;
}

const ob_result *ob_lab_analysis_next(const ob_lab_analysis *d, const ob_case *c, const ob_engine_kind *k,
				      const ob_result *after)
{
	const ob_result *end = d->results->result + d->results->count;
	for (const ob_result *r = after ? after + 1 : d->results->result; r && r < end; r++)
		if ((!c || r->of == c) && (!k || r->engine == k))
			return r;
	return NULL;
}

static const ob_result *find(const ob_lab_analysis *d, const ob_case *c, const ob_engine_kind *k, uint32_t lag)
{
	const ob_run_settings *usual = &k->usual, *s;
	for (const ob_result *r = NULL; (r = ob_lab_analysis_next(d, c, k, r));) {
		s = &r->settings;
		if (s->substeps == usual->substeps && s->iterations == usual->iterations &&
		    s->tolerance == usual->tolerance && s->lag == lag && s->sleeping == usual->sleeping)
			return r;
	}
	return NULL;
}

const ob_result *ob_lab_analysis_usual(const ob_lab_analysis *d, const ob_case *c, const ob_engine_kind *k)
{
	return find(d, c, k, k->usual.lag);
}

const ob_result *ob_lab_analysis_promised(const ob_lab_analysis *d, const ob_case *c)
{
	const ob_result *r = d->own ? ob_lab_analysis_usual(d, c, d->own) : NULL;
	for (size_t i = 0; !r && i < d->engines; i++)
		if (!strcmp(d->engine[i]->name,
			    "obsim-lag")) // the case's target holds for engines without late partners
			r = find(d, c, d->engine[i], 0);
	return r;
}

bool ob_lab_analysis_has_target(const ob_case *c, uint32_t figure)
{
	return isfinite(c->figure[figure].target);
}

bool ob_lab_analysis_meets(const ob_result *r, uint32_t figure)
{
	return !r->outcome.failed[0] && r->outcome.figure[figure] <= r->of->figure[figure].target;
}

bool ob_lab_analysis_meets_all(const ob_result *r)
{
	for (uint32_t i = 0; i < r->of->figures; i++)
		if (ob_lab_analysis_has_target(r->of, i) && !ob_lab_analysis_meets(r, i))
			return false;
	return !r->outcome.failed[0];
}

bool ob_lab_analysis_conserves(const ob_result *r, ob_conserved what)
{
	return !(r->outcome.conserved[what] > ob_conserved_kinds[what].bound);
}

double ob_lab_analysis_ratio(const ob_result *r)
{
	double worst = r->outcome.failed[0] ? INFINITY : NAN;
	bool missed = false; // a target of 0
	for (uint32_t i = 0; i < r->of->figures; i++) {
		double figure = r->outcome.figure[i], target = r->of->figure[i].target;
		if (!ob_lab_analysis_has_target(r->of, i))
			continue;
		double ratio = !isfinite(figure) ? INFINITY : figure <= 0 || target <= 0 ? 0 : figure / target;
		missed |= target <= 0 && !(figure <= target);
		worst = isnan(worst) ? ratio : fmax(worst, ratio);
	}
	return missed && worst <= 1 ? INFINITY : worst;
}

const ob_result *ob_lab_analysis_best_other(const ob_lab_analysis *d, const ob_case *c, uint32_t figure)
{
	const ob_result *best = NULL;
	for (size_t i = 0; i < d->engines; i++) {
		const ob_result *r =
			ob_lab_analysis_is_obsim(d->engine[i]) ? NULL : ob_lab_analysis_usual(d, c, d->engine[i]);
		if (!r || r->outcome.failed[0] || !isfinite(r->outcome.figure[figure]))
			continue;
		if (!best || r->outcome.figure[figure] < best->outcome.figure[figure])
			best = r;
	}
	return best;
}

ob_lab_analysis_rows ob_lab_analysis_count_rows(const ob_lab_analysis *d)
{
	bool measured[OB_LAB_ANALYSIS_ROWS] = { 0 }, missed[OB_LAB_ANALYSIS_ROWS] = { 0 };
	for (const ob_case *const *c = ob_cases; *c; c++) {
		const ob_result *r = ob_lab_analysis_promised(d, *c);
		if (!r || (*c)->row <= 0 || (*c)->row >= OB_LAB_ANALYSIS_ROWS)
			continue;
		measured[(*c)->row] = true;
		missed[(*c)->row] |= !ob_lab_analysis_meets_all(r);
	}
	ob_lab_analysis_rows rows = { 0 };
	for (int i = 0; i < OB_LAB_ANALYSIS_ROWS; i++) {
		rows.measured += measured[i];
		rows.met += measured[i] && !missed[i];
	}
	return rows;
}

const ob_result *ob_lab_analysis_finest(const ob_lab_analysis *d, const ob_case *c, const ob_engine_kind *k)
{
	const ob_result *best = NULL;
	for (const ob_result *r = NULL; (r = ob_lab_analysis_next(d, c, k, r));)
		if (!r->outcome.failed[0] && isfinite(r->outcome.figure[0]) &&
		    (!best || r->outcome.figure[0] < best->outcome.figure[0]))
			best = r;
	return best;
}

ob_lab_analysis_equal ob_lab_analysis_compare(const ob_lab_analysis *d, const ob_case *c)
{
	const ob_result *finest = d->own ? ob_lab_analysis_finest(d, c, d->own) : NULL;
	ob_lab_analysis_equal q = { .error = finest ? finest->outcome.figure[0] : NAN, .own = NAN };
	for (size_t i = 0; i < d->engines; i++) {
		const ob_result *r = ob_lab_analysis_finest(d, c, d->engine[i]);
		q.is_target |= r && ob_lab_analysis_meets(r, 0);
	}
	if (q.is_target)
		q.error = c->figure[0].target;
	for (size_t i = 0; i < d->engines; i++)
		q.cost[i] = isnan(q.error) ? NAN : ob_cost_at(d->results, c, d->engine[i], q.error);
	for (size_t i = 0; i < d->engines; i++)
		if (d->engine[i] == d->own)
			q.own = q.cost[i];
	q.ahead = isfinite(q.own);
	for (size_t i = 0; i < d->engines; i++)
		q.ahead &= ob_lab_analysis_is_obsim(d->engine[i]) || !(q.cost[i] < q.own);
	return q;
}

ob_lab_analysis_lead ob_lab_analysis_measure_lead(const ob_lab_analysis *d)
{
	ob_lab_analysis_lead l = { 0 };
	for (const ob_case *const *c = ob_cases; *c; c++) {
		if (!(*c)->compared || !ob_lab_analysis_next(d, *c, NULL, NULL))
			continue;
		const ob_lab_analysis_equal q = ob_lab_analysis_compare(d, *c);
		double best = INFINITY; // of the other engines
		for (size_t i = 0; i < d->engines; i++)
			if (!ob_lab_analysis_is_obsim(d->engine[i]) && q.cost[i] < best)
				best = q.cost[i];
		l.compared++;
		l.ahead += q.ahead;
		l.within += !q.ahead && q.own <= 2 * best;
		l.never |= isnan(q.own);
		if (!q.ahead && best > 0)
			l.worst = fmax(l.worst, q.own / best);
	}
	return l;
}

// ---- audit

static const double tolerance[OB_AUDIT_TOLERANCES] = { 1e-2, 1e-3, 1e-4, 1e-5 }; // m
static const char *const names[OB_AUDIT_SETTINGS] = { "10 mm", "1 mm", "0.1 mm", "0.01 mm", "4",  "8",
						      "16",    "32",   "64",     "128",     "256" };
static const double slack = 1.05, noticeable = 2, rounding = 1e-3; // ratios to the coarser error; share of the target

static uint32_t substeps_of(int setting)
{
	return 4u << (setting - OB_AUDIT_TOLERANCES);
}

static bool is_setting(const ob_run_settings *s, int setting)
{
	if (setting < OB_AUDIT_TOLERANCES)
		return s->substeps == 0 && fabs(s->tolerance / tolerance[setting] - 1) < 1e-9;
	return s->tolerance == 0 && s->substeps == substeps_of(setting);
}

// Ignores results that ran out of time.
static const ob_result *result_at(const ob_lab_analysis *d, const ob_case *c, int setting)
{
	for (const ob_result *r = NULL; d->own && (r = ob_lab_analysis_next(d, c, d->own, r));)
		if (is_setting(&r->settings, setting) && !isnan(r->outcome.body_seconds))
			return r;
	return NULL;
}

static double times(double fine, double coarse)
{
	return coarse > 0 && isfinite(fine) ? fine / coarse : INFINITY;
}

static void keep(ob_audit_rise *worst, int figure, int setting, double by)
{
	if (worst->figure < 0 || by > worst->times)
		*worst = (ob_audit_rise){ figure, setting, by };
}

// A run that fails at the finer setting counts as infinitely bad in its first figure.
static void compare(ob_audit *a, const ob_case *c, int coarse, int fine)
{
	const ob_case_result *from = &a->result[coarse]->outcome, *to = &a->result[fine]->outcome;
	if (*to->failed) {
		if (!*from->failed)
			keep(&a->above, 0, fine, INFINITY);
		return;
	}
	for (uint32_t i = 0; i < c->figures && !*from->failed; i++) {
		double target = c->figure[i].target, before = from->figure[i], after = to->figure[i];
		if (!ob_lab_analysis_has_target(c, i))
			continue;
		if (after > target && !(after <= slack * before))
			keep(&a->above, (int)i, fine, times(after, before));
		else if (after <= target && after > rounding * target && after > noticeable * before)
			keep(&a->below, (int)i, fine, times(after, before));
	}
}

ob_audit ob_lab_audit(const ob_lab_analysis *d, const ob_case *c)
{
	ob_audit a = { .above = { .figure = -1 }, .below = { .figure = -1 } };
	double h[OB_AUDIT_SUBSTEPS], error[OB_AUDIT_SUBSTEPS];
	int coarser = -1; // index of the coarser value of the same setting
	for (int i = 0; i < OB_AUDIT_SETTINGS; i++) {
		a.result[i] = result_at(d, c, i);
		a.ratio[i] = a.result[i] ? ob_lab_analysis_ratio(a.result[i]) : NAN;
		a.measured += a.result[i] != NULL;
		if (i == OB_AUDIT_TOLERANCES)
			coarser = -1;
		if (a.result[i] && coarser >= 0)
			compare(&a, c, coarser, i);
		if (a.result[i])
			coarser = i;
	}
	double least = INFINITY, most = 0;
	for (int i = 0; i < OB_AUDIT_SUBSTEPS; i++) {
		h[i] = 1. / substeps_of(OB_AUDIT_TOLERANCES + i);
		error[i] = a.ratio[OB_AUDIT_TOLERANCES + i];
		least = fmin(least, error[i]);
		most = fmax(most, error[i]);
	}
	bool flat = most <= 1 && most < noticeable * least; // good enough from the first value
	a.order = flat ? NAN : ob_statistics_order(OB_AUDIT_SUBSTEPS, h, error, rounding);
	return a;
}

// ---- tables

static ob_table *new_table(void)
{
	ob_table *t = ob_table_new("rlrrrrrrrrrrrrl");
	ob_table_row(t, "Row", "Case", NULL);
	for (int i = 0; i < OB_AUDIT_SETTINGS; i++)
		ob_table_add(t, "%s", names[i]);
	ob_table_add(t, "order");
	ob_table_add(t, "%s", "");
	return t;
}

static void add_case(ob_table *t, const ob_case *c, const ob_audit *a)
{
	if (c->row > 0)
		ob_table_add(t, "%d", c->row);
	else
		ob_table_add(t, "%s", "");
	ob_table_add(t, "%s", c->title);
	ob_table_link(t, c->name);
	for (int i = 0; i < OB_AUDIT_SETTINGS; i++) {
		if (isinf(a->ratio[i])) {
			ob_table_add(t, "failed");
			ob_table_class(t, "missed");
			continue;
		}
		ob_table_add(t, "%s", ob_word_number(a->ratio[i]).text);
		if (!isnan(a->ratio[i]))
			ob_table_class(t, a->ratio[i] <= 1 ? "met" : "missed");
	}
	if (isnan(a->order))
		ob_table_add(t, "\u2013");
	else
		ob_table_add(t, "%.1f", a->order);
	ob_table_add(t, "%s", a->above.figure >= 0 ? "RISES" : "");
	if (a->above.figure >= 0)
		ob_table_class(t, "missed");
}

ob_table *ob_lab_table_audit(const ob_lab_analysis *d)
{
	ob_table *t = NULL;
	for (const ob_case *const *c = ob_cases; *c; c++) {
		ob_audit a = ob_lab_audit(d, *c);
		if (a.measured < 2)
			continue;
		t = t ? t : new_table();
		add_case(t, *c, &a);
	}
	return t;
}

static void print_rise(FILE *f, const ob_case *c, const ob_audit_rise *r)
{
	bool by_tolerance = r->setting < OB_AUDIT_TOLERANCES;
	fprintf(f, "- `%s`: %s, at %s%s%s", c->name, c->figure[r->figure].name, by_tolerance ? "a tolerance of " : "",
		names[r->setting], by_tolerance ? "" : " substeps");
	if (isfinite(r->times))
		fprintf(f, ", %.3g times that of the coarser setting\n", r->times);
	else
		fprintf(f, ", where the coarser setting has none\n");
}

static void print_rises(FILE *f, const ob_lab_analysis *d, bool above, const char *what)
{
	size_t audited = 0, rising = 0;
	for (int pass = 0; pass < 2; pass++) { // counts, then names
		for (const ob_case *const *c = ob_cases; *c; c++) {
			ob_audit a = ob_lab_audit(d, *c);
			const ob_audit_rise *rise = above ? &a.above : &a.below;
			audited += !pass && a.measured > 1;
			rising += !pass && rise->figure >= 0;
			if (pass && rise->figure >= 0)
				print_rise(f, *c, rise);
		}
		if (!pass)
			fprintf(f, "\n%s in %zu of %zu cases%s\n\n", what, rising, audited, rising ? ":" : ".");
	}
}

void ob_lab_print_audit(FILE *f, const ob_lab_analysis *d, bool markdown)
{
	ob_table *t = ob_lab_table_audit(d);
	if (!t)
		return;
	fputs("Errors over their targets, the worst of a case, by tolerance and by substeps.\n\n", f);
	if (markdown)
		ob_table_markdown(t, f);
	else
		ob_table_print(t, f, 0);
	print_rises(f, d, true, "A finer setting has a larger error, above its target,");
	print_rises(f, d, false, "A finer setting has more than twice the error, below its target,");
}

// ---- result

static size_t place_of_case(const ob_case *c)
{
	size_t i = 0;
	while (ob_cases[i] && ob_cases[i] != c)
		i++;
	return i;
}

static size_t place_of_engine(const ob_engine_kind *k)
{
	size_t i = 0;
	while (ob_engine_kinds[i] && ob_engine_kinds[i] != k)
		i++;
	return i;
}

static int by_number(double a, double b)
{
	return (a > b) - (a < b);
}

// From coarse to fine; tolerances after explicit substeps.
static int by_settings(const ob_run_settings *a, const ob_run_settings *b)
{
	int order = (a->tolerance > 0) - (b->tolerance > 0);
	order = order ? order : by_number(b->tolerance, a->tolerance);
	order = order ? order : by_number(b->step_length, a->step_length);
	order = order ? order : by_number(a->substeps, b->substeps);
	order = order ? order : by_number(a->iterations, b->iterations);
	order = order ? order : by_number(a->lag, b->lag);
	return order ? order : (int)a->sleeping - (int)b->sleeping;
}

int ob_result_order(const ob_result *a, const ob_result *b)
{
	int order = by_number((double)place_of_case(a->of), (double)place_of_case(b->of));
	order = order ? order : by_number((double)place_of_engine(a->engine), (double)place_of_engine(b->engine));
	return order ? order : by_settings(&a->settings, &b->settings);
}

ob_result *ob_results_find(const ob_results *r, const ob_case *c, const ob_engine_kind *k, const ob_run_settings *s)
{
	for (size_t i = 0; i < r->count; i++) {
		ob_result *one = &r->result[i];
		if (one->of == c && one->engine == k && by_settings(&one->settings, s) == 0)
			return one;
	}
	return NULL;
}

bool ob_results_add(ob_results *r, const ob_result *one)
{
	if (!OB_MAKE_ROOM(r->result, r->count, r->max))
		return false;
	size_t at = r->count++;
	for (; at > 0 && ob_result_order(&r->result[at - 1], one) > 0; at--)
		r->result[at] = r->result[at - 1];
	r->result[at] = *one;
	return true;
}

static double median(const double *value, size_t n)
{
	double sorted[OB_REPEATS];
	memcpy(sorted, value, n * sizeof *value);
	return ob_statistics_summarise(n, sorted).median;
}

void ob_result_repeat(ob_result *r, const ob_case_result *again)
{
	if (r->repeats == OB_REPEATS)
		return;
	ob_case_result *o = &r->outcome;
	r->cpu_s[r->repeats] = again->cpu_s;
	r->wall_s[r->repeats++] = again->wall_s;
	if (r->repeats == 1) {
		*o = *again;
		return;
	}
	o->cpu_s = median(r->cpu_s, r->repeats);
	o->wall_s = median(r->wall_s, r->repeats);
	for (int i = 0; i < OB_FIGURES; i++)
		ob_figure_keep(&o->figure[i], again->figure[i]);
	ob_conservation_keep(o->conserved, again->conserved);
	if (!*o->failed)
		memcpy(o->failed, again->failed, sizeof o->failed);
	if (isnan(again->body_seconds)) // it was not completed
		o->body_seconds = NAN;
}

void ob_results_finish(ob_results *r)
{
	free(r->result);
	*r = (ob_results){ 0 };
}

double ob_cost_at(const ob_results *r, const ob_case *c, const ob_engine_kind *k, double error)
{
	ob_cost_point *list = calloc(r->count + 1, sizeof *list);
	size_t count = 0;
	for (size_t i = 0; list && i < r->count; i++) {
		const ob_result *one = &r->result[i];
		ob_cost_point p = { ob_result_cost(one), one->outcome.figure[0] };
		if (one->of == c && one->engine == k && !*one->outcome.failed && isfinite(p.error) && p.cost > 0 &&
		    isfinite(p.cost))
			list[count++] = p;
	}
	double cost = list ? ob_cost_at_error(list, count, error) : NAN;
	free(list);
	return cost;
}

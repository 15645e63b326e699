#include "lab/result.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "experiment/analysis.h"

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

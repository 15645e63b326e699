#include "lab/analysis.h"

#include <math.h>
#include <string.h>

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

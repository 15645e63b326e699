// Verdict of a comparison, by rules: it depends on the runs alone.
#include <math.h>
#include <string.h>

#include "compare/compare.h"
#include "experiment/words.h"

enum { runs_least = 3 }; // fewer are inconclusive
static const double alike = .05; // ratios within this of 1 count as no difference

// Median of a metric with its unit.
static ob_word value(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id, ob_compare_metric m)
{
	return ob_word_metric(ob_comparison_spread(c, p, id, m).value, &ob_compare_metric_table[m]);
}

// " (0.98 to 1.02)"; empty for a single run.
static ob_word range(ob_estimate r)
{
	ob_word to = { "" };
	if (!isnan(r.low))
		OB_SAY(to.text, " (%.2f to %.2f)", r.low, r.high);
	return to;
}

static ob_estimate cost_over_pool(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id)
{
	return ob_comparison_ratio(c, p, id, OB_CONFIGURATION_THREADS, OB_COMPARE_COST);
}

// Names the cheaper of the two pools, if any, and compares it with a worker per object.
static void write_headline(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p)
{
	ob_estimate r = cost_over_pool(c, p, OB_CONFIGURATION_PROCESSES);
	ob_estimate each = cost_over_pool(c, p, OB_CONFIGURATION_THREADS_EACH);
	if (isnan(r.value))
		return;
	if (r.n < runs_least) {
		OB_SAY(v->headline, "Undecided after so few runs: use --repeats 6.");
		return;
	}
	if (r.low > 1 + alike)
		OB_SAY(v->headline, "Threads");
	else if (r.high < 1 - alike)
		OB_SAY(v->headline, "Processes");
	else
		OB_SAY(v->headline, "Either: they cost the same");
	if (each.low > 1 + alike)
		OB_SAY(v->headline, "; but let objects share them: one for each object costs %.1f times as much.",
		       each.value);
	else
		OB_SAY(v->headline, ".");
}

static void compare_pools(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p)
{
	const ob_configuration_id threads = OB_CONFIGURATION_THREADS, processes = OB_CONFIGURATION_PROCESSES;
	ob_estimate r = cost_over_pool(c, p, processes);
	if (isnan(r.value)) {
		OB_SAY(v->answer, "One of the two pools did not run. ");
		return;
	}
	OB_SAY(v->answer, "A pool of processes takes %.2f times the CPU of a pool of threads%s. ", r.value,
	       range(r).text);
	OB_SAY(v->answer, "Threads start in %s and need %s of memory, processes %s and %s. ",
	       value(c, p, threads, OB_COMPARE_STARTUP).text, value(c, p, threads, OB_COMPARE_MEMORY).text,
	       value(c, p, processes, OB_COMPARE_STARTUP).text, value(c, p, processes, OB_COMPARE_MEMORY).text);
}

static void compare_worker_counts(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p)
{
	static const struct {
		ob_configuration_id id;
		const char *what;
	} counts[] = { { OB_CONFIGURATION_GROUPS, "Process groups of 60, which confine a crash, cost" },
		       { OB_CONFIGURATION_THREADS_EACH, "A thread for each object costs" },
		       { OB_CONFIGURATION_PROCESSES_EACH, "A process for each object costs" } };
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
		const ob_estimate r = cost_over_pool(c, p, counts[i].id);
		if (!isnan(r.value))
			OB_SAY(v->answer, "%s %.2f times the thread pool%s. ", counts[i].what, r.value, range(r).text);
	}
}

static void compare_architectures(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p)
{
	const ob_configuration_id pool = OB_CONFIGURATION_THREADS, monolith = OB_CONFIGURATION_MONOLITH;
	ob_estimate r = ob_comparison_ratio(c, p, pool, monolith, OB_COMPARE_COST);
	if (isnan(r.value))
		return;
	OB_SAY(v->architecture,
	       "One world or many? Object simulators in the thread pool take %.2f times the CPU of the monolith%s; the "
	       "deepest penetration is %s, in the monolith %s.",
	       r.value, range(r).text, value(c, p, pool, OB_COMPARE_WORST).text,
	       value(c, p, monolith, OB_COMPARE_WORST).text);
}

static void compare_narrow_phases(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p,
				  ob_configuration_id aabb, ob_configuration_id obb, const char *who)
{
	ob_estimate r = ob_comparison_ratio(c, p, aabb, obb, OB_COMPARE_COST);
	if (isnan(r.value))
		return;
	OB_SAY(v->narrow,
	       "In the %s boxes along the axes take %.2f times the CPU of true shapes%s; they leave contacts %s apart "
	       "(%s), penetrate by %s at most (%s). ",
	       who, r.value, range(r).text, value(c, p, aabb, OB_COMPARE_SEPARATION).text,
	       value(c, p, obb, OB_COMPARE_SEPARATION).text, value(c, p, aabb, OB_COMPARE_WORST).text,
	       value(c, p, obb, OB_COMPARE_WORST).text);
}

static void explain_time(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p)
{
	double least = INFINITY;
	const char *where = "";
	for (int w = 0; w < OB_CONFIGURATIONS; w++) {
		ob_estimate r = ob_comparison_spread(c, p, w, OB_COMPARE_EXPLAINED);
		double share = fmin(r.value, r.low); // low is NaN for a single run
		if (share < least) {
			least = share;
			where = ob_configuration_table[w].title;
		}
	}
	if (isfinite(least))
		OB_SAY(v->sum,
		       "Work, waiting for a core, at the gate and for the host account for at least %.1f %% of the "
		       "workers' time (%s).",
		       100 * least, where);
}

void ob_verdict_make(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p)
{
	static const struct {
		ob_configuration_id own, other;
		const char *who;
	} pairs[] = { { OB_CONFIGURATION_THREADS, OB_CONFIGURATION_THREADS_OTHER, "thread pool" },
		      { OB_CONFIGURATION_MONOLITH, OB_CONFIGURATION_MONOLITH_OTHER, "monolith" } };
	bool obb_first = strcmp(c->narrow, "obb") == 0;
	memset(v, 0, sizeof *v);
	write_headline(v, c, p);
	compare_pools(v, c, p);
	compare_worker_counts(v, c, p);
	compare_architectures(v, c, p);
	for (int i = 0; i < 2; i++)
		compare_narrow_phases(v, c, p, obb_first ? pairs[i].other : pairs[i].own,
				      obb_first ? pairs[i].own : pairs[i].other, pairs[i].who);
	explain_time(v, c, p);
}

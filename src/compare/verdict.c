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
static void write_headline(char *to, size_t room, const ob_comparison *c, const ob_sweep_point *p)
{
	ob_estimate r = cost_over_pool(c, p, OB_CONFIGURATION_PROCESSES);
	ob_estimate each = cost_over_pool(c, p, OB_CONFIGURATION_THREADS_EACH);
	if (isnan(r.value))
		return;
	if (r.n < runs_least) {
		ob_say(to, room, "Undecided after so few runs: use --repeats 6.");
		return;
	}
	if (r.low > 1 + alike)
		ob_say(to, room, "Threads");
	else if (r.high < 1 - alike)
		ob_say(to, room, "Processes");
	else
		ob_say(to, room, "Either: they cost the same");
	if (each.low > 1 + alike)
		ob_say(to, room, "; but let objects share them: one for each object costs %.1f times as much.",
		       each.value);
	else
		ob_say(to, room, ".");
}

static void compare_pools(char *to, size_t room, const ob_comparison *c, const ob_sweep_point *p)
{
	const ob_configuration_id threads = OB_CONFIGURATION_THREADS, processes = OB_CONFIGURATION_PROCESSES;
	ob_estimate r = cost_over_pool(c, p, processes);
	if (isnan(r.value)) {
		ob_say(to, room, "One of the two pools did not run. ");
		return;
	}
	ob_say(to, room, "A pool of processes takes %.2f times the CPU of a pool of threads%s. ", r.value,
	       range(r).text);
	ob_say(to, room, "Threads start in %s and need %s of memory, processes %s and %s. ",
	       value(c, p, threads, OB_COMPARE_STARTUP).text, value(c, p, threads, OB_COMPARE_MEMORY).text,
	       value(c, p, processes, OB_COMPARE_STARTUP).text, value(c, p, processes, OB_COMPARE_MEMORY).text);
}

static void compare_worker_counts(char *to, size_t room, const ob_comparison *c, const ob_sweep_point *p)
{
	ob_estimate groups = cost_over_pool(c, p, OB_CONFIGURATION_GROUPS);
	ob_estimate threads = cost_over_pool(c, p, OB_CONFIGURATION_THREADS_EACH);
	ob_estimate processes = cost_over_pool(c, p, OB_CONFIGURATION_PROCESSES_EACH);
	if (!isnan(groups.value))
		ob_say(to, room, "Process groups of %d, which confine a crash, cost %.2f times the thread pool%s. ",
		       OB_COMPARE_GROUP, groups.value, range(groups).text);
	if (!isnan(threads.value))
		ob_say(to, room, "A thread for each object costs %.2f times the thread pool%s. ", threads.value,
		       range(threads).text);
	if (!isnan(processes.value))
		ob_say(to, room, "A process for each object costs %.2f times the thread pool%s. ", processes.value,
		       range(processes).text);
}

static void compare_architectures(char *to, size_t room, const ob_comparison *c, const ob_sweep_point *p)
{
	const ob_configuration_id pool = OB_CONFIGURATION_THREADS, monolith = OB_CONFIGURATION_MONOLITH;
	ob_estimate r = ob_comparison_ratio(c, p, pool, monolith, OB_COMPARE_COST);
	if (isnan(r.value))
		return;
	ob_say(to, room,
	       "One world or many? Object simulators in the thread pool take %.2f times the CPU of the monolith%s; the "
	       "deepest "
	       "penetration is %s, in the monolith %s.",
	       r.value, range(r).text, value(c, p, pool, OB_COMPARE_WORST).text,
	       value(c, p, monolith, OB_COMPARE_WORST).text);
}

static void compare_narrow_phases(char *to, size_t room, const ob_comparison *c, const ob_sweep_point *p,
				  ob_configuration_id aabb, ob_configuration_id obb, const char *who)
{
	ob_estimate r = ob_comparison_ratio(c, p, aabb, obb, OB_COMPARE_COST);
	if (isnan(r.value))
		return;
	ob_say(to, room,
	       "In the %s boxes along the axes take %.2f times the CPU of true shapes%s; they leave contacts %s apart "
	       "(%s), "
	       "penetrate by %s at most (%s). ",
	       who, r.value, range(r).text, value(c, p, aabb, OB_COMPARE_SEPARATION).text,
	       value(c, p, obb, OB_COMPARE_SEPARATION).text, value(c, p, aabb, OB_COMPARE_WORST).text,
	       value(c, p, obb, OB_COMPARE_WORST).text);
}

static void explain_time(char *to, size_t room, const ob_comparison *c, const ob_sweep_point *p)
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
		ob_say(to, room,
		       "Work, waiting for a core, at the gate and for the host account for at least %.1f %% of the "
		       "workers' "
		       "time (%s).",
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
	write_headline(v->headline, sizeof v->headline, c, p);
	compare_pools(v->answer, sizeof v->answer, c, p);
	compare_worker_counts(v->answer, sizeof v->answer, c, p);
	compare_architectures(v->architecture, sizeof v->architecture, c, p);
	for (int i = 0; i < 2; i++)
		compare_narrow_phases(v->narrow, sizeof v->narrow, c, p, obb_first ? pairs[i].other : pairs[i].own,
				      obb_first ? pairs[i].own : pairs[i].other, pairs[i].who);
	explain_time(v->sum, sizeof v->sum, c, p);
}

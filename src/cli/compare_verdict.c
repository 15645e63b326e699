// What a comparison says, by rules: nothing here is known before the runs are.
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "cli/compare.h"
#include "cli/quantity.h"

enum { runs_least = 3 }; // fewer say nothing
static const double alike = .05; // ratios that reach to within this of 1 count as no difference

__attribute__((format(printf, 3, 4))) static void say(char *to, size_t room, const char *format, ...)
{
	size_t used = strlen(to);
	va_list list;
	va_start(list, format);
	vsnprintf(to + used, room - used, format, list);
	va_end(list);
}

static ob_spread cost_over_pool(const ob_section *s, ob_way_id way)
{
	return ob_ratio_of(&s->cell[way], &s->cell[OB_WAY_THREADS], OB_FIGURE_COST);
}

static double median(const ob_section *s, ob_way_id way, ob_figure f)
{
	return ob_spread_of(&s->cell[way], f).median;
}

// Which of the two pools is cheaper, if any; and whether the objects should share workers at all.
static void head(char *to, size_t room, const ob_section *s)
{
	ob_spread r = cost_over_pool(s, OB_WAY_PROCESSES), each = cost_over_pool(s, OB_WAY_THREADS_EACH);
	if (isnan(r.median))
		return;
	if (r.n < runs_least) {
		say(to, room, "That cannot be told from so few runs: take --repeats 6.");
		return;
	}
	if (r.low > 1 + alike)
		say(to, room, "Threads");
	else if (r.high < 1 - alike)
		say(to, room, "Processes");
	else
		say(to, room, "Either, for they cost the same");
	if (each.low > 1 + alike)
		say(to, room, "; but let objects share them: one for each object costs %.1f times as much.",
		    each.median);
	else
		say(to, room, ".");
}

static void answer_pools(char *to, size_t room, const ob_section *s)
{
	ob_spread r = cost_over_pool(s, OB_WAY_PROCESSES);
	ob_quantity a, b, m, n;
	if (isnan(r.median)) {
		say(to, room, "One of the two pools did not run. ");
		return;
	}
	say(to, room,
	    "A pool of processes takes %.2f times the CPU of a pool of threads (%.2f to %.2f over the repeats). ",
	    r.median, r.low, r.high);
	say(to, room, "Threads start in %s and need %s of memory, processes %s and %s. ",
	    ob_quantity_text(&a, median(s, OB_WAY_THREADS, OB_FIGURE_STARTUP), "s"),
	    ob_quantity_text(&m, median(s, OB_WAY_THREADS, OB_FIGURE_MEMORY), "B"),
	    ob_quantity_text(&b, median(s, OB_WAY_PROCESSES, OB_FIGURE_STARTUP), "s"),
	    ob_quantity_text(&n, median(s, OB_WAY_PROCESSES, OB_FIGURE_MEMORY), "B"));
}

static void answer_crowds(char *to, size_t room, const ob_section *s)
{
	ob_spread groups = cost_over_pool(s, OB_WAY_GROUPS);
	ob_spread threads = cost_over_pool(s, OB_WAY_THREADS_EACH), each = cost_over_pool(s, OB_WAY_PROCESSES_EACH);
	if (!isnan(groups.median))
		say(to, room,
		    "Where a crash must not take all along: process groups of %d cost %.2f times the thread pool (%.2f "
		    "to "
		    "%.2f). ",
		    OB_GROUP, groups.median, groups.low, groups.high);
	if (!isnan(threads.median))
		say(to, room, "A thread for each object costs %.2f times the thread pool. ", threads.median);
	if (!isnan(each.median))
		say(to, room, "A process for each object costs %.2f times the thread pool. ", each.median);
}

static void compare_architectures(char *to, size_t room, const ob_section *s)
{
	ob_spread r = ob_ratio_of(&s->cell[OB_WAY_THREADS], &s->cell[OB_WAY_MONOLITH], OB_FIGURE_COST);
	ob_quantity a, b;
	if (isnan(r.median))
		return;
	say(to, room,
	    "One world or many? Object simulators in the thread pool take %.2f times the CPU of the monolith (%.2f to "
	    "%.2f); the deepest penetration is %s, in the monolith %s.",
	    r.median, r.low, r.high, ob_quantity_text(&a, median(s, OB_WAY_THREADS, OB_FIGURE_WORST), "m"),
	    ob_quantity_text(&b, median(s, OB_WAY_MONOLITH, OB_FIGURE_WORST), "m"));
}

static void compare_narrow(char *to, size_t room, const ob_section *s, ob_way_id aabb, ob_way_id obb, const char *who)
{
	ob_spread r = ob_ratio_of(&s->cell[aabb], &s->cell[obb], OB_FIGURE_COST);
	ob_quantity q[4];
	if (isnan(r.median))
		return;
	say(to, room,
	    "In the %s boxes along the axes take %.2f times the CPU of true shapes (%.2f to %.2f); they leave contacts "
	    "%s apart (%s), penetrate by %s at most (%s). ",
	    who, r.median, r.low, r.high, ob_quantity_text(&q[0], median(s, aabb, OB_FIGURE_SEPARATION), "m"),
	    ob_quantity_text(&q[1], median(s, obb, OB_FIGURE_SEPARATION), "m"),
	    ob_quantity_text(&q[2], median(s, aabb, OB_FIGURE_WORST), "m"),
	    ob_quantity_text(&q[3], median(s, obb, OB_FIGURE_WORST), "m"));
}

static void explain_time(char *to, size_t room, const ob_section *s)
{
	double least = INFINITY;
	const char *where = "";
	for (int w = 0; w < OB_WAYS; w++) {
		double share = ob_spread_of(&s->cell[w], OB_FIGURE_EXPLAINED).low;
		if (share < least) {
			least = share;
			where = ob_way_table[w].title;
		}
	}
	if (isfinite(least))
		say(to, room,
		    "Where the time goes: work, waiting for a core, at the gate and for the host are %.1f %% of the "
		    "workers' time at least (%s).",
		    100 * least, where);
}

void ob_verdict_make(ob_verdict *v, const ob_comparison *c, const ob_section *s)
{
	bool obb_first = strcmp(c->narrow, "obb") == 0;
	memset(v, 0, sizeof *v);
	head(v->headline, sizeof v->headline, s);
	answer_pools(v->answer, sizeof v->answer, s);
	answer_crowds(v->answer, sizeof v->answer, s);
	compare_architectures(v->architecture, sizeof v->architecture, s);
	static const struct {
		ob_way_id own, other;
		const char *who;
	} pairs[] = { { OB_WAY_THREADS, OB_WAY_THREADS_OTHER, "thread pool" },
		      { OB_WAY_MONOLITH, OB_WAY_MONOLITH_OTHER, "monolith" } };
	for (int i = 0; i < 2; i++)
		compare_narrow(v->narrow, sizeof v->narrow, s, obb_first ? pairs[i].other : pairs[i].own,
			       obb_first ? pairs[i].own : pairs[i].other, pairs[i].who);
	explain_time(v->sum, sizeof v->sum, s);
}

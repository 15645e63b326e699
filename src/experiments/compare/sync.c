// Runs of a comparison of lockstep with free simulators, and what follows from them.
#include "compare/sync.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "experiment/analysis.h"
#include "experiment/json.h"
#include "experiment/process.h"
#include "experiment/table.h"

#define RATE(HZ) \
	{ \
		"own_" #HZ "_hz", "own, " #HZ " Hz", OB_SYNC_OWN, false, false, 0, HZ, false \
	}
#define LAG(MS) \
	{ \
		"own_lag_" #MS "ms", "own, lag " #MS " ms", OB_SYNC_OWN, false, false, 1e-3 * MS, 0, false \
	}
const ob_sync_configuration ob_sync_table[OB_SYNC_CONFIGURATIONS] = {
	{ "lockstep_threads", "lockstep, 2 threads", OB_SYNC_LOCKSTEP, false, false, 0, 0, true },
	{ "lockstep_processes", "lockstep, 2 processes", OB_SYNC_LOCKSTEP, true, false, 0, 0, true },
	{ "lockstep_threads_each", "lockstep, thread each", OB_SYNC_LOCKSTEP, false, true, 0, 0, false },
	{ "lockstep_processes_each", "lockstep, process each", OB_SYNC_LOCKSTEP, true, true, 0, 0, false },
	{ "group_threads", "group, 2 threads", OB_SYNC_GROUP, false, false, 0, 0, true },
	{ "group_processes", "group, 2 processes", OB_SYNC_GROUP, true, false, 0, 0, false },
	{ "group_threads_each", "group, thread each", OB_SYNC_GROUP, false, true, 0, 0, false },
	{ "group_processes_each", "group, process each", OB_SYNC_GROUP, true, true, 0, 0, false },
	{ "own_threads", "own, 2 threads", OB_SYNC_OWN, false, false, 0, 0, false },
	{ "own_processes", "own, 2 processes", OB_SYNC_OWN, true, false, 0, 0, false },
	{ "own_processes_each", "own, process each", OB_SYNC_OWN, true, true, 0, 0, true },
	{ "heavy_threads", "own, heavy, 2 threads", OB_SYNC_HEAVY, false, false, 0, 0, false },
	{ "ode_threads", "own, ODE, 2 threads", OB_SYNC_ODE, false, false, 0, 0, false },
	RATE(125),
	RATE(250),
	RATE(500),
	RATE(2000),
	LAG(1),
	LAG(3),
	LAG(10),
	LAG(30),
	LAG(100),
};

#define METRIC(id, key, title, unit, scale, meaning, ...) \
	[OB_SYNC_##id] = { key, title, unit, scale, NAN, NULL, meaning, 0, { __VA_ARGS__ } }
const ob_metric ob_sync_metrics[OB_SYNC_METRICS] = {
	METRIC(CPU, "cpu_s_per_body_and_simulated_s", "CPU, body and s", "ms", 1e3,
	       "CPU time of all workers over moving bodies and simulated seconds", NULL),
	METRIC(WALL, "wall_s_per_simulated_s", "wall, s", "s", 1,
	       "wall-clock time of a simulated second, with the measurement of each step", "wall_s", "simulated_s"),
	METRIC(UPDATES, "updates_per_s", "updates/s", "k", 1e-3,
	       "steps of all simulators in a second of wall-clock time", NULL),
	METRIC(LATENCY, "latency_mean_s", "latency", "ms", 1e3,
	       "from cause to effect: a simulator's own time less the time of the neighbour's version that it reads, "
	       "mean; in lockstep and in groups bodies in contact are solved together, so there is none",
	       "lag_mean_s"),
	METRIC(LATENCY_MOST, "latency_max_s", "latency, most", "ms", 1e3, "the largest of them", "lag_max_s"),
	METRIC(WORST, "worst_penetration_m", "worst penetration", "mm", 1e3, "of any pair at any boundary of 1/60 s",
	       "worst_penetration_m"),
	METRIC(SIZES, "worst_penetration_sizes", "over size", "1", 1,
	       "that over the median thickness of the bodies that move", NULL),
	METRIC(ENERGY, "energy_gain_max", "energy gained", "1", 1,
	       "largest energy above that of the start, over it, 0 below 1e-12; work of prescribed motion is not "
	       "counted",
	       NULL),
	METRIC(MOMENTUM, "momentum_error", "momentum", "1", 1,
	       "largest change of momentum that nothing explains, over its size; only in scenes without fixed bodies",
	       "momentum_error"),
	METRIC(LAG, "lag_speed_over_size", "lag x speed / size", "1", 1,
	       "mean latency times the speed that is worth the energy which lockstep's hits lose, over the size", NULL),
	METRIC(LOST, "energy_lost_j", "energy lost", "J", 1, "at the start less at the end", NULL),
};

typedef struct job {
	const ob_sync_comparison *comparison;
	const ob_sync_point *point;
	const ob_sync_configuration *of;
} job;

// ---- one run

static double rate_of(const ob_sync_comparison *c, const ob_sync_configuration *of)
{
	return of->rate > 0 ? of->rate : c->rate;
}

static char **arguments(const job *j, uint64_t seed)
{
	enum { OWN = 24 };
	static const char *const coupling[] = { "", "group", "own", "own", "own" };
	const ob_sync_comparison *c = j->comparison;
	const ob_sync_configuration *of = j->of;
	char **argv = calloc(OWN + OB_SYNC_DEFINES, sizeof *argv);
	size_t n = 0;
	bool fine = argv != NULL;
#define ADD(...) (fine = fine && asprintf(&argv[n++], __VA_ARGS__) >= 0)
	ADD("obsim");
	ADD("run");
	ADD("--json=-");
	ADD("--set=measure=step");
	ADD("--seed=%" PRIu64, seed);
	ADD("--duration=%.17g", c->duration);
	ADD("--isolation=%s", of->processes ? "process" : "thread");
	ADD("--workers=%s", of->each ? "objects" : "2");
	ADD("--sync=%s", of->coupling == OB_SYNC_LOCKSTEP ? "lockstep" : "free");
	if (of->coupling != OB_SYNC_LOCKSTEP)
		ADD("--set=coupling=%s", coupling[of->coupling]);
	if (of->coupling >= OB_SYNC_OWN) {
		ADD("--set=update_rate=%.17g", rate_of(c, of));
		ADD("--set=jitter=%.17g", c->jitter);
		ADD("--set=delay=%.17g", of->delay);
		ADD("--set=solver=%s", of->coupling == OB_SYNC_HEAVY ? "ghost" : "coloured");
		ADD("--set=integrator=%s", of->coupling == OB_SYNC_ODE ? "ode" : "exact");
	}
	for (uint32_t i = 0; i < c->defines; i++)
		ADD("-D%s", c->define[i]);
	if (*j->point->define)
		ADD("-D%s", j->point->define);
	ADD("--");
	ADD("%s", c->scene);
#undef ADD
	return fine ? argv : NULL;
}

static void read_report(const job *j, const char *r, double *m)
{
	const bool free = j->of->coupling != OB_SYNC_LOCKSTEP;
	static const double rounding = 1e-12;
	const double energy = ob_json_read_number(r, "energy_start"), gain = ob_json_read_number(r, "energy_gain_max");
	const double steps = ob_json_read_number(r, "steps") * j->point->objects;
	m[OB_SYNC_CPU] = ob_json_read_number(r, "cpu_s") / ob_json_read_number(r, "simulated_s") / j->point->objects;
	m[OB_SYNC_UPDATES] = (free ? ob_json_read_number(r, "updates") : steps) / ob_json_read_number(r, "wall_s");
	m[OB_SYNC_SIZES] = m[OB_SYNC_WORST] / j->point->size;
	m[OB_SYNC_ENERGY] = gain < rounding ? 0 : gain;
	m[OB_SYNC_LOST] = energy - ob_json_read_number(r, "energy_end");
}

static bool run_trial(const ob_trial *t, ob_record *out, ob_error *e);
static const ob_experiment experiment = {
	.name = "compare-sync", .metrics = OB_SYNC_METRICS, .metric = ob_sync_metrics, .run = run_trial
};

static bool run_trial(const ob_trial *t, ob_record *out, ob_error *e)
{
	const job *j = t->what;
	char *report = ob_program_report(arguments(j, t->seed), e);
	if (!report)
		return false;
	ob_record_read(out, &experiment, 0, report);
	read_report(j, report, out->metric);
	free(report);
	return true;
}

// ---- schedule

const ob_sync_point *ob_sync_main_point(const ob_sync_comparison *c)
{
	static const double usual = 100; // objects
	const ob_sync_point *best = c->point;
	for (const ob_sync_point *p = c->point; p < c->point + c->points; p++)
		if (fabs(log(p->objects / usual)) < fabs(log(best->objects / usual)))
			best = p;
	return best;
}

static bool schedule(const ob_sync_comparison *c, const ob_sync_point *p, uint32_t seeds, job *all, ob_trials *s)
{
	enum { LOCKSTEP_STEPS = 60 };
	static const double step_s = 1e-5;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		const ob_sync_configuration *of = &ob_sync_table[w];
		if (!of->swept && p != ob_sync_main_point(c))
			continue;
		all[w] = (job){ c, p, of };
		const double rate = of->coupling < OB_SYNC_OWN ? LOCKSTEP_STEPS : rate_of(c, of);
		ob_trial t = { .seed = p->seed,
			       .guess_s = .1 + step_s * rate * c->duration * p->objects,
			       .what = &all[w] };
		snprintf(t.of, sizeof t.of, "%s", p->key);
		snprintf(t.configuration, sizeof t.configuration, "%s", of->key);
		if (!ob_trials_add(s, &t))
			return false;
	}
	return ob_trials_repeat(s, 0, seeds, OB_ORDER_TO_AND_FRO, true);
}

// Finds the speed of each point, and with it lag x speed / size of each record.
static void scale_lags(ob_sync_comparison *c)
{
	for (uint32_t i = 0; i < c->points; i++) {
		ob_sync_point *p = &c->point[i];
		const double lost = ob_sync_estimate(c, p, 0, OB_SYNC_LOST).value;
		p->speed = lost > 0 ? sqrt(2 * lost / p->mass) : NAN;
		for (size_t k = 0; k < c->records.count; k++) {
			ob_record *r = &c->records.record[k];
			if (strcmp(r->of, p->key) == 0)
				r->metric[OB_SYNC_LAG] = r->metric[OB_SYNC_LATENCY] * p->speed / p->size;
		}
	}
}

// CPU of a run, s, at most: a heap that explodes takes long.
static double limit_of(const ob_sync_comparison *c, const ob_sync_point *p)
{
	return 5 + .15 * p->objects * c->duration;
}

// Runs the configurations of a point with so many seeds, as far as they have not been run. fresh: again.
static bool run_point(ob_sync_comparison *c, const ob_sync_point *p, uint32_t seeds, ob_experiment x,
		      const char *folder, bool fresh, ob_error *e)
{
	job all[OB_SYNC_CONFIGURATIONS];
	ob_trials s = { 0 };
	bool fine = schedule(c, p, seeds, all, &s) || ob_fail(e, "out of memory");
	if (fine && fresh)
		ob_records_drop(&c->records, &s);
	x.limit_s = limit_of(c, p);
	fine = fine && ob_experiment_run(&x, &s, &c->records, folder, e);
	ob_trials_finish(&s);
	return fine;
}

// Runs the main point with as many seeds as an interval takes, each other point with one, then each with one more as long
// as the budget lasts for it.
static bool run_points(ob_sync_comparison *c, const ob_experiment *x, const char *folder, bool fresh, ob_error *e)
{
	enum { INTERVAL = 3 };
	const double begun = ob_clock_wall();
	const uint32_t main_point = (uint32_t)(ob_sync_main_point(c) - c->point);
	double longest[OB_SYNC_POINTS] = { 0 }; // s, of a seed
	for (uint32_t seeds = 1; seeds <= c->seeds; seeds++)
		for (uint32_t k = 0; k < c->points; k++) {
			const uint32_t i = k == 0 ? main_point : k <= main_point ? k - 1 : k; // the main point first
			ob_sync_point *p = &c->point[i];
			const double since = ob_clock_wall();
			const uint32_t least = i != main_point       ? 1
					       : c->seeds < INTERVAL ? c->seeds
								     : INTERVAL,
				       more = isinf(c->budget) ? c->seeds
					      : seeds > least  ? seeds
							       : least;
			if (p->seeds >= more || (p->seeds >= least && since - begun + longest[i] > c->budget))
				continue;
			if (!run_point(c, p, more, *x, folder, fresh && p->seeds == 0, e))
				return false;
			longest[i] = fmax(longest[i], (ob_clock_wall() - since) / (more - p->seeds));
			p->seeds = more;
		}
	return true;
}

bool ob_sync_run(ob_sync_comparison *c, const char *commit, const char *folder, bool fresh, ob_error *e)
{
	ob_experiment x = experiment;
	x.commit = commit;
	if (!ob_experiment_open(&x, folder, &c->records, e) || !run_points(c, &x, folder, fresh, e))
		return false;
	scale_lags(c);
	return true;
}

void ob_sync_finish(ob_sync_comparison *c)
{
	ob_records_finish(&c->records);
}

// ---- results

static bool is_positive(ob_sync_metric m)
{
	return m != OB_SYNC_ENERGY && m != OB_SYNC_MOMENTUM && m != OB_SYNC_LOST;
}

ob_estimate ob_sync_estimate(const ob_sync_comparison *c, const ob_sync_point *p, int configuration, ob_sync_metric m)
{
	return ob_records_estimate(&c->records, p->key, ob_sync_table[configuration].key, m, is_positive(m));
}

static double value(const ob_sync_comparison *c, const ob_sync_point *p, int w, ob_sync_metric m)
{
	return ob_sync_estimate(c, p, w, m).value;
}

// True for configurations that differ in the injected lag alone.
static bool is_of_lags(int w, ob_sync_coupling coupling)
{
	const ob_sync_configuration *of = &ob_sync_table[w];
	return of->coupling == coupling && !of->processes && !of->each && of->rate == 0;
}

bool ob_sync_is_of_rates(int w)
{
	const ob_sync_configuration *of = &ob_sync_table[w];
	return of->coupling == OB_SYNC_OWN && !of->processes && !of->each && of->delay == 0;
}

ob_line ob_sync_order(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_coupling coupling)
{
	double x[OB_SYNC_CONFIGURATIONS], y[OB_SYNC_CONFIGURATIONS];
	size_t n = 0;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		const double lag = value(c, p, w, OB_SYNC_LAG), error = value(c, p, w, OB_SYNC_SIZES);
		if (is_of_lags(w, coupling) && ob_sync_table[w].delay > 0 && lag > 0 && error > 0)
			x[n] = log(lag), y[n++] = log(error);
	}
	return ob_statistics_line(n, x, y);
}

ob_line ob_sync_order_of_step(const ob_sync_comparison *c, const ob_sync_point *p)
{
	double x[OB_SYNC_CONFIGURATIONS], y[OB_SYNC_CONFIGURATIONS];
	size_t n = 0;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		const double error = value(c, p, w, OB_SYNC_SIZES);
		if (ob_sync_is_of_rates(w) && error > 0)
			x[n] = -log(rate_of(c, &ob_sync_table[w])), y[n++] = log(error);
	}
	return ob_statistics_line(n, x, y);
}

// Free configuration without an injected lag, of a coupling or of any (OB_SYNC_COUPLINGS), with the least penetration;
// -1: none was measured.
static int best_free(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_coupling coupling)
{
	int best = -1;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		const ob_sync_configuration *of = &ob_sync_table[w];
		const double error = value(c, p, w, OB_SYNC_WORST);
		if (of->coupling == OB_SYNC_LOCKSTEP || of->delay > 0 || of->rate > 0 || isnan(error) ||
		    (coupling != OB_SYNC_COUPLINGS && of->coupling != coupling))
			continue;
		if (best < 0 || error < value(c, p, best, OB_SYNC_WORST))
			best = w;
	}
	return best;
}

// ---- texts

// A number with two digits, or all before the point.
static void say_number(ob_sync_text *t, double x)
{
	OB_SAY(t->words, fabs(x) < 100 ? "%.2g" : "%.0f", x);
}

// A value in a unit for people, with its interval.
static void say_estimate(ob_sync_text *t, ob_estimate e, double scale)
{
	say_number(t, scale * e.value);
	if (isnan(e.low))
		return;
	OB_SAY(t->words, " (");
	say_number(t, scale * e.low);
	OB_SAY(t->words, " to ");
	say_number(t, scale * e.high);
	OB_SAY(t->words, ")");
}

// ---- hypotheses

typedef enum verdict { NOT_TESTED, UNDECIDED, CONTRADICTED, SUPPORTED } verdict;
static const char *const verdict_word[] = { "Not tested.", "Undecided.", "Contradicted.", "Not contradicted." };

static verdict worse(verdict a, verdict b)
{
	return a == CONTRADICTED || b == CONTRADICTED ? CONTRADICTED : a < b ? a : b;
}

// Order of the error in the lag between two configurations, from ratios seed by seed.
static ob_estimate order_between(const ob_sync_comparison *c, const ob_sync_point *p, int from, int to)
{
	const char *a = ob_sync_table[to].key, *b = ob_sync_table[from].key;
	const ob_estimate error = ob_records_estimate_ratio(&c->records, p->key, a, b, OB_SYNC_SIZES);
	const double decades = log(value(c, p, to, OB_SYNC_LAG) / value(c, p, from, OB_SYNC_LAG));
	return (ob_estimate){ error.n, log(error.value) / decades, log(error.low) / decades, log(error.high) / decades,
			      error.interval };
}

// Says the orders of the error of own responses over decades of the lag. Overlapping intervals contradict no fixed power.
static verdict judge_lags(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_text *t)
{
	static const double bounds[] = { 0, .001, .01, .1 }; // s, injected
	double least_high = INFINITY, most_low = -INFINITY;
	int last = -1;
	bool known = true;
	OB_SAY(t->words, " Powers");
	for (int w = 0, k = 0; w < OB_SYNC_CONFIGURATIONS && k < 4; w++) {
		if (!is_of_lags(w, OB_SYNC_OWN) || ob_sync_table[w].delay != bounds[k])
			continue;
		if (last >= 0) {
			const ob_estimate order = order_between(c, p, last, w);
			OB_SAY(t->words, "%s ", k > 1 ? "," : "");
			say_estimate(t, order, 1);
			OB_SAY(t->words, " from ");
			say_number(t, 1e3 * value(c, p, last, OB_SYNC_LATENCY));
			OB_SAY(t->words, " to ");
			say_number(t, 1e3 * value(c, p, w, OB_SYNC_LATENCY));
			OB_SAY(t->words, " ms");
			least_high = fmin(least_high, order.high), most_low = fmax(most_low, order.low);
			known &= !isnan(order.low);
		}
		last = w, k++;
	}
	if (!known || (most_low <= 0 && least_high >= 0 && most_low <= least_high)) {
		OB_SAY(t->words, known ? ": no power is excluded, 0 neither." : ".");
		return UNDECIDED;
	}
	if (most_low > least_high || least_high < 0) {
		OB_SAY(t->words, ": no fixed power.");
		return CONTRADICTED;
	}
	OB_SAY(t->words, ": any power from ");
	say_number(t, most_low);
	OB_SAY(t->words, " to ");
	say_number(t, least_high);
	OB_SAY(t->words, " describes it.");
	return SUPPORTED;
}

static verdict judge_power(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_text *t)
{
	const verdict v = judge_lags(c, p, t);
	const ob_line step = ob_sync_order_of_step(c, p);
	if (!isnan(step.slope_low))
		OB_SAY(t->words,
		       " Beside it, without an injected lag, the error grows with the length of a step to the "
		       "power of %.2f (%.2f to %.2f).",
		       step.slope, step.slope_low, step.slope_high);
	OB_SAY(t->words, " Scenes of other speeds and sizes would test whether the product alone counts.");
	return v;
}

// Whether a ratio is at most so large: undecided where its interval allows both.
static verdict is_at_most(ob_estimate ratio, double most)
{
	return isnan(ratio.low)     ? UNDECIDED
	       : ratio.high <= most ? SUPPORTED
	       : ratio.low > most   ? CONTRADICTED
				    : UNDECIDED;
}

// Says the ratio of a metric of each form of groups to that of a form of lockstep: the one with the same workers, or by two threads.
// Returns whether all are at most so large.
static verdict judge_groups(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_metric m, bool alike,
			    double most, ob_sync_text *t)
{
	verdict v = NOT_TESTED;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		const ob_sync_configuration *of = &ob_sync_table[w], *to = ob_sync_table;
		if (of->coupling != OB_SYNC_GROUP)
			continue;
		while (alike && (to->each != of->each || to->processes != of->processes))
			to++;
		const ob_estimate ratio = ob_records_estimate_ratio(&c->records, p->key, of->key, to->key, m);
		if (!ratio.n)
			continue;
		OB_SAY(t->words, "%s ", v == NOT_TESTED ? "" : ",");
		say_estimate(t, ratio, 1);
		OB_SAY(t->words, " (%s)", of->title);
		const verdict here = is_at_most(ratio, most);
		v = v == NOT_TESTED ? here : worse(v, here);
	}
	return v;
}

static verdict judge_error(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_text *t)
{
	static const double alike = 1.2;
	const int g = best_free(c, p, OB_SYNC_GROUP), o = best_free(c, p, OB_SYNC_OWN);
	const ob_estimate group = ob_sync_estimate(c, p, g, OB_SYNC_MOMENTUM),
			  own = ob_sync_estimate(c, p, o, OB_SYNC_MOMENTUM),
			  ratio = ob_records_estimate_ratio(&c->records, p->key, ob_sync_table[o].key,
							    ob_sync_table[0].key, OB_SYNC_WORST);
	OB_SAY(t->words, " Worst penetration over that of lockstep:");
	const verdict same = judge_groups(c, p, OB_SYNC_WORST, false, alike, t), other = is_at_most(ratio, alike);
	verdict v = worse(same, other == SUPPORTED ? CONTRADICTED : other == CONTRADICTED ? SUPPORTED : other);
	OB_SAY(t->words, "; ");
	say_estimate(t, ratio, 1);
	OB_SAY(t->words, " (%s). ", ob_sync_table[o].title);
	if (!group.n || !own.n) {
		OB_SAY(t->words, "Something is fixed in this scene, and takes up momentum.");
		return v;
	}
	OB_SAY(t->words, "Change of momentum: ");
	say_estimate(t, group, 1);
	OB_SAY(t->words, " in groups, ");
	say_estimate(t, own, 1);
	OB_SAY(t->words, " by own responses.");
	return worse(v, group.high < own.low ? SUPPORTED : group.low > own.high ? CONTRADICTED : UNDECIDED);
}

static verdict judge_cost(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_text *t)
{
	static const double most = 2;
	OB_SAY(t->words, " CPU over that of lockstep with the same workers:");
	const verdict v = judge_groups(c, p, OB_SYNC_CPU, true, most, t);
	OB_SAY(t->words, "; over that of lockstep with two threads:");
	judge_groups(c, p, OB_SYNC_CPU, false, most, t);
	OB_SAY(t->words, ".");
	return v;
}

ob_sync_text ob_sync_judge(const ob_sync_comparison *c, int hypothesis)
{
	static verdict (*const judge[OB_SYNC_HYPOTHESES])(const ob_sync_comparison *, const ob_sync_point *,
							  ob_sync_text *) = { judge_power, judge_error, judge_cost };
	const ob_sync_point *p = ob_sync_main_point(c);
	ob_sync_text t = { "" }, judged;
	verdict v = NOT_TESTED;
	if (best_free(c, p, OB_SYNC_GROUP) < 0 || best_free(c, p, OB_SYNC_OWN) < 0)
		OB_SAY(t.words, " Too little was measured.");
	else
		v = judge[hypothesis](c, p, &t);
	snprintf(judged.words, sizeof judged.words, "%s%.2000s", verdict_word[v], t.words);
	return judged;
}

// ---- recommendation

// Largest lag, s, up to which the interval of a coupling's worst penetration stays below a share of the size; -1: not even
// without; 0: none was seen, as nothing touched.
static double tolerable_lag(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_coupling coupling,
			    double share)
{
	double most = -1;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		const ob_estimate error = ob_sync_estimate(c, p, w, OB_SYNC_SIZES);
		if (!is_of_lags(w, coupling))
			continue;
		if (!((isnan(error.high) ? error.value : error.high) <= share))
			break; // rows of a coupling stand in the order of lags
		most = fmax(most, fmax(value(c, p, w, OB_SYNC_LATENCY), 0));
	}
	return most;
}

// Least injected lag, s, with which a coupling gains energy, by the whole interval or possibly; NaN: none does.
static double gains_from(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_coupling coupling, bool possibly)
{
	static const double noticeable = 1e-6;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		const ob_estimate gain = ob_sync_estimate(c, p, w, OB_SYNC_ENERGY);
		const double edge = possibly ? gain.high : gain.low;
		if (is_of_lags(w, coupling) && ob_sync_table[w].delay > 0 &&
		    (isnan(edge) ? gain.value : edge) > noticeable)
			return ob_sync_table[w].delay;
	}
	return NAN;
}

// Says which configurations without an injected lag gained energy in some run.
static void say_gains(ob_sync_text *t, const ob_sync_comparison *c, const ob_sync_point *p)
{
	bool any = false;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		const ob_estimate gain = ob_sync_estimate(c, p, w, OB_SYNC_ENERGY);
		if (ob_sync_table[w].delay > 0 || !(gain.value > 0))
			continue;
		OB_SAY(t->words, "%s %s by ",
		       any ? "," : " Without an injected lag some runs gained energy, in the mean:",
		       ob_sync_table[w].title);
		say_estimate(t, gain, 1);
		any = true;
	}
	OB_SAY(t->words, "%s", any ? " of that at the start." : " Without an injected lag no run gained energy.");
}

// The advice that ratios of free running to lockstep allow.
static const char *advice(ob_estimate error, ob_estimate cost)
{
	if (isnan(error.low) || isnan(cost.low))
		return "Fewer than three seeds decide nothing.";
	if (cost.low <= 1 && cost.high >= 1)
		return error.low > 1 ? "Which of the two is cheaper is undecided; lockstep is more accurate."
				     : "Which of the two is cheaper is undecided.";
	if (error.low > 1)
		return cost.low > 1 ? "So run in lockstep, unless simulators must not wait for each other."
				    : "So choose by need: free running is cheaper, lockstep more accurate.";
	if (cost.high < 1)
		return "It was not shown to be less accurate, so free running costs nothing here: take it where "
		       "simulators must not wait.";
	return "It was not shown to be less accurate: take it where simulators must not wait, and pay the CPU.";
}

ob_sync_text ob_sync_recommend(const ob_sync_comparison *c, const ob_sync_point *p)
{
	static const double share = .1; // of the size: penetration that counts as large
	const int free = best_free(c, p, OB_SYNC_COUPLINGS);
	ob_sync_text t = { "" };
	if (free < 0 || isnan(value(c, p, 0, OB_SYNC_WORST))) {
		OB_SAY(t.words, "Too little was measured to recommend anything.");
		return t;
	}
	const ob_sync_configuration *of = &ob_sync_table[free];
	const char *lockstep = ob_sync_table[0].key;
	const ob_estimate error = ob_records_estimate_ratio(&c->records, p->key, of->key, lockstep, OB_SYNC_WORST),
			  cost = ob_records_estimate_ratio(&c->records, p->key, of->key, lockstep, OB_SYNC_CPU);
	OB_SAY(t.words, "Lockstep kept bodies within ");
	say_estimate(&t, ob_sync_estimate(c, p, 0, OB_SYNC_WORST), 1e3);
	OB_SAY(t.words, " mm of each other's surfaces. The most accurate free form (%s) let them sink in by ",
	       of->title);
	say_estimate(&t, ob_sync_estimate(c, p, free, OB_SYNC_WORST), 1e3);
	OB_SAY(t.words, " mm, ");
	say_estimate(&t, error, 1);
	OB_SAY(t.words, " times as far, and took ");
	say_estimate(&t, cost, 1);
	OB_SAY(t.words, " times the CPU. %s", advice(error, cost));
	if (p != ob_sync_main_point(c))
		return t;
	say_gains(&t, c, p);
	const double lag = tolerable_lag(c, p, OB_SYNC_OWN, share), gains = gains_from(c, p, OB_SYNC_OWN, false),
		     may_gain = gains_from(c, p, OB_SYNC_OWN, true);
	if (lag > 0)
		OB_SAY(t.words,
		       " Own responses, to what is seen late, stay within %.0f %% of the bodies' size up to a latency "
		       "of %.3g ms, which is a lag of %.2g sizes at these speeds.",
		       100 * share, 1e3 * lag, lag * p->speed / p->size);
	else if (lag < 0)
		OB_SAY(t.words,
		       " Even without an injected lag own responses may sink in by more than %.0f %% of their size.",
		       100 * share);
	if (isnan(may_gain))
		OB_SAY(t.words, " No injected lag made them gain energy.");
	else if (isnan(gains))
		OB_SAY(t.words, " From an injected lag of %.3g ms on they may gain energy: that is undecided.",
		       1e3 * may_gain);
	else
		OB_SAY(t.words, " They gain energy from an injected lag of %.3g ms on: bound the lag below %s.",
		       1e3 * gains,
		       may_gain < gains ? "that, and better below the lags where that is undecided" : "that");
	return t;
}

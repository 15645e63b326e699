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

#define RATE(HZ) \
	{ \
		"ledger_" #HZ "_hz", "ledger, " #HZ " Hz", OB_SYNC_LEDGER, false, false, 0, HZ \
	}
#define LAGS(COUPLING, KEY, TITLE) \
	{ KEY "_lag_1ms", TITLE ", lag 1 ms", COUPLING, false, false, .001, 0 }, \
		{ KEY "_lag_3ms", TITLE ", lag 3 ms", COUPLING, false, false, .003, 0 }, \
		{ KEY "_lag_10ms", TITLE ", lag 10 ms", COUPLING, false, false, .01, 0 }, \
		{ KEY "_lag_30ms", TITLE ", lag 30 ms", COUPLING, false, false, .03, 0 }, \
	{ \
		KEY "_lag_100ms", TITLE ", lag 100 ms", COUPLING, false, false, .1, 0 \
	}
const ob_sync_configuration ob_sync_table[OB_SYNC_CONFIGURATIONS] = {
	{ "lockstep_threads", "lockstep, 2 threads", OB_SYNC_LOCKSTEP, false, false, 0, 0 },
	{ "lockstep_processes", "lockstep, 2 processes", OB_SYNC_LOCKSTEP, true, false, 0, 0 },
	{ "lockstep_threads_each", "lockstep, thread each", OB_SYNC_LOCKSTEP, false, true, 0, 0 },
	{ "ledger_threads", "ledger, 2 threads", OB_SYNC_LEDGER, false, false, 0, 0 },
	{ "ledger_processes", "ledger, 2 processes", OB_SYNC_LEDGER, true, false, 0, 0 },
	{ "ledger_threads_each", "ledger, thread each", OB_SYNC_LEDGER, false, true, 0, 0 },
	{ "ledger_processes_each", "ledger, process each", OB_SYNC_LEDGER, true, true, 0, 0 },
	{ "own_threads", "own, 2 threads", OB_SYNC_OWN, false, false, 0, 0 },
	{ "own_processes", "own, 2 processes", OB_SYNC_OWN, true, false, 0, 0 },
	{ "own_processes_each", "own, process each", OB_SYNC_OWN, true, true, 0, 0 },
	{ "heavy_threads", "own, heavy, 2 threads", OB_SYNC_HEAVY, false, false, 0, 0 },
	{ "ode_threads", "own, ODE, 2 threads", OB_SYNC_ODE, false, false, 0, 0 },
	RATE(125),
	RATE(250),
	RATE(500),
	RATE(2000),
	LAGS(OB_SYNC_LEDGER, "ledger", "ledger"),
	LAGS(OB_SYNC_OWN, "own", "own"),
};

#define METRIC(id, key, title, unit, scale, meaning) [id] = { key, title, unit, scale, NAN, NULL, meaning }
const ob_metric ob_sync_metrics[OB_SYNC_METRICS] = {
	METRIC(OB_SYNC_CPU, "cpu_s_per_body_and_simulated_s", "CPU, body and s", "ms", 1e3,
	       "CPU time of all workers over moving bodies and simulated seconds"),
	METRIC(OB_SYNC_WALL, "wall_s_per_simulated_s", "wall, s", "ms", 1e3,
	       "wall-clock time of a simulated second, with the measurement of each step"),
	METRIC(OB_SYNC_UPDATES, "updates_per_s", "updates/s", "k", 1e-3,
	       "steps of all simulators in a second of wall-clock time"),
	METRIC(OB_SYNC_LATENCY, "latency_mean_s", "latency", "ms", 1e3,
	       "from cause to effect: a simulator's own time less the time of the neighbour's version that it reads, "
	       "mean; in "
	       "lockstep bodies in contact are solved together, so there is none"),
	METRIC(OB_SYNC_LATENCY_MOST, "latency_max_s", "latency, most", "ms", 1e3, "the largest of them"),
	METRIC(OB_SYNC_WORST, "worst_penetration_m", "worst penetration", "mm", 1e3,
	       "of any pair at any boundary of 1/60 s"),
	METRIC(OB_SYNC_SIZES, "worst_penetration_sizes", "over size", "1", 1,
	       "that over the median thickness of the bodies that move"),
	METRIC(OB_SYNC_ENERGY, "energy_gain_max", "energy gained", "1", 1,
	       "largest energy above that of the start, over it; work of prescribed motion is not counted"),
	METRIC(OB_SYNC_BY_LAG, "energy_by_lag", "by late mail", "1", 1,
	       "energy that late mail of the ledger has added, over the energy of the start: the sum over all pairs of "
	       "each "
	       "impulse's work on the body that received it, less its work on that body as the sender saw it"),
	METRIC(OB_SYNC_MOMENTUM, "momentum_error", "momentum", "1", 1,
	       "largest change of momentum that nothing explains, over its size; only in scenes without fixed bodies"),
	METRIC(OB_SYNC_LAG, "lag_speed_over_size", "lag x speed / size", "1", 1,
	       "mean latency times the speed that is worth the energy which lockstep's hits lose, over the size"),
	METRIC(OB_SYNC_LOST, "energy_lost_j", "energy lost", "J", 1, "at the start less at the end"),
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
	static const char *const coupling[] = { "", "ledger", "own", "own", "own" };
	const ob_sync_comparison *c = j->comparison;
	const ob_sync_configuration *of = j->of;
	char **argv = calloc(OWN + OB_SYNC_DEFINES, sizeof *argv);
	size_t n = 0;
	bool fine = argv != NULL;
#define ADD(...) (fine = fine && asprintf(&argv[n++], __VA_ARGS__) >= 0)
	ADD("obsim");
	ADD("run");
	ADD("--json=-");
	ADD("--measure=step");
	ADD("--seed=%" PRIu64, seed);
	ADD("--duration=%.17g", c->duration);
	ADD("--isolation=%s", of->processes ? "process" : "thread");
	ADD("--workers=%s", of->each ? "objects" : "2");
	ADD("--sync=%s", of->coupling == OB_SYNC_LOCKSTEP ? "lockstep" : "free");
	if (of->coupling != OB_SYNC_LOCKSTEP) {
		ADD("--coupling=%s", coupling[of->coupling]);
		ADD("--update-rate=%.17g", rate_of(c, of));
		ADD("--jitter=%.17g", c->jitter);
		ADD("--delay=%.17g", of->delay);
		ADD("--solver=%s", of->coupling == OB_SYNC_HEAVY ? "ghost" : "coloured");
		ADD("--integrator=%s", of->coupling == OB_SYNC_ODE ? "ode" : "exact");
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
	const double energy = ob_json_read_number(r, "energy_start");
	const double simulated = ob_json_read_number(r, "simulated_s"), wall = ob_json_read_number(r, "wall_s"),
		     steps = ob_json_read_number(r, "steps") * j->point->objects;
	m[OB_SYNC_CPU] = ob_json_read_number(r, "cpu_s") / simulated / j->point->objects;
	m[OB_SYNC_WALL] = wall / simulated;
	m[OB_SYNC_UPDATES] = (free ? ob_json_read_number(r, "updates") : steps) / wall;
	m[OB_SYNC_LATENCY] = ob_json_read_number(r, "lag_mean_s");
	m[OB_SYNC_LATENCY_MOST] = ob_json_read_number(r, "lag_max_s");
	m[OB_SYNC_WORST] = ob_json_read_number(r, "worst_penetration_m");
	m[OB_SYNC_SIZES] = m[OB_SYNC_WORST] / j->point->size;
	m[OB_SYNC_ENERGY] = ob_json_read_number(r, "energy_gain_max");
	m[OB_SYNC_BY_LAG] = ob_json_read_number(r, "energy_by_lag_j") / (energy != 0 ? fabs(energy) : 1);
	m[OB_SYNC_MOMENTUM] = ob_json_read_number(r, "momentum_error");
	m[OB_SYNC_LOST] = energy - ob_json_read_number(r, "energy_end");
}

static bool run_trial(const ob_trial *t, ob_record *out, ob_error *e)
{
	const job *j = t->what;
	char *report = ob_program_report(arguments(j, t->seed), e);
	const bool fine = report;
	if (fine)
		read_report(j, report, out->metric);
	free(report);
	return fine;
}

// ---- schedule

static bool schedule(const ob_sync_comparison *c, uint32_t seeds, job *all, ob_trials *s)
{
	enum { LOCKSTEP_STEPS = 60 };
	static const double step_s = 1e-5;
	for (uint32_t i = 0; i < c->points; i++)
		for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
			const ob_sync_configuration *of = &ob_sync_table[w];
			job *j = &all[i * OB_SYNC_CONFIGURATIONS + w];
			*j = (job){ c, &c->point[i], of };
			const double rate = of->coupling == OB_SYNC_LOCKSTEP ? LOCKSTEP_STEPS : rate_of(c, of);
			ob_trial t = { .seed = c->point[i].seed,
				       .guess_s = .1 + step_s * rate * c->duration * c->point[i].objects,
				       .what = j };
			snprintf(t.of, sizeof t.of, "%s", c->point[i].key);
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
		const double lost = ob_sync_summarise(c, p, 0, OB_SYNC_LOST).median;
		p->speed = lost > 0 ? sqrt(2 * lost / p->mass) : NAN;
		for (size_t k = 0; k < c->records.count; k++) {
			ob_record *r = &c->records.record[k];
			if (strcmp(r->of, p->key) == 0)
				r->metric[OB_SYNC_LAG] = r->metric[OB_SYNC_LATENCY] * p->speed / p->size;
		}
	}
}

// CPU of a run, s, at most: a heap that explodes takes long.
static double limit_of(const ob_sync_comparison *c)
{
	double bodies = 0;
	for (uint32_t i = 0; i < c->points; i++)
		bodies = fmax(bodies, c->point[i].objects);
	return 10 + .1 * bodies * c->duration;
}

// Runs all configurations with so many seeds, as far as they have not been run. fresh: again.
static bool run_seeds(const ob_sync_comparison *c, uint32_t seeds, const ob_experiment *x, const char *folder,
		      bool fresh, ob_records *records, ob_error *e)
{
	job *all = calloc(OB_SYNC_POINTS * OB_SYNC_CONFIGURATIONS, sizeof *all);
	ob_trials s = { 0 };
	bool fine = (all && schedule(c, seeds, all, &s)) || ob_fail(e, "out of memory");
	if (fine && fresh)
		ob_records_drop(records, &s);
	fine = fine && ob_experiment_run(x, &s, records, folder, e);
	ob_trials_finish(&s);
	free(all);
	return fine;
}

bool ob_sync_run(ob_sync_comparison *c, const char *commit, const char *folder, bool fresh, ob_error *e)
{
	const ob_experiment x = { .name = "compare-sync",
				  .commit = commit,
				  .metrics = OB_SYNC_METRICS,
				  .metric = ob_sync_metrics,
				  .run = run_trial,
				  .limit_s = limit_of(c) };
	const double begun = ob_clock_wall();
	const uint32_t first = isfinite(c->budget) ? 1 : c->seeds;
	uint32_t seeds = first;
	double longest = 0; // s
	bool fine = ob_experiment_open(&x, folder, &c->records, e);
	for (bool more = fine; more; seeds++) {
		const double since = ob_clock_wall();
		fine = run_seeds(c, seeds, &x, folder, fresh && seeds == first, &c->records, e);
		longest = fmax(longest, ob_clock_wall() - since);
		more = fine && seeds < c->seeds && ob_clock_wall() - begun + longest < c->budget;
	}
	c->seeds = seeds - 1;
	if (fine)
		scale_lags(c);
	return fine;
}

void ob_sync_finish(ob_sync_comparison *c)
{
	ob_records_finish(&c->records);
}

// ---- results

ob_statistics ob_sync_summarise(const ob_sync_comparison *c, const ob_sync_point *p, int configuration,
				ob_sync_metric m)
{
	return ob_records_summarise(&c->records, p->key, ob_sync_table[configuration].key, m);
}

ob_line ob_sync_order(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_coupling coupling)
{
	double x[OB_SYNC_CONFIGURATIONS], y[OB_SYNC_CONFIGURATIONS];
	size_t n = 0;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		const double lag = ob_sync_summarise(c, p, w, OB_SYNC_LAG).median,
			     error = ob_sync_summarise(c, p, w, OB_SYNC_SIZES).median;
		if (ob_sync_table[w].coupling == coupling && ob_sync_table[w].delay > 0 && lag > 0 && error > 0)
			x[n] = log(lag), y[n++] = log(error);
	}
	return ob_reference_line(n, x, y);
}

bool ob_sync_is_of_rates(int w)
{
	const ob_sync_configuration *of = &ob_sync_table[w];
	return of->coupling == OB_SYNC_LEDGER && !of->processes && !of->each && of->delay == 0;
}

ob_line ob_sync_order_of_step(const ob_sync_comparison *c, const ob_sync_point *p)
{
	double x[OB_SYNC_CONFIGURATIONS], y[OB_SYNC_CONFIGURATIONS];
	size_t n = 0;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		const double error = ob_sync_summarise(c, p, w, OB_SYNC_SIZES).median;
		if (ob_sync_is_of_rates(w) && error > 0)
			x[n] = -log(rate_of(c, &ob_sync_table[w])), y[n++] = log(error);
	}
	return ob_reference_line(n, x, y);
}

static double median(const ob_sync_comparison *c, const ob_sync_point *p, int w, ob_sync_metric m)
{
	return ob_sync_summarise(c, p, w, m).median;
}

// Free configuration without an injected lag, of a coupling or of any (OB_SYNC_COUPLINGS), with the least penetration;
// -1: none was measured.
static int best_free(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_coupling coupling)
{
	int best = -1;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		const ob_sync_configuration *of = &ob_sync_table[w];
		const double error = median(c, p, w, OB_SYNC_WORST);
		if (of->coupling == OB_SYNC_LOCKSTEP || of->delay > 0 || of->rate > 0 || isnan(error) ||
		    (coupling != OB_SYNC_COUPLINGS && of->coupling != coupling))
			continue;
		if (best < 0 || error < median(c, p, best, OB_SYNC_WORST))
			best = w;
	}
	return best;
}

// Largest lag, s, up to which a coupling's worst penetration stays below a share of the size; -1: not even without;
// 0: none was seen, as nothing touched.
static double tolerable_lag(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_coupling coupling,
			    double share)
{
	double most = -1;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		const ob_sync_configuration *of = &ob_sync_table[w];
		if (of->coupling != coupling || of->processes || of->each || of->rate > 0)
			continue;
		if (!(median(c, p, w, OB_SYNC_SIZES) <= share))
			break; // rows of a coupling stand in the order of lags
		most = fmax(most, fmax(median(c, p, w, OB_SYNC_LATENCY), 0));
	}
	return most;
}

// Least injected lag, s, with which a coupling gains energy; NaN: none does.
static double gains_from(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_coupling coupling)
{
	static const double noticeable = 1e-6;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++)
		if (ob_sync_table[w].coupling == coupling && ob_sync_table[w].rate == 0 &&
		    median(c, p, w, OB_SYNC_ENERGY) > noticeable)
			return ob_sync_table[w].delay;
	return NAN;
}

// Appends the order of an error with its interval.
static size_t print_order(char *to, size_t room, const char *of, ob_line order)
{
	if (isnan(order.slope))
		return 0;
	if (isnan(order.slope_low))
		return (size_t)snprintf(to, room, " %s: %.2f.", of, order.slope);
	return (size_t)snprintf(to, room, " %s: %.2f (%.2f to %.2f).", of, order.slope, order.slope_low,
				order.slope_high);
}

static void judge_power(const ob_sync_comparison *c, const ob_sync_point *p, char *to, size_t room)
{
	const ob_line ledger = ob_sync_order(c, p, OB_SYNC_LEDGER), own = ob_sync_order(c, p, OB_SYNC_OWN);
	size_t n = (size_t)snprintf(to, room, "Powers of the lag, each over %zu lags.", ledger.n);
	n += print_order(to + n, n < room ? room - n : 0, "Ledger", ledger);
	n += print_order(to + n, n < room ? room - n : 0, "Own", own);
	n += print_order(to + n, n < room ? room - n : 0, "Length of a step, ledger, no injected lag",
			 ob_sync_order_of_step(c, p));
	const double width = fmax(ledger.slope_high - ledger.slope_low, own.slope_high - own.slope_low);
	if (n < room && !isnan(width))
		snprintf(to + n, room - n, " %s",
			 width < .5 ? "One power describes each."
				    : "One power does not describe them: the intervals are wide, so the curves bend.");
}

static void judge_momentum(const ob_sync_comparison *c, const ob_sync_point *p, char *to, size_t room)
{
	const double ledger = median(c, p, best_free(c, p, OB_SYNC_LEDGER), OB_SYNC_MOMENTUM),
		     own = median(c, p, best_free(c, p, OB_SYNC_OWN), OB_SYNC_MOMENTUM);
	if (isnan(ledger) || isnan(own))
		snprintf(to, room,
			 "Not tested by this scene: something is fixed in it, and takes up momentum. A test of the "
			 "program holds the ledger to 1e-12 with the mail under way, for random lags, jitter, orders "
			 "and kills.");
	else
		snprintf(to, room,
			 "Change of momentum, without the mail under way: %.2g by the ledger, %.2g by own responses.",
			 ledger, own);
}

static void judge_energy(const ob_sync_comparison *c, const ob_sync_point *p, char *to, size_t room)
{
	double gained = 0, by_mail = -INFINITY, mildest = INFINITY;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++) {
		if (ob_sync_table[w].coupling != OB_SYNC_LEDGER || isnan(median(c, p, w, OB_SYNC_BY_LAG)))
			continue;
		gained = fmax(gained, median(c, p, w, OB_SYNC_ENERGY));
		by_mail = fmax(by_mail, median(c, p, w, OB_SYNC_BY_LAG));
		if (ob_sync_table[w].delay > 0 && median(c, p, w, OB_SYNC_BY_LAG) > 0)
			mildest = fmin(mildest, ob_sync_table[w].delay);
	}
	size_t n = (size_t)snprintf(
		to, room,
		"Of the energy at the start, late mail added up to %.2g, and the bodies had at most %.2g more than "
		"at the start: what hits lose is not counted against it.",
		by_mail, gained);
	if (n < room && isfinite(mildest))
		snprintf(to + n, room - n,
			 " Late mail added energy from an injected lag of %.3g ms on, and took some below.",
			 1e3 * mildest);
}

void ob_sync_judge(const ob_sync_comparison *c, const ob_sync_point *p, int hypothesis, char *to, size_t room)
{
	static void (*const judge[])(const ob_sync_comparison *, const ob_sync_point *, char *,
				     size_t) = { judge_power, judge_momentum, judge_energy };
	if (best_free(c, p, OB_SYNC_LEDGER) < 0 || best_free(c, p, OB_SYNC_OWN) < 0)
		snprintf(to, room, "Too little was measured.");
	else
		judge[hypothesis](c, p, to, room);
}

void ob_sync_recommend(const ob_sync_comparison *c, const ob_sync_point *p, char *to, size_t room)
{
	static const double share = .1; // of the size: penetration that counts as large
	const int free = best_free(c, p, OB_SYNC_COUPLINGS);
	const double exact = median(c, p, 0, OB_SYNC_WORST), cost = median(c, p, 0, OB_SYNC_CPU);
	if (free < 0 || isnan(exact)) {
		snprintf(to, room, "Too little was measured to recommend anything.");
		return;
	}
	const ob_sync_configuration *of = &ob_sync_table[free];
	const double error = median(c, p, free, OB_SYNC_WORST), ratio = median(c, p, free, OB_SYNC_CPU) / cost;
	const ob_statistics ratios =
		ob_records_ratio(&c->records, p->key, of->key, ob_sync_table[0].key, OB_SYNC_CPU, true);
	char interval[64] = "";
	if (!isnan(ratios.mean_low) && c->seeds > 2)
		snprintf(interval, sizeof interval, " (%.2g to %.2g)", exp(ratios.mean_low), exp(ratios.mean_high));
	size_t n = (size_t)snprintf(
		to, room,
		"Lockstep kept bodies within %.3g mm of each other's surfaces. The most accurate free form "
		"(%s) let them sink in by %.3g mm, and took %.2g times the CPU%s. ",
		1e3 * exact, of->title, 1e3 * error, ratio, interval);
	n += (size_t)snprintf(to + n, room - n, "%s ",
			      error <= exact && ratio <= 1
				      ? "So free running costs nothing here: take it where simulators must not wait."
			      : error <= exact
				      ? "It is as accurate: take it where simulators must not wait, and pay the CPU."
			      : ratio <= 1 ? "So choose by need: free running is cheaper, lockstep more accurate."
					   : "So run in lockstep, unless simulators must not wait for each other.");
	const double lag = tolerable_lag(c, p, of->coupling, share), gains = gains_from(c, p, of->coupling);
	if (n < room && lag > 0)
		n += (size_t)snprintf(
			to + n, room - n,
			"Free simulators of this coupling stay within %.0f %% of the bodies' size up to a latency of "
			"%.3g ms, which is a lag of %.2g sizes at these speeds. ",
			100 * share, 1e3 * lag, lag * p->speed / p->size);
	else if (n < room && lag < 0)
		n += (size_t)snprintf(to + n, room - n,
				      "Even without an injected lag it sinks in by more than %.0f %% of their size. ",
				      100 * share);
	if (n < room && isnan(gains))
		snprintf(to + n, room - n, "No lag that was tried made it gain energy.");
	else if (n < room)
		snprintf(to + n, room - n,
			 "It gains energy from an injected lag of %.3g ms on: bound the lag below that.", 1e3 * gains);
}

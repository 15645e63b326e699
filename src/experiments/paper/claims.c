#include "paper/claims.h"

#include <math.h>
#include <string.h>

#include "paper/paper.h"

// ---- words

ob_word ob_word_value(double v, ob_paper_metric m)
{
	return ob_word_metric(v, &ob_paper_metrics[m]);
}

// "1.9 to 2.4"; empty if unknown
static ob_word interval(double low, double high)
{
	ob_word w = { "no interval" };
	if (!isnan(low) && !isnan(high))
		snprintf(w.text, sizeof w.text, "%.20s to %.20s", ob_word_number(low).text, ob_word_number(high).text);
	return w;
}

ob_word ob_word_ratio(const ob_estimate *r)
{
	ob_word w;
	snprintf(w.text, sizeof w.text, "%.20s times (%.42s)", ob_word_number(r->value).text,
		 interval(r->low, r->high).text);
	return w;
}

ob_word ob_word_exponent(const ob_line *l)
{
	ob_word w;
	snprintf(w.text, sizeof w.text, "n^%.2f (%.2f to %.2f)", l->slope, l->slope_low, l->slope_high);
	return w;
}

ob_word ob_word_odds(double logarithm)
{
	static const double most = 1e6;
	ob_word w = { "more than a million to 1" };
	double odds = exp(fabs(logarithm));
	if (odds <= most)
		snprintf(w.text, sizeof w.text, "%.0f to 1", odds);
	return w;
}

// ---- rules

// Evidence for a claim.
typedef struct evidence {
	const ob_paper_results *here, *paper; // measured; printed in the paper
	ob_paper_claim *claim;
} evidence;

// Three meanings of "runtime".
enum { RUNTIMES = 3 };
static const struct {
	ob_paper_metric metric;
	const char *name;
} runtimes[RUNTIMES] = {
	{ OB_PAPER_STEP, "the slowest simulator's step" },
	{ OB_PAPER_TOTAL, "the CPU time of all simulators together" },
	{ OB_PAPER_ONE, "the CPU time of one simulator" },
};

static const double half = .5, tenfold = 10;
static const double doubled = 2; // ratio of costs from which a test is too expensive to use
static const double flat = .1; // exponent: slower growth counts as constant
enum { GROWTH_LEAST = 3 }; // runs needed for an interval
static const double load_far = 10; // times the paper's load: beyond that, its figure does not apply to this claim

const char *ob_paper_verdict_text(ob_paper_verdict v)
{
	static const char *const texts[OB_PAPER_VERDICTS] = { "holds", "holds only if", "does not hold",
							      "cannot be told" };
	return texts[v];
}

// True if the whole interval of ratios lies on this side; false if it is unknown.
static bool below(const ob_estimate *r, double limit)
{
	return r->high < limit;
}

static bool above(const ob_estimate *r, double limit)
{
	return r->low > limit;
}

// The median is robust against one disturbed run.
static double median(const ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m)
{
	return ob_paper_summarise(r, s, m).median;
}

// Writes "1.2 ms instead of 3.4 ms, 0.35 times (.. to ..)".
static void say_pair(ob_paper_claim *c, const ob_paper_results *r, ob_paper_scenario a, ob_paper_scenario b,
		     ob_paper_metric m, const ob_estimate *ratio)
{
	OB_SAY(c->because, "%s instead of %s, %s", ob_word_value(median(r, a, m), m).text,
	       ob_word_value(median(r, b, m), m).text, ob_word_ratio(ratio).text);
}

static void say_itself(const evidence *c, ob_paper_scenario a, ob_paper_scenario b, ob_paper_metric m)
{
	ob_estimate ratio = ob_paper_compare(c->paper, a, b, m);
	OB_SAY(c->claim->itself, "%s in its tables.", ob_word_ratio(&ratio).text);
}

static void judge_runtime(const evidence *c)
{
	ob_paper_claim *claim = c->claim;
	int lower = 0, higher = 0;
	OB_SAY(claim->because, "With OBS ");
	for (int i = 0; i < RUNTIMES; i++) {
		ob_estimate ratio = ob_paper_compare(c->here, OB_PAPER_OBS, OB_PAPER_COMMON, runtimes[i].metric);
		if (below(&ratio, 1))
			OB_SAY(claim->condition, "%s%s", lower++ ? " or " : "runtime means ", runtimes[i].name);
		higher += above(&ratio, 1);
		OB_SAY(claim->because, "%s%s takes ", i ? "; " : "", runtimes[i].name);
		say_pair(claim, c->here, OB_PAPER_OBS, OB_PAPER_COMMON, runtimes[i].metric, &ratio);
	}
	ob_estimate pool = ob_paper_compare(c->here, OB_PAPER_POOL, OB_PAPER_COMMON, OB_PAPER_TOTAL);
	OB_SAY(claim->because,
	       ". One thread per core that runs all the simulators takes %s the CPU time of the common environment.",
	       ob_word_ratio(&pool).text);
	claim->verdict = lower == RUNTIMES    ? OB_PAPER_HOLDS
			 : lower > 0          ? OB_PAPER_ONLY_IF
			 : higher == RUNTIMES ? OB_PAPER_FAILS
					      : OB_PAPER_OPEN;
	say_itself(c, OB_PAPER_OBS, OB_PAPER_COMMON, OB_PAPER_STEP);
}

static uint32_t count_faster(const ob_paper_results *r)
{
	uint32_t faster = 0;
	for (uint32_t k = 0; k < r->experiments; k++) {
		const ob_record *obs = ob_paper_find(r, OB_PAPER_OBS, k),
				*common = ob_paper_find(r, OB_PAPER_COMMON, k);
		faster += obs && common && obs->metric[OB_PAPER_FPS] > common->metric[OB_PAPER_FPS];
	}
	return faster;
}

static void judge_frames(const evidence *c)
{
	ob_paper_claim *claim = c->claim;
	ob_estimate ratio = ob_paper_compare(c->here, OB_PAPER_OBS, OB_PAPER_COMMON, OB_PAPER_FPS);
	ob_estimate pool = ob_paper_compare(c->here, OB_PAPER_POOL, OB_PAPER_COMMON, OB_PAPER_FPS);
	OB_SAY(claim->itself, "Higher in %u of %u experiments, equal in the rest: it looks like a cap at 240.",
	       count_faster(c->paper), c->paper->experiments);
	claim->verdict = OB_PAPER_OPEN;
	if (ratio.n == 0) {
		OB_SAY(claim->because, "No frames were drawn.");
		return;
	}
	if (above(&ratio, 1)) {
		claim->verdict = OB_PAPER_HOLDS;
	} else if (above(&pool, 1)) {
		claim->verdict = OB_PAPER_ONLY_IF;
		OB_SAY(claim->condition, "one thread per core runs all the simulators, not a process for each");
	} else if (below(&ratio, 1)) {
		claim->verdict = OB_PAPER_FAILS;
	}
	OB_SAY(claim->because, "Drawn as fast as they could be, frames a second were ");
	say_pair(claim, c->here, OB_PAPER_OBS, OB_PAPER_COMMON, OB_PAPER_FPS, &ratio);
	OB_SAY(claim->because, "; with one thread per core for all simulators %s.", ob_word_ratio(&pool).text);
}

static void judge_cpu(const evidence *c)
{
	ob_paper_claim *claim = c->claim;
	ob_estimate ratio = ob_paper_compare(c->here, OB_PAPER_OBS, OB_PAPER_COMMON, OB_PAPER_CPU);
	ob_estimate pool = ob_paper_compare(c->here, OB_PAPER_POOL, OB_PAPER_COMMON, OB_PAPER_CPU);
	ob_estimate one = ob_paper_compare(c->here, OB_PAPER_OBS, OB_PAPER_COMMON, OB_PAPER_ONE);
	bool with_pool = below(&pool, half), with_one = below(&one, half);
	if (with_pool)
		OB_SAY(claim->condition, "one thread per core runs all the simulators, not a process for each");
	if (with_one)
		OB_SAY(claim->condition, "%sthe CPU usage is that of one simulator, set against the whole of the other",
		       with_pool ? ", or " : "");
	claim->verdict = below(&ratio, half)     ? OB_PAPER_HOLDS
			 : with_pool || with_one ? OB_PAPER_ONLY_IF
			 : above(&ratio, half)   ? OB_PAPER_FAILS
						 : OB_PAPER_OPEN;
	OB_SAY(claim->because, "All simulators of OBS together took, of one core, ");
	say_pair(claim, c->here, OB_PAPER_OBS, OB_PAPER_COMMON, OB_PAPER_CPU, &ratio);
	OB_SAY(claim->because, "; with one thread per core for all of them %s; one simulator alone %s.",
	       ob_word_ratio(&pool).text, ob_word_ratio(&one).text);
	say_itself(c, OB_PAPER_OBS, OB_PAPER_COMMON, OB_PAPER_CPU);
}

// Writes the load without a spatial sorting structure.
static void say_all_pairs(const evidence *c)
{
	double pairs = .5 * c->here->objects * (c->here->objects - 1.);
	double alone = median(c->here, OB_PAPER_COMMON, OB_PAPER_TOTAL);
	OB_SAY(c->claim->because,
	       " If each of the %.0f pairs of boxes were tested in each step, it would become about %s times.", pairs,
	       ob_word_number(1 + pairs * c->here->sum_s / alone).text);
}

// Judges by CPU time, the least disturbed by other programs: with one simulator, it is the step's, too.
static void judge_load(const evidence *c)
{
	ob_paper_claim *claim = c->claim;
	ob_estimate ratio = ob_paper_compare(c->here, OB_PAPER_COMMON_LOAD, OB_PAPER_COMMON, OB_PAPER_TOTAL);
	double load = ob_paper_setups[OB_PAPER_COMMON_LOAD].load;
	double needed = load * (tenfold - 1) / (ratio.value - 1);
	double tests = median(c->here, OB_PAPER_COMMON_LOAD, OB_PAPER_TESTS);
	OB_SAY(claim->because, "The runtime of the common environment became ");
	say_pair(claim, c->here, OB_PAPER_COMMON_LOAD, OB_PAPER_COMMON, OB_PAPER_TOTAL, &ratio);
	OB_SAY(claim->because, ". There are %s tests of boxes in a step, and one sum takes %s us.",
	       ob_word_number(tests).text, ob_word_number(1e6 * c->here->sum_s).text);
	claim->verdict = OB_PAPER_OPEN;
	if (!below(&ratio, tenfold)) {
		if (above(&ratio, half * tenfold))
			claim->verdict = OB_PAPER_HOLDS;
	} else if (above(&ratio, 1)) {
		bool near = needed <= load_far * load;
		claim->verdict = near ? OB_PAPER_ONLY_IF : OB_PAPER_FAILS;
		if (near)
			OB_SAY(claim->condition, "1 to %.0f are added up instead of 1 to %.0f", needed, load);
		else
			OB_SAY(claim->because, " It would take 1 to %s to make it ten times longer.",
			       ob_word_number(needed).text);
		say_all_pairs(c);
	} else {
		claim->verdict = OB_PAPER_FAILS;
		OB_SAY(claim->because, " The difference lies within the noise.");
	}
	say_itself(c, OB_PAPER_COMMON_LOAD, OB_PAPER_COMMON, OB_PAPER_STEP);
}

static void judge_kept(const evidence *c)
{
	ob_paper_claim *claim = c->claim;
	ob_estimate better = ob_paper_compare(c->here, OB_PAPER_COMMON_OBB, OB_PAPER_COMMON, OB_PAPER_TOTAL);
	ob_estimate load = ob_paper_compare(c->here, OB_PAPER_COMMON_LOAD, OB_PAPER_COMMON, OB_PAPER_TOTAL);
	claim->verdict = above(&better, doubled)   ? OB_PAPER_HOLDS
			 : below(&better, doubled) ? OB_PAPER_FAILS
						   : OB_PAPER_OPEN;
	OB_SAY(claim->because, "With the true shapes (OBB) the runtime of the common environment is ");
	say_pair(claim, c->here, OB_PAPER_COMMON_OBB, OB_PAPER_COMMON, OB_PAPER_TOTAL, &better);
	OB_SAY(claim->because, "; the added sum, which stands for a better test, makes it %s. ",
	       ob_word_ratio(&load).text);
	OB_SAY(claim->because, "%s",
	       claim->verdict == OB_PAPER_HOLDS ? "A better test costs at least as much again."
	       : claim->verdict == OB_PAPER_FAILS
		       ? "A better test does not double it: its cost is no reason to keep boxes along the axes."
		       : "These runs do not decide whether it doubles.");
	OB_SAY(claim->itself, "It has no run with another test.");
}

// Judges by the CPU time of the busiest simulator, which must finish its step before the next begins. The pace itself
// depends more on other load of the machine.
static void judge_obb(const evidence *c)
{
	ob_paper_claim *claim = c->claim;
	ob_statistics obs = ob_paper_summarise(c->here, OB_PAPER_OBS_OBB, OB_PAPER_BUSIEST),
		      common = ob_paper_summarise(c->here, OB_PAPER_COMMON_OBB, OB_PAPER_BUSIEST);
	ob_estimate ratio = ob_paper_compare(c->here, OB_PAPER_OBS_OBB, OB_PAPER_COMMON_OBB, OB_PAPER_STEP);
	OB_SAY(claim->itself, "It has no run with OBB: it is a proposal.");
	claim->verdict = OB_PAPER_OPEN;
	if (isnan(obs.mean) || isnan(common.mean)) {
		OB_SAY(claim->because, "It was not measured.");
		return;
	}
	OB_SAY(claim->because,
	       "In each %s the busiest simulator of OBS with OBB needs %s of CPU, the common environment ",
	       ob_word_value(OB_PAPER_STEP_LENGTH, OB_PAPER_STEP).text,
	       ob_word_value(obs.median, OB_PAPER_BUSIEST).text);
	OB_SAY(claim->because, "%s. The step takes ", ob_word_value(common.median, OB_PAPER_BUSIEST).text);
	say_pair(claim, c->here, OB_PAPER_OBS_OBB, OB_PAPER_COMMON_OBB, OB_PAPER_STEP, &ratio);
	OB_SAY(claim->because, ".");
	bool common_fits = common.mean_high<OB_PAPER_STEP_LENGTH, common_late = common.mean_low> OB_PAPER_STEP_LENGTH;
	if (common_fits && below(&ratio, 1)) {
		claim->verdict = OB_PAPER_ONLY_IF;
		OB_SAY(claim->condition, "a shorter step is meant: both keep pace with reality");
	} else if (common_fits) {
		claim->verdict = OB_PAPER_FAILS;
		OB_SAY(claim->because, " OBB is affordable without OBS.");
	} else if (obs.mean_low > OB_PAPER_STEP_LENGTH) {
		claim->verdict = OB_PAPER_FAILS;
	} else if (common_late && obs.mean_high < OB_PAPER_STEP_LENGTH) {
		claim->verdict = OB_PAPER_HOLDS;
	}
}

static void judge_constant(const evidence *c)
{
	ob_paper_claim *claim = c->claim;
	int constant = 0, growing = 0;
	ob_statistics s = ob_paper_summarise(c->paper, OB_PAPER_OBS, OB_PAPER_STEP);
	OB_SAY(claim->itself, "%s to %s, printed to one digit; how many objects there were is not said.",
	       ob_word_value(s.least, OB_PAPER_STEP).text, ob_word_value(s.most, OB_PAPER_STEP).text);
	claim->verdict = OB_PAPER_OPEN;
	if (ob_paper_grow(c->here, OB_PAPER_OBS, OB_PAPER_STEP).power.n < GROWTH_LEAST) {
		OB_SAY(claim->because, "It was not run with different numbers of objects.");
		return;
	}
	OB_SAY(claim->because, "With n objects in OBS, ");
	for (int i = 0; i < RUNTIMES; i++) {
		ob_line power = ob_paper_grow(c->here, OB_PAPER_OBS, runtimes[i].metric).power;
		if (power.slope_high < flat)
			OB_SAY(claim->condition, "%s%s", constant++ ? " or " : "runtime means ", runtimes[i].name);
		growing += power.slope_low > flat;
		OB_SAY(claim->because, "%s%s goes as %s", i ? "; " : "", runtimes[i].name,
		       ob_word_exponent(&power).text);
	}
	OB_SAY(claim->because, ".");
	claim->verdict = constant == RUNTIMES ? OB_PAPER_HOLDS
			 : constant > 0       ? OB_PAPER_ONLY_IF
			 : growing > 0        ? OB_PAPER_FAILS
					      : OB_PAPER_OPEN;
}

static void say_growth(ob_paper_claim *claim, const char *of, const ob_paper_growth *g)
{
	int prefers = ob_paper_prefers(g);
	OB_SAY(claim->because, "%s it goes as %s, and the data prefer %s", of, ob_word_exponent(&g->power).text,
	       prefers > 0   ? "a line"
	       : prefers < 0 ? "a logarithm"
			     : "neither a line nor a logarithm");
	if (prefers)
		OB_SAY(claim->because, ", %s", ob_word_odds(g->favour).text);
}

static void judge_growth(const evidence *c)
{
	ob_paper_claim *claim = c->claim;
	ob_paper_growth common = ob_paper_grow(c->here, OB_PAPER_COMMON, OB_PAPER_DEMAND),
			obs = ob_paper_grow(c->here, OB_PAPER_OBS, OB_PAPER_DEMAND),
			common_shown = ob_paper_grow(c->here, OB_PAPER_COMMON, OB_PAPER_CPU),
			obs_shown = ob_paper_grow(c->here, OB_PAPER_OBS, OB_PAPER_CPU);
	OB_SAY(claim->itself, "A drawn trend line, no fit; taken from an earlier paper.");
	claim->verdict = OB_PAPER_OPEN;
	if (common.linear.n < GROWTH_LEAST || obs.linear.n < GROWTH_LEAST) {
		OB_SAY(claim->because, "It was not run with different numbers of objects.");
		return;
	}
	OB_SAY(claim->because, "CPU of all simulators for each simulated second: ");
	say_growth(claim, "in the common environment", &common);
	say_growth(claim, "; in OBS", &obs);
	say_growth(
		claim,
		". As a share of real time, as a system monitor shows it, which ends where the cores are busy: in OBS",
		&obs_shown);
	OB_SAY(claim->because, ".");
	if (ob_paper_prefers(&common) > 0 && ob_paper_prefers(&obs) < 0) {
		claim->verdict = OB_PAPER_HOLDS;
	} else if (ob_paper_prefers(&common_shown) > 0 && ob_paper_prefers(&obs_shown) < 0) {
		claim->verdict = OB_PAPER_ONLY_IF;
		OB_SAY(claim->condition, "CPU usage is read off a monitor, where it ends when the cores are busy");
	} else if (ob_paper_prefers(&common) < 0 || ob_paper_prefers(&obs) > 0) {
		claim->verdict = OB_PAPER_FAILS;
	}
}

static const struct {
	ob_paper_claim claim;
	void (*judge)(const evidence *c);
} rules[OB_PAPER_CLAIMS] = {
	{ { .key = "runtime",
	    .says = "The runtime of OBS (.001 s) is smaller than that of the common environment (.007 s).",
	    .where = "Tables 1 and 3, Figure 14" },
	  judge_runtime },
	{ { .key = "constant",
	    .says = "The runtime of OBS is constant: the number of objects does not affect it.",
	    .where = "Table 3, Figure 14" },
	  judge_constant },
	{ { .key = "frames",
	    .says = "The frame rate of OBS (239 fps) is higher than that of the common environment (234 fps).",
	    .where = "Tables 1 and 4, Figure 15" },
	  judge_frames },
	{ { .key = "cpu",
	    .says = "The CPU usage of OBS (21 %) is half of that of the common environment (50 %).",
	    .where = "Tables 1 and 5, Figure 16" },
	  judge_cpu },
	{ { .key = "load",
	    .says = "Adding up 1 to 1000 in each AABB test makes the runtime ten times longer.",
	    .where = "Tables 1 and 2" },
	  judge_load },
	{ { .key = "kept",
	    .says = "Such added work is why environments keep AABB and leave better tests alone.",
	    .where = "Sections 4.2 and 5" },
	  judge_kept },
	{ { .key = "obb", .says = "OBS makes a better test such as OBB affordable.", .where = "Abstract, Section 5" },
	  judge_obb },
	{ { .key = "growth",
	    .says = "CPU usage grows as O(n) in the common environment, and as O(log n) in OBS.",
	    .where = "Figure 6" },
	  judge_growth },
};

void ob_paper_judge(const ob_paper_results *r, ob_paper_claim claim[OB_PAPER_CLAIMS])
{
	ob_paper_results paper = ob_paper_published();
	for (int i = 0; i < OB_PAPER_CLAIMS; i++) {
		claim[i] = rules[i].claim;
		rules[i].judge(&(evidence){ r, &paper, &claim[i] });
		if (claim[i].verdict != OB_PAPER_ONLY_IF)
			claim[i].condition[0] = 0;
	}
	ob_records_finish(&paper.records);
}

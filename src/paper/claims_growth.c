// The claims about more and more objects.
#include <math.h>

#include "paper/claims.h"
#include "paper/words.h"

static const double flat = .1; // exponent: what grows less counts as constant
enum { GROWTH_LEAST = 3 }; // runs, for an interval

void ob_paper_judge_constant(const ob_paper_case *c)
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
	for (int i = 0; i < OB_PAPER_RUNTIMES; i++) {
		const ob_paper_runtime *t = &ob_paper_runtimes[i];
		ob_line power = ob_paper_grow(c->here, OB_PAPER_OBS, t->quantity).power;
		if (power.slope_high < flat)
			OB_SAY(claim->condition, "%s%s", constant++ ? " or " : "runtime means ", t->name);
		growing += power.slope_low > flat;
		OB_SAY(claim->because, "%s%s goes as %s", i ? "; " : "", t->name, ob_word_exponent(&power).text);
	}
	OB_SAY(claim->because, ".");
	claim->verdict = constant == OB_PAPER_RUNTIMES ? OB_PAPER_HOLDS
			 : constant > 0                ? OB_PAPER_ONLY_IF
			 : growing > 0                 ? OB_PAPER_FAILS
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

void ob_paper_judge_growth(const ob_paper_case *c)
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
	say_growth(claim,
		   ". As a share of real time, as a system monitor shows it, which ends where the cores are busy: "
		   "in OBS",
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

#include "made.h"

#include <math.h>
#include <string.h>

// Value in [-1, 1], the same each time.
static double noise(unsigned seed)
{
	return sin(12.9898 * seed + 4.1414 * sin(78.233 * seed));
}

ob_record made_record(ob_paper_scenario s, bool growth, uint32_t objects, uint32_t repeat)
{
	ob_record r = { .repeat = repeat, .seed = repeat + 1 };
	ob_paper_case_key(r.of, growth, objects);
	snprintf(r.configuration, sizeof r.configuration, "%s", ob_paper_setups[s].key);
	for (int i = 0; i < OB_METRICS; i++)
		r.metric[i] = NAN;
	return r;
}

ob_paper_results made_alike(void)
{
	ob_paper_results r = { .objects = 64, .experiments = MADE_EXPERIMENTS, .sum_s = 3e-7, .busy = .01 };
	static const double of[OB_PAPER_METRICS] = {
		[OB_PAPER_STEP] = .001, [OB_PAPER_TOTAL] = .001, [OB_PAPER_ONE] = .001,   [OB_PAPER_BUSIEST] = .001,
		[OB_PAPER_CPU] = .06,   [OB_PAPER_DEMAND] = .06, [OB_PAPER_PACE] = 1,     [OB_PAPER_FPS] = 100,
		[OB_PAPER_VIEWER] = .5, [OB_PAPER_TESTS] = 90,   [OB_PAPER_MEMORY] = 2e6,
	};
	strcpy(r.records.machine, "made <up> & \"checked\"");
	strcpy(r.records.commit, "0123456789ab");
	for (uint32_t k = 0; k < MADE_EXPERIMENTS; k++) {
		for (int s = 0; s < OB_PAPER_SCENARIOS; s++) {
			ob_record one = made_record(s, false, r.objects, k);
			for (int m = 0; m < OB_PAPER_METRICS; m++)
				one.metric[m] = of[m] * (m < OB_PAPER_PACE || m == OB_PAPER_FPS
								 ? 1 + .01 * noise(100 * (unsigned)s + k)
								 : 1);
			ob_records_add(&r.records, &one);
		}
	}
	return r;
}

// Scales the experiments of a scenario; the factor may depend on the experiment's number.
static void scale_each(ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m, double even, double odd)
{
	uint32_t objects;
	for (size_t i = 0; i < r->records.count; i++) {
		ob_record *at = &r->records.record[i];
		if (ob_paper_scenario_of(at) == s && !ob_paper_is_growth(at->of, &objects))
			at->metric[m] *= at->repeat % 2 ? odd : even;
	}
}

void made_scale(ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m, double factor)
{
	scale_each(r, s, m, factor, factor);
}

void made_scatter(ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m, double share)
{
	scale_each(r, s, m, exp(-share), exp(share));
}

void made_growth(ob_paper_results *r, ob_paper_scenario s, double (*of)(double objects))
{
	for (uint32_t k = 0; k < MADE_REPEATS; k++)
		for (uint32_t i = 0; i < MADE_SIZES; i++) {
			ob_record one = made_record(s, true, 8u << i, k);
			ob_records_add(&r->records, &one);
		}
	for (int m = 0; m < OB_PAPER_METRICS; m++)
		made_set_growth(r, s, m, of);
}

void made_set_growth(ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m, double (*of)(double objects))
{
	uint32_t objects;
	for (size_t i = 0; i < r->records.count; i++) {
		ob_record *at = &r->records.record[i];
		if (ob_paper_scenario_of(at) == s && ob_paper_is_growth(at->of, &objects))
			at->metric[m] = of(objects) * (1 + .01 * noise((unsigned)(31 * i) + (unsigned)m));
	}
}

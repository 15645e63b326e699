#include "made.h"

#include <math.h>
#include <string.h>

// In [-1, 1], the same each time
static double noise(unsigned seed)
{
	return sin(12.9898 * seed + 4.1414 * sin(78.233 * seed));
}

static double *member(ob_paper_sample *s, ob_paper_quantity q)
{
	return (double *)((char *)s + ob_paper_quantities[q].offset);
}

ob_paper_results made_alike(void)
{
	ob_paper_results r = { .objects = 64, .experiments = MADE_EXPERIMENTS, .sum_s = 3e-7, .busy = .01 };
	strcpy(r.machine, "made <up> & \"checked\"");
	strcpy(r.commit, "0123456789ab");
	for (uint32_t k = 0; k < MADE_EXPERIMENTS; k++) {
		for (int s = 0; s < OB_PAPER_SCENARIOS; s++) {
			double with = 1 + .01 * noise(100 * (unsigned)s + k);
			ob_paper_sample sample = { .scenario = s,
						   .experiment = k,
						   .objects = 64,
						   .seed = k + 1,
						   .step_s = .001 * with,
						   .total_s = .001 * with,
						   .one_s = .001 * with,
						   .busiest_s = .001 * with,
						   .cpu = .06 * with,
						   .demand = .06 * with,
						   .pace = 1,
						   .fps = 100 * with,
						   .viewer_cpu = .5,
						   .box_tests = 90,
						   .memory_bytes = 2e6 };
			ob_paper_results_add(&r, &sample);
		}
	}
	return r;
}

void made_scale(ob_paper_results *r, ob_paper_scenario s, ob_paper_quantity q, double factor)
{
	for (size_t i = 0; i < r->count; i++)
		if (r->sample[i].scenario == s && !r->sample[i].growth)
			*member(&r->sample[i], q) *= factor;
}

void made_scatter(ob_paper_results *r, ob_paper_scenario s, ob_paper_quantity q, double share)
{
	for (size_t i = 0; i < r->count; i++)
		if (r->sample[i].scenario == s && !r->sample[i].growth)
			*member(&r->sample[i], q) *= exp(r->sample[i].experiment % 2 ? share : -share);
}

void made_growth(ob_paper_results *r, ob_paper_scenario s, double (*of)(double objects))
{
	for (uint32_t k = 0; k < MADE_REPEATS; k++)
		for (uint32_t i = 0; i < MADE_SIZES; i++) {
			ob_paper_sample sample = ob_paper_sample_unmeasured();
			sample.scenario = s;
			sample.growth = true;
			sample.experiment = k;
			sample.objects = 8u << i;
			ob_paper_results_add(r, &sample);
		}
	for (int q = 0; q < OB_PAPER_QUANTITIES; q++)
		made_set_growth(r, s, q, of);
}

void made_set_growth(ob_paper_results *r, ob_paper_scenario s, ob_paper_quantity q, double (*of)(double objects))
{
	for (size_t i = 0; i < r->count; i++) {
		ob_paper_sample *at = &r->sample[i];
		if (at->scenario == s && at->growth)
			*member(at, q) = of(at->objects) * (1 + .01 * noise((unsigned)(31 * i) + (unsigned)q));
	}
}

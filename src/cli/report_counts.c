#include <math.h>
#include <string.h>

#include "cli/report.h"

// The smallest number of substeps with which at least this share of the island-steps were solved.
static uint64_t quantile(const ob_counters *c, double share)
{
	uint64_t all = 0, sum = 0;
	for (int i = 0; i < OB_SUBSTEP_CHOICES; i++)
		all += c->chosen[i];
	for (int i = 0; i < OB_SUBSTEP_CHOICES; i++) {
		sum += c->chosen[i];
		if (sum > 0 && (double)sum >= share * (double)all)
			return UINT64_C(1) << i;
	}
	return 0;
}

static double work_of(const ob_counters *c)
{
	double sum = 0;
	for (int i = 0; i < OB_PROFILE_SECTIONS; i++)
		sum += 1e-9 * (double)c->time_ns[i];
	return sum;
}

void ob_report_count(ob_report *r, const ob_counters *c, bool timed)
{
	bool chosen = r->tolerance > 0;
	r->error_reached = chosen ? c->error : NAN;
	r->substeps_min = quantile(c, 0);
	r->substeps_median = quantile(c, .5);
	r->substeps_max = quantile(c, 1);
	r->islands_redone = c->islands_redone;
	r->islands_over = c->islands_over;
	r->energy_recovered = strcmp(r->arch, "monolith") == 0 ? NAN : c->recovered;
	r->box_tests = c->box_tests;
	r->work_s = timed ? work_of(c) : NAN;
	r->held_s = timed ? 1e-9 * (double)c->held_ns : NAN;
	r->gate_cpu_s = timed ? 1e-9 * (double)c->gate_cpu_ns : NAN;
}

#include "step/verify.h"

#include "base/random.h"
#include "solver/estimate.h"
#include "solver/probe.h"
#include "step/profile.h"

enum { SAMPLED = 8 }; // one in so many island steps
static const uint64_t most_work = UINT64_C(1) << 27; // for an island; some seconds

static bool is_sampled(const ob_island_input *in)
{
	uint64_t key = in->step << 32 | in->object[0].id;
	return ob_splitmix(&key) % SAMPLED == 0;
}

// Bin of an error (m): its power of two.
static uint32_t bin_of(double error)
{
	const int bin = error > 0 ? ilogb(error) - OB_ERROR_LEAST_EXPONENT : 0;
	return bin < 0 ? 0 : bin < OB_ERROR_BINS ? (uint32_t)bin : OB_ERROR_BINS - 1;
}

static void count(ob_sim *s, const ob_motion *before, uint32_t row)
{
	const ob_island_work *w = &s->solver.island;
	ob_counters *c = &s->solver.counters;
	const double *v = w->v[row], radius = w->body[row].radius;
	const double moves = ob_max(ob_surface_speed(before->v, before->w, radius),
				    ob_surface_speed(ob_row_linear(v), ob_row_angular(v), radius));
	double speed;
	const double error = ob_probe_distance(s->verifier, w, row, &speed),
		     second = ob_max(error, ob_min(ob_error_of_time(error, speed, s->settings->step_length, 1), moves));
	c->verified_step[bin_of(error)]++;
	c->verified_second[bin_of(second)]++;
	c->verified_most[0] = ob_max(c->verified_most[0], error);
	c->verified_most[1] = ob_max(c->verified_most[1], second);
}

void ob_verify(ob_sim *s, const ob_island_input *in)
{
	if (!s->verifier || !is_sampled(in))
		return;
	ob_profile_enter(s, OB_PROFILE_VERIFY);
	if (!ob_probe_try(s->verifier, in, OB_VERIFY_SUBSTEPS, most_work)) {
		s->solver.counters.unverified += in->members;
		return;
	}
	ob_probe_compare(s->verifier, &s->solver.island);
	for (uint32_t row = 1; row <= in->members; row++)
		count(s, in->object[row - 1].motion, row);
}

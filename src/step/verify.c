#include "step/verify.h"

#include "base/random.h"
#include "step/probe.h"
#include "step/profile.h"

enum { SAMPLED = 8 }; // one in so many island steps
static const uint64_t most_work = UINT64_C(1) << 27; // for an island; some seconds

static bool is_sampled(const ob_island_input *in)
{
	uint64_t key = in->step << 32 | in->object[0].id;
	return ob_splitmix(&key) % SAMPLED == 0;
}

void ob_verify_solve(ob_sim *s, const ob_island_input *in)
{
	s->verify.sampled = false;
	if (!s->verify.probe || !is_sampled(in))
		return;
	ob_profile_enter(s, OB_PROFILE_VERIFY);
	s->verify.sampled = ob_probe_solve(s->verify.probe, s, in, OB_VERIFY_SUBSTEPS, most_work);
	s->solver.counters.unverified += s->verify.sampled ? 0 : in->members;
}

// Bin of an error (m): its power of two.
static uint32_t bin_of(double error)
{
	const int bin = error > 0 ? ilogb(error) - OB_ERROR_LEAST_EXPONENT : 0;
	return bin < 0 ? 0 : bin < OB_ERROR_BINS ? (uint32_t)bin : OB_ERROR_BINS - 1;
}

void ob_verify_compare(ob_sim *s, uint32_t i, const ob_island_object *object, const ob_state *end)
{
	ob_counters *c = &s->solver.counters;
	double speed;
	if (!s->verify.sampled)
		return;
	// As many steps as a second has, each with this error of place, and of speed for half a second in the mean.
	const double error = ob_probe_distance(s->verify.probe, i, object->passport, end, &speed),
		     second = (error + .5 * speed) / s->settings->step_length;
	c->verified_step[bin_of(error)]++;
	c->verified_second[bin_of(second)]++;
	c->verified_most[0] = ob_max(c->verified_most[0], error);
	c->verified_most[1] = ob_max(c->verified_most[1], second);
}

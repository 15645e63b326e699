#include "free_way.h"

#include <math.h>

#include "base/random.h"
#include "free/free.h"
#include "measure/measure.h"
#include "table/free.h"

// Simulators that solve contacts each for itself, at any rate, lag and delay.
static void draw_own(run *r, uint64_t *seed)
{
	static const double rates[] = { 60, 100, 333, 1000 }, lags[] = { INFINITY, .0005, .01, .05 };
	static const double jitters[] = { 0, .3, .9 };
	r->free.coupling = OB_COUPLING_OWN;
	r->free.update_rate = rates[ob_splitmix(seed) % 4];
	r->free.max_lag = lags[ob_splitmix(seed) % 4];
	r->free.jitter = jitters[ob_splitmix(seed) % 3];
	r->free.delay = ob_splitmix(seed) % 4 ? 0 : .002;
	r->config.run.tolerance = 0;
	r->config.run.sleeping = 0;
	r->config.run.substeps = (uint32_t)fmax(1, rint(480 / r->free.update_rate));
}

static uint64_t seed_of(const life *l)
{
	return l->seed ^ 0xf4ee;
}

static bool has_own_responses(uint64_t *seed)
{
	return ob_splitmix(seed) % 2;
}

bool free_way_repeats(const life *l)
{
	uint64_t seed = seed_of(l);
	return l->closed && !has_own_responses(&seed);
}

void free_way_settings(run *r)
{
	uint64_t seed = seed_of(r->l);
	ob_host_config *c = &r->config;
	r->free = (ob_free_settings){ .update_rate = 1 / c->run.step_length,
				      .max_lag = INFINITY,
				      .pace = INFINITY,
				      .end = LIFE_STEPS / 60.,
				      .seed = seed,
				      .coupling = OB_COUPLING_GROUP };
	if (has_own_responses(&seed))
		draw_own(r, &seed);
	r->free.rate_most = r->free.update_rate;
	c->free = &r->free;
	c->free_window = ob_splitmix(&seed) % 2 ? 0 : .1;
	c->isolation = ob_splitmix(&seed) % 2 ? OB_ISOLATION_PROCESS : OB_ISOLATION_THREAD;
	c->workers = (uint32_t)(ob_splitmix(&seed) % 4); // 0: one for each object
	c->check = c->returns = false;
}

free_sums free_way_measure(run *r)
{
	free_sums s = { .energy = 0 };
	ob_snapshot now = { 0 };
	const ob_universe *u = universe(r);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		ob_motion m;
		ob_passport p;
		if (!ob_universe_get_passport(u, id, &p) || p.flags & OB_OBJECT_PRESCRIBED ||
		    !ob_universe_get_motion(u, id, &m))
			continue;
		s.momentum = ob_madd(s.momentum, p.mass, m.v);
		s.size += p.mass * ob_norm(m.v);
	}
	if (ob_snapshot_take(&now, u, 0, &r->e))
		s.energy = ob_measure_energy(&now, r->config.run.gravity);
	ob_snapshot_finish(&now);
	return s;
}

bool free_way_check(run *r, const free_sums *begin)
{
	const double rounding = 1e-9;
	const free_sums end = free_way_measure(r);
	const double off = ob_norm(ob_sub(end.momentum, begin->momentum));
	if (!free_way_repeats(r->l))
		return true;
	if (off > rounding * (begin->size + end.size)) {
		r->broken = true;
		return ob_fail(&r->e, "momentum is off by %g of %g N s", off, begin->size);
	}
	if (end.energy > (1 + rounding) * begin->energy) {
		r->broken = true;
		return ob_fail(&r->e, "energy grew from %g to %g J", begin->energy, end.energy);
	}
	return true;
}

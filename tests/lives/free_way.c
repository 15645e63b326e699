#include "free_way.h"

#include <math.h>

#include "base/random.h"
#include "free/free.h"
#include "measure/measure.h"
#include "table/free.h"

void free_way_settings(run *r)
{
	static const double rates[] = { 60, 100, 333, 1000 }, lags[] = { INFINITY, .0005, .01, .05 };
	static const double jitters[] = { 0, .3, .9 };
	uint64_t seed = r->l->seed ^ 0xf4ee;
	ob_host_config *c = &r->config;
	r->free = (ob_free_settings){ .update_rate = rates[ob_splitmix(&seed) % 4],
				      .max_lag = lags[ob_splitmix(&seed) % 4],
				      .jitter = jitters[ob_splitmix(&seed) % 3],
				      .delay = ob_splitmix(&seed) % 4 ? 0 : .002,
				      .pace = INFINITY,
				      .end = LIFE_STEPS / 60.,
				      .seed = seed,
				      .coupling = ob_splitmix(&seed) % 3 ? OB_COUPLING_LEDGER : OB_COUPLING_OWN };
	r->free.rate_most = r->free.update_rate;
	c->free = &r->free;
	c->free_window = ob_splitmix(&seed) % 2 ? 0 : .1;
	c->isolation = ob_splitmix(&seed) % 2 ? OB_ISOLATION_PROCESS : OB_ISOLATION_THREAD;
	c->workers = (uint32_t)(ob_splitmix(&seed) % 4); // 0: one for each object
	c->check = c->returns = false;
	c->run.tolerance = 0;
	c->run.sleeping = 0;
	c->run.substeps = (uint32_t)fmax(1, rint(480 / r->free.update_rate));
}

// Impulse, N s, that an account has deposited and its partner has not consumed.
static ob_vec3 under_way(const ob_universe *u, uint32_t id, const ob_account *a)
{
	ob_motion m;
	ob_ledger theirs;
	ob_vec3 sum = ob_v3(a->sum[0], a->sum[1], a->sum[2]);
	if (!ob_free_read_ledger(u, a->partner, &m, &theirs))
		return sum;
	for (uint32_t i = 0; i < theirs.head.accounts; i++) {
		const ob_account *c = &theirs.account[i];
		if (c->partner == id && c->epoch == a->epoch)
			sum = ob_sub(sum, ob_v3(c->sum[0], c->sum[1], c->sum[2]));
	}
	return sum;
}

free_sums free_way_measure(run *r)
{
	free_sums s = { .energy = 0 };
	ob_snapshot now = { 0 };
	const ob_universe *u = universe(r);
	if (r->free.coupling != OB_COUPLING_LEDGER)
		return s;
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		ob_motion m;
		ob_ledger l;
		ob_passport p;
		if (!ob_universe_get_passport(u, id, &p) || !ob_free_read_ledger(u, id, &m, &l))
			continue;
		s.momentum = ob_madd(s.momentum, p.mass, m.v);
		s.size += p.mass * ob_norm(m.v);
		for (uint32_t i = 0; i < l.head.accounts; i++)
			if (l.account[i].partner > id)
				s.momentum = ob_add(s.momentum, under_way(u, id, &l.account[i]));
	}
	if (ob_snapshot_take(&now, u, 0, &r->e))
		s.energy = ob_measure_energy(&now, r->config.run.gravity);
	ob_snapshot_finish(&now);
	return s;
}

bool free_way_check(run *r, const free_sums *begin)
{
	const double rounding = 1e-9, gain = .2; // mail that is late adds energy: the report sums it
	const free_sums end = free_way_measure(r);
	const double off = ob_norm(ob_sub(end.momentum, begin->momentum));
	ob_free_sums sums;
	ob_free_sum(universe(r), &sums);
	const double by_lag = fmax(0, sums.counts.worked - sums.counts.work_seen);
	if (r->free.coupling != OB_COUPLING_LEDGER || !r->l->closed)
		return true;
	if (off > rounding * (begin->size + end.size)) {
		r->broken = true;
		return ob_fail(&r->e, "momentum is off by %g of %g N s", off, begin->size);
	}
	if (end.energy > (1 + gain) * begin->energy + by_lag) {
		r->broken = true;
		return ob_fail(&r->e, "energy grew from %g to %g J, of which %g by the lag", begin->energy, end.energy,
			       by_lag);
	}
	return true;
}

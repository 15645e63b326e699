#include "free/simulator.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "exchange/results.h"
#include "free/neighbours.h"
#include "free/view.h"
#include "motion/flight.h"

bool ob_free_sim_begin(ob_free_sim *s, const ob_universe *u, uint32_t id)
{
	ob_motion next;
	uint32_t *group = s->group ? s->group : malloc(ob_free_groups(u) * sizeof *group);
	ob_free_neighbour *neighbour = s->neighbour;
	const uint32_t max = s->neighbours_max;
	if (!group)
		return false;
	*s = (ob_free_sim){
		.id = id, .group = group, .neighbour = neighbour, .neighbours_max = max, .blocker = OB_NO_OBJECT
	};
	s->present = ob_free_kind_of(u, id, &s->generation) == OB_FREE_SIMULATED &&
		     ob_free_read(u, id, INFINITY, &s->motion, &next);
	if (!s->present)
		return true;
	if (ob_free_settings_of(u)->coupling == OB_COUPLING_LEDGER)
		s->present = ob_free_read_ledger(u, id, &s->motion, &s->ledger);
	ob_free_get_counts(u, id, &s->counts);
	s->anew = true;
	s->time = s->base = s->motion.t0;
	s->random = ob_free_settings_of(u)->seed + 0x632be59bd9b4e019u * (1 + id) + s->counts.updates;
	return true;
}

void ob_free_sim_finish(ob_free_sim *s)
{
	free(s->group);
	free(s->neighbour);
}

// A step ends at the host's boundary if it would end within half a step of it, or beyond.
double ob_free_sim_next(const ob_free_sim *s, const ob_free_scratch *x)
{
	const double h = 1 / x->free->update_rate, until = ob_free_until(x->u) * x->boundary;
	uint64_t random = s->random;
	double next = s->base + (double)(s->since_base + 1) * h;
	if (x->free->jitter > 0)
		next = s->time + h * (1 + x->free->jitter * ob_splitmix_within(&random, -1, 1));
	return until - next < h / 2 ? until : next;
}

// Notes the end of a step that began with this plan.
static void advance_time(ob_free_sim *s, const ob_free_scratch *x, double next)
{
	const bool planned = next == s->base + (double)(s->since_base + 1) / x->free->update_rate;
	ob_splitmix(&s->random);
	s->time = next;
	if (planned)
		s->since_base++;
	else
		s->base = next, s->since_base = 0;
}

bool ob_free_sim_step(ob_free_sim *s, ob_free_scratch *x)
{
	ob_free_planned_step planned;
	const bool replays = ob_free_schedule_replays(x->schedule) && ob_free_schedule_next(x->schedule, &planned);
	const double next = replays ? planned.end : ob_free_sim_next(s, x), h = next - s->time;
	x->sim = s;
	x->run.step_length = h;
	const uint64_t version = ob_universe_get_passport_version(x->u, s->id);
	if (version != s->passport_version) {
		ob_universe_get_passport(x->u, s->id, &s->passport);
		s->hull = ob_hull_of(x->u, &s->passport);
		s->passport_version = version;
	}
	ob_free_neighbours_update(s, x, h);
	ob_motion m;
	ob_free_view_step(s, x, h, &m);
	m.t0 = next;
	m.valid_until = INFINITY;
	m.step = (uint32_t)(s->counts.updates + 1);
	m.island = s->id;
	s->counts.updates++;
	if (x->failed || !ob_state_is_sane(&(ob_state){ { m.p, m.q }, m.v, m.w })) {
		ob_step_fail(x->u, x->failed ? OB_STEP_ENGINE : OB_STEP_DIVERGED, s->id);
		s->failed = true;
		return false;
	}
	s->motion = m;
	const ob_ledger *ledger = x->free->coupling == OB_COUPLING_LEDGER ? &s->ledger : NULL;
	ob_free_schedule_put(x->schedule, x->u, s->id, &m, ledger, s->anew);
	s->anew = false;
	ob_free_publish(x->u, s->id, &m, ledger);
	advance_time(s, x, next);
	ob_free_put_counts(x->u, s->id, &s->counts);
	return true;
}

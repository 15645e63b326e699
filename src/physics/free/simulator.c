#include "free/simulator.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "exchange/results.h"
#include "free/neighbours.h"
#include "free/view.h"
#include "motion/flight.h"
#include "table/trace.h"

bool ob_free_sim_begin(ob_free_sim *s, ob_universe *u, uint32_t id)
{
	ob_motion next;
	ob_free_neighbour *neighbour = s->neighbour;
	const uint32_t max = s->neighbours_max;
	ob_free_end_wait(u, id); // its predecessor may have waited, or flown
	const double time = ob_free_land(u, id, 0, NULL);
	*s = (ob_free_sim){ .id = id, .neighbour = neighbour, .neighbours_max = max, .blocker = OB_NO_OBJECT };
	s->present = ob_free_kind_of(u, id, &s->generation) == OB_FREE_SIMULATED &&
		     ob_free_read(u, id, INFINITY, &s->motion, &next);
	if (!s->present)
		return true;
	ob_free_get_counts(u, id, &s->counts);
	s->rate = ob_free_rate(u, id);
	s->step = INFINITY;
	s->anew = true;
	s->time = s->base = ob_max(s->motion.t0, time);
	s->random = ob_free_settings_of(u)->seed + 0x632be59bd9b4e019u * (1 + id) + s->counts.updates;
	return true;
}

void ob_free_sim_finish(ob_free_sim *s)
{
	free(s->neighbour);
}

// Length (s) of the next step.
static double length_of(const ob_free_sim *s)
{
	const double usual = 1 / s->rate;
	return ob_max(usual / OB_FREE_SHORTEST, ob_min(usual, s->step));
}

// A step ends at the host's boundary if it would end within half a step of it, or beyond.
double ob_free_sim_next(const ob_free_sim *s, const ob_free_scratch *x)
{
	const double h = length_of(s), until = ob_free_until(x->u) * x->boundary;
	uint64_t random = s->random;
	double next = s->base + (double)(s->since_base + 1) / s->rate;
	if (x->free->jitter > 0 || h < 1 / s->rate)
		next = s->time + h * (1 + x->free->jitter * ob_splitmix_within(&random, -1, 1));
	return until - next < h / 2 ? until : next;
}

// Notes the end of a step that began with this plan.
static void advance_time(ob_free_sim *s, double next)
{
	const bool planned = next == s->base + (double)(s->since_base + 1) / s->rate;
	ob_splitmix(&s->random);
	s->time = next;
	if (planned)
		s->since_base++;
	else
		s->base = next, s->since_base = 0;
}

// As many substeps in a second as the run has at its own rate, and one at least. h (s): length of the step.
static uint32_t substeps_of(const ob_free_scratch *x, double h)
{
	const double n = rint(x->substeps * x->free->update_rate * h);
	return n > 1 ? (uint32_t)ob_min(n, OB_MAX_SUBSTEPS) : 1;
}

// True if the object flies on until `next` as published, and so do all that are near.
static bool flies_on(const ob_free_sim *s, const ob_free_scratch *x, double next)
{
	bool flies = s->flies && next <= s->covered;
	for (uint32_t i = 0; flies && i < s->neighbours; i++) {
		const ob_free_neighbour *n = &s->neighbour[i];
		flies = next <= n->apart &&
			(n->kind != OB_FREE_SIMULATED || ob_free_version(x->u, n->id) == n->version);
	}
	return flies;
}

// Own time, s, until which the object flies as published, if nothing near changes. It steps again before it may touch one
// that moves, so that both have short steps by then.
static double flies_until(const ob_free_sim *s, const ob_free_scratch *x)
{
	double until = s->covered;
	for (uint32_t i = 0; i < s->neighbours; i++) {
		const ob_free_neighbour *n = &s->neighbour[i];
		until = ob_min(until, n->kind == OB_FREE_SIMULATED ? ob_free_approach(s, x, n) : n->apart);
	}
	return until;
}

static const double least_flight =
	4; // steps: a shorter one, as of a box that hops on another, costs more than it saves

// Lets the object fly until something may happen to it, if that is some steps ahead. A neighbour
// that changes lowers that time.
static bool take_off(ob_free_sim *s, ob_free_scratch *x)
{
	const double holds = s->flies && !x->schedule ? flies_until(s, x) : 0;
	if (!(holds > s->time + least_flight / s->rate) || !flies_on(s, x, holds))
		return false;
	ob_free_take_off(x->u, s->id, holds);
	s->aloft = true;
	if (flies_on(s, x, holds) && ob_free_boxes_are_current(&x->boxes, x->u))
		ob_free_sim_look(s, x->u);
	else
		ob_free_lower(x->u, s->id, s->time); // something has changed meanwhile: it looks again
	return true;
}

void ob_free_sim_look(ob_free_sim *s, const ob_universe *u)
{
	if (s->aloft)
		s->time = ob_free_holds(u, s->id);
}

// Ends a flight. false: at the host's boundary, or so close to it that no step fits in between.
static bool land(ob_free_sim *s, ob_free_scratch *x)
{
	if (!s->aloft)
		return true;
	s->aloft = false;
	s->time = s->base = ob_free_land(x->u, s->id, .5 / (OB_FREE_SHORTEST * s->rate), &s->counts);
	s->since_base = 0;
	return s->time < ob_free_until(x->u) * x->boundary;
}

// Publishes the state at the simulator's time, up to which it has flown.
static void end_flight(ob_free_sim *s, ob_free_scratch *x)
{
	ob_motion *m = &s->motion;
	const ob_state now = ob_motion_at(m, s->passport.inertia, s->time);
	m->path += ob_norm(now.v) * (s->time - m->t0);
	m->p = now.pose.p, m->q = now.pose.q, m->v = now.v, m->w = now.w;
	m->t0 = s->time;
	ob_free_publish(x->u, s->id, m);
}

bool ob_free_sim_step(ob_free_sim *s, ob_free_scratch *x)
{
	ob_free_planned_step planned;
	if (!land(s, x))
		return true;
	const bool replays = ob_free_schedule_replays(x->schedule) && ob_free_schedule_next(x->schedule, &planned);
	const double next = replays ? planned.end : ob_free_sim_next(s, x), h = next - s->time;
	x->sim = s;
	x->run.step_length = h;
	x->run.substeps = substeps_of(x, h);
	const uint64_t version = ob_universe_get_passport_version(x->u, s->id);
	if (version != s->passport_version) {
		const double friction = s->passport.friction;
		s->flies = false;
		ob_universe_get_passport(x->u, s->id, &s->passport);
		s->hull = ob_hull_of(x->u, &s->passport);
		s->passport_version = version;
		for (uint32_t i = 0; i < s->neighbours && s->passport.friction != friction; i++)
			s->neighbour[i].contact.kept = 0;
	}
	ob_free_neighbours_update(s, x, h);
	ob_free_put_counts(x->u, s->id, &s->counts);
	if (take_off(s, x))
		return true;
	if (s->time > s->motion.t0)
		end_flight(s, x);
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
	if (ob_universe_traced(x->u))
		ob_trace_moves(x->u, x->worker, s->id, s->motion.flags, m.flags);
	s->motion = m;
	s->flies = m.flags & OB_MOTION_FREE && x->near == 0;
	ob_free_schedule_put(x->schedule, x->u, s->id, &m, s->anew);
	s->anew = false;
	ob_free_publish(x->u, s->id, &m);
	advance_time(s, next);
	ob_free_put_counts(x->u, s->id, &s->counts);
	take_off(s, x);
	return true;
}

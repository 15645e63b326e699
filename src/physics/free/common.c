// The host's part: objects that come and go, and the common time.
//
//   own times       a ──────────────────●        slots hold the states at the newest boundary that all have passed;
//                   b ───────────●               readers of the universe see those, as in lockstep
//                   c ──────────────●
//   boundaries      |     |     |     |     |
//                             common
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "free/free.h"
#include "free/view.h"
#include "motion/flight.h"
#include "table/group.h"
#include "table/home.h"

static const double window_seconds =
	1.25; // simulators may be ahead of the common time by so much, unless memory is short
static const double instant = 1e-9; // s: times closer than this are the same
static const uint64_t history_bytes = 512 << 20; // B, all versions together

// Versions in a second, Hz, that a simulator may publish.
static double most_rate(const ob_free_settings *f, double step)
{
	return OB_FREE_SHORTEST * f->rate_most * (1 + f->jitter) + 1 / step;
}

uint32_t ob_free_plan_depth(const ob_free_settings *f, double step, uint32_t capacity)
{
	enum { LEAST = 8, MOST = 1 << 15, GROUPED = 16 };
	const double rate = most_rate(f, step), lag = isinf(f->max_lag) ? 0 : f->max_lag,
		     fits = (double)history_bytes / ((double)capacity * sizeof(ob_motion)),
		     least = LEAST + ceil(rate * (f->delay + lag + 4 * step)),
		     window = ob_free_lead(f, step) > 0 ? 0 : window_seconds,
		     depth = ob_max(least, ob_min(fits, ceil(rate * (window + f->delay + lag))));
	return f->coupling == OB_COUPLING_GROUP ? GROUPED : (uint32_t)ob_min(MOST, depth);
}

uint64_t ob_free_window(const ob_universe *u)
{
	enum { SLACK = 4, BOUNDED = 2 };
	const ob_free_settings *f = ob_free_settings_of(u);
	const double step = ob_universe_settings(u)->step_length, rate = most_rate(f, step),
		     steps = floor((ob_free_depth(u) - SLACK) / (rate * step)) - 1;
	if (ob_group_is(u))
		return ob_free_depth(u) - SLACK;
	if (ob_free_lead(f, step) > 0 && steps > BOUNDED)
		return BOUNDED;
	return steps < 1 ? 1 : (uint64_t)steps;
}

static ob_free_kind kind_of(const ob_passport *p)
{
	return !(p->flags & OB_OBJECT_PRESENT)   ? OB_FREE_ABSENT
	       : p->flags & OB_OBJECT_PRESCRIBED ? OB_FREE_PRESCRIBED
						 : OB_FREE_SIMULATED;
}

// The motion that goes on from this state of m, at t.
static ob_motion motion_from(const ob_motion *m, const ob_state *state, double t)
{
	return (ob_motion){ .t0 = t,
			    .valid_until = INFINITY,
			    .p = state->pose.p,
			    .q = state->pose.q,
			    .v = state->v,
			    .w = state->w,
			    .a = m->a,
			    .path = m->path };
}

void ob_free_enter_objects(ob_universe *u)
{
	const double now = (double)ob_step_count(u) * ob_universe_settings(u)->step_length;
	uint64_t passports = 0;
	bool changed = false;
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		ob_passport p;
		ob_motion m;
		uint32_t generation;
		const ob_free_kind known = ob_free_kind_of(u, id, &generation);
		const uint64_t version = ob_universe_get_passport_version(u, id);
		passports += version;
		if (!version || !ob_universe_get_passport(u, id, &p))
			p = (ob_passport){ 0 };
		const ob_free_kind kind = kind_of(&p);
		if (kind == known && (kind == OB_FREE_ABSENT || generation == p.generation) &&
		    !(p.flags & OB_OBJECT_KINEMATIC))
			continue;
		changed = true;
		if (kind == OB_FREE_SIMULATED) {
			if (!ob_universe_get_motion(u, id, &m))
				continue;
			const ob_state state = ob_motion_at(&m, p.inertia, now);
			m = motion_from(&m, &state, now);
			m.flags = OB_MOTION_FREE;
			ob_home_set(u, id, ob_free_worker_of(u, id));
		}
		if (kind == OB_FREE_SIMULATED && ob_group_is(u))
			ob_group_enter(u, id, ob_free_worker_of(u, id), ob_newest_motion(u, id));
		ob_free_enter(u, id, kind, p.generation, &m);
	}
	if (changed || passports != ob_free_passports(u))
		ob_free_note_entered(u, passports);
}

// ---- the common time

// True if all simulators have passed a time, at once: unless a flight was lowered meanwhile, each time that was read is still
// passed at the end.
static bool all_passed(const ob_universe *u, double t)
{
	const uint64_t lowerings = ob_free_lowerings(u);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++)
		if (ob_free_kind_of(u, id, NULL) == OB_FREE_SIMULATED && ob_free_time(u, id) < t - instant)
			return false;
	return lowerings == ob_free_lowerings(u);
}

// Shows an object's state at a boundary in its slot.
static void show(ob_universe *u, uint32_t id, uint64_t step, double t)
{
	ob_motion m, next;
	ob_passport p;
	if (!ob_free_read(u, id, t + instant, &m, &next) || !ob_universe_get_passport(u, id, &p))
		return;
	const ob_state state = fabs(m.t0 - t) <= instant ? (ob_state){ { m.p, m.q }, m.v, m.w }
							 : ob_free_state_at(&m, &next, p.inertia, t);
	ob_motion shown = motion_from(&m, &state, t);
	shown.step = (uint32_t)step;
	shown.island = id;
	shown.flags = m.flags & OB_MOTION_FREE;
	ob_publish_motion(u, id, &shown);
}

// Steps that all bodies of a run in groups have made, `until` at most.
static uint64_t steps_made(const ob_universe *u, uint64_t until)
{
	uint64_t least = until;
	for (uint32_t id = 0; id < ob_universe_ids(u) && least > ob_step_count(u); id++)
		if (ob_free_kind_of(u, id, NULL) == OB_FREE_SIMULATED)
			least = ob_group_step(u, id) < least ? ob_group_step(u, id) : least;
	return least;
}

// The same of a run in groups: versions are motions as lockstep publishes them, so the newest is shown, if it is another one.
static uint64_t complete_groups(ob_universe *u, uint64_t until)
{
	const uint64_t made = steps_made(u, until);
	uint32_t simulated = 0;
	if (made <= ob_step_count(u))
		return ob_step_count(u);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		ob_motion m;
		if (ob_free_kind_of(u, id, NULL) != OB_FREE_SIMULATED)
			continue;
		simulated++;
		if (ob_free_version(u, id) != ob_motion_version(u, id) &&
		    ob_group_read(u, id, (uint32_t)made, &m, NULL) && memcmp(&m, ob_newest_motion(u, id), sizeof m))
			ob_publish_motion(u, id, &m);
	}
	while (ob_step_count(u) < made)
		ob_step_complete(u, simulated, 0, 0);
	return made;
}

uint64_t ob_free_complete(ob_universe *u, uint64_t until)
{
	if (ob_group_is(u))
		return complete_groups(u, until);
	const double length = ob_universe_settings(u)->step_length;
	for (uint64_t step = ob_step_count(u) + 1; step <= until; step++) {
		const double t = (double)step * length;
		uint32_t simulated = 0;
		if (!all_passed(u, t))
			break;
		for (uint32_t id = 0; id < ob_universe_ids(u); id++)
			if (ob_free_kind_of(u, id, NULL) == OB_FREE_SIMULATED)
				show(u, id, step, t), simulated++;
		ob_step_complete(u, simulated, 0, 0);
	}
	return ob_step_count(u);
}

// True if the simulator of an object waits for a neighbour that is behind: never the earliest of all.
static bool waits(const ob_universe *u, uint32_t id)
{
	uint32_t blocker;
	return ob_free_blocker(u, id, &blocker) && ob_free_kind_of(u, blocker, NULL) == OB_FREE_SIMULATED &&
	       ob_free_time(u, blocker) < ob_free_time(u, id);
}

// Finds the part of each worker in a run in groups.
static void find_parts_of_groups(const ob_universe *u, unsigned char *part, uint64_t next)
{
	uint32_t other;
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		if (ob_free_kind_of(u, id, NULL) != OB_FREE_SIMULATED || ob_group_step(u, id) >= next ||
		    ob_free_due_ns(u, ob_free_time(u, id)) > ob_clock_ns())
			continue;
		const uint32_t w = ob_group_place_of(u, id).worker;
		part[w] = ob_group_blocker(u, w, &other) ? OB_FREE_WAITS : OB_FREE_HOLDS;
	}
}

void ob_free_find_parts(const ob_universe *u, unsigned char *part)
{
	const uint64_t next = ob_step_count(u) + 1, until = ob_free_until(u), now = ob_clock_ns();
	const double t = (double)(next < until ? next : until) * ob_universe_settings(u)->step_length - instant;
	memset(part, OB_FREE_DONE, ob_universe_workers(u));
	if (ob_group_is(u)) {
		find_parts_of_groups(u, part, next < until ? next : until);
		return;
	}
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		if (ob_free_kind_of(u, id, NULL) != OB_FREE_SIMULATED || ob_free_time(u, id) >= t ||
		    ob_free_due_ns(u, ob_free_time(u, id)) > now)
			continue;
		unsigned char *its = &part[ob_free_worker_of(u, id)];
		if (waits(u, id)) // it waits for one at a time, when none of its simulators may step
			*its = OB_FREE_WAITS;
		else if (*its == OB_FREE_DONE)
			*its = OB_FREE_HOLDS;
	}
}

void ob_free_sum(const ob_universe *u, ob_free_sums *out)
{
	*out = (ob_free_sums){ .least_time = INFINITY };
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		ob_free_counts c;
		if (ob_free_kind_of(u, id, NULL) != OB_FREE_SIMULATED)
			continue;
		ob_free_get_counts(u, id, &c);
		out->objects++;
		out->counts.updates += c.updates;
		out->counts.solved += c.solved;
		out->counts.waits += c.waits;
		out->counts.wait_ns += c.wait_ns;
		out->counts.late += c.late;
		out->counts.readings += c.readings;
		out->counts.lag_ns += c.lag_ns;
		out->counts.lag_most_ns =
			c.lag_most_ns > out->counts.lag_most_ns ? c.lag_most_ns : out->counts.lag_most_ns;
		out->least_time = ob_min(out->least_time, ob_free_time(u, id));
		out->most_time = ob_max(out->most_time, ob_free_time(u, id));
	}
	for (uint32_t w = 0; ob_group_is(u) && w < ob_universe_workers(u); w++)
		ob_group_count(u, w, &out->counts.updates, &out->counts.waits);
}

#include "sim/island.h"

#include <stdlib.h>

#include "sim/broadphase.h"
#include "sim/calm.h"
#include "sim/exchange.h"
#include "sim/flight.h"
#include "sim/ghost.h"
#include "sim/members.h"
#include "sim/pace.h"
#include "sim/profile.h"
#include "sim/tolerance.h"
#include "sim/touch.h"

// Who touches whom now? true if that may have changed.
static bool look(ob_sim *s)
{
	ob_profile_enter(s, OB_PROFILE_NARROWPHASE);
	bool any = ob_contacts_update(s, s->island.h);
	ob_contacts_prepare(s);
	ob_bodies_warm_start(s);
	return any;
}

// A substep or one stride of it, in the order in which things happen.
static void make_stride(ob_sim *s, bool first)
{
	look(s);
	ob_error_control_note_depth(s, first);
	ob_adaptive_end_at_rebound(s);
	// What flies off may hit something that was out of reach before; a rattle is left to the contact solver in the
	// end.
	ob_profile_enter(s, OB_PROFILE_IMPACTS);
	for (int again = 0; again < 4 && ob_solver_impacts(s); again++) {
		ob_bodies_update_speed_bounds(s);
		ob_ghosts_follow(s);
		if (!look(s))
			break;
		ob_profile_enter(s, OB_PROFILE_IMPACTS);
	}
	ob_adaptive_end_at_rebound(s);
	ob_error_control_note_bounce(s);
	ob_profile_enter(s, OB_PROFILE_MOVE);
	ob_bodies_gyroscopic_step(s);
	ob_ghosts_follow(s);
	do {
		ob_profile_enter(s, OB_PROFILE_MOVE);
		ob_bodies_predict_velocities(s);
		ob_profile_enter(s, OB_PROFILE_SOLVE);
		ob_solver_iterate(s);
		ob_profile_enter(s, OB_PROFILE_MOVE);
	} while (ob_adaptive_shorten(s));
	ob_bodies_integrate_positions(s);
	ob_error_control_note_slip(s);
	ob_solver_limit_prediction(s);
	ob_ghosts_follow(s);
	ob_profile_enter(s, OB_PROFILE_PROJECT);
	ob_solver_project_positions(s);
}

static void substep(ob_sim *s, bool first)
{
	for (double left = s->island.substep; left > 0; left -= s->island.h) {
		ob_profile_enter(s, OB_PROFILE_NARROWPHASE);
		ob_ghosts_follow(s);
		ob_adaptive_begin(s, left);
		make_stride(s, first);
		first = false;
	}
}

// The whole step on a private copy, from what is published. true: the solution stands.
static bool solve(ob_sim *s, const ob_island *is)
{
	ob_island_work *w = &s->island;
	ob_profile_enter(s, OB_PROFILE_LOAD);
	ob_bodies_load(s, is);
	ob_contacts_load(s, is);
	ob_direct_begin(&s->island.forest);
	s->counters.body_substeps += (uint64_t)is->members * w->substeps;
	for (uint32_t k = 0; k < w->substeps; k++)
		substep(s, k == 0);
	ob_profile_enter(s, OB_PROFILE_NARROWPHASE);
	for (uint32_t row = 1; row <= w->members; row++)
		ob_body_update_pose(w, row);
	return ob_error_control_accept(s);
}

// One substep, where that is enough.
static bool solve_calm(ob_sim *s, const ob_island *is)
{
	const uint32_t substeps = s->island.substeps;
	if (!ob_equilibrium_likely(s, is))
		return false;
	s->island.substeps = 1;
	if (solve(s, is) && ob_equilibrium_confirmed(&s->island))
		return true;
	s->island.substeps = substeps;
	return false;
}

// In exchanges of a pair; a collision test costs as much as a few.
static uint64_t cost_so_far(const ob_sim *s)
{
	enum { OF_A_LOOK = 4 };
	return s->counters.pair_solves + OF_A_LOOK * s->counters.narrowphase_tests;
}

// For the arranger, so that what costs much is begun first.
static void note_effort(ob_sim *s, const ob_island *is, uint64_t cost)
{
	enum { MOST = 1 << 16 }; // so that sums stay within bounds
	ob_step_data *ex = ob_universe_step_data(s->u);
	uint64_t share = cost / is->members;
	for (uint32_t i = 0; i < is->members; i++)
		ex->effort[ex->member[is->first_member + i]] = (uint32_t)(share < MOST ? share : MOST);
}

// Did the pair's contact hold anything up when the step before ended?
static bool pressed(const ob_universe *u, const ob_pair_key *k)
{
	const ob_pair_state *p = ob_pair_before(&ob_universe_step_data(u)->record[k->record], ob_step_count(u));
	double sum = 0;
	for (uint32_t j = 0; p && j < p->points; j++)
		sum += p->impulse[j];
	return sum > 0;
}

// Alone, and near nothing but planes, on which it does not stand: what hops so low that the contact solver has it still
// goes on as a flight; what has grown slow is left to come to rest. What has met something in this step is not alone.
static bool may_leap(const ob_universe *u, const ob_island *is)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	const uint32_t id = ex->member[is->first_member];
	if (is->members > 1 ||
	    (is->pairs && (ex->count->merged || ob_universe_settings(u)->integrator == OB_INTEGRATOR_ODE)))
		return false;
	for (uint32_t i = 0; i < is->pairs; i++) {
		const ob_pair_key *k = &ex->pair[ex->island_pair[is->first_pair + i]];
		uint32_t other = k->a == id ? k->b : k->a;
		if (ex->schedule[other].state != OB_SCHEDULE_PLANE ||
		    (k->active && (ob_newest_motion(u, id)->rest_time > 0 || pressed(u, k))))
			return false;
	}
	return true;
}

// Its contacts end, and the next solver looks at them anew.
static void leave_contacts(const ob_universe *u, const ob_island *is)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	for (uint32_t i = 0; i < is->pairs; i++) {
		ob_pair_key *k = &ex->pair[ex->island_pair[is->first_pair + i]];
		if (k->active)
			k->active = 0, k->limit = -INFINITY;
	}
}

// The island's rest, as a flag of its members' motions; 0: it goes on.
static uint32_t rest_of(ob_sim *s)
{
	bool slow = ob_bodies_update_rest(s), still = ob_equilibrium_reached(&s->island);
	if (slow || (still && ob_universe_settings(s->u)->sleeping))
		return OB_MOTION_ASLEEP;
	return still ? OB_MOTION_EQUILIBRIUM : 0;
}

void ob_island_solve(ob_sim *s, uint32_t i)
{
	const ob_island *is = &ob_universe_step_data(s->u)->island[i];
	if (may_leap(s->u, is)) {
		ob_profile_enter(s, OB_PROFILE_BALLISTIC);
		if (ob_ballistic_advance(s, ob_universe_step_data(s->u)->member[is->first_member])) {
			leave_contacts(s->u, is);
			s->counters.ballistic_advances++;
			return;
		}
	}
	const uint64_t before = cost_so_far(s);
	s->island.substeps = ob_error_control_substeps(s, is);
	if (!solve_calm(s, is))
		while (!solve(s, is))
			s->counters.islands_redone++;
	ob_profile_enter(s, OB_PROFILE_LOAD);
	s->counters.island_steps++;
	s->counters.recovered += s->island.recovered;
	s->counters.body_steps += is->members;
	note_effort(s, is, cost_so_far(s) - before);
	ob_contacts_store(s);
	ob_profile_enter(s, OB_PROFILE_PUBLISH);
	ob_bodies_publish(s, rest_of(s));
}

void ob_island_work_finish(ob_island_work *w)
{
	free(w->member);
	free(w->v);
	free(w->dv);
	free(w->u);
	free(w->d);
	free(w->delta);
	free(w->drift);
	free(w->touch);
	free(w->adjacency);
	free(w->batch);
	free(w->batch_colour);
	free(w->batch_open);
	free(w->batch_due);
	free(w->batch_order);
	free(w->row_of);
	free(w->history);
	ob_direct_finish(&w->forest);
}

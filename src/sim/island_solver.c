#include "sim/island_solver.h"

#include <stdlib.h>

#include "sim/adaptive_substep.h"
#include "sim/balance.h"
#include "sim/bodies.h"
#include "sim/broadphase.h"
#include "sim/budget.h"
#include "sim/conjugate.h"
#include "sim/contact_solver.h"
#include "sim/contacts.h"
#include "sim/direct_solver.h"
#include "sim/equilibrium.h"
#include "sim/error_control.h"
#include "sim/flight.h"
#include "sim/frame.h"
#include "sim/ghost.h"
#include "sim/impacts.h"
#include "sim/midpoint.h"
#include "sim/pairs.h"
#include "sim/profile.h"
#include "sim/push_apart.h"
#include "sim/results.h"
#include "sim/surfaces.h"
#include "sim/touches.h"

enum { MAX_IMPACT_ROUNDS = 4 }; // maximum in a partial substep; a body that rattles faster is left to the contact
				// solver

// Updates contacts to the present poses, and predicts the velocities that follow from the last impulses.
static void update_contacts(ob_sim *s)
{
	ob_profile_enter(s, OB_PROFILE_NARROWPHASE);
	ob_contacts_update(s, s->island.h);
	ob_contacts_prepare(s);
	ob_bodies_warm_start(s);
}

// The same for bodies that were hit. true: their contacts may have changed.
static bool update_hit_contacts(ob_sim *s)
{
	ob_profile_enter(s, OB_PROFILE_NARROWPHASE);
	bool changed = ob_contacts_update_hit(s, s->island.h);
	ob_contacts_prepare(s);
	ob_bodies_warm_start(s);
	return changed;
}

// Solves impacts at their instants, in rounds: a body that leaves may hit another that was out of reach before.
static void resolve_impacts(ob_sim *s)
{
	ob_profile_enter(s, OB_PROFILE_IMPACTS);
	for (int round = 0; round < MAX_IMPACT_ROUNDS && ob_impacts_resolve(s, round == 0); round++) {
		ob_bodies_update_speed_bounds(s);
		ob_ghosts_follow(s);
		if (!update_hit_contacts(s))
			break;
		ob_profile_enter(s, OB_PROFILE_IMPACTS);
	}
}

// Solves for the velocities at the partial substep's end, u, such that no contact is violated. Shortens the partial
// substep where a body that was hit is now too fast for its length.
static void solve_velocities(ob_sim *s)
{
	do {
		ob_profile_enter(s, OB_PROFILE_MOVE);
		ob_bodies_predict_velocities(s);
		ob_profile_enter(s, OB_PROFILE_SOLVE);
		ob_solver_iterate(s);
		ob_profile_enter(s, OB_PROFILE_MOVE);
	} while (ob_adaptive_shorten(s));
}

// Solves a substep, or a part of one: the table of contents of an island's step, in the order in which things happen.
static void solve_partial_substep(ob_sim *s, double left, bool first_of_step)
{
	enum { WORK_OF_BODY = 24, WORK_OF_CONTACT = 8 }; // in addition to its tests and solves
	ob_budget_note(s, WORK_OF_BODY * s->island.rows + WORK_OF_CONTACT * s->island.contacts);
	ob_profile_enter(s, OB_PROFILE_NARROWPHASE);
	ob_ghosts_follow(s);
	ob_adaptive_begin(s, left);
	ob_surfaces_renew_contacts(s);
	ob_impacts_begin(s);
	ob_midpoint_mark(s);
	update_contacts(s);
	ob_error_control_note_depth(s, first_of_step);
	resolve_impacts(s);
	ob_error_control_note_bounce(s);
	ob_midpoint_begin(s);
	solve_velocities(s);
	ob_touches_note_solved(s);
	ob_bodies_integrate_positions(s);
	ob_error_control_note_slip(s);
	ob_midpoint_end(s);
	ob_solver_limit_prediction(s);
	ob_ghosts_follow(s);
	ob_profile_enter(s, OB_PROFILE_PROJECT);
	ob_push_apart(s);
}

// Solves the whole step on a private copy of the published state. true: the solution's error is tolerable.
static bool solve_step(ob_sim *s, const ob_island *is)
{
	ob_island_work *w = &s->island;
	const double refined = (double)w->substeps / s->settings->substeps;
	w->coarseness = ob_max(1, w->run_coarseness / ob_max(1, refined));
	ob_profile_enter(s, OB_PROFILE_LOAD);
	ob_touches_begin(s, is);
	ob_bodies_load(s, is);
	ob_frame_enter(s, is);
	ob_contacts_load(s, is);
	ob_direct_begin(&w->direct);
	s->counters.body_substeps += (uint64_t)is->members * w->substeps;
	for (uint32_t k = 0; k < w->substeps; k++) {
		bool first = k == 0;
		for (double left = w->substep; left > 0 && !ob_budget_spent(s); left -= w->h, first = false)
			solve_partial_substep(s, left, first);
	}
	ob_profile_enter(s, OB_PROFILE_NARROWPHASE);
	for (uint32_t row = 1; row <= w->bodies; row++)
		ob_body_update_pose(w, row);
	return ob_error_control_accept(s) || ob_budget_spent(s);
}

// Solves one substep, where that suffices. false: the island is not in equilibrium.
static bool solve_equilibrium(ob_sim *s, const ob_island *is)
{
	const uint32_t substeps = s->island.substeps;
	if (!ob_equilibrium_likely(s, is))
		return false;
	s->island.substeps = 1;
	if (solve_step(s, is) && ob_equilibrium_confirmed(&s->island))
		return true;
	s->island.substeps = substeps;
	return false;
}

// ---- cost

// Returns the cost in solves of a pair; a collision test costs as much as a few.
static uint64_t cost_so_far(const ob_sim *s)
{
	enum { OF_A_TEST = 4 };
	return s->counters.pair_solves + OF_A_TEST * s->counters.narrowphase_tests;
}

// Notes each member's share of the cost, by which the scheduler begins expensive islands first.
static void note_effort(ob_sim *s, uint32_t island, uint64_t cost)
{
	const uint64_t share = cost / s->data->island[island].members;
	ob_commit_effort(s, island, (uint32_t)(share < UINT32_MAX ? share : UINT32_MAX));
}

// ---- ballistic advance

// True for a body near planes only, or two near each other and planes, with no resting contact, and no late contact in
// this step: a ballistic advance may suffice. A body that the contact solver has had as it bounced low goes on in
// flight; one that has become slow is left to come to rest.
static bool may_advance_ballistically(const ob_sim *s, const ob_island *is)
{
	const ob_step_data *data = s->data;
	const uint32_t *id = data->member + is->first_member;
	if (is->members > 2 || (is->pairs && (data->count->merged || s->settings->integrator == OB_INTEGRATOR_ODE)))
		return false;
	for (uint32_t i = 0; data->script_of && i < is->members; i++)
		if (ob_norm2(ob_script_torque(data, id[i])) > 0)
			return false;
	for (uint32_t i = 0; i < is->pairs; i++) {
		const ob_pair_key *k = &data->pair[data->island_pair[is->first_pair + i]];
		const bool a = data->schedule[k->a].state == OB_SCHEDULE_PLANE,
			   b = data->schedule[k->b].state == OB_SCHEDULE_PLANE;
		const bool met = data->result_island[k->a] == data->result_island[k->b];
		if ((!a && !b && !met) || (k->active && (ob_newest_motion(s->u, a ? k->b : k->a)->rest_time > 0 ||
							 ob_pair_carried_load(s->u, k))))
			return false;
	}
	return true;
}

// Ends the island's contacts; the next solver tests their geometry anew.
static void end_contacts(ob_sim *s, const ob_island *is)
{
	for (uint32_t i = 0; i < is->pairs; i++) {
		const uint32_t pair = s->data->island_pair[is->first_pair + i];
		if (s->data->pair[pair].active)
			ob_commit_contact(s, &(ob_found_contact){ .pair = pair, .limit = -INFINITY });
	}
}

static bool advance_pair(ob_sim *s, const ob_island *is)
{
	if (is->members != 2 || !may_advance_ballistically(s, is))
		return false;
	ob_profile_enter(s, OB_PROFILE_BALLISTIC);
	ob_touches_begin(s, is);
	if (!ob_ballistic_pair_advance(s, s->data->member + is->first_member))
		return false;
	end_contacts(s, is);
	s->counters.ballistic_advances += is->members;
	return true;
}

void ob_islands_fly(ob_sim *s, uint32_t first, uint32_t n, bool *flown)
{
	const ob_step_data *data = s->data;
	uint32_t lone[OB_ISLANDS_ABREAST], id[OB_ISLANDS_ABREAST], fly = 0;
	bool done[OB_ISLANDS_ABREAST];
	ob_budget_begin_share(s, data->member[data->island[first].first_member]);
	ob_profile_enter(s, OB_PROFILE_BALLISTIC);
	for (uint32_t k = 0; k < n; k++) {
		const ob_island *is = &data->island[first + k];
		flown[k] = false;
		if (is->members != 1 || !may_advance_ballistically(s, is))
			continue;
		ob_touches_begin(s, is);
		lone[fly] = k, id[fly++] = data->member[is->first_member];
	}
	ob_ballistic_advance(s, id, fly, done);
	for (uint32_t i = 0; i < fly; i++)
		if ((flown[lone[i]] = done[i])) {
			end_contacts(s, &data->island[first + lone[i]]);
			s->counters.ballistic_advances++;
		}
}

// ---- the step

// Returns the island's state of rest, as a flag of its bodies' motions; 0: it moves.
static uint32_t rest_flag(ob_sim *s)
{
	const double rest_time = ob_bodies_update_rest(s);
	if (s->island.torques || ob_norm2(s->island.frame) > 0 ||
	    ob_surfaces_carry_any(&s->island)) // equilibrium and sleep test forces alone
		return 0;
	if (ob_equilibrium_reached(&s->island))
		return s->settings->sleeping ? OB_MOTION_ASLEEP : OB_MOTION_EQUILIBRIUM;
	return ob_balance_may_sleep(s, rest_time) ? OB_MOTION_ASLEEP : 0;
}

void ob_island_solve(ob_sim *s, uint32_t i)
{
	const ob_island *is = &s->data->island[i];
	ob_budget_begin_share(s, s->data->member[is->first_member]);
	if (advance_pair(s, is))
		return;
	const uint64_t before = cost_so_far(s);
	s->island.in_field = false;
	s->island.substeps = ob_error_control_substeps(s, is);
	if (!solve_equilibrium(s, is))
		while (!solve_step(s, is))
			s->counters.islands_redone++;
	ob_profile_enter(s, OB_PROFILE_LOAD);
	s->counters.island_steps++;
	s->counters.recovered += s->island.recovered;
	s->counters.body_steps += is->members;
	note_effort(s, i, cost_so_far(s) - before);
	ob_frame_leave(s);
	const uint32_t rest = rest_flag(s);
	ob_contacts_store(s);
	ob_profile_enter(s, OB_PROFILE_PUBLISH);
	ob_bodies_publish(s, rest);
}

void ob_island_work_finish(ob_island_work *w)
{
	free(w->body);
	free(w->v);
	free(w->dv);
	free(w->u);
	free(w->d);
	free(w->delta);
	free(w->drift);
	free(w->contact);
	free(w->contact_lane);
	free(w->adjacency);
	free(w->contact_key);
	free(w->contact_order);
	free(w->batch);
	free(w->batch_colour);
	free(w->next_open_batch);
	free(w->batch_due);
	free(w->batch_order);
	free(w->row_of);
	free(w->history);
	ob_direct_finish(&w->direct);
	ob_conjugate_finish(&w->conjugate);
	ob_impacts_finish(&w->impacts);
	ob_surfaces_finish(&w->surfaces);
}

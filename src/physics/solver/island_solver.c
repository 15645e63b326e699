// The step of an island, in the order in which things happen: solve_partial_substep is its table of contents.
#include "solver/island_solver.h"

#include <stdlib.h>

#include "solver/adaptive_substep.h"
#include "solver/balance.h"
#include "solver/bodies.h"
#include "solver/budget.h"
#include "solver/conjugate.h"
#include "solver/contact_solver.h"
#include "solver/contacts.h"
#include "solver/direct_solver.h"
#include "solver/equilibrium.h"
#include "solver/error_control.h"
#include "solver/frame.h"
#include "solver/impacts.h"
#include "solver/joint_load.h"
#include "solver/joint_rows.h"
#include "solver/joints.h"
#include "solver/methods.h"
#include "solver/midpoint.h"
#include "solver/push_apart.h"
#include "solver/surfaces.h"
#include "solver/touches.h"

enum { MAX_IMPACT_ROUNDS = 4 }; // in a partial substep; a body that rattles faster is left to the contact solver

// Updates contacts to the present poses, and predicts the velocities that follow from the last impulses.
static void update_contacts(ob_solver *s)
{
	ob_solver_enter(s, OB_PROFILE_NARROWPHASE);
	ob_contacts_update(s, s->island.h);
	ob_contacts_prepare(s);
	ob_bodies_warm_start(s);
}

// The same for bodies that were hit. true: their contacts may have changed.
static bool update_hit_contacts(ob_solver *s)
{
	ob_solver_enter(s, OB_PROFILE_NARROWPHASE);
	bool changed = ob_contacts_update_hit(s, s->island.h);
	ob_contacts_prepare(s);
	ob_bodies_warm_start(s);
	return changed;
}

// Solves impacts at their instants, in rounds: a body that leaves may hit another that was out of reach before.
static void resolve_impacts(ob_solver *s)
{
	ob_solver_enter(s, OB_PROFILE_IMPACTS);
	for (int round = 0; round < MAX_IMPACT_ROUNDS && ob_impacts_resolve(s, round == 0); round++) {
		ob_bodies_update_speed_bounds(s);
		s->methods.follow(s);
		if (!update_hit_contacts(s))
			break;
		ob_solver_enter(s, OB_PROFILE_IMPACTS);
	}
}

// Solves for the velocities at the partial substep's end, u, such that no contact is violated. Shortens the partial
// substep where a body that was hit is now too fast for its length.
static void solve_velocities(ob_solver *s)
{
	do {
		ob_solver_enter(s, OB_PROFILE_MOVE);
		ob_joints_begin(s);
		ob_bodies_predict_velocities(s);
		ob_solver_enter(s, OB_PROFILE_SOLVE);
		ob_solver_iterate(s);
		ob_solver_enter(s, OB_PROFILE_MOVE);
	} while (ob_adaptive_shorten(s));
}

// Solves a substep, or a part of one: the table of contents of an island's step, in the order in which things happen.
static void solve_partial_substep(ob_solver *s, double left, bool first_of_step)
{
	enum { WORK_OF_BODY = 24, WORK_OF_CONTACT = 8 }; // beside its tests and solves
	ob_budget_note(s, WORK_OF_BODY * s->island.rows + WORK_OF_CONTACT * s->island.contacts);
	ob_solver_enter(s, OB_PROFILE_NARROWPHASE);
	s->methods.follow(s);
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
	s->methods.follow(s);
	ob_solver_enter(s, OB_PROFILE_PROJECT);
	ob_push_apart(s);
	ob_joints_project(s);
	ob_joint_loads_keep(&s->island.joints);
}

// Returns the largest difference (m/s) between the changes of a body's velocity in both halves of a step.
static double jolt_of(const ob_island_work *w, const ob_vec3 *start, const ob_vec3 *middle)
{
	double most = 0;
	for (uint32_t row = 1; row <= w->bodies; row++) {
		const ob_vec3 mean = ob_scale(ob_add(start[row], ob_row_linear(w->v[row])), .5);
		most = ob_max(most, 2 * ob_norm(ob_sub(middle[row], mean)));
	}
	return most;
}

static void note_velocities(const ob_island_work *w, ob_vec3 *v)
{
	for (uint32_t row = 1; row <= w->bodies; row++)
		v[row] = ob_row_linear(w->v[row]);
}

// Solves the substeps in turn.
static void solve_substeps(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const bool watched = w->bodies <= OB_WATCHED_BODIES && w->substeps % 2 == 0;
	ob_vec3 start[OB_WATCHED_BODIES + 1], middle[OB_WATCHED_BODIES + 1];
	w->partial = 0;
	if (watched)
		note_velocities(w, start);
	for (uint32_t k = 0; k < w->substeps; k++) {
		bool first = k == 0;
		for (double left = w->substep; left > 0 && !ob_budget_spent(s); left -= w->h, first = false) {
			solve_partial_substep(s, left, first);
			w->partial++;
		}
		ob_joints_end(s);
		if (watched && 2 * (k + 1) == w->substeps)
			note_velocities(w, middle);
	}
	if (watched)
		w->jolt = jolt_of(w, start, middle);
}

// Flies with the joints where nothing may touch. false: they need more substeps, which are set.
static bool fly(ob_solver *s)
{
	ob_island_work *w = &s->island;
	ob_solver_enter(s, OB_PROFILE_MOVE);
	if (ob_joints_fly(s) || w->substeps >= OB_MAX_SUBSTEPS)
		return true;
	w->substeps = ob_joints_substeps(s);
	return false;
}

// Solves the whole step on a private copy of the published state. true: the solution's error is tolerable.
static bool solve_step(ob_solver *s, const ob_island_input *in)
{
	ob_island_work *w = &s->island;
	const double refined = (double)w->substeps / s->settings->substeps;
	w->coarseness = ob_max(1, w->run_coarseness / ob_max(1, refined));
	ob_solver_enter(s, OB_PROFILE_LOAD);
	s->calls.attempt(s->calls.with);
	ob_bodies_load(s, in);
	ob_joints_load(s, in);
	ob_frame_enter(s, in);
	ob_contacts_load(s, in);
	ob_direct_begin(&w->direct);
	w->jolt = 0;
	s->counters.body_substeps += (uint64_t)in->members * w->substeps;
	if (ob_flies_with_joints(in)) {
		if (!fly(s) && !ob_budget_spent(s))
			return false;
	} else {
		solve_substeps(s);
	}
	ob_solver_enter(s, OB_PROFILE_NARROWPHASE);
	for (uint32_t row = 1; row <= w->bodies; row++)
		ob_body_update_pose(w, row);
	return ob_error_control_accept(s) || ob_budget_spent(s);
}

// Solves one substep, where that suffices. false: the island is not in equilibrium.
static bool solve_equilibrium(ob_solver *s, const ob_island_input *in)
{
	const uint32_t substeps = s->island.substeps;
	if (!ob_equilibrium_likely(s, in))
		return false;
	s->island.substeps = 1;
	if (solve_step(s, in) && ob_equilibrium_confirmed(&s->island))
		return true;
	s->island.substeps = substeps;
	return false;
}

// ---- the step

// Returns the island's state of rest, as a flag of its bodies' motions; 0: it moves.
static uint32_t rest_flag(ob_solver *s)
{
	const double rest_time = ob_bodies_update_rest(s);
	if (s->island.torques || ob_norm2(s->island.frame) > 0 ||
	    ob_surfaces_carry_any(&s->island)) // equilibrium and sleep know of forces alone
		return 0;
	if (!ob_joints_may_rest(&s->island))
		return 0;
	if (ob_equilibrium_reached(s))
		return s->settings->sleeping ? OB_MOTION_ASLEEP : OB_MOTION_EQUILIBRIUM;
	return ob_balance_may_sleep(s, rest_time) ? OB_MOTION_ASLEEP : 0;
}

void ob_island_step(ob_solver *s, const ob_island_input *in)
{
	s->in = in;
	s->island.in_field = in->joints > 0; // joints are solved in no other frame than the world's
	s->island.substeps = ob_error_control_substeps(s, in);
	s->island.balanced = solve_equilibrium(s, in);
	if (!s->island.balanced)
		while (!solve_step(s, in))
			s->counters.islands_redone++;
	ob_solver_enter(s, OB_PROFILE_LOAD);
	ob_frame_leave(s);
}

void ob_island_step_finer(ob_solver *s, uint32_t substeps)
{
	s->island.substeps = substeps;
	do
		s->counters.islands_redone++;
	while (!solve_step(s, s->in));
	ob_solver_enter(s, OB_PROFILE_LOAD);
	ob_frame_leave(s);
}

void ob_island_report(ob_solver *s)
{
	ob_solver_enter(s, OB_PROFILE_LOAD);
	s->counters.island_steps++;
	s->counters.recovered += s->island.recovered;
	s->counters.body_steps += s->in->members;
	ob_error_control_count(s);
	const uint32_t rest = rest_flag(s);
	ob_contacts_report(s);
	ob_joint_loads_report(s);
	ob_solver_enter(s, OB_PROFILE_PUBLISH);
	ob_bodies_report(s, rest);
}

void ob_island_probe(ob_solver *s, const ob_island_input *in, uint32_t substeps, double stretch)
{
	s->island.stretch = stretch;
	s->in = in;
	s->island.in_field = in->joints > 0; // joints are solved in no other frame than the world's
	s->island.substeps = substeps;
	(void)solve_step(s, in);
	ob_frame_leave(s);
}

// ---- life

bool ob_solver_create(ob_solver *s, const ob_run_settings *settings, const ob_island_calls *calls, uint32_t objects)
{
	s->settings = settings;
	s->calls = *calls;
	s->methods = ob_methods_of(settings);
	s->island.unit = ob_run_settings_units(settings);
	s->island.tolerance = OB_DEFAULT_TOLERANCE * s->island.unit.length;
	s->island.stretch = 1;
	s->island.run_coarseness = s->island.coarseness = ob_run_settings_coarseness(settings);
	return ob_ode_bodies_create(&s->ode_bodies, objects);
}

void ob_solver_finish(ob_solver *s)
{
	ob_island_work *w = &s->island;
	ob_ode_bodies_finish(&s->ode_bodies);
	free(w->body);
	free(w->by_height);
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
	ob_joints_finish(&w->joints);
}

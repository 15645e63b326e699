#include "solver/contact_solver.h"

#include <string.h>

#include "solver/budget.h"
#include "solver/conjugate.h"
#include "solver/direct_solver.h"
#include "solver/few_contacts.h"
#include "solver/joint_rows.h"

// Iterations. A change of velocity above the wake threshold activates a body: its contacts are solved again.
static const double wake_threshold = 2e-3; // m/s
static const double max_wake_threshold = 1e-2; // m/s: its upper bound where a short partial substep raises it
static const double max_wake_rate = 1; // 1/s: its upper bound divided by the tolerance
static const double coarse_wake_share = .05; // share of the largest speed in the island: wake threshold in a coarse run
static const double coarse_wake_way = .1; // share of the tolerance that it may move a body in a partial substep
static const uint32_t max_extra_iterations = 8; // times the run's number: for changes above the next threshold
static const double extra_iteration_threshold = .05; // m/s, with the usual number of substeps
static const int block_sweeps = 4;
static const double block_tolerance = .01; // of the residual: accuracy to which an iteration solves a block
static const int fine_block_sweeps = 8; // block sweeps for a converged solution
static const double converged = 1e-12; // m/s: a block is solved once a sweep changes less

// Bodies at rest.
static const double settled = 1e-10, high_settled = 1e-7; // m/s: solved; enough while a high island moves
static const double nearly_settled = 1e-6; // m/s: not given up
static const int max_settling_rounds = 32; // in a partial substep
static const uint32_t max_settling_iterations = 512, max_failures = 4; // iterations; failures of direct solves

static const double resting_gap = 1e-7; // m: a point that presses keeps its gap if that is smaller

// Few contacts in smooth motion (OB_FEW_CONTACTS at most) are solved to the end, in any order of contacts. Otherwise,
// the remainder of each partial substep would be a force that nothing exerts.
static const double solved_few = 1e-12; // m/s: their wake threshold in smooth motion
static const double smooth_change = .01; // m/s: motion is smooth if the first iteration changes no velocity by more
static const uint32_t iterations_before_steps = 2; // before Newton steps on all these contacts

static const double impact_threshold = .1; // m/s: faster changes are impacts; the warm start does not extrapolate them

static const double slop = 1e-4, max_slop_share = 1. / 8; // m; bound as a share of the tolerance

// Returns the usual threshold, or a smaller one in proportion to the run's tolerance.
static double within_tolerance(const ob_solver *s, double usual, double of_tolerance)
{
	double tolerance = s->settings->tolerance;
	return tolerance > 0 ? ob_min(usual, of_tolerance * tolerance) : usual;
}

double ob_solver_slop(const ob_solver *s)
{
	return within_tolerance(s, slop * s->island.unit.length, max_slop_share);
}

void ob_solver_add_rows(ob_island_work *w, ob_body_row *to, ob_body_row *from)
{
	for (uint32_t i = 1; i <= w->bodies; i++)
		for (int c = 0; c < 6; c++)
			to[i][c] += from[i][c];
	memset(from, 0, w->rows * sizeof *from);
}

// ---- iterations

void ob_solver_limit_prediction(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const double gained = w->max_acceleration * w->h; // m/s, without contacts
	const double growth = .3 * gained * w->mass; // N s
	const double cap[OB_LANES] = { growth, growth, growth, growth };
	for (uint32_t i = 0; i < w->batches; i++)
		ob_batch_limit_prediction(&w->batch[i], cap, 2.5 * gained);
}

void ob_solver_activate(ob_island_work *w, uint32_t row, uint32_t iteration)
{
	ob_body *body = &w->body[row];
	if (body->active_iteration == iteration || body->inv_mass == 0)
		return;
	body->active_iteration = iteration;
	for (uint32_t k = 0; k < body->adjacent; k++) {
		uint32_t lane = w->contact_lane[w->adjacency[body->first_adjacent + k]];
		if (lane != OB_NO_LANE)
			w->batch_due[lane / OB_LANES] = iteration + 1;
	}
}

static bool activate_bodies(ob_island_work *w, const ob_batch *b)
{
	for (unsigned left = b->active; left; left &= left - 1) {
		int l = __builtin_ctz(left);
		ob_solver_activate(w, b->body_a[l], w->iteration);
		ob_solver_activate(w, b->body_b[l], w->iteration);
	}
	return b->active != 0;
}

// Runs one iteration over the contacts of active bodies, colour by colour; the first one runs over all. Returns the
// largest change of a velocity (m/s) that another iteration may have to correct: isolated pairs, solved to the end, do
// not count. changed: the largest change of all (m/s).
static double solve_contacts(ob_solver *s, const ob_solver_iteration *iteration, bool *any_active, double *changed)
{
	ob_island_work *w = &s->island;
	double residual = 0, most = 0; // squares
	*any_active = false;
	for (uint32_t k = 0; k < w->batches; k++) {
		const uint32_t i = w->batch_order[k];
		ob_batch *b = &w->batch[i];
		if (iteration->first ? !b->live : w->batch_due[i] < w->iteration)
			continue;
		unsigned pairs = lanes_count(b->live);
		enum { SWEEP = 2, ISOLATED_SWEEP = 16 }; // work of a patch, at most
		s->counters.pair_solves += pairs;
		s->counters.frictionless_solves += b->kind & OB_KIND_FRICTIONLESS ? pairs : 0;
		ob_batch_solve(b, iteration, w->u, w->v, w->d, w->delta);
		ob_budget_note(s, OB_LANES - pairs + (b->isolated ? ISOLATED_SWEEP : SWEEP) * b->sweeps);
		*any_active |= activate_bodies(w, b);
		residual = b->residual > residual ? b->residual : residual;
		most = b->changed > most ? b->changed : most;
	}
	if (iteration->jacobi)
		ob_solver_add_rows(w, w->u, w->delta);
	*changed = sqrt(most);
	return sqrt(residual);
}

static void solve_joints(ob_solver *s, double threshold, bool *any);

// Runs conjugate iterations on u, over all contacts and joints, until none changes a velocity by more than the wake
// threshold. Returns the largest change (m/s) of the last.
static double converge(ob_solver *s, ob_solver_iteration *iteration, uint32_t max_iterations)
{
	ob_island_work *w = &s->island;
	double residual = INFINITY, changed;
	bool any_active = true;
	ob_conjugate_begin(w);
	ob_joints_iterate(w);
	for (uint32_t k = 0; k < max_iterations && any_active && !ob_budget_spent(s); k++) {
		if (k) {
			ob_conjugate_go_on(w);
			ob_joints_iterate(w);
		}
		s->counters.solver_iterations++;
		s->methods.read(s, w->u, k);
		for (uint32_t i = 0; i < w->batches; i++)
			w->batch_due[i] = w->iteration;
		ob_conjugate_note(w);
		residual = solve_contacts(s, iteration, &any_active, &changed);
		solve_joints(s, iteration->wake_threshold, &any_active);
		iteration->first = false;
	}
	return residual;
}

void ob_solver_converge(ob_solver *s, double enough, uint32_t max_iterations)
{
	ob_solver_iteration iteration = {
		.h = s->island.h,
		.block_sweeps = fine_block_sweeps,
		.converged = converged * s->island.unit.speed,
		.wake_threshold = enough,
		.impact_threshold = INFINITY,
		.first = true,
		.jacobi = s->methods.jacobi,
		.ghosts = s->methods.restless,
		.resting_gap = resting_gap * s->island.unit.length,
		.dv = s->island.dv,
	};
	for (uint32_t i = 0; i < s->island.batches; i++)
		s->island.batch[i].follows = 0; // nothing that slides stands
	converge(s, &iteration, max_iterations);
}

// Solves cycles of contacts between bodies at rest, or stacked high. Alternates direct solves with conjugate iterations,
// more and more of them if a direct solve does not reduce the residual. Gives up for this step if the end is not in
// sight; if bodies still move, as soon as a direct solve fails.
static void settle(ob_solver *s, const ob_solver_iteration *last)
{
	ob_solver_iteration iteration = *last;
	const bool moves = s->island.direct.shape == OB_DIRECT_HIGH;
	uint32_t iterations = 1, made = 0, failures = 0;
	double residual = INFINITY;
	iteration.block_sweeps = fine_block_sweeps;
	iteration.block_tolerance = 0;
	iteration.wake_threshold = (moves ? high_settled : settled) * s->island.unit.speed;
	for (int round = 0; round < max_settling_rounds && made < max_settling_iterations && !ob_budget_spent(s);
	     round++) {
		made += iterations;
		residual = converge(s, &iteration, iterations);
		if (residual <= iteration.wake_threshold)
			return;
		if (moves && failures)
			break;
		if (failures == max_failures || !ob_direct_solve(s)) {
			failures += failures < max_failures;
			iterations = 2 * iterations + 6;
		} else {
			iterations = 1;
		}
	}
	s->island.direct.gave_up = residual > nearly_settled * s->island.unit.speed;
}

// Returns the wake threshold (m/s). A coarse run leaves larger changes to the next partial substep while something
// moves. It does not if all is slow: then bodies would creep.
static double wake_threshold_of(const ob_solver *s)
{
	const ob_island_work *w = &s->island;
	const double wake = within_tolerance(s, wake_threshold * w->unit.speed, max_wake_rate / w->unit.time);
	const double least = ob_min(max_wake_threshold * w->unit.speed,
				    wake * w->substep / w->h); // a shorter partial substep moves less
	if (w->coarseness == 1)
		return least;
	return ob_max(least, ob_min(coarse_wake_share * ob_largest_speed(w), coarse_wake_way * w->tolerance / w->h));
}

static bool few_touch(const ob_island_work *w)
{
	unsigned pairs = 0;
	for (uint32_t i = 0; i < w->batches; i++)
		pairs += lanes_count(w->batch[i].live);
	return pairs <= OB_FEW_CONTACTS;
}

// Finds patches that slide and whose pressure is known, as all but "others" of the load of one of the two bodies is theirs: by
// loads, not by the number of contacts, so a body without weight changes nothing. Elsewhere loads may be moved from one
// contact to another, and with them the centres of pressure. Returns true if a contact has no load yet: it is asked once
// more after an iteration.
static bool find_follows(ob_island_work *w, bool again)
{
	const double others = .01;
	bool any = false;
	for (uint32_t i = 0; i < w->rows; i++)
		w->body[i].load = w->body[i].joints ? INFINITY : 0; // a joint brings load, too
	for (uint32_t i = 0; i < w->batches; i++)
		for (unsigned left = w->batch[i].live; left; left &= left - 1) {
			const uint32_t l = (uint32_t)__builtin_ctz(left);
			const double load = ob_batch_load(&w->batch[i], l);
			w->body[w->batch[i].body_a[l]].load += load;
			w->body[w->batch[i].body_b[l]].load += load;
		}
	for (uint32_t i = 0; i < w->batches; i++) {
		ob_batch *b = &w->batch[i];
		if (again && !b->unloaded)
			continue;
		b->follows = b->unloaded = 0;
		for (unsigned left = b->live & ~b->isolated; left && b->kind == OB_KIND_FULL; left &= left - 1) {
			const uint32_t l = (uint32_t)__builtin_ctz(left);
			b->unloaded |= (unsigned)!(ob_batch_load(b, l) > 0) << l;
			const ob_body *of[2] = { &w->body[b->body_a[l]], &w->body[b->body_b[l]] };
			const double most = (1 + others) * ob_batch_load(b, l);
			const bool known = (of[0]->inv_mass > 0 && of[0]->load < most) ||
					   (of[1]->inv_mass > 0 && of[1]->load < most);
			b->follows |= (unsigned)known << l;
		}
		if (b->follows)
			ob_batch_find_follows(b, w->v, w->u);
		any |= b->unloaded != 0;
	}
	return any;
}

static void activate_all(ob_island_work *w)
{
	for (uint32_t i = 1; i <= w->bodies; i++)
		ob_solver_activate(w, i, w->iteration);
}

// Solves the joints on the velocities that the contacts have left. Bodies that they change by more than the threshold (m/s)
// are active: any.
static void solve_joints(ob_solver *s, double threshold, bool *any)
{
	ob_island_work *w = &s->island;
	if (!w->joints.count)
		return;
	memcpy(w->delta, w->u, w->rows * sizeof *w->u);
	ob_joints_iterate(w);
	for (uint32_t i = 1; i <= w->bodies; i++) {
		const ob_body *body = &w->body[i];
		const ob_vec3 v = ob_sub(ob_row_linear(w->u[i]), ob_row_linear(w->delta[i])),
			      turn = ob_sub(ob_row_angular(w->u[i]), ob_row_angular(w->delta[i]));
		if (!body->contacts ||
		    !(ob_norm2(v) + body->radius * body->radius * ob_norm2(turn) > threshold * threshold))
			continue;
		ob_solver_activate(w, i, w->iteration);
		*any = true;
	}
	memset(w->delta, 0, w->rows * sizeof *w->delta);
}

// Returns the ratio of substeps to their usual number, at least 1. Remainders of all substeps add up over the step, so
// thresholds fall when a step is solved again with more substeps.
static double refinement(const ob_solver *s)
{
	return ob_max(1, (double)s->island.substeps / s->settings->substeps);
}

void ob_solver_iterate(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	ob_solver_iteration iteration = {
		.h = w->h,
		.block_sweeps = block_sweeps,
		.converged = converged * w->unit.speed,
		.wake_threshold = wake_threshold_of(s),
		.impact_threshold = impact_threshold * w->unit.speed * w->h / w->substep,
		.first = true,
		.jacobi = s->methods.jacobi,
		.ghosts = s->methods.restless,
		.resting_gap = resting_gap * w->unit.length,
		.dv = w->dv,
	};
	const double usual = iteration.wake_threshold;
	bool to_the_end = w->coarseness == 1 && few_touch(w);
	if (to_the_end)
		iteration.wake_threshold = ob_min(usual, solved_few * w->unit.speed);
	enum { WORK_OF_STEP = 32 };
	bool any_active = true;
	double residual = 0, changed;
	const bool asks =
		!iteration.ghosts && find_follows(w, false); // ghosts move between iterations: no slip is known
	ob_direct_begin_partial(&w->direct);
	if (w->joints.count && ob_direct_stands(w)) // contacts show by their first change that they are in equilibrium
		ob_joints_solve(w, w->u);
	for (uint32_t k = 0; k < max_extra_iterations * run->iterations && any_active && !ob_budget_spent(s); k++) {
		if (k == run->iterations) {
			iteration.wake_threshold = extra_iteration_threshold * w->unit.speed / refinement(s);
			to_the_end = false;
		}
		if (to_the_end && k >= iterations_before_steps && !w->joints.count && !iteration.jacobi &&
		    !iteration.ghosts) {
			ob_budget_note(s, WORK_OF_STEP);
			ob_few_contacts_step(w);
			activate_all(w);
		}
		if (k == 1 && asks)
			find_follows(w, true);
		s->counters.solver_iterations++;
		s->methods.read(s, w->u, k);
		w->iteration += 1 + (k == 0); // a gap of 1, so that no body is active from the last partial substep
		residual = solve_contacts(s, &iteration, &any_active, &changed);
		solve_joints(s, iteration.wake_threshold, &any_active);
		if (iteration.first) {
			w->last_residual = changed;
			w->residual = ob_max(w->residual, changed);
			if (changed > smooth_change * w->unit.speed) {
				iteration.wake_threshold = usual;
				to_the_end = false;
			}
		}
		iteration.first = false;
		iteration.block_tolerance = block_tolerance * residual;
		if (ob_direct_wanted(s, residual)) {
			ob_direct_solve(s);
			any_active = true;
			activate_all(w);
		}
	}
	w->direct.used_last = w->direct.solves > 0;
	if (ob_direct_settles(s, residual))
		settle(s, &iteration);
}

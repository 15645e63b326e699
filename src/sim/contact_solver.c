#include "sim/contact_solver.h"

#include <string.h>

#include "sim/budget.h"
#include "sim/conjugate.h"
#include "sim/direct_solver.h"
#include "sim/few_contacts.h"
#include "sim/ghost.h"

// Iterations. A change of velocity above the wake threshold makes a body active: its contacts are solved again.
static const double wake_threshold = 2e-3; // m/s ..
static const double max_wake_threshold = 1e-2; // m/s: .. where a partial substep is short, and raises it ..
static const double max_wake_rate = 1; // 1/s: .. and, times the tolerance, at most
static const double coarse_wake_share = .05; // .. or, in a coarse run, so much of the largest speed in the island, ..
static const double coarse_wake_way = .1; // .. unless that moves something farther than so much of the tolerance
static const uint32_t max_extra_iterations = 8; // times the run's number; only for changes above ..
static const double extra_iteration_threshold = .05; // m/s, with as many substeps as usual
static const int block_sweeps = 4;
static const double block_tolerance = .01; // of the residual: a block need not be solved more finely in an iteration
static const int fine_block_sweeps = 8; // where the solution is wanted to the end
static const double converged = 1e-12; // m/s: a block whose sweep changes less is solved

// Bodies that stand.
static const double settled = 1e-10, nearly_settled = 1e-6; // m/s: smaller changes are nothing; worth to go on
static const int max_settling_rounds = 32; // in a partial substep
static const uint32_t max_settling_iterations = 512, max_failures = 4; // .. and of direct solves

static const double resting_gap = 1e-7; // m: a point that presses keeps its distance from the surface, if that is less
static const double turning_gap = 3e-6; // m: the same where the geometry turns

// A few contacts that go on as they did are solved to the end, whatever the order in which they are taken: what is left
// of each partial substep, else, is a force that nothing exerts. How many: OB_FEW_CONTACTS.
static const double solved_few = 1e-12; // m/s: the wake threshold, unless the first iteration changes more than ..
static const double smooth_change = .01; // m/s: .. this
static const uint32_t iterations_before_steps = 2; // for all of them at once

static const double impact_threshold = .1; // m/s: faster changes are impacts and not extrapolated by the warm start

static const double slop = 1e-4, max_slop_share = 1. / 8; // m; of the tolerance

static bool is_jacobi(const ob_sim *s)
{
	return s->settings->solver == OB_SOLVER_JACOBI;
}

// A threshold as usual, or smaller where the run's tolerance is.
static double within_tolerance(const ob_sim *s, double usual, double of_tolerance)
{
	double tolerance = s->settings->tolerance;
	return tolerance > 0 ? ob_min(usual, of_tolerance * tolerance) : usual;
}

double ob_solver_slop(const ob_sim *s)
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

void ob_solver_limit_prediction(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const double gained = w->max_acceleration * w->h; // m/s, without contacts
	const double growth = .3 * gained * w->mass; // N s
	const double cap[OB_LANES] = { growth, growth, growth, growth };
	for (uint32_t i = 0; i < w->batches; i++)
		ob_batch_limit_prediction(&w->batch[i], cap, 2.5 * gained);
}

// The row's velocity has changed by more than the wake threshold in an iteration: its contacts are due in that one, if
// their turn is still to come, and in the next.
static void activate_body(ob_island_work *w, uint32_t row, uint32_t iteration)
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
		activate_body(w, b->body_a[l], w->iteration);
		activate_body(w, b->body_b[l], w->iteration);
	}
	return b->active != 0;
}

// Ghosts are active when the bodies are that they stand for.
static void activate_ghosts(ob_island_work *w)
{
	for (uint32_t g = w->first_ghost; g < w->rows; g++)
		activate_body(w, g, w->body[w->body[g].ghost_of].active_iteration);
}

// One iteration over the contacts of active bodies, colour by colour; over all in the first. Returns the largest change
// of a velocity (m/s) after which another iteration may find something to do: not where a pair that touches nothing
// else has been solved to the end. changed: the largest of all.
static double solve_contacts(ob_sim *s, const ob_solver_iteration *iteration, bool *any_active, double *changed)
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
		enum { SWEEP = 2, ISOLATED_SWEEP = 16 }; // work: of a patch, at most
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

// Conjugate iterations on u, over all contacts, until none changes a velocity by more than the wake threshold. Returns
// the largest change (m/s) in the last.
static double converge(ob_sim *s, ob_solver_iteration *iteration, uint32_t max_iterations)
{
	ob_island_work *w = &s->island;
	double residual = INFINITY, changed;
	bool any_active = true;
	ob_conjugate_begin(w);
	for (uint32_t k = 0; k < max_iterations && any_active && !ob_budget_spent(s); k++) {
		if (k)
			ob_conjugate_go_on(w);
		s->counters.solver_iterations++;
		ob_ghosts_read(s, w->u, k);
		for (uint32_t i = 0; i < w->batches; i++)
			w->batch_due[i] = w->iteration;
		ob_conjugate_note(w);
		residual = solve_contacts(s, iteration, &any_active, &changed);
		iteration->first = false;
	}
	return residual;
}

void ob_solver_converge(ob_sim *s, double enough, uint32_t max_iterations)
{
	ob_solver_iteration iteration = {
		.h = s->island.h,
		.block_sweeps = fine_block_sweeps,
		.converged = converged * s->island.unit.speed,
		.wake_threshold = enough,
		.impact_threshold = INFINITY,
		.first = true,
		.jacobi = is_jacobi(s),
		.ghosts = ob_ghosts_used(s),
		.resting_gap = resting_gap * s->island.unit.length,
		.turning_gap = turning_gap * s->island.unit.length,
		.dv = s->island.dv,
	};
	converge(s, &iteration, max_iterations);
}

// Bodies that stand, with cycles of contacts: direct solves, and where they do not lead down, more and more conjugate
// iterations, until nothing is left to do. Given up, for this step, where that does not come into sight.
static void settle(ob_sim *s, const ob_solver_iteration *last)
{
	ob_solver_iteration iteration = *last;
	uint32_t iterations = 1, made = 0, failures = 0;
	double residual = INFINITY;
	iteration.block_sweeps = fine_block_sweeps;
	iteration.block_tolerance = 0;
	iteration.wake_threshold = settled * s->island.unit.speed;
	for (int round = 0; round < max_settling_rounds && made < max_settling_iterations && !ob_budget_spent(s);
	     round++) {
		made += iterations;
		residual = converge(s, &iteration, iterations);
		if (residual <= iteration.wake_threshold)
			return;
		if (failures == max_failures || !ob_direct_solve(s)) {
			failures += failures < max_failures;
			iterations = 2 * iterations + 6;
		} else {
			iterations = 1;
		}
	}
	s->island.direct.gave_up = residual > nearly_settled * s->island.unit.speed;
}

// m/s, of any point of a body
static double largest_speed(const ob_island_work *w)
{
	double most = 0;
	for (uint32_t i = 1; i <= w->bodies; i++)
		most = ob_max(most, w->body[i].speed);
	return most;
}

// m/s. A coarse run leaves more where something moves, for the next partial substep finds it; but no more where all is
// slow, for there it would creep.
static double wake_threshold_of(const ob_sim *s)
{
	const ob_island_work *w = &s->island;
	const double wake = within_tolerance(s, wake_threshold * w->unit.speed, max_wake_rate / w->unit.time);
	const double least = ob_min(max_wake_threshold * w->unit.speed,
				    wake * w->substep / w->h); // what lasts shorter, moves less
	if (w->coarseness == 1)
		return least;
	return ob_max(least, ob_min(coarse_wake_share * largest_speed(w), coarse_wake_way * w->tolerance / w->h));
}

static bool few_touch(const ob_island_work *w)
{
	unsigned pairs = 0;
	for (uint32_t i = 0; i < w->batches; i++)
		pairs += lanes_count(w->batch[i].live);
	return pairs <= OB_FEW_CONTACTS;
}

static void activate_all(ob_island_work *w)
{
	for (uint32_t i = 1; i <= w->bodies; i++)
		activate_body(w, i, w->iteration);
}

// By how many times as many substeps as usual: what iterations leave in each of them adds up over the step, and where a
// step is solved again with more, it has to become less.
static double refinement(const ob_sim *s)
{
	return ob_max(1, (double)s->island.substeps / s->settings->substeps);
}

void ob_solver_iterate(ob_sim *s)
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
		.jacobi = is_jacobi(s),
		.ghosts = ob_ghosts_used(s),
		.resting_gap = resting_gap * w->unit.length,
		.turning_gap = turning_gap * w->unit.length,
		.dv = w->dv,
	};
	const double usual = iteration.wake_threshold;
	bool to_the_end = w->coarseness == 1 && few_touch(w);
	if (to_the_end)
		iteration.wake_threshold = ob_min(usual, solved_few * w->unit.speed);
	enum { WORK_OF_STEP = 32 };
	bool any_active = true;
	double residual = 0, changed;
	ob_direct_begin_partial(&w->direct);
	for (uint32_t k = 0; k < max_extra_iterations * run->iterations && any_active && !ob_budget_spent(s); k++) {
		if (k == run->iterations) {
			iteration.wake_threshold = extra_iteration_threshold * w->unit.speed / refinement(s);
			to_the_end = false;
		}
		if (to_the_end && k >= iterations_before_steps && !iteration.jacobi && !iteration.ghosts) {
			ob_budget_note(s, WORK_OF_STEP);
			ob_few_contacts_step(w);
			activate_all(w);
		}
		s->counters.solver_iterations++;
		ob_ghosts_read(s, w->u, k);
		activate_ghosts(w);
		w->iteration += 1 + (k == 0); // a gap, so that no body is active from the last partial substep
		residual = solve_contacts(s, &iteration, &any_active, &changed);
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

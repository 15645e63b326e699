#include "sim/contact_solver.h"

#include <string.h>

#include "sim/direct_solver.h"
#include "sim/ghost.h"

// Iterations. A change of velocity above the wake threshold makes a body active: its contacts are solved again.
static const double wake_threshold = 2e-3; // m/s ..
static const double max_wake_threshold = 1e-2; // m/s: .. where a partial substep is short, and raises it ..
static const double max_wake_rate = 1; // 1/s: .. and, times the tolerance, at most
static const uint32_t max_extra_iterations = 8; // times the run's number; only for changes above ..
static const double extra_iteration_threshold = .05; // m/s
static const int block_sweeps = 4;
static const double block_tolerance = .01; // of the residual: a block need not be solved more finely in an iteration

// Impacts.
static const double impact_threshold = .1; // m/s: faster changes are impacts and not extrapolated by the warm start
static const double rebound_turn = 1e-3; // rad: a body that turns by more in a partial substep is taken to its rebound
static const double max_smooth_acceleration = 3; // of the largest external one: more is the echo of an impact

// Position projection.
static const double slop = 1e-4, projected_share = .3; // m; of the penetration, per partial substep
static const double max_slop_share = 1. / 8; // of the tolerance

static bool is_jacobi(const ob_sim *s)
{
	return s->settings->solver == OB_SOLVER_JACOBI;
}

// A threshold as usual, or smaller where the run's tolerance is.
static double within_tolerance(const ob_sim *s, double usual, double of_tolerance)
{
	double tolerance = s->settings->tolerance;
	return tolerance > 0 ? fmin(usual, of_tolerance * tolerance) : usual;
}

static void add_rows(ob_island_work *w, ob_body_row *to, ob_body_row *from)
{
	for (uint32_t i = 1; i <= w->bodies; i++)
		for (int c = 0; c < 6; c++)
			to[i][c] += from[i][c];
	memset(from, 0, w->rows * sizeof *from);
}

// ---- impacts

// rad/s, of what changes the contact's geometry by turning
static double turn_rate(const ob_island_work *w, uint32_t row)
{
	const double *v = w->v[row];
	return w->body[row].shape == OB_SHAPE_SPHERE ? 0 : ob_norm(ob_v3(v[3], v[4], v[5]));
}

// True where a body turns by more than the threshold: it rebounds at the partial substep's start, or not in this one.
static bool turns(const ob_island_work *w, const ob_contact *contact)
{
	return fmax(turn_rate(w, contact->a), turn_rate(w, contact->b)) * w->h > rebound_turn;
}

static ob_impact impact_of(const ob_sim *s, const ob_contact *contact)
{
	const ob_island_work *w = &s->island;
	double resting = 4 * w->max_acceleration * w->substep; // m/s, of contacts that do not rebound
	return (ob_impact){ w->h, turns(w, contact) ? w->h_min : w->h, contact->e, resting + 1e-6, 1, 1 };
}

static bool is_elastic(const ob_contact *contact)
{
	return contact->e > 0 && contact->lane != OB_NO_LANE;
}

static ob_impact_rows impact_rows(const ob_island_work *w)
{
	return (ob_impact_rows){ w->v, w->drift, w->d };
}

// instant: s into the partial substep; < 0: there was no impact.
static bool note_impact(ob_sim *s, double instant)
{
	s->counters.impacts += instant >= 0;
	s->island.last_impact = fmax(s->island.last_impact, instant);
	return instant >= 0;
}

// Each pair on the velocities that the one before it has left.
static bool impacts_gauss_seidel(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const ob_impact_rows at = impact_rows(w);
	bool any = false;
	for (uint32_t i = 0; i < w->contacts; i++) {
		const ob_contact *contact = &w->contact[i];
		ob_impact in = impact_of(s, contact);
		if (is_elastic(contact))
			any |= note_impact(s, ob_impact_solve(&w->batch[contact->lane / OB_LANES],
							      contact->lane % OB_LANES, &in, &at, w->v, w->d));
	}
	return any;
}

// All pairs on the same velocities, each with its share of the bodies; u is free here and takes the shifts.
static bool impacts_jacobi(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const ob_impact_rows at = impact_rows(w);
	bool any = false;
	for (uint32_t i = 0; i < w->rows; i++)
		w->body[i].pending_impacts = 0;
	memset(w->u, 0, w->rows * sizeof *w->u);
	for (int solve = 0; solve < 2; solve++)
		for (uint32_t i = 0; i < w->contacts; i++) {
			const ob_contact *contact = &w->contact[i];
			ob_impact in = impact_of(s, contact);
			if (!is_elastic(contact))
				continue;
			const ob_batch *b = &w->batch[contact->lane / OB_LANES];
			int l = contact->lane % OB_LANES;
			if (solve) {
				in.split_a = fmax(1, w->body[contact->a].pending_impacts);
				in.split_b = fmax(1, w->body[contact->b].pending_impacts);
				any |= note_impact(s, ob_impact_solve(b, l, &in, &at, w->delta, w->u));
			} else if (ob_impact_time(b, l, &in, &at) <= in.h) {
				w->body[contact->a].pending_impacts++;
				w->body[contact->b].pending_impacts++;
			}
		}
	add_rows(w, w->v, w->delta);
	add_rows(w, w->d, w->u);
	return any;
}

// The warm start of contacts that were just hit repeats their impact: another must not take that for an approach.
static void set_drift(ob_island_work *w)
{
	for (uint32_t i = 1; i <= w->bodies; i++) {
		const ob_body *body = &w->body[i];
		const double *dv = w->dv[i], most = max_smooth_acceleration * w->max_acceleration * w->h;
		double linear = ob_norm(ob_v3(dv[0], dv[1], dv[2])), angular = ob_norm(ob_v3(dv[3], dv[4], dv[5]));
		ob_vec3 external = ob_scale(body->acceleration, w->h);
		if (linear + body->radius * angular <= most)
			memcpy(w->drift[i], dv, sizeof *w->drift);
		else
			memcpy(w->drift[i], (double[8]){ external.x, external.y, external.z }, sizeof *w->drift);
	}
}

double ob_solver_first_rebound(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const ob_impact_rows at = impact_rows(w);
	double first = INFINITY;
	if (!w->elastic)
		return first;
	set_drift(w);
	for (uint32_t i = 0; i < w->contacts; i++) {
		ob_contact *contact = &w->contact[i];
		ob_impact in = impact_of(s, contact);
		if (!is_elastic(contact) || !turns(w, contact))
			continue;
		in.within = w->h;
		double when = ob_impact_time(&w->batch[contact->lane / OB_LANES], contact->lane % OB_LANES, &in, &at);
		if (when <= w->h)
			contact->limit = -INFINITY;
		first = fmin(first, when);
	}
	return first;
}

bool ob_solver_impacts(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const int max_rounds =
		400; // pairs that still approach then are left to the iterations, which lose their energy
	int round = 0;
	if (!w->elastic)
		return false;
	set_drift(w);
	for (bool any = true; any && round < max_rounds; round += any) {
		ob_ghosts_read(s, w->v, (uint32_t)round);
		any = is_jacobi(s) ? impacts_jacobi(s) : impacts_gauss_seidel(s);
	}
	s->counters.impact_iterations += (unsigned)round;
	return round > 0;
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
		uint32_t lane = w->contact[w->adjacency[body->first_adjacent + k]].lane;
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
// of a velocity (m/s).
static double solve_contacts(ob_sim *s, const ob_solver_iteration *iteration, bool *any_active)
{
	ob_island_work *w = &s->island;
	lanes residual = lanes_of(0);
	*any_active = false;
	for (uint32_t k = 0; k < w->batches; k++) {
		const uint32_t i = w->batch_order[k];
		ob_batch *b = &w->batch[i];
		if (iteration->first ? !b->live : w->batch_due[i] < w->iteration)
			continue;
		unsigned pairs = (unsigned)__builtin_popcount(b->live);
		s->counters.pair_solves += pairs;
		s->counters.frictionless_solves += b->kind & OB_KIND_FRICTIONLESS ? pairs : 0;
		ob_batch_solve(b, iteration, w->u, w->v, w->d, w->delta);
		*any_active |= activate_bodies(w, b);
		residual = lanes_max(residual, b->residual);
	}
	if (iteration->jacobi)
		add_rows(w, w->u, w->delta);
	return fmax(fmax(residual[0], residual[1]), fmax(residual[2], residual[3]));
}

void ob_solver_iterate(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	const double wake = within_tolerance(s, wake_threshold, max_wake_rate);
	ob_solver_iteration iteration = {
		.h = w->h,
		.block_sweeps = block_sweeps,
		.wake_threshold = fmin(max_wake_threshold, wake * w->substep / w->h), // what lasts shorter, moves less
		.impact_threshold = impact_threshold * w->h / w->substep,
		.first = true,
		.jacobi = is_jacobi(s),
	};
	bool any_active = true;
	ob_direct_begin_partial(&w->direct);
	for (uint32_t k = 0; k < max_extra_iterations * run->iterations && any_active; k++) {
		if (k == run->iterations)
			iteration.wake_threshold = extra_iteration_threshold;
		s->counters.solver_iterations++;
		ob_ghosts_read(s, w->u, k);
		activate_ghosts(w);
		w->iteration += 1 + (k == 0); // a gap, so that no body is active from the last partial substep
		double residual = solve_contacts(s, &iteration, &any_active);
		if (iteration.first)
			w->residual = fmax(w->residual, residual);
		iteration.first = false;
		iteration.block_tolerance = block_tolerance * residual;
		if (!ob_direct_wanted(s, residual, any_active && k + 1 < run->iterations))
			continue;
		ob_direct_solve(s);
		s->counters.direct_solves++;
		any_active = true;
		for (uint32_t i = 1; i <= w->bodies; i++)
			activate_body(w, i, w->iteration);
	}
	w->direct.used_last = w->direct.solves > 0;
}

// ---- position projection

// J: potential energy that the displacements of all bodies add against their external accelerations
static double potential_energy(const ob_island_work *w)
{
	double sum = 0;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		const ob_vec3 a = w->body[i].acceleration;
		sum -= w->body[i].mass * (a.x * w->d[i][0] + a.y * w->d[i][1] + a.z * w->d[i][2]);
	}
	return sum;
}

// A projected body turns, too, and with it its axis-aligned box grows or shrinks: the narrow phase must test it again.
static void add_projection_to_paths(ob_island_work *w)
{
	for (uint32_t i = 1; i <= w->bodies; i++) {
		double *was = w->delta[i];
		const double *is = w->d[i];
		ob_vec3 shift = ob_v3(is[0] - was[0], is[1] - was[1], is[2] - was[2]);
		ob_vec3 turn = ob_v3(is[3] - was[3], is[4] - was[4], is[5] - was[5]);
		w->body[i].path += ob_norm(shift) + w->body[i].radius * ob_norm(turn);
		memset(was, 0, sizeof *w->delta);
	}
}

void ob_solver_project_positions(ob_sim *s)
{
	ob_island_work *w = &s->island;
	bool aabb = s->settings->narrow_phase == OB_NARROW_AABB && !is_jacobi(s);
	double before = potential_energy(w);
	if (aabb)
		memcpy(w->delta + 1, w->d + 1, w->bodies * sizeof *w->d);
	for (uint32_t k = 0; k < w->batches; k++) {
		ob_batch *b = &w->batch[w->batch_order[k]];
		if (b->live)
			w->projected |= ob_batch_project(b, within_tolerance(s, slop, max_slop_share), projected_share,
							 is_jacobi(s), w->d, w->delta);
	}
	if (is_jacobi(s))
		add_rows(w, w->d, w->delta);
	if (aabb)
		add_projection_to_paths(w);
	w->recovered += potential_energy(w) - before;
}

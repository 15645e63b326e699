#include "sim/exchange.h"

#include <string.h>

#include "sim/ghost.h"
#include "sim/pace.h"

static const double noticeable = 2e-3; // m/s: a change that makes another round worth while ..
static const double most_noticeable = 1e-2; // m/s: .. in a stride that is shorter than the substep
static const double noticeable_rate = 1; // 1/s: .. and, of the tolerance, at most
static const double jump = .1; // m/s: faster changes are impacts and are not extrapolated
static const double violent = .05; // m/s: a change that makes rounds beyond the run's number worth while ..
static const uint32_t more = 8; // .. up to so many times that number
static const double turned = 1e-3; // rad: who turns by more in a stride is taken to where it rebounds
static const double plausible = 3; // of what pulls at a body: more acceleration is an impact's
static const int sweeps = 4;
static const double rough = .01; // of what the round before has changed: finer than that, a pair need not be solved now
static const double slop = 1e-4, share = .3; // m; of the penetration, per substep
static const double slop_share = 1. / 8; // of the tolerance, at most

static bool is_jacobi(const ob_sim *s)
{
	return ob_universe_settings(s->u)->solver == OB_SOLVER_JACOBI;
}

// What is small enough: as usual, or less where the run tolerates less.
static double least(const ob_sim *s, double usual, double of_tolerance)
{
	double tolerance = ob_universe_settings(s->u)->tolerance;
	return tolerance > 0 ? fmin(usual, of_tolerance * tolerance) : usual;
}

static void add_rows(ob_island_work *w, ob_body_row *to, ob_body_row *from)
{
	for (uint32_t i = 1; i <= w->members; i++)
		for (int c = 0; c < 6; c++)
			to[i][c] += from[i][c];
	memset(from, 0, w->rows * sizeof *from);
}

// ---- impacts

static double turn_rate(const ob_island_work *w, uint32_t row)
{
	const double *v = w->v[row];
	return w->member[row].shape == OB_SHAPE_SPHERE ? 0 : ob_norm(ob_v3(v[3], v[4], v[5]));
}

// Does one of the two turn noticeably in the stride? Then it rebounds at the stride's start, or not in this one.
static bool turns(const ob_island_work *w, const ob_contact *t)
{
	return fmax(turn_rate(w, t->a), turn_rate(w, t->b)) * w->h > turned;
}

static ob_impact impact_of(const ob_sim *s, const ob_contact *t)
{
	const ob_island_work *w = &s->island;
	double resting = 4 * w->pull * w->substep; // m/s: what comes without impacts
	return (ob_impact){ w->h, turns(w, t) ? ob_adaptive_shortest(w) : w->h, t->e, resting + 1e-6, 1, 1 };
}

static bool elastic(const ob_contact *t)
{
	return t->e > 0 && t->lane != OB_NO_LANE;
}

static ob_impact_rows impact_rows(const ob_island_work *w)
{
	return (ob_impact_rows){ w->v, w->drift, w->d };
}

// instant: s into the stride; < 0: there was none.
static bool note_impact(ob_sim *s, double instant)
{
	s->counters.impacts += instant >= 0;
	s->island.last_impact = fmax(s->island.last_impact, instant);
	return instant >= 0;
}

// Each pair on what the one before it published.
static bool impacts_in_turn(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const ob_impact_rows at = impact_rows(w);
	bool any = false;
	for (uint32_t i = 0; i < w->touches; i++) {
		const ob_contact *t = &w->touch[i];
		ob_impact in = impact_of(s, t);
		if (elastic(t))
			any |= note_impact(s, ob_impact_solve(&w->batch[t->lane / OB_LANES], t->lane % OB_LANES, &in,
							      &at, w->v, w->d));
	}
	return any;
}

// All pairs on the same state, each with its share of the bodies; u is free here and takes the shifts.
static bool impacts_at_once(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const ob_impact_rows at = impact_rows(w);
	bool any = false;
	for (uint32_t i = 0; i < w->rows; i++)
		w->member[i].waiting = 0;
	memset(w->u, 0, w->rows * sizeof *w->u);
	for (int solve = 0; solve < 2; solve++)
		for (uint32_t i = 0; i < w->touches; i++) {
			const ob_contact *t = &w->touch[i];
			ob_impact in = impact_of(s, t);
			if (!elastic(t))
				continue;
			const ob_batch *b = &w->batch[t->lane / OB_LANES];
			int l = t->lane % OB_LANES;
			if (solve) {
				in.split_a = fmax(1, w->member[t->a].waiting);
				in.split_b = fmax(1, w->member[t->b].waiting);
				any |= note_impact(s, ob_impact_solve(b, l, &in, &at, w->delta, w->u));
			} else if (ob_impact_time(b, l, &in, &at) <= in.h) {
				w->member[t->a].waiting++;
				w->member[t->b].waiting++;
			}
		}
	add_rows(w, w->v, w->delta);
	add_rows(w, w->d, w->u);
	return any;
}

// Contacts that were just hit predict what no contact will do again: an impact must not take that for an approach.
static void set_drift(ob_island_work *w)
{
	for (uint32_t i = 1; i <= w->members; i++) {
		const ob_body *m = &w->member[i];
		const double *dv = w->dv[i], most = plausible * w->pull * w->h;
		double linear = ob_norm(ob_v3(dv[0], dv[1], dv[2])), angular = ob_norm(ob_v3(dv[3], dv[4], dv[5]));
		ob_vec3 pull = ob_scale(m->pull, w->h);
		if (linear + m->radius * angular <= most)
			memcpy(w->drift[i], dv, sizeof *w->drift);
		else
			memcpy(w->drift[i], (double[8]){ pull.x, pull.y, pull.z }, sizeof *w->drift);
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
	for (uint32_t i = 0; i < w->touches; i++) {
		ob_contact *t = &w->touch[i];
		ob_impact in = impact_of(s, t);
		if (!elastic(t) || !turns(w, t))
			continue;
		in.within = w->h;
		double when = ob_impact_time(&w->batch[t->lane / OB_LANES], t->lane % OB_LANES, &in, &at);
		if (when <= w->h)
			t->limit = -INFINITY;
		first = fmin(first, when);
	}
	return first;
}

bool ob_solver_impacts(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const int most =
		400; // rounds; what still approaches then is left to the contact solver, which loses its energy
	int round = 0;
	if (!w->elastic)
		return false;
	set_drift(w);
	for (bool any = true; any && round < most; round += any) {
		ob_ghosts_read(s, w->v, (uint32_t)round);
		any = is_jacobi(s) ? impacts_at_once(s) : impacts_in_turn(s);
	}
	s->counters.impact_rounds += (unsigned)round;
	return round > 0;
}

// ---- contacts

void ob_solver_limit_prediction(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const double brought = w->pull * w->h; // m/s, without contacts
	const double growth = .3 * brought * w->mass; // N s
	const double cap[OB_LANES] = { growth, growth, growth, growth };
	for (uint32_t i = 0; i < w->batches; i++)
		ob_batch_limit_prediction(&w->batch[i], cap, 2.5 * brought);
}

void ob_solver_activate(ob_island_work *w, uint32_t row, uint32_t pass)
{
	ob_body *m = &w->member[row];
	if (m->hot == pass || m->inv_mass == 0)
		return;
	m->hot = pass;
	for (uint32_t k = 0; k < m->adjacent; k++) {
		uint32_t lane = w->touch[w->adjacency[m->first_adjacent + k]].lane;
		if (lane != OB_NO_LANE)
			w->batch_due[lane / OB_LANES] = pass + 1;
	}
}

static bool heat_bodies(ob_island_work *w, const ob_batch *b)
{
	for (unsigned left = b->active; left; left &= left - 1) {
		int l = __builtin_ctz(left);
		ob_solver_activate(w, b->body_a[l], w->pass);
		ob_solver_activate(w, b->body_b[l], w->pass);
	}
	return b->active != 0;
}

// One round over the pairs that are worth while, colour by colour. Returns the largest change of a velocity (m/s).
static double make_round(ob_sim *s, const ob_solver_iteration *iteration, bool *hot)
{
	ob_island_work *w = &s->island;
	lanes moved = lanes_of(0);
	*hot = false;
	for (uint32_t k = 0; k < w->batches; k++) {
		const uint32_t i = w->batch_order[k];
		ob_batch *b = &w->batch[i];
		if (iteration->first ? !b->live : w->batch_due[i] < w->pass)
			continue;
		unsigned pairs = (unsigned)__builtin_popcount(b->live);
		s->counters.pair_solves += pairs;
		s->counters.frictionless_solves += b->kind & OB_KIND_FRICTIONLESS ? pairs : 0;
		ob_batch_solve(b, iteration, w->u, w->v, w->d, w->delta);
		*hot |= heat_bodies(w, b);
		moved = lanes_max(moved, b->residual);
	}
	if (iteration->jacobi)
		add_rows(w, w->u, w->delta);
	return fmax(fmax(moved[0], moved[1]), fmax(moved[2], moved[3]));
}

void ob_solver_iterate(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = ob_universe_settings(s->u);
	ob_solver_iteration iteration = { w->h, sweeps,      0, least(s, noticeable, noticeable_rate), jump * w->h / w->substep,
			 true, is_jacobi(s) };
	bool again = true;
	iteration.wake_threshold = fmin(most_noticeable, iteration.wake_threshold * w->substep / w->h); // what lasts shorter, moves less
	ob_direct_begin_partial(&w->forest);
	for (uint32_t round = 0; round < more * run->iterations && again; round++) {
		if (round == run->iterations)
			iteration.wake_threshold = violent;
		s->counters.solver_iterations++;
		ob_ghosts_read(s, w->u, round);
		w->pass += 1 + (round == 0); // a gap, so that nothing is hot from the last substep
		double moved = make_round(s, &iteration, &again);
		if (iteration.first)
			w->stirred = fmax(w->stirred, moved);
		iteration.first = false;
		iteration.block_tolerance = rough * moved;
		if (!ob_direct_wanted(s, moved, again && round + 1 < run->iterations))
			continue;
		ob_direct_solve(s);
		s->counters.direct_solves++;
		again = true;
		for (uint32_t i = 1; i <= w->members; i++)
			ob_solver_activate(w, i, w->pass);
	}
	w->forest.recent = w->forest.solved > 0;
}

// J, of all members together, by which their displacements raise them against what pulls at them
static double raised(const ob_island_work *w)
{
	double sum = 0;
	for (uint32_t i = 1; i <= w->members; i++) {
		const ob_vec3 a = w->member[i].pull;
		sum -= w->member[i].mass * (a.x * w->d[i][0] + a.y * w->d[i][1] + a.z * w->d[i][2]);
	}
	return sum;
}

// What is pushed apart turns, too, and with it its box grows or shrinks: it has to be looked at again.
static void count_push(ob_island_work *w)
{
	for (uint32_t i = 1; i <= w->members; i++) {
		double *was = w->delta[i];
		const double *is = w->d[i];
		ob_vec3 way = ob_v3(is[0] - was[0], is[1] - was[1], is[2] - was[2]);
		ob_vec3 turn = ob_v3(is[3] - was[3], is[4] - was[4], is[5] - was[5]);
		w->member[i].path += ob_norm(way) + w->member[i].radius * ob_norm(turn);
		memset(was, 0, sizeof *w->delta);
	}
}

void ob_solver_project_positions(ob_sim *s)
{
	ob_island_work *w = &s->island;
	bool boxed = ob_universe_settings(s->u)->narrow_phase == OB_NARROW_AABB && !is_jacobi(s);
	double before = raised(w);
	if (boxed)
		memcpy(w->delta + 1, w->d + 1, w->members * sizeof *w->d);
	for (uint32_t k = 0; k < w->batches; k++) {
		ob_batch *b = &w->batch[w->batch_order[k]];
		if (b->live)
			w->pushed |=
				ob_batch_project(b, least(s, slop, slop_share), share, is_jacobi(s), w->d, w->delta);
	}
	if (is_jacobi(s))
		add_rows(w, w->d, w->delta);
	if (boxed)
		count_push(w);
	w->recovered += raised(w) - before;
}

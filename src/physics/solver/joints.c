#include "solver/joints.h"

#include <string.h>

#include "motion/drift.h"
#include "solver/bodies.h"
#include "solver/budget.h"
#include "solver/contacts.h"
#include "solver/joint_axis.h"
#include "solver/joint_load.h"
#include "solver/joint_rows.h"
#include "solver/midpoint.h"

static const double exact = 1e-14; // m, sine: violation that counts as none, beside rounding
static const double rounding = 4e-16; // share of the coordinates
static const double most_violation = 1e-6; // m, sine: a flight that ends with more was too long
static const double misplaced = 1e-9; // m, sine: more at a step's start is not of a flight: bodies were put there
static const double few_rate = .032; // rad: largest swing in a block of five flights, which err by 1e-9 of it then
static const double flight_rate = .5; // rad: largest swing in a flight of a step without blocks

enum {
	MOST_BLOCKS = 4,
	MOST_OF_BLOCK = OB_MAX_SUBSTEPS / (2 * MOST_BLOCKS)
}; // blocks in a step; beyond that single flights

// ---- flights

// Largest violation of a row, and what counts as none beside these coordinates.
static double largest_error(const ob_island_work *w, double *none)
{
	double most = 0, far = 0;
	for (uint32_t i = 0; i < w->joints.count; i++) {
		const ob_held_joint *j = &w->joints.joint[i];
		for (uint32_t r = 0; r < j->rows.rows; r++)
			most = ob_max(most, fabs(j->error[r]));
		far = ob_max(far, ob_norm(j->end[0].at));
	}
	*none = exact + rounding * far;
	return most;
}

static void clear_sums(ob_island_work *w)
{
	for (uint32_t i = 0; i < w->joints.count; i++)
		memset(w->joints.joint[i].sum, 0, sizeof w->joints.joint[i].sum);
}

// Adds the rows of rotors, and of dampers over half of a flight of h (s), and factors. h 0: of rotors alone.
static void factor(ob_island_work *w, double h)
{
	for (uint32_t i = 0; w->joints.axes && i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		double force, damping, inertia = ob_axis_armature(j);
		if (j->axis && h != 0) {
			ob_axis_find_terms(j, j->along.rotor_rate, h, &force, &damping);
			inertia += .5 * h * damping;
		}
		j->along.softness = inertia != 0 ? 1 / inertia : 0;
		j->rows.rows = j->base + j->along.engaged + (inertia != 0);
	}
	ob_joints_factor(w);
}

// Rates of all rows: none, but for the axes that something moves, and for rotors, which have those of their axes.
static void set_targets(ob_island_work *w)
{
	for (uint32_t i = 0; i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		memset(j->target, 0, sizeof j->target);
		if (j->along.softness != 0)
			j->target[j->base + j->along.engaged] = ob_joint_axis_rate(j, w->v);
		if (j->along.engaged)
			j->target[j->base] = j->along.goal_rate;
	}
}

// Half of the change by external forces and torques, before or after a flight of h (s).
static void push_bodies(ob_island_work *w, double h)
{
	for (uint32_t row = 1; row <= w->bodies; row++) {
		const ob_body *body = &w->body[row];
		const ob_vec3 turn = w->torques ? ob_body_turned_by(body, body->torque) : ob_v3(0, 0, 0);
		ob_row_add(w->v[row], ob_scale(body->acceleration, .5 * h), ob_scale(turn, .5 * h));
	}
}

// Notes the values and rates of all axes, and of their rotors.
static void note_rates(ob_island_work *w)
{
	for (uint32_t i = 0; w->joints.axes && i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		if (!j->axis)
			continue;
		j->along.rotor = j->along.value, j->along.rotor_rate = ob_joint_axis_rate(j, w->v);
		j->along.rotor_attitude = ob_quat_mul(ob_quat_conjugate(j->end[1].attitude), j->end[0].attitude);
	}
}

// Half of the change by what acts along axes in a flight of h (s), at the rates noted.
static void push_axes(ob_island_work *w, double h)
{
	for (uint32_t i = 0; w->joints.axes && i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		if (j->axis)
			ob_joint_push_axis(j, .5 * h * ob_axis_force(j, j->along.rotor_rate, h), w->v);
	}
}

// The same by the rates that it leaves, with the joints. Motors are clamped as they are at the rates noted.
static void push_axes_implicitly(ob_island_work *w, double h)
{
	factor(w, h);
	clear_sums(w);
	set_targets(w);
	for (uint32_t i = 0; i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		double force, damping;
		if (!j->axis)
			continue;
		ob_axis_find_terms(j, j->along.rotor_rate, h, &force, &damping);
		if (j->along.softness != 0)
			j->target[j->base + j->along.engaged] =
				j->along.softness * (.5 * h * force + j->axis->armature * j->along.rotor_rate);
		else
			ob_joint_push_axis(j, .5 * h * force, w->v);
	}
	ob_joints_solve(w, w->v);
}

// Moves from the start of the flight for h (s) with the velocities u: straight, and turning freely.
static void fly_freely(ob_island_work *w, double h)
{
	for (uint32_t row = 1; row <= w->bodies; row++) {
		ob_body *body = &w->body[row];
		const ob_vec3 v = ob_row_linear(w->u[row]);
		ob_vec3 rate;
		ob_quat q;
		ob_drift(body->start_q, ob_row_angular(w->u[row]), body->inertia, h, &q, &rate);
		ob_body_place(body, ob_madd(body->start_p, h, v), q);
		memset(w->v[row], 0, sizeof *w->v);
		ob_row_add(w->v[row], v, rate);
	}
}

// Finds the impulses at the flight's start after which no row is violated at its end: a Newton iteration with the
// equations of the start. Their sums hold the first guess.
static void aim(ob_island_work *w, double h, double end)
{
	enum { MOST_ROUNDS = 32 };
	double before = INFINITY, none;
	for (int round = 0; round < MOST_ROUNDS; round++) {
		for (uint32_t row = 1; row <= w->bodies; row++)
			memcpy(w->u[row], w->dv[row], sizeof *w->u);
		for (uint32_t i = 0; i < w->joints.count; i++)
			ob_joint_respond(&w->joints.joint[i], w->joints.joint[i].sum, w->u);
		fly_freely(w, h);
		ob_joints_find(w, end);
		const double error = largest_error(w, &none);
		if (error <= none || (round > 2 && !(error < .5 * before))) {
			w->joints.failed |= !(error < most_violation);
			return;
		}
		before = error;
		for (uint32_t i = 0; i < w->joints.count; i++) {
			ob_held_joint *j = &w->joints.joint[i];
			for (uint32_t r = 0; r < j->rows.rows; r++)
				j->rows.y[r] = -j->error[r] / h;
		}
		ob_joints_find_impulses(w);
		for (uint32_t i = 0; i < w->joints.count; i++)
			for (uint32_t r = 0; r < w->joints.joint[i].rows.rows; r++)
				w->joints.joint[i].sum[r] += w->joints.joint[i].rows.x[r];
	}
	w->joints.failed = true;
}

// Moment of inertia (kg m^2) against turning the arm, as a mean over the axes across it.
static double inertia_across(const ob_body *b, ob_vec3 arm)
{
	const double *i = b->inv_inertia, length2 = ob_norm2(arm);
	return 2 / (i[0] + i[3] + i[5] - ob_dot(arm, ob_body_turned_by(b, arm)) / length2);
}

// Notes squared rates (1/s^2) of the body at an end of a joint that pulls with a force (N): at which that may swing it about its arm,
// or turns it; and all, also those of a pendulum that turns back, of the end of a distance, of a top that nods.
static void note_rates2(const ob_island_work *w, const ob_held_joint *j, const ob_joint_end *e, double force,
			double *swing, double *all)
{
	const ob_body *b = &w->body[e->row];
	const bool alone = b->joints == 1;
	const double arm = ob_norm(e->arm), pull = ob_max(force, b->mass * ob_norm(b->acceleration)),
		     round = j->length > 0 ? 2 * pull * b->inv_mass / j->length : 0;
	const ob_vec3 rate = ob_row_angular(w->v[e->row]), own = ob_rotate_back(&b->r, rate), i = b->inertia;
	*all = ob_max(*all, e->row ? round : 0);
	if (!e->row || !(arm > 0))
		return;
	const double own_inertia = inertia_across(b, e->arm), inertia = own_inertia + (alone ? b->mass * arm * arm : 0),
		     spin = ob_norm(ob_v3(i.x * own.x, i.y * own.y, i.z * own.z)) / own_inertia,
		     turns = ob_norm(ob_cross(rate, e->arm)) / arm;
	*swing = ob_max(*swing, ob_max((alone ? 1 : 2) * force * arm / inertia, turns * turns));
	*all = ob_max(*all, round + ob_max(spin * spin, 2 * pull * arm / inertia));
}

// Notes the stiffness of the joints, whose impulses at the end of a flight of h (s) have been found.
static void note_stiffness(ob_island_work *w, double h)
{
	double most = 0, all = 0;
	for (uint32_t i = 0; i < w->joints.count; i++) {
		const ob_held_joint *j = &w->joints.joint[i];
		ob_vec3 pull = { 0, 0, 0 };
		for (uint32_t r = 0; r < j->rows.rows; r++)
			pull = ob_madd(pull, j->sum[r], ob_row_linear(j->rows.child[r]));
		for (int side = 0; side < 2; side++)
			note_rates2(w, j, &j->end[side], 2 * ob_norm(pull) / fabs(h), &most, &all);
		if (j->axis)
			most = ob_max(most, ob_axis_swing(j) * ob_axis_swing(j));
	}
	w->joints.stiffness = ob_max(w->joints.stiffness, sqrt(most));
	w->joints.swing = ob_max(w->joints.swing, sqrt(ob_max(most, all)));
}

// Rows of rotors move as their rotors do.
static void aim_rotors(ob_island_work *w)
{
	for (uint32_t i = 0; w->joints.axes && i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		if (j->along.softness != 0)
			j->target[j->base + j->along.engaged] = j->along.rotor_rate;
	}
}

// Begins a flight of h (s): forces along axes are those of the rates that they leave, if there are dampers.
static void begin_flight(ob_island_work *w, double h)
{
	note_rates(w);
	push_bodies(w, h);
	if (!w->joints.damped) {
		push_axes(w, h);
		return;
	}
	push_axes_implicitly(w, h);
	factor(w, 0);
	note_rates(w);
}

// After it: the other way round, so that the flight is symmetric.
static void end_flight(ob_island_work *w, double h)
{
	if (w->joints.damped) {
		ob_joints_solve(w, w->v);
		note_rates(w);
	}
	push_axes(w, h);
	push_bodies(w, h);
	ob_joints_solve(w, w->v);
}

// Tells the rows of rotors of the flight for which the joints aim; 0: ends it, and lets them turn on.
static void set_flight(ob_island_work *w, double h)
{
	for (uint32_t i = 0; w->joints.axes && i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		j->along.flight = h;
		if (h == 0 && j->along.softness != 0)
			j->along.rotor_rate -= j->along.softness * j->sum[j->base + j->along.engaged];
	}
}

// Flies for h (s), of any sign, to this time. The rows of its start have been factored, and so are those of its end.
static void fly(ob_island_work *w, double h, double end)
{
	begin_flight(w, h);
	for (uint32_t i = 0; i < w->joints.count; i++)
		memcpy(w->joints.joint[i].sum, w->joints.joint[i].guess, sizeof w->joints.joint[i].sum);
	for (uint32_t row = 1; row <= w->bodies; row++) {
		ob_body *body = &w->body[row];
		body->start_p = body->p;
		body->start_q = body->q;
		memcpy(w->dv[row], w->v[row], sizeof *w->dv);
	}
	set_flight(w, h);
	aim(w, h, end);
	set_flight(w, 0);
	for (uint32_t i = 0; i < w->joints.count; i++)
		ob_joint_note(&w->joints.joint[i], w->joints.joint[i].sum);
	factor(w, 0);
	clear_sums(w);
	aim_rotors(w);
	end_flight(w, h);
	note_stiffness(w, h);
}

// Scales the impulses of the last flight's end as a first guess for a flight of another length.
static void guess(ob_island_work *w, double ratio)
{
	for (uint32_t i = 0; i < w->joints.count; i++)
		for (uint32_t r = 0; r < OB_JOINT_ROWS; r++)
			w->joints.joint[i].guess[r] = ratio * w->joints.joint[i].sum[r];
}

// Adds what the bodies have moved at most in h (s) to their paths, and counts their turns.
static void note_paths(ob_solver *s, double h)
{
	ob_island_work *w = &s->island;
	for (uint32_t row = 1; row <= w->bodies; row++) {
		const double before = w->body[row].speed;
		ob_body_set_velocity(w, row, ob_row_linear(w->v[row]), ob_row_angular(w->v[row]));
		w->body[row].path += h * ob_max(before, w->body[row].speed);
		ob_body_count_turn(s, row);
	}
}

static void update_poses(ob_island_work *w)
{
	for (uint32_t row = 1; row <= w->bodies; row++)
		if (w->body[row].joints)
			ob_body_update_pose(w, row);
}

// Finds the rows, with those of axes that are beyond a limit. true: some have come.
static bool find_with_limits(ob_island_work *w, double time)
{
	bool any = false;
	ob_joints_find(w, time);
	for (uint32_t i = 0; w->joints.axes && i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		if (!j->axis || j->along.limit || !(j->along.value > j->axis->high || j->along.value < j->axis->low))
			continue;
		ob_axis_rest(j, j->along.value > j->axis->high ? 1 : -1, time);
		any = true;
	}
	if (any)
		ob_joints_find(w, time);
	return any;
}

void ob_joints_project(ob_solver *s)
{
	enum { ROUNDS = 16 };
	ob_island_work *w = &s->island;
	double before = INFINITY, none;
	ob_joints_free_axes(w);
	for (int round = 0; w->joints.count && round < ROUNDS; round++) {
		update_poses(w);
		if (find_with_limits(w, w->joints.step_begin + w->time))
			before = INFINITY;
		const double error = largest_error(w, &none);
		if (error <= none || !(error < .5 * before))
			return;
		before = error;
		ob_joints_factor(w);
		for (uint32_t i = 0; i < w->joints.count; i++)
			for (uint32_t r = 0; r < w->joints.joint[i].rows.rows; r++)
				w->joints.joint[i].rows.y[r] = -w->joints.joint[i].error[r];
		ob_joints_find_impulses(w);
		for (uint32_t i = 0; i < w->joints.count; i++)
			ob_joint_respond(&w->joints.joint[i], w->joints.joint[i].rows.x, w->d);
	}
	update_poses(w);
}

// Lengths of the flights of a block, as shares (Kahan and Li, "Composition constants for raising the orders of
// unconventional schemes for ordinary differential equations", 1997: s9odr6a).
static const double shares[] = { .39216144400731413928,  .33259913678935943860, -.70624617255763935981,
				 .082213596293550800230, .79854399093482996340, .082213596293550800230,
				 -.70624617255763935981, .33259913678935943860, .39216144400731413928 };
// Five flights of the fourth order that begin as those nine do.
static const double few_shares[] = { .39216144400731413928, .43851686650098997310, -.66135662102160822476,
				     .43851686650098997310, .39216144400731413928 };
static const double single[] = { 1 };

// Division of a step into parts of h (s), each of so many flights.
typedef struct division {
	uint32_t parts, flights;
	const double *share;
	double h;
} division;

// Returns the number of substeps for which a block stands: the run's, but so few that a step has room for more flights than
// blocks have.
static uint32_t substeps_of_block(const ob_solver *s)
{
	return s->settings->substeps < MOST_OF_BLOCK ? s->settings->substeps : MOST_OF_BLOCK;
}

static division divide(const ob_solver *s)
{
	const uint32_t block = substeps_of_block(s), n = s->island.substeps;
	const bool blocks = n >= block && n <= MOST_BLOCKS * block;
	const uint32_t parts = blocks && !s->island.joints.breakable ? (n + block - 1) / block : n;
	return (division){ parts, blocks ? sizeof shares / sizeof *shares : 1, blocks ? shares : single,
			   s->settings->step_length / parts };
}

// An event along the axis of a joint, and how far its state is from it.
typedef struct axis_event {
	double margin;
	uint32_t joint;
	ob_axis_event kind;
} axis_event;

// Returns the event that has happened most, or that is nearest.
static axis_event next_event(const ob_island_work *w)
{
	const double half = .5 * w->joints.last_share * w->joints.last_length;
	axis_event next = { INFINITY, 0, OB_AXIS_NONE };
	for (uint32_t i = 0; i < w->joints.count; i++) {
		const ob_held_joint *j = &w->joints.joint[i];
		ob_axis_event kind;
		if (!j->axis)
			continue;
		const double force = j->along.engaged && half != 0 ? j->sum[j->base] / half : 0,
			     margin = ob_axis_margin(j, ob_joint_axis_rate(j, w->v), force, &kind);
		if (margin < next.margin)
			next = (axis_event){ margin, i, kind };
	}
	return next;
}

// Flies from part "from" of the step, a share of it may have been done, for h (s); not on from its first flight if the event that
// this finds has happened. event: NULL: none is looked for. Returns the time flown.
static double fly_part(ob_solver *s, const division *d, double from, double h, axis_event *event)
{
	enum { WORK_OF_FLIGHT = 64 }; // for a joint
	ob_island_work *w = &s->island;
	const bool alone = d->share == single || (w->joints.swing > 0 && w->joints.swing * h < few_rate * few_rate);
	const double *share = alone ? single : d->share;
	uint32_t flights = alone ? 1 : d->flights;
	double done = 0;
	for (uint32_t i = 0; i < flights && !w->joints.failed; i++) {
		done += share[i];
		guess(w, w->joints.last_share != 0 ? share[i] / w->joints.last_share * (h / w->joints.last_length) : 0);
		ob_budget_note(s, WORK_OF_FLIGHT * w->joints.count);
		const double part = (i + 1 < flights ? done : 1) * (h / d->h);
		fly(w, share[i] * h, w->joints.step_begin + (from + part) * d->h);
		w->joints.last_share = share[i], w->joints.last_length = h;
		if (i == 0 && share == shares && w->joints.swing * h < few_rate)
			share = few_shares, flights = sizeof few_shares / sizeof *few_shares;
		if (event && (i == 0 || i + 1 == flights))
			*event = next_event(w);
		if (event && event->margin < 0)
			return done * h;
	}
	return h;
}

// Lets velocities be those that the rows allow, after these have changed.
static void change_rows(ob_island_work *w)
{
	factor(w, 0);
	set_targets(w);
	clear_sums(w);
	ob_joints_solve(w, w->v);
	clear_sums(w);
	w->joints.last_share = 0;
}

// ---- events along axes

// States kept: of the last event, and of the begin of the part.
enum { OF_EVENT, OF_PART };

static void keep_states(ob_island_work *w, uint32_t of)
{
	for (uint32_t row = 1; row <= w->bodies; row++) {
		ob_joint_kept *k = &w->joints.kept[of * w->bodies + row - 1];
		k->p = w->body[row].p, k->q = w->body[row].q;
		memcpy(k->v, w->v[row], sizeof k->v);
	}
	ob_joint_loads_keep(&w->joints);
}

// Goes back to the states kept, of this time (s).
static void put_back(ob_island_work *w, uint32_t of, double time)
{
	for (uint32_t row = 1; row <= w->bodies; row++) {
		const ob_joint_kept *k = &w->joints.kept[of * w->bodies + row - 1];
		ob_body_place(&w->body[row], k->p, k->q);
		memcpy(w->v[row], k->v, sizeof k->v);
	}
	ob_joint_loads_put_back(&w->joints);
	ob_joints_find(w, time);
	factor(w, 0);
	clear_sums(w);
	w->joints.last_share = 0;
}

static void enter_axes(ob_island_work *w)
{
	for (uint32_t i = 0; i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		if (!j->axis)
			continue;
		ob_axis_enter(j, ob_joint_axis_rate(j, w->v), w->joints.now);
	}
}

// Frees one limit that the last solution pulls at. false: none.
static bool free_limit(ob_island_work *w)
{
	for (uint32_t i = 0; i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		if (j->axis && j->along.limit * j->sum[j->base] > 0) {
			ob_axis_disengage(j);
			return true;
		}
	}
	return false;
}

// A limit is hit: an impulse, to which limits on which others rest give their share. Forces give none.
static void hit_limit(ob_island_work *w, ob_held_joint *hit, int limit)
{
	const double rate = ob_joint_axis_rate(hit, w->v), e = ob_axis_restitution(hit, rate);
	for (uint32_t i = 0; i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		if (j->axis && j->along.engaged && !j->along.limit && (j == hit || !ob_axis_is_driven(j)))
			ob_axis_disengage(j);
	}
	ob_axis_rest(hit, limit, w->joints.now);
	keep_states(w, OF_EVENT);
	do {
		for (uint32_t row = 1; row <= w->bodies; row++)
			memcpy(w->v[row], w->joints.kept[row - 1].v, sizeof *w->v);
		ob_joint_loads_put_back(&w->joints);
		factor(w, 0);
		set_targets(w);
		hit->target[hit->base] = -e * rate;
		clear_sums(w);
		ob_joints_solve(w, w->v);
	} while (free_limit(w));
	const bool rests = hit->along.limit && !(e > 0);
	enter_axes(w);
	if (rests)
		ob_axis_rest(hit, limit, w->joints.now);
}

static void pass(ob_island_work *w, const axis_event *event)
{
	ob_held_joint *j = &w->joints.joint[event->joint];
	if (event->kind == OB_AXIS_LOW || event->kind == OB_AXIS_HIGH)
		hit_limit(w, j, event->kind == OB_AXIS_LOW ? -1 : 1);
	else
		ob_axis_pass(j, event->kind, w->joints.now);
	change_rows(w);
}

// Bracket of an event's instant, in seconds from the start of a flight.
typedef struct bracket {
	double low, high, low_margin, high_margin;
	int side; // that moved last
	double last, before; // its width at the last two tries
} bracket;

// Next instant to try. Forces change at once: without a margin at the start the shortest flight comes first. Then it is a false position (Illinois),
// beyond an end that is at the event, so that the bracket closes; the middle where two tries have not halved it.
static double try_at(bracket *b, double shortest, double resolved)
{
	const double inset = .9 * resolved, width = b->high - b->low,
		     t = (b->low * b->high_margin - b->high * b->low_margin) / (b->high_margin - b->low_margin);
	const bool halves = width <= .5 * b->before;
	b->before = b->last, b->last = width;
	if (b->low <= 0 && (b->low_margin <= 0 || t < shortest) && b->high > shortest)
		return shortest;
	return halves ? ob_max(b->low + inset, ob_min(t, b->high - inset)) : .5 * (b->low + b->high);
}

static void narrow(bracket *b, double t, double margin)
{
	const int side = margin < 0 ? 1 : -1;
	if (side > 0)
		b->high = t, b->high_margin = margin, b->low_margin *= b->side == side ? .5 : 1;
	else
		b->low = t, b->low_margin = margin, b->high_margin *= b->side == side ? .5 : 1;
	b->side = side;
}

// Flies up to the first event found within h (s), and passes it. Returns the time flown.
static double fly_to_event(ob_solver *s, const division *d, double from, double h)
{
	enum { MOST_ROUNDS = 48 };
	const double shortest = 1e-3 * d->h,
		     exact_time = 1e-10 * d->h; // shorter flights find no forces, but for rounding
	ob_island_work *w = &s->island;
	if (!w->joints.axes)
		return fly_part(s, d, from, h, NULL);
	keep_states(w, OF_EVENT);
	axis_event event = next_event(w);
	const double start = event.margin;
	double t = fly_part(s, d, from, h, &event);
	bool found = t == h; // by the whole part: its first flight alone may find what is not there
	if (w->joints.failed || event.margin >= 0 || ob_budget_spent(s))
		return h;
	bracket b = { .low_margin = w->joints.joint[event.joint].along.engaged ? 0 : start,
		      .high = t,
		      .high_margin = event.margin,
		      .last = INFINITY,
		      .before = INFINITY };
	for (int round = 0; round < MOST_ROUNDS && b.high - b.low > exact_time && b.high > shortest; round++) {
		put_back(w, OF_EVENT, w->joints.step_begin + from * d->h);
		t = try_at(&b, shortest, exact_time);
		fly_part(s, d, from, t, NULL);
		const axis_event now = next_event(w);
		narrow(&b, t, now.margin);
		if (now.margin < 0)
			event = now, found = true;
	}
	if (t != b.low) {
		put_back(w, OF_EVENT, w->joints.step_begin + from * d->h);
		if (b.low > 0)
			fly_part(s, d, from, b.low, NULL);
	}
	if (found)
		pass(w, &event);
	return b.low;
}

// Flies through a part of the step, from one event along an axis to the next.
static void fly_whole_part(ob_solver *s, const division *d, uint32_t part)
{
	enum { MOST_EVENTS = 64 };
	ob_island_work *w = &s->island;
	double done = 0;
	for (int event = 0; done < d->h && event < MOST_EVENTS && !w->joints.failed && !ob_budget_spent(s); event++)
		done += fly_to_event(s, d, (double)part + done / d->h, d->h - done);
	if (done < d->h && !w->joints.failed)
		fly_part(s, d, (double)part + done / d->h, d->h - done, NULL);
}

static void find_axes(ob_island_work *w, double time)
{
	ob_joints_find(w, time);
	if (!w->joints.axes)
		return;
	ob_joints_free_axes(w);
	for (uint32_t i = 0; i < w->joints.count; i++)
		ob_joint_find_rows(w, &w->joints.joint[i]);
	if (w->joints.soft) {
		ob_joints_factor(w);
		ob_joints_find_responses(w);
	}
	enter_axes(w);
	ob_joints_find(w, time);
}

// Flies through a part of the step, and again without each joint that it breaks.
static void fly_and_break(ob_solver *s, const division *d, uint32_t part)
{
	ob_island_work *w = &s->island;
	ob_held_joint *weakest;
	ob_joint_loads_begin(&w->joints);
	if (w->joints.breakable)
		keep_states(w, OF_PART);
	fly_whole_part(s, d, part);
	while (!w->joints.failed && !ob_budget_spent(s) && (weakest = ob_joint_loads_weakest(&w->joints, d->h))) {
		const double begin = w->joints.step_begin + part * d->h;
		ob_joint_break(w, weakest, d->h);
		ob_joint_loads_begin(&w->joints);
		ob_joint_loads_keep(&w->joints);
		put_back(w, OF_PART, begin);
		find_axes(w, begin);
		change_rows(w);
		fly_whole_part(s, d, part);
	}
	ob_joint_loads_end(&w->joints);
}

// Puts bodies where their joints hold them as the step begins, and takes away velocities that these do not allow.
static void begin_flights(ob_solver *s)
{
	ob_island_work *w = &s->island;
	double none;
	find_axes(w, w->joints.step_begin);
	if (largest_error(w, &none) > misplaced) {
		ob_joints_project(s);
		find_axes(w, w->joints.step_begin);
	}
	change_rows(w);
}

bool ob_joints_fly(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const division d = divide(s);
	begin_flights(s);
	for (uint32_t k = 0; k < d.parts && !w->joints.failed && !ob_budget_spent(s); k++) {
		fly_and_break(s, &d, k);
		note_paths(s, d.h);
	}
	w->time = s->settings->step_length;
	return ob_joints_substeps(s) <= w->substeps && !w->joints.failed;
}

uint32_t ob_joints_substeps(const ob_solver *s)
{
	const ob_joint_set *set = &s->island.joints;
	const uint32_t block = substeps_of_block(s);
	const double swing = set->stiffness * s->settings->step_length;
	uint32_t n = s->settings->substeps;
	if (set->failed)
		return s->island.substeps < OB_MAX_SUBSTEPS / 2 ? 2 * s->island.substeps : OB_MAX_SUBSTEPS;
	while (n < MOST_BLOCKS * block && n < swing * block)
		n *= 2;
	if (n < swing * block)
		for (n *= 2; n < OB_MAX_SUBSTEPS && flight_rate * n < swing;)
			n *= 2;
	return n < OB_MAX_SUBSTEPS ? n : OB_MAX_SUBSTEPS;
}

uint32_t ob_joints_finer(const ob_solver *s, uint32_t n)
{
	const uint32_t blocks = MOST_BLOCKS * substeps_of_block(s);
	return 2 * n <= blocks || (n > blocks && 2 * n <= OB_MAX_SUBSTEPS / 4) ? 2 * n : 0;
}

// ---- among contacts

// Finds the rows of all axes at the midpoint.
static void begin_axes(ob_island_work *w)
{
	for (uint32_t i = 0; i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		if (j->axis)
			ob_axis_begin(j, ob_joint_axis_rate(j, w->v), w->h);
	}
	ob_joints_factor(w);
}

void ob_joints_begin(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const double begin = w->joints.step_begin + w->time;
	if (!w->joints.count)
		return;
	update_poses(w);
	ob_joints_find_free(w, begin);
	set_targets(w);
	ob_joint_loads_put_back(&w->joints); // drops a try that was too long
	ob_joints_solve(w, w->v); // plastic impacts know no joints
	ob_joint_loads_keep(&w->joints);
	for (uint32_t row = 1; row <= w->bodies; row++)
		if (w->body[row].joints)
			ob_midpoint_halve(s, row);
	ob_joints_find(w, begin + .5 * w->h);
	ob_joints_factor(w);
	clear_sums(w);
	for (uint32_t i = 0; i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		for (uint32_t r = 0; r < j->base; r++)
			j->target[r] = -ob_joint_row_velocity(j, r, w->v);
	}
	if (w->joints.axes)
		begin_axes(w);
	ob_contacts_prepare(s);
	ob_bodies_warm_start(s);
	for (uint32_t i = 0; w->joints.axes && i < w->joints.count; i++)
		if (w->joints.joint[i].axis)
			ob_joint_push_axis(&w->joints.joint[i], w->joints.joint[i].along.applied, w->dv);
}

void ob_joints_end(ob_solver *s)
{
	ob_island_work *w = &s->island;
	ob_held_joint *weakest = ob_joint_loads_weakest(&w->joints, w->substep);
	if (weakest)
		ob_joint_break(w, weakest, w->substep);
	ob_joint_loads_end(&w->joints);
}

// ---- at rest

bool ob_joints_may_rest(const ob_island_work *w)
{
	for (uint32_t i = 0; i < w->joints.count; i++)
		for (int side = 0; side < 2; side++) {
			const ob_motion *m = w->joints.joint[i].end[side].motion;
			if (m && (ob_norm2(m->v) > 0 || ob_norm2(m->w) > 0 || ob_norm2(m->a) > 0 ||
				  isfinite(m->valid_until)))
				return false;
		}
	return true;
}

void ob_joints_find_rest(ob_solver *s)
{
	ob_island_work *w = &s->island;
	if (!w->joints.count)
		return;
	update_poses(w);
	ob_joints_find_free(w, w->joints.now);
	clear_sums(w);
	for (uint32_t i = 0; i < w->joints.count; i++)
		memset(w->joints.joint[i].target, 0, sizeof w->joints.joint[i].target);
	if (!w->joints.axes)
		return;
	begin_axes(w);
	for (uint32_t i = 0; i < w->joints.count; i++)
		if (w->joints.joint[i].axis)
			ob_joint_push_axis(&w->joints.joint[i], w->joints.joint[i].along.applied, w->u);
}

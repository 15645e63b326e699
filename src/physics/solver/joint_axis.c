#include "solver/joint_axis.h"

#include <math.h>

static const double same_rate = 1e-10; // m/s, rad/s: a smaller difference counts as none
static const double at_limit = 1e-10; // m, rad
static const double value_rounding = 1e-12, force_rounding = 1e-9; // m, rad; share of the force
static const double slowest_bounce = .01; // m/s, rad/s: slower hits on a limit have no restitution

// ---- value

// Difference of two values: of a turn about an axis the least, for its value jumps after half a turn.
static double difference(const ob_held_joint *j, double x, double y)
{
	const bool turn = j->kind == OB_JOINT_HINGE || j->kind == OB_JOINT_UNIVERSAL;
	return turn ? x - y - 2 * M_PI * nearbyint((x - y) / (2 * M_PI)) : x - y;
}

double ob_axis_armature(const ob_held_joint *j)
{
	return j->axis ? j->axis->armature : 0;
}

void ob_axis_find(ob_held_joint *j, double value, double turned, double time)
{
	double *error = &j->error[j->base];
	const double held = j->along.goal + j->along.goal_rate * (time - j->along.since);
	j->along.value = value;
	error[0] = j->along.engaged ? difference(j, value, held) : 0;
	error[1] = 0;
	if (j->along.flight != 0 && j->axis->armature > 0) {
		const uint32_t row = j->along.engaged;
		const double rate = j->along.rotor_rate - j->sum[j->base + row] / j->axis->armature;
		error[row] = j->kind == OB_JOINT_BALL ? turned - j->along.flight * rate
						      : difference(j, value, j->along.rotor + j->along.flight * rate);
	}
}

// ---- friction and motors that hold a rate

// The rates that are held, ascending, and the greatest force of each.
typedef struct holders {
	uint32_t count;
	double rate[2], most[2];
} holders;

static holders holders_of(const ob_joint_axis *a)
{
	holders h = { 0 };
	const bool motor = a->motor == OB_MOTOR_RATE && a->most > 0;
	if (motor && (a->target < 0 || !(a->friction > 0)))
		h.rate[h.count] = a->target, h.most[h.count++] = a->most;
	if (a->friction > 0)
		h.rate[h.count] = 0, h.most[h.count++] = a->friction + (motor && a->target == 0 ? a->most : 0);
	if (motor && a->target > 0 && a->friction > 0)
		h.rate[h.count] = a->target, h.most[h.count++] = a->most;
	return h;
}

bool ob_axis_is_driven(const ob_held_joint *j)
{
	return j->axis->motor == OB_MOTOR_RATE && isinf(j->axis->most);
}

// Place of a rate: 2 i + 1 at the holder i, even ones between them.
static uint32_t place_of(const holders *h, double rate)
{
	uint32_t below = 0, at = UINT32_MAX;
	for (uint32_t i = 0; i < h->count; i++) {
		if (isinf(h->most[i]))
			return 2 * i + 1;
		if (fabs(rate - h->rate[i]) <= same_rate)
			at = 2 * i + 1;
		below += h->rate[i] < rate;
	}
	return at < UINT32_MAX ? at : 2 * below;
}

// Bounds of the force at a place.
static void bounds_at(const holders *h, uint32_t place, double *low, double *high)
{
	*low = *high = 0;
	for (uint32_t i = 0; i < h->count; i++) {
		*low += place > 2 * i ? -h->most[i] : h->most[i];
		*high += place > 2 * i + 1 ? -h->most[i] : h->most[i];
	}
}

// Bounds of the force at rest on a limit.
static void bounds_at_rest(const ob_held_joint *j, double *low, double *high)
{
	const holders h = holders_of(j->axis);
	bounds_at(&h, place_of(&h, 0), low, high);
}

bool ob_axis_slides(const ob_held_joint *j)
{
	const holders h = holders_of(j->axis);
	double low, high;
	bounds_at(&h, j->along.place, &low, &high);
	return !j->along.engaged && low != 0;
}

// ---- states

static void engage(ob_held_joint *j, double value, double rate, double time)
{
	j->along.engaged = true;
	j->along.goal = value, j->along.goal_rate = rate, j->along.since = time;
	j->rows.rows = j->base + 1;
}

void ob_axis_disengage(ob_held_joint *j)
{
	j->along.engaged = false;
	j->along.limit = 0;
	j->rows.rows = j->base;
}

void ob_axis_rest(ob_held_joint *j, int limit, double time)
{
	j->along.limit = limit;
	engage(j, limit > 0 ? j->axis->high : j->axis->low, 0, time);
}

static void enter_place(ob_held_joint *j, const holders *h, uint32_t place, double time)
{
	ob_axis_disengage(j);
	j->along.place = place;
	if (place & 1)
		engage(j, j->along.value, h->rate[place / 2], time);
}

// Limit on which the axis rests, or beyond which it has been put; 0: none.
static int limit_of(const ob_held_joint *j, double rate)
{
	const double above = j->along.value - j->axis->high, below = j->axis->low - j->along.value;
	const bool driven = ob_axis_is_driven(j);
	if (above >= -at_limit && (above > at_limit || (driven ? j->axis->target >= 0 : fabs(rate) <= same_rate)))
		return 1;
	if (below >= -at_limit && (below > at_limit || (driven ? j->axis->target <= 0 : fabs(rate) <= same_rate)))
		return -1;
	return 0;
}

void ob_axis_enter(ob_held_joint *j, double rate, double time)
{
	const holders h = holders_of(j->axis);
	const int limit = limit_of(j, rate);
	enter_place(j, &h, place_of(&h, rate), time);
	if (limit)
		ob_axis_rest(j, limit, time);
}

void ob_axis_pass(ob_held_joint *j, ob_axis_event event, double time)
{
	const holders h = holders_of(j->axis);
	uint32_t place = j->along.place;
	if (event == OB_AXIS_RELEASED) {
		const uint32_t rest = place_of(&h, 0);
		const bool up = j->along.limit < 0;
		place = rest & 1 ? rest + (up ? 1 : -1) : rest;
	} else {
		place += event == OB_AXIS_FASTER ? 1 : -1;
	}
	enter_place(j, &h, place, time);
}

double ob_axis_restitution(const ob_held_joint *j, double rate)
{
	return ob_axis_is_driven(j) || !(j->axis->restitution * fabs(rate) > slowest_bounce) ? 0 : j->axis->restitution;
}

// ---- forces

static double clamped(double x, double most)
{
	return ob_max(-most, ob_min(most, x));
}

// Stiffness, at most what a flight of h (s) can follow.
static double followed(const ob_held_joint *j, double stiffness, double h)
{
	return ob_min(stiffness, 1 / (j->along.response * h * h));
}

void ob_axis_find_terms(const ob_held_joint *j, double rate, double h, double *force, double *damping)
{
	const ob_joint_axis *a = j->axis;
	*force = followed(j, a->stiffness, h) * (a->rest - j->along.value);
	*damping = a->damping;
	if (a->motor == OB_MOTOR_VALUE) {
		const double pull = followed(j, a->motor_stiffness, h) * (a->target - j->along.value),
			     all = pull - a->motor_damping * rate;
		const bool most = fabs(all) > a->most;
		*force += most ? clamped(all, a->most) : pull;
		*damping += most ? 0 : a->motor_damping;
	}
	if (!j->along.engaged) {
		const holders held = holders_of(a);
		double low, high;
		bounds_at(&held, j->along.place, &low, &high);
		*force += low;
	}
}

double ob_axis_force(const ob_held_joint *j, double rate, double h)
{
	double force, damping;
	ob_axis_find_terms(j, rate, h, &force, &damping);
	return force - damping * rate;
}

static double stiffness_of(const ob_joint_axis *a)
{
	return a->stiffness + (a->motor == OB_MOTOR_VALUE ? a->motor_stiffness : 0);
}

static double damping_of(const ob_joint_axis *a)
{
	return a->damping + (a->motor == OB_MOTOR_VALUE ? a->motor_damping : 0);
}

bool ob_axis_is_damped(const ob_held_joint *j)
{
	return damping_of(j->axis) > 0;
}

bool ob_axis_is_soft(const ob_held_joint *j)
{
	return stiffness_of(j->axis) > 0 || ob_axis_is_damped(j);
}

double ob_axis_swing(const ob_held_joint *j)
{
	return ob_max(sqrt(stiffness_of(j->axis) * j->along.response), damping_of(j->axis) * j->along.response);
}

// ---- events

static void note_margin(double margin, ob_axis_event event, double *least, ob_axis_event *of)
{
	if (margin < *least)
		*least = margin, *of = event;
}

double ob_axis_margin(const ob_held_joint *j, double rate, double force, ob_axis_event *event)
{
	const holders h = holders_of(j->axis);
	const double rounding = force_rounding * (1 + fabs(force)), value = j->along.value;
	double least = INFINITY, low, high;
	*event = OB_AXIS_NONE;
	if (j->along.limit) {
		bounds_at_rest(j, &low, &high);
		*event = OB_AXIS_RELEASED;
		return (j->along.limit > 0 ? high - force : force - low) + rounding;
	}
	note_margin(value - j->axis->low + value_rounding, OB_AXIS_LOW, &least, event);
	note_margin(j->axis->high - value + value_rounding, OB_AXIS_HIGH, &least, event);
	if (j->along.engaged) {
		bounds_at(&h, j->along.place, &low, &high);
		note_margin(force - low + rounding, OB_AXIS_FASTER, &least, event);
		note_margin(high - force + rounding, OB_AXIS_SLOWER, &least, event);
		return least;
	}
	if (j->along.place > 0)
		note_margin(rate - h.rate[j->along.place / 2 - 1] + value_rounding, OB_AXIS_SLOWER, &least, event);
	if (j->along.place / 2 < h.count)
		note_margin(h.rate[j->along.place / 2] - rate + value_rounding, OB_AXIS_FASTER, &least, event);
	return least;
}

// ---- among contacts

// Spring, damper and motor at the midpoint as a row: their force is c0 - c1 u at the rate u of the end.
static void begin_soft(ob_held_joint *j, double rate, double h)
{
	const ob_joint_axis *a = j->axis;
	const double change = .25 * h * rate; // value at the midpoint is off by h / 4 (u - rate)
	const uint32_t row = j->base + j->along.engaged;
	double c0 = a->stiffness * (a->rest - j->along.value + change) - .5 * a->damping * rate +
		    a->armature * rate / h,
	       c1 = .25 * h * a->stiffness + .5 * a->damping + a->armature / h;
	if (a->motor == OB_MOTOR_VALUE) {
		const double pull = a->motor_stiffness * (a->target - j->along.value) - a->motor_damping * rate;
		const bool most = fabs(pull) > a->most;
		c0 += most ? clamped(pull, a->most)
			   : a->motor_stiffness * (a->target - j->along.value + change) - .5 * a->motor_damping * rate;
		c1 += most ? 0 : .25 * h * a->motor_stiffness + .5 * a->motor_damping;
	}
	if (c1 > 0) {
		j->along.softness = 1 / (h * c1);
		j->target[row] = c0 / c1;
		j->rows.rows = row + 1;
	} else {
		j->along.applied += h * c0;
	}
}

// Limit that the axis reaches on the second half of the partial substep; 0: none.
static int limit_ahead(const ob_held_joint *j, double rate, double h)
{
	const double ahead = j->along.value + .5 * h * rate;
	return ahead >= j->axis->high - at_limit ? 1 : ahead <= j->axis->low + at_limit ? -1 : 0;
}

void ob_axis_begin(ob_held_joint *j, double rate, double h)
{
	const holders held = holders_of(j->axis);
	const int limit = limit_ahead(j, rate, h);
	double low, high;
	j->along.softness = j->along.applied = 0;
	enter_place(j, &held, place_of(&held, rate), 0);
	j->target[j->base] = j->along.goal_rate;
	if (limit) {
		ob_axis_rest(j, limit, 0);
		const double left = 2 / h * (j->along.goal - j->along.value);
		j->target[j->base] = limit * rate > 0 && ob_axis_restitution(j, rate) > 0
					     ? -j->axis->restitution * rate
					     : limit * ob_max(0, limit * left);
	} else if (!j->along.engaged) {
		bounds_at(&held, j->along.place, &low, &high);
		j->along.applied = h * low;
	}
	begin_soft(j, rate, h);
}

// Leaves the equality for a place between the held rates, whose force takes the place of the row's impulse.
static double leave(ob_held_joint *j, const holders *held, uint32_t place, double h)
{
	const uint32_t row = j->base;
	const double was = j->sum[row];
	double low, high;
	bounds_at(held, place, &low, &high);
	j->sum[row] = j->sum[row + 1], j->target[row] = j->target[row + 1];
	ob_axis_disengage(j);
	j->rows.rows += j->along.softness > 0;
	j->along.place = place;
	return h * low - was;
}

// Holds a rate; the force so far is the row's impulse.
static void hold(ob_held_joint *j, const holders *held, uint32_t place, double h)
{
	const uint32_t row = j->base;
	double low, high;
	bounds_at(held, j->along.place, &low, &high);
	j->sum[row + 1] = j->sum[row], j->target[row + 1] = j->target[row];
	engage(j, j->along.value, held->rate[place / 2], 0);
	j->rows.rows += j->along.softness > 0;
	j->sum[row] = h * low, j->target[row] = j->along.goal_rate;
	j->along.place = place;
}

bool ob_axis_settle(ob_held_joint *j, double rate, double h, double *change)
{
	const holders held = holders_of(j->axis);
	ob_axis_event event;
	*change = 0;
	if (j->along.limit) {
		if (ob_axis_margin(j, rate, j->sum[j->base] / h, &event) >= 0)
			return false;
		const uint32_t rest = place_of(&held, 0);
		*change = leave(j, &held, rest & 1 ? rest - (uint32_t)j->along.limit : rest, h);
		return true;
	}
	double low, high;
	bounds_at(&held, j->along.place, &low, &high);
	const double force = j->sum[j->base] / h, rounding = force_rounding * (1 + fabs(force));
	if (j->along.engaged) {
		if (force >= low - rounding && force <= high + rounding)
			return false;
		*change = leave(j, &held, j->along.place + (force < low ? 1 : -1), h);
		return true;
	}
	const uint32_t place = j->along.place;
	if (place > 0 && rate < held.rate[place / 2 - 1] - same_rate)
		hold(j, &held, place - 1, h);
	else if (place / 2 < held.count && rate > held.rate[place / 2] + same_rate)
		hold(j, &held, place + 1, h);
	else
		return false;
	return true;
}

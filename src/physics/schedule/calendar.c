#include "schedule/calendar.h"

#include <string.h>

#include "table/home.h"

ob_calendar ob_calendar_of_objects(const ob_universe *u)
{
	ob_step_data *data = ob_universe_step_data(u);
	return (ob_calendar){ data->solve, ob_universe_ids(u), &data->count->visits };
}

ob_calendar ob_calendar_of_pairs(const ob_universe *u)
{
	ob_step_data *data = ob_universe_step_data(u);
	return (ob_calendar){ data->look, ob_pairs_end(data), &data->count->visits };
}

static uint32_t urgency_of(uint64_t step)
{
	return step < UINT32_MAX ? UINT32_MAX - (uint32_t)step : 0;
}

// Another worker may have raised of_64 but not yet of_4096. It does so before the phase ends, so a worker that finds
// of_64 high enough need not look at of_4096.
void ob_calendar_set(const ob_calendar *c, uint32_t i, uint64_t step)
{
	const uint32_t urgency = urgency_of(step);
	c->level.one[i] = urgency;
	if (ob_calendar_level_raise(&c->level.of_64[i / 64], urgency))
		ob_calendar_level_raise(&c->level.of_4096[i / 4096], urgency);
}

void ob_calendar_enter_due(const ob_universe *u, uint32_t id)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_schedule *s = &data->schedule[id];
	const ob_calendar solve = ob_calendar_of_objects(u);
	const uint32_t due = ob_schedule_is_dynamic(s) ? s->due : UINT32_MAX;
	const bool here = ob_universe_ranks(u) < 2 || ob_worker_is_here(u, ob_home_of(u, id));
	ob_calendar_set(&solve, id, here ? due : UINT32_MAX);
	if (!here && due < data->count->next_due)
		data->count->next_due = due;
}

// Four lanes, compared as signed numbers: every processor can do that.
typedef int32_t quad __attribute__((vector_size(16)));
typedef int64_t halves __attribute__((vector_size(16)));

static int32_t as_signed(uint32_t urgency)
{
	return (int32_t)(urgency ^ UINT32_C(0x80000000));
}

static quad four_at(const uint32_t *from)
{
	const int32_t zero = as_signed(0);
	quad q;
	memcpy(&q, from, sizeof q);
	return q ^ (quad) { zero, zero, zero, zero };
}

static quad larger_of(quad a, quad b)
{
	const quad larger = a > b;
	return (a & larger) | (b & ~larger);
}

static uint32_t largest_of(quad a)
{
	const int32_t b = a[0] > a[1] ? a[0] : a[1], c = a[2] > a[3] ? a[2] : a[3];
	return (uint32_t)(b > c ? b : c) ^ UINT32_C(0x80000000);
}

static uint32_t most_of_64(const uint32_t *below)
{
	quad most = four_at(below);
	for (int k = 4; k < 64; k += 4)
		most = larger_of(four_at(below + k), most);
	return largest_of(most);
}

// Returns a bit for each of four lanes that is false.
static uint64_t false_of(quad a)
{
	const halves both = (halves)~a;
	const uint64_t x = (uint64_t)both[0], y = (uint64_t)both[1];
	return (x & 1) | (x >> 62 & 2) | (y & 4) | (y >> 60 & 8);
}

// Returns a bit for each of 64 entries whose urgency is at least "least". rest: largest urgency of the others.
static uint64_t due_of_64(const uint32_t *below, uint32_t least, uint32_t *rest)
{
	const int32_t low = as_signed(least), zero = as_signed(0);
	const quad soonest = { low, low, low, low };
	uint64_t due = 0;
	quad largest = { zero, zero, zero, zero };
	for (int k = 0; k < 64; k += 8) {
		const quad q = four_at(below + k), r = four_at(below + k + 4), q_later = soonest > q,
			   r_later = soonest > r, both = q_later & r_later;
		const halves all = (halves)both;
		if ((all[0] & all[1]) != -1)
			due |= (false_of(q_later) | false_of(r_later) << 4) << k;
		const quad q_larger = q_later & (q > largest);
		largest = (q & q_larger) | (largest & ~q_larger);
		const quad r_larger = r_later & (r > largest);
		largest = (r & r_larger) | (largest & ~r_larger);
	}
	*rest = largest_of(largest);
	return due;
}

// Fate of the entries that are found.
typedef enum found_entries { STAY, TAKEN } found_entries;

// Appends the entries of a block of 64 that are at least so urgent to the list of n; returns the new n. list NULL: only
// counts. Corrects the block's urgency in the level above, but not while due entries stay.
static uint32_t list_64(const ob_calendar *c, uint32_t block, uint32_t least, uint32_t *list, uint32_t n, uint32_t most,
			found_entries then)
{
	uint32_t rest, *one = c->level.one + 64 * (size_t)block;
	uint64_t due = due_of_64(one, least, &rest);
	const bool any = due;
	*c->visits += 1;
	for (; due && n < most; due &= due - 1, n++) {
		const uint32_t i = (uint32_t)__builtin_ctzll(due);
		if (list)
			list[n] = 64 * block + i;
		if (then == TAKEN)
			one[i] = 0;
	}
	if (!any || (then == TAKEN && !due))
		c->level.of_64[block] = rest;
	return n;
}

static uint32_t list_all(const ob_calendar *c, uint64_t step, uint32_t *list, uint32_t most, found_entries then)
{
	const uint32_t least = urgency_of(step);
	uint32_t n = 0;
	for (uint32_t top = 0; top < (c->end + 4095) / 4096; top++) {
		if (c->level.of_4096[top] < least)
			continue;
		for (uint32_t block = 64 * top; block < 64 * (top + 1) && n < most; block++)
			if (c->level.of_64[block] >= least)
				n = list_64(c, block, least, list, n, most, then);
		c->level.of_4096[top] = most_of_64(c->level.of_64 + 64 * (size_t)top);
	}
	return n;
}

bool ob_calendar_is_due(const ob_calendar *c, uint64_t step)
{
	return list_all(c, step, NULL, 1, STAY) > 0;
}

uint32_t ob_calendar_list(const ob_calendar *c, uint64_t step, uint32_t *list, uint32_t most)
{
	return list_all(c, step, list, most, STAY);
}

uint32_t ob_calendar_take(const ob_calendar *c, uint64_t step, uint32_t *list, uint32_t most)
{
	return list_all(c, step, list, most, TAKEN);
}

uint32_t ob_calendar_first(const ob_calendar *c)
{
	uint32_t most = 0;
	for (uint32_t top = 0; top < (c->end + 4095) / 4096; top++) {
		if (c->level.of_4096[top] <= most)
			continue;
		for (uint32_t block = 64 * top; block < 64 * (top + 1); block++) {
			if (c->level.of_64[block] <= most)
				continue;
			const uint32_t urgency = c->level.of_64[block] = most_of_64(c->level.one + 64 * (size_t)block);
			most = urgency > most ? urgency : most;
		}
		c->level.of_4096[top] = most_of_64(c->level.of_64 + 64 * (size_t)top);
	}
	return UINT32_MAX - most;
}

void ob_calendar_clear(const ob_calendar *c)
{
	memset(c->level.one, 0, c->end * sizeof *c->level.one);
	memset(c->level.of_64, 0, (c->end + 63) / 64 * sizeof *c->level.of_64);
	memset(c->level.of_4096, 0, (c->end + 4095) / 4096 * sizeof *c->level.of_4096);
}

// ---- work

// Work for small but hard scenes, and for each object of a large one.
static const uint64_t base = UINT64_C(1) << 27, per_object = 1 << 15;

uint64_t ob_work_limit(const ob_universe *u)
{
	const uint32_t given = ob_universe_settings(u)->budget;
	return given ? per_object * given : base + per_object * ob_universe_ids(u);
}

bool ob_work_add(ob_universe *u, uint64_t work, uint32_t object)
{
	if (ob_step_work_add(u, work) <= ob_work_limit(u))
		return false;
	ob_step_fail(u, OB_STEP_OVERWORKED, object);
	return true;
}

uint64_t ob_work_share(uint64_t total, uint32_t count)
{
	enum { SLACK = 10, WORTH_SHARING = 16 * OB_WORK_WORTH_A_WORKER };
	const uint64_t share = total / count + total / (count * SLACK) + 1;
	return share > WORTH_SHARING ? share : WORTH_SHARING;
}

#include "sim/arrange.h"

#include <math.h>
#include <string.h>

#include "sim/index.h"
#include "sim/islands.h"
#include "sim/pairs.h"
#include "sim/perceive.h"
#include "sim/sim.h"

// What a MEMBERS phase belongs to.
enum { STAGE_START, STAGE_FINISH };

static bool own_worker_each(const ob_universe *u)
{
	return ob_universe_settings(u)->one_per_object;
}

// The perceivers, and with one worker per object those whose island was solved by another.
static void open_members(ob_universe *u, uint32_t stage)
{
	ob_exchange *ex = ob_universe_exchange(u);
	uint32_t count, n = 0, *who = ex->scratch;
	const uint32_t *list = ob_rebound_list(u, &count);
	for (uint32_t i = 0; i < count; i++)
		ob_index_put(u, list[i]);
	ex->count->stage = stage;
	if (!own_worker_each(u)) {
		ob_claim_reset(u, count);
		ob_gate_open(u, OB_PHASE_MEMBERS, NULL, 0);
		return;
	}
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		uint32_t island = ex->result_island[id];
		bool adopts = stage == STAGE_FINISH && island != UINT32_MAX &&
			      ex->member[ex->island[island].first_member] != id;
		if (adopts || ob_perceive_asked(u, id))
			who[n++] = id;
	}
	ob_gate_open(u, OB_PHASE_MEMBERS, who, n);
}

static void open_islands(ob_universe *u)
{
	ob_exchange *ex = ob_universe_exchange(u);
	if (!own_worker_each(u)) {
		ob_claim_reset(u, ex->count->chunks);
		ob_gate_open(u, OB_PHASE_ISLANDS, NULL, 0);
		return;
	}
	uint32_t n = 0, *who = ex->scratch;
	for (uint32_t i = 0; i < ex->count->islands; i++)
		who[n++] = ex->member[ex->island[i].first_member];
	ob_gate_open(u, OB_PHASE_ISLANDS, who, n);
}

static uint32_t count_awake(const ob_universe *u)
{
	const ob_exchange *ex = ob_universe_exchange(u);
	uint32_t n = 0;
	for (uint32_t id = 0; id < ob_universe_ids(u); id++)
		n += ex->brief[id].state == OB_BRIEF_AWAKE;
	return n;
}

// The host may ask for a pause at a step that has just gone by: then the next one will do.
static bool must_pause(const ob_universe *u)
{
	return ob_step_count(u) >= ob_gate_pause_step(u) || ob_universe_exchange(u)->count->failure;
}

static void complete_step(ob_universe *u)
{
	ob_exchange *ex = ob_universe_exchange(u);
	ob_step_complete(u, count_awake(u), ex->count->pairs, ex->count->islands);
}

// Steps in which nothing is awake are complete as soon as they begin.
static void begin_step(ob_universe *u)
{
	ob_exchange *ex = ob_universe_exchange(u);
	uint32_t asked;
	if (ob_universe_settings(u)->monolith) {
		ob_gate_open(u, OB_PHASE_ISLANDS, NULL, 0);
		return;
	}
	for (;;) {
		ob_rebound_list(u, &asked);
		if (asked || !ob_islands_plan(u)) {
			open_members(u, STAGE_START);
			return;
		}
		if (ex->count->islands) {
			open_islands(u);
			return;
		}
		complete_step(u);
		if (must_pause(u)) {
			ob_gate_pause(u);
			return;
		}
	}
}

static void go_on(ob_universe *u)
{
	if (must_pause(u))
		ob_gate_pause(u);
	else
		begin_step(u);
}

static void finish_step(ob_universe *u)
{
	complete_step(u);
	go_on(u);
}

// Is there anything to do between the islands' solution and the end of the step?
static bool members_needed(const ob_universe *u)
{
	const ob_exchange *ex = ob_universe_exchange(u);
	uint32_t asked;
	ob_rebound_list(u, &asked);
	if (asked || !own_worker_each(u))
		return asked > 0;
	for (uint32_t i = 0; i < ex->count->islands; i++)
		if (ex->island[i].members > 1)
			return true;
	return false;
}

void ob_arrange(ob_universe *u, ob_phase finished)
{
	ob_exchange *ex = ob_universe_exchange(u);
	ob_phase_close(u);
	if (finished == OB_PHASE_ISLANDS) {
		if (!ob_universe_settings(u)->monolith && members_needed(u))
			open_members(u, STAGE_FINISH);
		else
			finish_step(u);
		return;
	}
	ob_pairs_merge(u);
	if (ex->count->stage == STAGE_FINISH)
		finish_step(u);
	else
		go_on(u);
}

void ob_sim_resume(ob_universe *u)
{
	uint32_t asked;
	ob_step_begin(u);
	ob_rebound_list(u, &asked);
	if (ob_universe_settings(u)->monolith)
		ob_rebound_reset(u); // one world finds its own neighbours
	else if (asked) {
		open_members(u, STAGE_START);
		return;
	}
	go_on(u);
}

const char *ob_sim_failure(const ob_universe *u)
{
	switch (ob_universe_exchange(u)->count->failure) {
	case OB_EXCHANGE_PAIRS_FULL:
		return "more pairs of neighbours than the universe has room for: the objects lie too close together";
	case OB_EXCHANGE_PERCEIVED_FULL:
		return "objects perceive more neighbours than the universe has room for: they lie too close together";
	case OB_EXCHANGE_DIVERGED:
		return "a state is no longer a number: the run diverged; try more substeps or a smaller step";
	default:
		return NULL;
	}
}

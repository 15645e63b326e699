// Tasks of a phase: claimed one after the other by workers that are free, or shared in turns by contained simulators.
#include "table/layout.h"
#include "table/outbox.h"

// Place of a worker in a round of turns, or worker of a place: 0 1 2, then 2 1 0, and so on.
static uint32_t in_turn(uint32_t round, uint32_t place, uint32_t workers)
{
	return round % 2 ? workers - 1 - place : place;
}

uint32_t ob_task_owner(uint32_t index, uint32_t workers)
{
	return in_turn(index / workers, index % workers, workers);
}

uint32_t ob_task_workers(const ob_universe *u)
{
	return u->control->claim_workers;
}

uint32_t ob_task_first(const ob_universe *u)
{
	return u->control->claim_first;
}

void ob_task_reset(ob_universe *u, uint32_t total, uint32_t workers)
{
	ob_task_reset_from(u, total, 0, workers);
}

void ob_task_reset_from(ob_universe *u, uint32_t total, uint32_t first, uint32_t workers)
{
	u->control->claim_first = first;
	u->control->claim_workers = workers;
	__atomic_store_n(&u->control->claim_total, total, __ATOMIC_RELAXED);
	__atomic_store_n(&u->control->claim_next, 0, __ATOMIC_RELEASE);
}

// A contained simulator cannot count others' claims: it takes its share (ob_task_owner).
static bool claim_own(ob_universe *u, uint32_t *index)
{
	uint32_t worker;
	const uint32_t round = ob_outbox_next_task(u, &worker), workers = u->control->claim_workers;
	if (!workers)
		return false;
	const uint64_t i = (uint64_t)round * workers + in_turn(round, worker - u->control->claim_first, workers);
	*index = (uint32_t)i;
	return i < u->control->claim_total;
}

bool ob_task_claim(ob_universe *u, uint32_t *index)
{
	if (ob_universe_contained(u))
		return claim_own(u, index);
	uint64_t total = __atomic_load_n(&u->control->claim_total, __ATOMIC_RELAXED);
	uint64_t i = __atomic_fetch_add(&u->control->claim_next, 1, __ATOMIC_RELAXED);
	*index = (uint32_t)i;
	return i < total;
}

uint32_t ob_task_count(const ob_universe *u)
{
	return __atomic_load_n(&u->control->claim_total, __ATOMIC_RELAXED);
}

static uint32_t *time_of_task(const ob_universe *u, uint32_t task)
{
	return &u->step_data.task_ns[task % ob_universe_ids(u)];
}

void ob_task_took(ob_universe *u, uint32_t task, uint32_t ns)
{
	if (!ob_universe_contained(u))
		__atomic_fetch_add(time_of_task(u, task), ns, __ATOMIC_RELAXED);
}

uint32_t ob_task_take_time(ob_universe *u, uint32_t task)
{
	return __atomic_exchange_n(time_of_task(u, task), 0, __ATOMIC_RELAXED);
}

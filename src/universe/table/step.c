// Shared data of the workers in a step beside the slots: the clock, failures, the list of bodies to requery, records of
// pairs, the arena of neighbours. Only the scheduler resets; the gate orders that.
#include <stdio.h>

#include "base/clock.h"
#include "table/layout.h"
#include "table/outbox_page.h"
#include "table/pages.h"

void ob_step_set_scheduler(ob_universe *u, uint32_t worker)
{
	__atomic_store_n(&ob_universe_step_data(u)->count->scheduler, worker, __ATOMIC_RELAXED);
}

uint32_t ob_step_scheduler(const ob_universe *u)
{
	return __atomic_load_n(&ob_universe_step_data(u)->count->scheduler, __ATOMIC_RELAXED);
}

void ob_step_set(ob_universe *u, uint64_t step)
{
	__atomic_store_n(&u->control->step, step, __ATOMIC_RELEASE);
}

void ob_step_complete(ob_universe *u, uint32_t awake, uint32_t pairs, uint32_t islands)
{
	ob_control *c = u->control;
	__atomic_store_n(&c->awake, awake, __ATOMIC_RELAXED);
	__atomic_store_n(&c->pairs, pairs, __ATOMIC_RELAXED);
	__atomic_store_n(&c->islands, islands, __ATOMIC_RELAXED);
	ob_step_clock *clock = u->step_clock;
	uint64_t now = ob_clock_ns();
	ob_latency_add(&clock->latency, 1e-9 * (double)(now - clock->begun_ns));
	clock->begun_ns = now;
	__atomic_store_n(&c->step, c->step + 1, __ATOMIC_RELEASE);
}

void ob_step_begin(ob_universe *u)
{
	u->step_clock->begun_ns = ob_clock_ns();
}

const ob_latency *ob_step_latency(const ob_universe *u)
{
	return &u->step_clock->latency;
}

static void raise_time(uint64_t *longest, uint64_t ns)
{
	uint64_t seen = __atomic_load_n(longest, __ATOMIC_RELAXED);
	while (seen < ns && !__atomic_compare_exchange_n(longest, &seen, ns, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
		;
}

void ob_phase_worked(ob_universe *u, uint64_t ns, uint64_t beside)
{
	if (u->outbox) {
		u->outbox->end.worked_ns = ns;
		return;
	}
	raise_time(&u->step_clock->longest_ns, ns);
	raise_time(&u->step_clock->beside_ns, beside);
}

uint64_t ob_phase_close(ob_universe *u)
{
	ob_critical_add(u, __atomic_exchange_n(&u->step_clock->longest_ns, 0, __ATOMIC_RELAXED), 0);
	return __atomic_exchange_n(&u->step_clock->beside_ns, 0, __ATOMIC_RELAXED);
}

void ob_critical_add(ob_universe *u, uint64_t ns, uint64_t simulated)
{
	__atomic_fetch_add(&u->step_clock->critical_ns, ns, __ATOMIC_RELAXED);
	__atomic_fetch_add(&u->step_clock->simulated_ns, simulated, __ATOMIC_RELAXED);
}

void ob_critical_add_alone(ob_universe *u, uint64_t ns)
{
	ob_critical_add(u, ns, ns);
	__atomic_fetch_add(&u->step_clock->alone_ns, ns, __ATOMIC_RELAXED);
}

uint64_t ob_time_alone(const ob_universe *u)
{
	return __atomic_load_n(&u->step_clock->alone_ns, __ATOMIC_RELAXED);
}

uint64_t ob_critical_path(const ob_universe *u)
{
	return __atomic_load_n(&u->step_clock->critical_ns, __ATOMIC_RELAXED);
}

uint64_t ob_simulated_path(const ob_universe *u)
{
	return __atomic_load_n(&u->step_clock->simulated_ns, __ATOMIC_RELAXED);
}

// The bits keep an id from being listed twice, so the list has room for all ids.
void ob_requery_append(ob_universe *u, uint32_t id)
{
	uint64_t bit = UINT64_C(1) << id % 64;
	if (__atomic_fetch_or(&u->requery_bit[id / 64], bit, __ATOMIC_RELAXED) & bit)
		return;
	uint64_t i = __atomic_fetch_add(&u->control->requery_count, 1, __ATOMIC_RELAXED);
	if (i < u->header.sizes.capacity)
		__atomic_store_n(&u->requery[i], id, __ATOMIC_RELAXED);
	else
		u->step_data.count->failure = OB_STEP_DAMAGED;
}

void ob_pairs_requery(ob_universe *u, uint32_t id)
{
	ob_step_data *data = &u->step_data;
	if (data->neighbours[id].count == UINT32_MAX)
		return;
	data->neighbours[id].count = UINT32_MAX;
	ob_requery_append(u, id);
}

bool ob_requery_lists(const ob_universe *u, uint32_t id)
{
	return __atomic_load_n(&u->requery_bit[id / 64], __ATOMIC_RELAXED) >> id % 64 & 1;
}

void ob_requery_drop(ob_universe *u, uint32_t id)
{
	uint32_t n, i = 0;
	const uint32_t *list = ob_requery_list(u, &n);
	const uint64_t bit = UINT64_C(1) << id % 64;
	if (!(__atomic_fetch_and(&u->requery_bit[id / 64], ~bit, __ATOMIC_RELAXED) & bit))
		return;
	while (i < n && list[i] != id)
		i++;
	if (i == n) {
		u->step_data.count->failure = OB_STEP_DAMAGED;
		return;
	}
	u->requery[i] = list[n - 1];
	__atomic_store_n(&u->control->requery_count, n - 1, __ATOMIC_RELEASE);
}

const uint32_t *ob_requery_list(const ob_universe *u, uint32_t *count)
{
	const uint64_t n = __atomic_load_n(&u->control->requery_count, __ATOMIC_ACQUIRE),
		       most = u->header.sizes.capacity;
	*count = (uint32_t)(n < most ? n : most);
	return u->requery;
}

void ob_requery_reset(ob_universe *u)
{
	uint32_t n;
	const uint32_t *list = ob_requery_list(u, &n);
	for (uint32_t i = 0; i < n; i++)
		if (list[i] < u->header.sizes.capacity)
			__atomic_store_n(&u->requery_bit[list[i] / 64], 0, __ATOMIC_RELAXED);
	__atomic_store_n(&u->control->requery_count, 0, __ATOMIC_RELEASE);
}

void ob_step_fail(ob_universe *u, ob_step_failure why, uint32_t object)
{
	uint64_t *first = u->outbox ? &u->outbox->end.failure : &u->step_data.count->failure,
		 seen = __atomic_load_n(first, __ATOMIC_RELAXED);
	const uint64_t failure = (uint64_t)object << 32 | why;
	while ((seen == OB_STEP_OK || seen > failure) &&
	       !__atomic_compare_exchange_n(first, &seen, failure, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
		;
}

ob_step_failure ob_step_failed(const ob_universe *u, uint32_t *object)
{
	uint64_t failure = __atomic_load_n(&u->step_data.count->failure, __ATOMIC_RELAXED);
	if (u->outbox && !failure)
		failure = u->outbox->end.failure;
	uint32_t blamed = (uint32_t)(failure >> 32);
	if (failure && (!(failure & UINT32_MAX) || blamed >= u->header.sizes.capacity))
		failure = OB_STEP_DAMAGED; // an invalid failure
	if (object)
		*object = blamed;
	return (ob_step_failure)(failure & UINT32_MAX);
}

uint64_t ob_step_work_add(ob_universe *u, uint64_t work)
{
	if (u->outbox) // others' work is added once all have arrived
		return u->step_data.count->work + (u->outbox->end.work += work);
	return __atomic_add_fetch(&u->step_data.count->work, work, __ATOMIC_RELAXED);
}

void ob_step_work_reset(ob_universe *u)
{
	__atomic_store_n(&u->step_data.count->work, 0, __ATOMIC_RELAXED);
}

void ob_step_woken(ob_universe *u, int32_t objects)
{
	__atomic_fetch_add(&u->step_data.count->awake, (uint32_t)objects, __ATOMIC_RELAXED);
}

void ob_step_visited(ob_universe *u, uint64_t visits)
{
	__atomic_fetch_add(&u->step_data.count->visits, visits, __ATOMIC_RELAXED);
}

bool ob_object_involve(ob_universe *u, uint32_t id)
{
	const ob_step_data *data = &u->step_data;
	if (__atomic_load_n(&data->result_island[id], __ATOMIC_RELAXED) != UINT32_MAX ||
	    __atomic_exchange_n(&data->result_island[id], 0, __ATOMIC_RELAXED) != UINT32_MAX)
		return false;
	const uint32_t at = __atomic_fetch_add(&data->count->involved, 1, __ATOMIC_RELAXED);
	if (at < ob_universe_ids(u))
		data->scratch[at] = id;
	return true;
}

uint32_t ob_island_pairs_reserve(ob_universe *u, uint32_t pairs)
{
	const ob_step_data *data = &u->step_data;
	const uint32_t at = __atomic_fetch_add(&data->count->island_pairs, pairs, __ATOMIC_RELAXED);
	if (at <= data->pairs_max && pairs <= data->pairs_max - at)
		return at;
	ob_step_fail(u, OB_STEP_DAMAGED, 0);
	return UINT32_MAX;
}

void ob_late_contacts_reset(ob_universe *u)
{
	u->step_data.count->late = 0;
}

void ob_late_contacts_note(ob_universe *u)
{
	if (u->outbox)
		u->outbox->end.late = 1;
	else
		__atomic_store_n(&u->step_data.count->late, 1, __ATOMIC_RELAXED);
}

void ob_step_blame(ob_universe *u, uint32_t worker, const char *what)
{
	struct ob_step_counts *count = u->step_data.count;
	if (count->culprit) // the first is kept
		return;
	count->failure = OB_STEP_DAMAGED;
	count->culprit = worker + 1;
	snprintf(count->blamed_for, sizeof count->blamed_for, "%s", what);
}

void ob_step_break(ob_universe *u, const char *what)
{
	struct ob_step_counts *count = u->step_data.count;
	count->failure = OB_STEP_BROKEN;
	snprintf(count->blamed_for, sizeof count->blamed_for, "%s", what);
}

void ob_step_misses_plan(ob_universe *u, const char *why)
{
	struct ob_step_counts *count = u->step_data.count;
	snprintf(count->blamed_for, sizeof count->blamed_for, "%s", why);
	ob_step_fail(u, OB_STEP_UNPLANNED, 0);
}

// Within a phase the stack only shrinks, so no other worker gets the same record.
uint32_t ob_record_take(ob_universe *u)
{
	const ob_step_data *ex = &u->step_data;
	int32_t left = __atomic_fetch_sub(&ex->count->records_free, 1, __ATOMIC_RELAXED);
	uint32_t record = left > 0 ? ex->record_free[left - 1]
				   : __atomic_fetch_add(&ex->count->records_used, 1, __ATOMIC_RELAXED);
	if (!ob_reserve_record(u, record)) {
		ob_step_fail(u, OB_STEP_MEMORY_FULL, 0);
		return OB_NO_RECORD;
	}
	ex->record[record].stamp[0] = ex->record[record].stamp[1] = 0;
	return record;
}

void ob_record_give_back(ob_universe *u, uint32_t record)
{
	const ob_step_data *ex = &u->step_data;
	int32_t free = ex->count->records_free > 0 ? ex->count->records_free : 0;
	if (record >= ex->pairs_max || (uint32_t)free >= ex->pairs_max) {
		ex->count->failure = OB_STEP_DAMAGED;
		return;
	}
	if (!ob_pages_take(u, OB_AREA_RECORD_FREE, (uint64_t)free, 1)) {
		ob_step_fail(u, OB_STEP_MEMORY_FULL, 0);
		return;
	}
	ex->record_free[free] = record;
	ex->count->records_free = free + 1;
}

void ob_pair_release_record(ob_universe *u, ob_pair_key *k)
{
	if (k->record != OB_NO_RECORD)
		ob_record_give_back(u, k->record);
	k->record = OB_NO_RECORD;
}

uint32_t ob_neighbours_reserve(ob_universe *u, uint32_t id, uint32_t count)
{
	uint64_t at = __atomic_fetch_add(&u->control->neighbours_used, count, __ATOMIC_RELAXED);
	if (at + count > u->header.sizes.neighbours_max) {
		ob_step_fail(u, OB_STEP_NEIGHBOURS_FULL, id);
		return UINT32_MAX;
	}
	if (!ob_pages_take(u, OB_AREA_NEIGHBOUR_ID, at, count)) {
		ob_step_fail(u, OB_STEP_MEMORY_FULL, id);
		return UINT32_MAX;
	}
	return (uint32_t)at;
}

void ob_neighbours_reset(ob_universe *u)
{
	__atomic_store_n(&u->control->neighbours_used, 0, __ATOMIC_RELEASE);
}

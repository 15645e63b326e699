// Reports of each worker: its identity, the object it is working on, its counters, faults injected into it. A contained
// simulator writes them into its outbox, others into their cells.
#include <string.h>

#include "table/layout.h"
#include "table/outbox_page.h"

void ob_worker_announce(ob_universe *u, uint32_t worker, int32_t pid, int32_t tid, int32_t cpu)
{
	ob_worker_cell *w = u->worker + worker;
	__atomic_store_n(&w->tid, tid, __ATOMIC_RELAXED);
	__atomic_store_n(&w->cpu, cpu, __ATOMIC_RELAXED);
	__atomic_store_n(&w->pid, pid, __ATOMIC_RELEASE); // last: a cell with a pid is complete
}

void ob_worker_set_objects(ob_universe *u, uint32_t worker, uint32_t objects)
{
	if (u->outbox) {
		u->outbox->end.objects = objects;
		return;
	}
	__atomic_store_n(&u->worker[worker].objects, objects, __ATOMIC_RELAXED);
}

void ob_worker_set_cpu(ob_universe *u, uint32_t worker, uint64_t cpu_ns)
{
	__atomic_store_n(&u->worker[worker].cpu_ns, cpu_ns, __ATOMIC_RELAXED);
}

void ob_worker_set_object(ob_universe *u, uint32_t worker, uint32_t object)
{
	uint32_t *to = u->outbox ? &u->outbox->page->working_on : &u->worker[worker].working_on;
	__atomic_store_n(to, object + 1, __ATOMIC_RELAXED);
}

uint32_t ob_worker_object(const ob_universe *u, uint32_t worker)
{
	if (worker >= u->header.sizes.workers)
		return OB_NO_OBJECT;
	const uint32_t *from = u->header.sizes.outbox_bytes ? &ob_outbox_page_of(u, worker)->working_on
							    : &u->worker[worker].working_on;
	const uint32_t object = __atomic_load_n(from, __ATOMIC_RELAXED) - 1;
	return object < u->header.sizes.capacity ? object : OB_NO_OBJECT;
}

ob_counters *ob_worker_counters(const ob_universe *u, uint32_t worker)
{
	return &u->worker[worker].counters;
}

// ---- injected faults

// A counter of faults lies in memory that they may overwrite: its upper half verifies the lower one. 0 is 0.
static uint64_t sealed(uint32_t count)
{
	return (uint64_t)(count * UINT32_C(0x9E3779B1)) << 32 | count;
}

void ob_fault_note(ob_universe *u, uint32_t worker, ob_fault_kind kind)
{
	uint64_t *at = u->outbox ? &u->outbox->page->faults[kind] : &u->worker[worker].faults[kind];
	const uint64_t seen = __atomic_load_n(at, __ATOMIC_RELAXED);
	if (seen == sealed((uint32_t)seen)) // otherwise it stays as it is: overwritten
		__atomic_store_n(at, sealed((uint32_t)seen + 1), __ATOMIC_RELAXED);
}

static uint32_t add_faults(const uint64_t from[OB_FAULT_KINDS], uint64_t sum[OB_FAULT_KINDS])
{
	uint32_t overwritten = 0;
	for (int kind = 0; kind < OB_FAULT_KINDS; kind++) {
		const bool whole = from[kind] == sealed((uint32_t)from[kind]);
		sum[kind] += whole ? (uint32_t)from[kind] : 0;
		overwritten += !whole;
	}
	return overwritten;
}

uint32_t ob_universe_faults(const ob_universe *u, uint64_t sum[OB_FAULT_KINDS])
{
	uint32_t overwritten = 0;
	memset(sum, 0, OB_FAULT_KINDS * sizeof *sum);
	for (uint32_t w = 0; w < u->header.sizes.workers; w++) {
		overwritten += add_faults(u->worker[w].faults, sum);
		if (u->header.sizes.outbox_bytes)
			overwritten += add_faults(ob_outbox_page_of(u, w)->faults, sum);
	}
	return overwritten;
}

uint32_t ob_universe_lives(const ob_universe *u)
{
	return u->control->lives;
}

#include "table/trace.h"

#include <string.h>
#include <sys/mman.h>

#include "base/clock.h"
#include "table/layout.h"

enum { KIND_BITS = 8 }; // of "doing": the rest is ns, enough for two years of uptime

bool ob_universe_traced(const ob_universe *u)
{
	return u->header.sizes.trace_events > 0;
}
uint32_t ob_trace_rings(const ob_universe *u)
{
	return u->header.sizes.workers + OB_TRACE_HOST_RINGS;
}
uint32_t ob_trace_host(const ob_universe *u)
{
	return u->header.sizes.workers;
}
uint32_t ob_trace_supervisor(const ob_universe *u)
{
	return u->header.sizes.workers + 1;
}

// First event and number of events of a ring.
static ob_trace_event *events_of(const ob_universe *u, uint32_t ring, uint32_t *size)
{
	uint32_t each = u->header.sizes.trace_events, workers = u->header.sizes.workers;
	bool hosts = ring >= workers;
	*size = hosts ? OB_TRACE_HOST_EVENTS : each;
	return u->trace_event + (size_t)each * (hosts ? workers : ring) +
	       (hosts ? (size_t)OB_TRACE_HOST_EVENTS * (ring - workers) : 0);
}

bool ob_trace_unprotect(ob_universe *u, uint32_t ring)
{
	if (!ob_universe_traced(u))
		return true;
	uint32_t size;
	ob_trace_event *event = events_of(u, ring, &size);
	return mprotect(u->trace_ring + ring, sizeof *u->trace_ring, PROT_READ | PROT_WRITE) == 0 &&
	       mprotect(event, size * sizeof *event, PROT_READ | PROT_WRITE) == 0;
}

// ---- writers

static void put(ob_universe *u, uint32_t ring, const ob_trace_event *e)
{
	uint32_t size;
	ob_trace_event *event = events_of(u, ring, &size);
	ob_trace_ring *r = u->trace_ring + ring;
	uint64_t n = __atomic_load_n(&r->written, __ATOMIC_RELAXED);
	// the reader's word is read once in a round, not at each event: it lies in the reader's cache line
	if (n - r->taken_seen >= size)
		r->taken_seen = __atomic_load_n(&r->taken, __ATOMIC_ACQUIRE);
	if (n - r->taken_seen >= size) {
		__atomic_store_n(&r->lost, __atomic_load_n(&r->lost, __ATOMIC_RELAXED) + 1, __ATOMIC_RELAXED);
		return;
	}
	event[n & (size - 1)] = *e;
	__atomic_store_n(&r->written, n + 1, __ATOMIC_RELEASE);
}

uint64_t ob_trace_span(ob_universe *u, uint32_t ring, ob_trace_kind kind, uint64_t begin, uint32_t a, uint32_t b)
{
	uint64_t now = ob_clock_ns();
	ob_trace_event e = { begin, now, kind, a, b, (uint32_t)ob_step_count(u) + 1 };
	put(u, ring, &e);
	return now;
}

void ob_trace_doing(ob_universe *u, uint32_t ring, ob_trace_kind kind, uint64_t begin)
{
	__atomic_store_n(&u->trace_ring[ring].doing, begin << KIND_BITS | kind, __ATOMIC_RELAXED);
}

ob_trace_motion ob_trace_motion_of(uint32_t flags)
{
	return flags & OB_MOTION_ASLEEP ? OB_TRACE_ASLEEP
	       : flags & OB_MOTION_FREE ? OB_TRACE_FLYING
					: OB_TRACE_TOUCHING;
}

static void change(ob_universe *u, uint32_t ring, uint32_t id, ob_trace_motion before, ob_trace_motion after)
{
	uint64_t *since = u->trace_since + id;
	uint64_t begin = __atomic_load_n(since, __ATOMIC_RELAXED);
	uint64_t now = ob_trace_span(u, ring, OB_TRACE_STATE, begin, id, before | (uint32_t)after << 8);
	__atomic_store_n(since, now, __ATOMIC_RELAXED);
}

void ob_trace_moves(ob_universe *u, uint32_t ring, uint32_t id, uint32_t flags_before, uint32_t flags)
{
	ob_trace_motion before = ob_trace_motion_of(flags_before), after = ob_trace_motion_of(flags);
	if (before != after)
		change(u, ring, id, before, after);
}

void ob_trace_birth(ob_universe *u, uint32_t id)
{
	uint64_t now = ob_trace_span(u, ob_trace_host(u), OB_TRACE_BIRTH, ob_clock_ns(), id, 0);
	__atomic_store_n(u->trace_since + id, now, __ATOMIC_RELAXED);
}

void ob_trace_death(ob_universe *u, uint32_t id, uint32_t flags_before)
{
	if (!(ob_passport_of(u, id)->flags & OB_OBJECT_PRESCRIBED)) // static and kinematic objects have no state
		change(u, ob_trace_host(u), id, ob_trace_motion_of(flags_before), OB_TRACE_ABSENT);
	ob_trace_span(u, ob_trace_host(u), OB_TRACE_DEATH, ob_trace_since(u, id), id, 0);
}

// ---- the reader

// A writer in another process may have stored anything in its words: a ring that claims to be more than full is
// damaged, and its contents are skipped.
uint32_t ob_trace_take(ob_universe *u, uint32_t ring, ob_trace_event *out, uint32_t max)
{
	uint32_t size, n = 0;
	const ob_trace_event *event = events_of(u, ring, &size);
	ob_trace_ring *r = u->trace_ring + ring;
	uint64_t taken = __atomic_load_n(&r->taken, __ATOMIC_RELAXED);
	uint64_t ready = __atomic_load_n(&r->written, __ATOMIC_ACQUIRE) - taken;
	if (ready > size) { // more than the ring's size
		__atomic_store_n(&r->taken, taken + ready, __ATOMIC_RELEASE);
		return 0;
	}
	for (; n < max && n < ready; n++)
		out[n] = event[(taken + n) & (size - 1)];
	__atomic_store_n(&r->taken, taken + n, __ATOMIC_RELEASE);
	return n;
}

uint64_t ob_trace_lost(const ob_universe *u, uint32_t ring)
{
	return __atomic_load_n(&u->trace_ring[ring].lost, __ATOMIC_RELAXED);
}

ob_trace_event ob_trace_unfinished(const ob_universe *u, uint32_t ring)
{
	uint64_t doing = __atomic_load_n(&u->trace_ring[ring].doing, __ATOMIC_RELAXED);
	return (ob_trace_event){ .begin = doing >> KIND_BITS, .kind = doing & ((1u << KIND_BITS) - 1) };
}

uint64_t ob_trace_since(const ob_universe *u, uint32_t id)
{
	return __atomic_load_n(u->trace_since + id, __ATOMIC_RELAXED);
}

// The object may have been added and removed between two reads.
bool ob_trace_name(const ob_universe *u, uint32_t id, char name[OB_NAME_MAX])
{
	ob_passport p;
	if (!ob_passport_read(u, id, &p) || !memchr(p.name, 0, sizeof p.name))
		return false;
	memcpy(name, p.name, OB_NAME_MAX);
	return true;
}

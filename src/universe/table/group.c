#include "table/group.h"

#include <stddef.h>
#include <string.h>

#include "table/futex.h"
#include "table/layout.h"
#include "table/pages.h"

enum { WAIT_MS = 50 };

bool ob_group_is(const ob_universe *u)
{
	return u->header.sizes.grouped > 0;
}

// ---- places: step << 32 | worker << 1 | held

static uint64_t place_at(const ob_universe *u, uint32_t id)
{
	return __atomic_load_n(&u->free.place[id], __ATOMIC_SEQ_CST);
}

static ob_group_place place_of(uint64_t word)
{
	return (ob_group_place){ .worker = (uint32_t)word >> 1, .step = (uint32_t)(word >> 32), .held = word & 1 };
}

static uint64_t word_of(ob_group_place p)
{
	return (uint64_t)p.step << 32 | p.worker << 1 | p.held;
}

static bool change_place(ob_universe *u, uint32_t id, ob_group_place known, ob_group_place to)
{
	uint64_t word = word_of(known);
	return __atomic_compare_exchange_n(&u->free.place[id], &word, word_of(to), false, __ATOMIC_SEQ_CST,
					   __ATOMIC_SEQ_CST);
}

ob_group_place ob_group_place_of(const ob_universe *u, uint32_t id)
{
	return place_of(place_at(u, id));
}

uint32_t ob_group_made(const ob_universe *u, uint32_t worker)
{
	return __atomic_load_n(&u->free.bed[worker].made, __ATOMIC_SEQ_CST);
}

// A body that is parked meanwhile is so at the step that its worker has made.
uint32_t ob_group_step(const ob_universe *u, uint32_t id)
{
	for (;;) {
		const uint64_t word = place_at(u, id);
		const ob_group_place p = place_of(word);
		if (!p.held || p.worker >= u->header.sizes.workers)
			return p.step;
		const uint32_t made = ob_group_made(u, p.worker);
		if (place_at(u, id) == word)
			return made;
	}
}

bool ob_group_park(ob_universe *u, uint32_t id, ob_group_place known, uint32_t worker, uint32_t step)
{
	return change_place(u, id, known, (ob_group_place){ .worker = worker, .step = step });
}

bool ob_group_hold(ob_universe *u, uint32_t id, ob_group_place known)
{
	return change_place(u, id, known, (ob_group_place){ .worker = known.worker, .held = true });
}

// ---- versions

static ob_motion *motion_at(const ob_universe *u, uint32_t id, uint64_t version)
{
	const uint32_t depth = u->header.sizes.history;
	return &u->free.ring[(uint64_t)id * depth + version % depth];
}

static ob_group_state *state_at(const ob_universe *u, uint32_t id, uint64_t version)
{
	return &u->free.state[OB_GROUP_VERSIONS * (uint64_t)id + version % OB_GROUP_VERSIONS];
}

// Place of a contact: the first few of each version lie together, those beyond take memory when they come.
static ob_group_contact *contact_at(const ob_universe *u, uint32_t id, uint64_t version, uint32_t i)
{
	const uint64_t block = 2 * (uint64_t)id + version % 2;
	return i < OB_GROUP_USUALLY ? &u->free.contact[block * OB_GROUP_USUALLY + i]
				    : &u->free.more_contact[block * OB_GROUP_SELDOM + i - OB_GROUP_USUALLY];
}

// Bytes of a contact that say something.
static size_t size_of(const ob_group_contact *c)
{
	return c->key.record == OB_NO_RECORD ? offsetof(ob_group_contact, state) : sizeof *c;
}

static uint64_t version_of(const ob_universe *u, uint32_t id)
{
	return __atomic_load_n(&u->free.cell[id].version, __ATOMIC_SEQ_CST);
}

uint64_t ob_group_read(const ob_universe *u, uint32_t id, uint32_t step, ob_motion *m, float bounds[6])
{
	const uint32_t depth = bounds ? OB_GROUP_VERSIONS : u->header.sizes.history;
	for (int i = 0; i < OB_RING_TRIES; i++) {
		const uint64_t newest = version_of(u, id), kept = newest < depth - 1 ? newest : depth - 1;
		for (uint64_t v = newest; v > newest - kept; v--) {
			ob_words_get(m, motion_at(u, id, v), sizeof *m);
			if (m->step > step)
				continue;
			if (bounds)
				ob_words_get(bounds, state_at(u, id, v)->bounds, 6 * sizeof *bounds);
			if (version_of(u, id) + 2 <= v + depth)
				return v;
			break;
		}
	}
	return 0;
}

void ob_group_take_back(ob_universe *u, uint32_t id, uint32_t step)
{
	ob_free_cell *c = &u->free.cell[id];
	while (c->version > 1 && state_at(u, id, c->version)->step > step)
		__atomic_store_n(&c->version, c->version - 1, __ATOMIC_SEQ_CST);
}

void ob_group_get(const ob_universe *u, uint32_t id, ob_motion *m, ob_group_state *s, ob_group_contact *contact)
{
	const uint64_t v = version_of(u, id);
	ob_words_get(m, motion_at(u, id, v), sizeof *m);
	ob_words_get(s, state_at(u, id, v), sizeof *s);
	s->contacts = s->contacts < OB_GROUP_CONTACTS ? s->contacts : OB_GROUP_CONTACTS;
	for (uint32_t i = 0; i < s->contacts; i++) {
		const ob_group_contact *from = contact_at(u, id, v, i);
		ob_words_get(&contact[i], from, offsetof(ob_group_contact, state));
		if (contact[i].key.record != OB_NO_RECORD)
			ob_words_get(&contact[i], from, sizeof *from);
	}
}

bool ob_group_put(ob_universe *u, uint32_t id, const ob_motion *m, const ob_group_state *s,
		  const ob_group_contact *contact)
{
	ob_free_cell *c = &u->free.cell[id];
	const uint64_t next = c->version + 1;
	if (s->contacts > OB_GROUP_USUALLY &&
	    !ob_pages_take(u, OB_AREA_FREE_CONTACT_MORE, (2 * (uint64_t)id + next % 2) * OB_GROUP_SELDOM,
			   s->contacts - OB_GROUP_USUALLY)) {
		ob_step_fail(u, OB_STEP_MEMORY_FULL, id);
		return false;
	}
	ob_words_put(motion_at(u, id, next), m, sizeof *m);
	ob_words_put(state_at(u, id, next), s, sizeof *s);
	for (uint32_t i = 0; i < s->contacts; i++)
		ob_words_put(contact_at(u, id, next, i), &contact[i], size_of(&contact[i]));
	__atomic_store_n(&c->version, next, __ATOMIC_SEQ_CST);
	return true;
}

void ob_group_enter(ob_universe *u, uint32_t id, uint32_t worker, const ob_motion *m)
{
	const ob_step_data *data = &u->step_data;
	ob_group_state s = { .schedule = data->schedule[id],
			     .neighbours = UINT32_MAX,
			     .step = (uint32_t)ob_step_count(u) };
	memcpy(s.bounds, data->bounds[id], sizeof s.bounds);
	ob_group_put(u, id, m, &s, NULL);
	__atomic_store_n(&u->free.place[id], word_of((ob_group_place){ .worker = worker, .step = s.step }),
			 __ATOMIC_SEQ_CST);
}

// ---- waiting

static void rouse(ob_universe *u, uint32_t worker)
{
	ob_free_bed *b = &u->free.bed[worker];
	__atomic_fetch_add(&b->word, 1, __ATOMIC_SEQ_CST);
	if (__atomic_load_n(&b->at, __ATOMIC_SEQ_CST))
		ob_futex_wake(&b->word, ~0u);
}

// Wakes workers that wait for this one. In one order with the waiter's store of `awaited` and its look at what it waits for.
static void rouse_waiting(ob_universe *u, uint32_t worker)
{
	if (!__atomic_load_n(&u->free.bed[worker].awaited, __ATOMIC_SEQ_CST))
		return;
	__atomic_store_n(&u->free.bed[worker].awaited, 0, __ATOMIC_SEQ_CST);
	for (uint32_t w = 0; w < u->header.sizes.workers; w++)
		if (__atomic_load_n(&u->free.bed[w].blocker, __ATOMIC_SEQ_CST) == worker + 1)
			rouse(u, w);
}

void ob_group_make(ob_universe *u, uint32_t worker, uint32_t steps, uint64_t updates)
{
	ob_free_bed *b = &u->free.bed[worker];
	__atomic_store_n(&b->made, steps, __ATOMIC_SEQ_CST);
	__atomic_store_n(&b->updates, b->updates + updates, __ATOMIC_RELAXED);
	rouse_waiting(u, worker);
}

void ob_group_notify(ob_universe *u, uint32_t worker, uint32_t other)
{
	if (other != worker)
		rouse(u, other);
	rouse_waiting(u, worker);
}

void ob_group_await(ob_universe *u, uint32_t worker, uint32_t blocker)
{
	__atomic_store_n(&u->free.bed[worker].blocker, blocker + 1, __ATOMIC_SEQ_CST);
	if (blocker != OB_NO_WORKER)
		__atomic_store_n(&u->free.bed[blocker].awaited, 1, __ATOMIC_SEQ_CST);
}

void ob_group_wait(ob_universe *u, uint32_t worker, uint32_t seen)
{
	ob_free_bed *b = &u->free.bed[worker];
	__atomic_store_n(&b->at, OB_FREE_OWN_WORD, __ATOMIC_SEQ_CST);
	if (__atomic_load_n(&b->word, __ATOMIC_SEQ_CST) == seen)
		ob_futex_wait_ms(&b->word, seen, WAIT_MS);
	__atomic_store_n(&b->at, 0, __ATOMIC_RELAXED);
	__atomic_store_n(&b->waits, b->waits + 1, __ATOMIC_RELAXED);
}

bool ob_group_blocker(const ob_universe *u, uint32_t worker, uint32_t *blocker)
{
	const uint32_t found = __atomic_load_n(&u->free.bed[worker].blocker, __ATOMIC_RELAXED);
	*blocker = found - 1;
	return found;
}

void ob_group_count(const ob_universe *u, uint32_t worker, uint64_t *updates, uint64_t *waits)
{
	const ob_free_bed *b = &u->free.bed[worker];
	*updates += __atomic_load_n(&b->updates, __ATOMIC_RELAXED);
	*waits += __atomic_load_n(&b->waits, __ATOMIC_RELAXED);
}

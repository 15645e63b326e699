// The slot explored exhaustively: its own code, a writer that may be killed before any of its stores, its successor,
// and a reader, in every interleaving, with delayed stores, as on processors with store buffers (total store order;
// Owens, Sarkar and Sewell 2009). Every copy is of one version, none is older than one that was complete before. Broken
// variants are detected.
//
// Each execution is replayed from its choices (stateless search, Godefroid 1997). A state seen before is abandoned: it
// consists of memory, buffers, and the values read by each thread, which determine its place.
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <ucontext.h>

#include "../check.h"
#include <ob/universe.h>

static uint64_t load(const void *at, int order);
static void store(void *at, uint64_t value, int order);
#define __atomic_load_n(at, order) load(at, order)
#define __atomic_store_n(at, value, order) store(at, value, order)
#include "table/slot.h"
#undef __atomic_load_n
#undef __atomic_store_n

enum {
	THREADS = 3,
	WRITER = 0,
	SUCCESSOR,
	READER,
	WORDS = 2,
	BUFFER = 8,
	CHOICES_MAX = 4096,
	STACK = 64 << 10,
	SEEN = 1 << 22
};

static struct {
	uint64_t version, ring[2][WORDS];
} slot;

static struct thread {
	ucontext_t context;
	uint64_t history; // hash of its reads and stores
	struct {
		uint64_t *at, value;
	} buffer[BUFFER];
	uint32_t buffered;
	bool done, killed;
	uint64_t read[2]; // a reader's first and second copy
} threads[THREADS];

static enum variant { SOUND, VERSION_FIRST, ONE_PLACE } variant;
static char stacks[THREADS][STACK];
static ucontext_t explorer;
static int running;
static uint64_t seen[SEEN], states;
static uint16_t choice[CHOICES_MAX];
static uint32_t depth;
static long torn, stale;

static uint64_t mix(uint64_t h, uint64_t x)
{
	h = (h ^ (x + UINT64_C(0x632be59bd9b4e019))) * UINT64_C(0x9e3779b97f4a7c15);
	return h ^ h >> 29;
}

static void yield(void)
{
	swapcontext(&threads[running].context, &explorer);
}

static uint64_t load(const void *at, int order)
{
	(void)order;
	yield();
	struct thread *t = &threads[running];
	uint64_t value = *(const uint64_t *)at;
	for (uint32_t i = 0; i < t->buffered; i++)
		if (t->buffer[i].at == at)
			value = t->buffer[i].value;
	t->history = mix(t->history, value);
	return value;
}

static void store(void *at, uint64_t value, int order)
{
	(void)order;
	yield();
	struct thread *t = &threads[running];
	t->buffer[t->buffered].at = at;
	t->buffer[t->buffered++].value = value;
	t->history = mix(t->history, ~value);
}

static void publish(uint64_t number)
{
	uint64_t record[WORDS] = { number, number };
	const ptrdiff_t stride = variant == ONE_PLACE ? 0 : (ptrdiff_t)sizeof slot.ring[0];
	if (variant == VERSION_FIRST) {
		uint64_t next = load(&slot.version, __ATOMIC_ACQUIRE) + 1;
		store(&slot.version, next, __ATOMIC_RELEASE);
		for (int i = 0; i < WORDS; i++)
			store(&slot.ring[next % 2][i], number, __ATOMIC_RELEASE);
		return;
	}
	ob_ring_publish(&slot.version, slot.ring, stride, sizeof record, record);
}

static void live(void)
{
	const int me = running;
	if (me == WRITER || me == SUCCESSOR) {
		for (uint64_t k = 1; k <= (me == WRITER ? 2 : 1); k++)
			publish(10 * (uint64_t)(me + 1) + k);
	} else {
		const ptrdiff_t stride = variant == ONE_PLACE ? 0 : (ptrdiff_t)sizeof slot.ring[0];
		for (int k = 0; k < 2; k++) {
			uint64_t out[WORDS] = { 0, 0 };
			if (ob_ring_read(&slot.version, slot.ring, stride, sizeof out, out)) {
				torn += out[0] != out[1];
				threads[me].read[k] = out[0];
			}
		}
		stale += threads[me].read[1] < threads[me].read[0];
	}
	threads[me].done = true;
	swapcontext(&threads[me].context, &explorer);
}

static void begin(void)
{
	memset(&slot, 0, sizeof slot);
	memset(threads, 0, sizeof threads);
	for (int i = 0; i < THREADS; i++) {
		getcontext(&threads[i].context);
		threads[i].context.uc_stack.ss_sp = stacks[i];
		threads[i].context.uc_stack.ss_size = STACK;
		makecontext(&threads[i].context, live, 0);
		running = i;
		swapcontext(&explorer, &threads[i].context); // up to its first access
	}
}

static bool may_run(int i)
{
	const struct thread *w = &threads[WRITER];
	if (threads[i].done || threads[i].killed || threads[i].buffered == BUFFER)
		return false;
	return i != SUCCESSOR || ((w->done || w->killed) && !w->buffered); // the gate orders a change of writer
}

// Choices of a state: thread i goes on (i), a store of it becomes visible (THREADS + i), the writer is killed (2
// THREADS).
static bool is_possible(uint16_t c)
{
	if (c < THREADS)
		return may_run(c);
	if (c < 2 * THREADS)
		return threads[c - THREADS].buffered > 0;
	return !threads[WRITER].done && !threads[WRITER].killed;
}

static void carry_out(uint16_t c)
{
	if (c < THREADS) {
		running = c;
		swapcontext(&explorer, &threads[c].context);
	} else if (c < 2 * THREADS) {
		struct thread *t = &threads[c - THREADS];
		*t->buffer[0].at = t->buffer[0].value;
		memmove(t->buffer, t->buffer + 1, --t->buffered * sizeof t->buffer[0]);
	} else {
		threads[WRITER].killed = true;
	}
}

// Returns true for a new state.
static bool note_state(void)
{
	uint64_t h = mix(1, slot.version);
	for (int i = 0; i < 2 * WORDS; i++)
		h = mix(h, slot.ring[i / WORDS][i % WORDS]);
	for (int i = 0; i < THREADS; i++) {
		const struct thread *t = &threads[i];
		h = mix(mix(h, t->history), (uint64_t)t->done << 1 | t->killed);
		for (uint32_t k = 0; k < t->buffered; k++)
			h = mix(mix(h, (uint64_t)((char *)t->buffer[k].at - (char *)&slot)), t->buffer[k].value);
		h = mix(h, t->buffered);
	}
	h |= !h;
	for (uint64_t at = h % SEEN;; at = (at + 1) % SEEN) {
		if (seen[at] == h)
			return false;
		if (!seen[at]) {
			seen[at] = h;
			states++;
			return states < SEEN / 2;
		}
	}
}

static uint16_t first_possible(uint16_t from)
{
	while (from <= 2 * THREADS && !is_possible(from))
		from++;
	return from;
}

// Replays the choices so far, then goes on with the first of each new state to its end.
static void execute(void)
{
	begin();
	for (uint32_t i = 0; i < depth; i++)
		carry_out(choice[i]);
	while (note_state() && depth < CHOICES_MAX) {
		uint16_t c = first_possible(0);
		if (c > 2 * THREADS)
			return;
		choice[depth++] = c;
		carry_out(c);
	}
}

// Finds the next choice of the last state that has one, by replaying the choices before.
static bool backtrack(void)
{
	while (depth > 0) {
		uint16_t last = choice[--depth];
		begin();
		for (uint32_t i = 0; i < depth; i++)
			carry_out(choice[i]);
		uint16_t c = first_possible(last + 1);
		if (c <= 2 * THREADS) {
			choice[depth++] = c;
			return true;
		}
	}
	return false;
}

static void explore(enum variant v)
{
	variant = v;
	memset(seen, 0, sizeof seen);
	states = depth = 0;
	torn = stale = 0;
	do
		execute();
	while (!(torn | stale) && backtrack());
	printf("variant %d: %llu states, %ld torn, %ld stale\n", (int)v, (unsigned long long)states, torn, stale);
}

int main(void)
{
	explore(SOUND);
	CHECK(torn == 0 && stale == 0 && states > 1000 && states < SEEN / 2);
	explore(ONE_PLACE);
	CHECK(torn + stale > 0);
	explore(VERSION_FIRST);
	CHECK(torn + stale > 0);
	return check_end();
}

// The gate explored exhaustively, like the slot (test_slot_model.c): its own code, two workers and the host, in every
// interleaving, with delayed stores (total store order). A worker may be killed between any two accesses, and the gate
// may be stopped at any time. Each phase runs in exactly its participants, once; exactly one worker schedules the next,
// after all have arrived. No thread sleeps for ever: when the gate is opened, when the host has the turn, or when it is
// stopped. Broken variants are detected.
//
// After a kill the host stops the gate, all leave, and the restart begins with a new gate, so it has no part here.
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <ucontext.h>

#include "../check.h"
#include "base/cpu.h"
#include "table/futex.h"
#include "table/layout.h"
#include "table/outbox.h"

// ---- the explorer executes the memory accesses of the gate's code

enum change { SET, OR, AND, ADD };

static uint64_t load(const void *at, size_t bytes);
static void store(void *at, size_t bytes, uint64_t value);
static uint64_t change(void *at, size_t bytes, enum change how, uint64_t x); // returns the previous value
static void sleep_on(const uint32_t *word, uint32_t seen, uint32_t bits, const struct timespec *until);
static void wake_sleepers(const uint32_t *word, uint32_t bits);

#define __atomic_load_n(at, order) ((__typeof__(*(at)))load(at, sizeof *(at)))
#define __atomic_store_n(at, value, order) \
	((order) == __ATOMIC_SEQ_CST ? (void)change(at, sizeof *(at), SET, value) : store(at, sizeof *(at), value))
#define __atomic_fetch_or(at, x, order) change(at, sizeof *(at), OR, x)
#define __atomic_fetch_and(at, x, order) change(at, sizeof *(at), AND, x)
#define __atomic_fetch_add(at, x, order) change(at, sizeof *(at), ADD, x)
#define __atomic_sub_fetch(at, x, order) ((__typeof__(*(at)))(change(at, sizeof *(at), ADD, -(uint64_t)(x)) - (x)))
#define ob_futex_wait(word, seen, bits, until) sleep_on(word, seen, bits, until)
#define ob_futex_wake(word, bits) wake_sleepers(word, bits)
#include "table/gate.c"
#include "table/turn.c"
#undef __atomic_load_n
#undef __atomic_store_n
#undef __atomic_fetch_or
#undef __atomic_fetch_and
#undef __atomic_fetch_add
#undef __atomic_sub_fetch

enum {
	WORKERS = 2,
	HOST = WORKERS,
	STOPPER, // a thread of the host: the supervisor after a death, or Ctrl-C
	THREADS,
	BUFFER = 16,
	DEPTH_MAX = 2048,
	STACK = 64 << 10,
	SAVED = 3 << 10, // size of a saved stack
	BELOW = 512, // part of it below the frame of the yielding thread
	SEEN = 1 << 22
};

enum variant {
	SOUND,
	WORD_STANDS, // an opening does not move the futex word
	OPENER_CLEARS, // the waker clears the bits of sleepers
	LATE_DONE, // a worker records the turn as done after its arrival
	STOP_WORD_STANDS, // STOP does not move the words
	STOP_TAKEN, // an opening overwrites STOP's signal to the host
	VARIANTS
};

enum fate { LIVES, STOPPED_ANY_TIME, KILLED_ANY_TIME };

// Scenario: phases by their participants (bit per worker; 0: the host has the turn).
static struct scenario {
	const char *what;
	uint32_t id[WORKERS]; // in one half of a group, in two, in two groups
	uint8_t phase[8];
	uint32_t phases;
	enum fate fate;
} const *scenario;

static struct {
	ob_gate gate;
	ob_gate_group group[2];
	ob_gate_cell cell[65];
	ob_control control;
	struct ob_step_counts count;
} shared;

static ob_universe universe = {
	.gate = &shared.gate, .gate_group = shared.group, .gate_cell = shared.cell, .control = &shared.control
};

static struct thread {
	ucontext_t context;
	uint64_t history; // hash of its actions and reads, since it was last without pending state
	struct {
		void *at;
		size_t bytes;
		uint64_t value;
	} buffer[BUFFER];
	uint32_t buffered;
	bool drains; // goes on when its buffer is empty
	const uint32_t *asleep_on; // NULL: it is awake
	uint32_t bits;
	bool done, killed;
	char *top; // top of the used part of its stack: it grows down
} threads[THREADS];

// Expected and actual state of the phases, visible to all at once.
static struct {
	uint32_t opened; // phases so far; a turn of the host counts as one
	uint32_t invited, ran, arrived; // bit per worker
	bool scheduled;
	bool over; // the host has had its last turn
} now;

static enum variant variant;
static _Alignas(64) char stacks[THREADS][STACK];
static ucontext_t explorer;
static int running;
static uint64_t seen[SEEN], states;
static uint32_t deepest;
static long wrong, stuck;

static uint64_t mix(uint64_t h, uint64_t x)
{
	h = (h ^ (x + UINT64_C(0x632be59bd9b4e019))) * UINT64_C(0x9e3779b97f4a7c15);
	return h ^ h >> 29;
}

__attribute__((noinline)) static void yield(void)
{
	threads[running].top = (char *)__builtin_frame_address(0) - BELOW;
	swapcontext(&threads[running].context, &explorer);
}

static void yield_drained(void)
{
	struct thread *t = &threads[running];
	t->drains = true;
	yield();
	t->drains = false;
}

static uint64_t get(const void *at, size_t bytes)
{
	uint64_t value = 0;
	memcpy(&value, at, bytes); // little-endian or not: it is put back the same way
	return value;
}

// True for words that others read only in turns of their own.
static bool is_opener_word(const void *at)
{
	return at == &shared.group[0].expected || at == &shared.group[1].expected || at == &shared.gate.phase;
}

static bool is_done_word(const void *at)
{
	return running < WORKERS && at == &shared.cell[scenario->id[running]].done;
}

static uint64_t load(const void *at, size_t bytes)
{
	struct thread *t = &threads[running];
	if (!is_opener_word(at) && !is_done_word(at)) // the latter is the worker's own
		yield();
	if (variant == STOP_TAKEN && at == &shared.gate.host_turn && running < WORKERS)
		shared.gate.host_turn = 0;
	uint64_t value = get(at, bytes);
	for (uint32_t i = 0; i < t->buffered; i++)
		if (t->buffer[i].at == at)
			value = t->buffer[i].value;
	t->history = mix(t->history, value);
	return value;
}

static bool is_arrived_word(const void *at)
{
	return at == &shared.group[0].arrived || at == &shared.group[1].arrived;
}

static bool is_sleeping(const void *at, size_t offset)
{
	for (int i = 0; i < 4; i++)
		if (at == (char *)&shared.group[i / 2].half[i % 2] + offset)
			return true;
	return false;
}

// A store is invisible until it leaves the buffer, so it is no choice of its own.
static void put_into_buffer(void *at, size_t bytes, uint64_t value)
{
	struct thread *t = &threads[running];
	while (t->buffered == BUFFER)
		yield();
	t->buffer[t->buffered].at = at;
	t->buffer[t->buffered].bytes = bytes;
	t->buffer[t->buffered++].value = value;
	t->history = mix(t->history, ~value);
}

static void store(void *at, size_t bytes, uint64_t value)
{
	if (variant == LATE_DONE && is_done_word(at))
		return;
	put_into_buffer(at, bytes, value);
}

static uint64_t change(void *at, size_t bytes, enum change how, uint64_t x)
{
	yield_drained();
	struct thread *t = &threads[running];
	const uint64_t before = get(at, bytes);
	uint64_t after = how == SET ? x : how == OR ? before | x : how == AND ? before & x : before + x;
	if (is_sleeping(at, offsetof(ob_gate_half, word)) &&
	    variant == (shared.gate.stop ? STOP_WORD_STANDS : WORD_STANDS))
		after = before;
	if (variant == OPENER_CLEARS && how == OR && x == 0 && is_sleeping(at, offsetof(ob_gate_half, asleep)))
		after = 0;
	memcpy(at, &after, bytes);
	t->history = mix(t->history, before);
	if (variant == LATE_DONE && is_arrived_word(at) && running < WORKERS) {
		ob_gate_cell *cell = &shared.cell[scenario->id[running]];
		put_into_buffer(&cell->done, sizeof cell->done, load(&cell->turn, sizeof cell->turn));
	}
	return before;
}

// The kernel compares the word and lets the thread sleep as one.
static void sleep_on(const uint32_t *word, uint32_t expected, uint32_t bits, const struct timespec *until)
{
	(void)until; // late wakes are not modelled
	yield_drained();
	struct thread *t = &threads[running];
	t->history = 1; // after any wake, it reads everything anew
	if (*word != expected)
		return;
	t->asleep_on = word;
	t->bits = bits;
	yield();
}

static void wake_sleepers(const uint32_t *word, uint32_t bits)
{
	yield_drained();
	threads[running].history = mix(threads[running].history, bits);
	for (int i = 0; i < THREADS; i++)
		if (threads[i].asleep_on == word && threads[i].bits & bits)
			threads[i].asleep_on = NULL;
}

// ---- workers and host

static void open_next(void)
{
	const uint8_t part = now.opened < scenario->phases ? scenario->phase[now.opened] : 0;
	uint32_t participants[WORKERS], n = 0;
	now.opened++;
	now.invited = part;
	now.ran = now.arrived = 0;
	now.scheduled = false;
	for (uint32_t w = 0; w < WORKERS; w++)
		if (part >> w & 1)
			participants[n++] = scenario->id[w];
	if (part)
		ob_gate_open(&universe, now.opened % 2 ? OB_PHASE_BROADPHASE : OB_PHASE_ISLANDS, participants, n);
	else
		ob_gate_pause(&universe);
}

static void work(uint32_t me)
{
	for (;;) {
		threads[running].history = 0; // it has no pending state
		const ob_phase phase = ob_turn_wait(&universe, scenario->id[me]);
		if (phase == OB_PHASE_STOP)
			return;
		wrong += !(now.invited >> me & 1) || now.ran >> me & 1;
		wrong += phase != (now.opened % 2 ? OB_PHASE_BROADPHASE : OB_PHASE_ISLANDS);
		now.ran |= 1u << me;
		now.arrived |= 1u << me;
		if (ob_turn_arrive(&universe, scenario->id[me])) {
			wrong += now.scheduled || now.arrived != now.invited;
			now.scheduled = true;
			open_next();
		}
	}
}

static void be_host(void)
{
	for (;;) {
		threads[running].history = 0;
		if (now.over) { // it sleeps until STOP
			sleep_on(&shared.gate.host_turn, 1, ~0u, NULL);
			return;
		}
		wrong += !ob_gate_host_wait(&universe, 1e9);
		if (load(&shared.gate.stop, sizeof shared.gate.stop))
			return;
		wrong += now.invited != 0;
		if (now.opened >= scenario->phases)
			now.over = true;
		else
			open_next();
	}
}

static void live(void)
{
	const int me = running;
	if (me < WORKERS)
		work((uint32_t)me);
	else if (me == HOST)
		be_host();
	else
		ob_gate_stop(&universe);
	threads[me].done = true;
	swapcontext(&threads[me].context, &explorer);
}

// ---- the explorer

static void begin(void)
{
	memset(&shared, 0, sizeof shared);
	memset(threads, 0, sizeof threads);
	memset(&now, 0, sizeof now);
	universe.header.sizes.workers = scenario->id[WORKERS - 1] + 1;
	universe.step_data.count = &shared.count;
	ob_gate_prepare(&shared.gate, universe.header.sizes.workers);
	shared.gate.spin = 0; // spinning is just reading more often
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
	const struct thread *t = &threads[i];
	if (t->done || t->killed || t->asleep_on || (t->buffered && (t->drains || t->buffered == BUFFER)))
		return false;
	return i != STOPPER || scenario->fate == STOPPED_ANY_TIME || threads[0].killed || now.over;
}

// Choices of a state: thread i goes on (i), a store of it becomes visible (THREADS + i), a worker is killed (2 THREADS;
// all are equivalent).
enum { CHOICES = 2 * THREADS + 1 };

static bool is_possible(uint16_t c)
{
	if (c < THREADS)
		return may_run(c);
	if (c < 2 * THREADS)
		return threads[c - THREADS].buffered > 0;
	return scenario->fate == KILLED_ANY_TIME && !threads[0].killed && !threads[0].done;
}

// Makes the oldest store visible; if it concerns words that others read only in turns of their own, the next one, too.
static void let_out(struct thread *t)
{
	bool alone = false;
	while (t->buffered && !alone) {
		const void *at = t->buffer[0].at;
		alone = !is_opener_word(at) && !is_arrived_word(at) && at != &shared.gate.groups_left;
		memcpy(t->buffer[0].at, &t->buffer[0].value, t->buffer[0].bytes);
		memmove(t->buffer, t->buffer + 1, --t->buffered * sizeof t->buffer[0]);
	}
}

static void carry_out(uint16_t c)
{
	if (c < THREADS) {
		running = c;
		swapcontext(&explorer, &threads[c].context);
	} else if (c < 2 * THREADS) {
		let_out(&threads[c - THREADS]);
	} else {
		threads[0].killed = true;
		threads[0].asleep_on = NULL;
	}
}

// Returns true for a new state.
static bool note_state(void)
{
	const ob_gate *g = &shared.gate;
	uint64_t h = mix(mix(mix(mix(mix(1, g->turn), g->phase), g->groups_left), g->stop), g->host_turn);
	for (int i = 0; i < 2; i++) {
		h = mix(mix(h, shared.group[i].arrived), shared.group[i].expected);
		for (int k = 0; k < 2; k++)
			h = mix(h, (uint64_t)shared.group[i].half[k].word << 32 | shared.group[i].half[k].asleep);
	}
	for (int w = 0; w < WORKERS; w++)
		h = mix(h, (uint64_t)shared.cell[scenario->id[w]].turn << 32 | shared.cell[scenario->id[w]].done);
	h = mix(mix(h, (uint64_t)now.opened << 32 | now.invited << 24 | now.ran << 16 | now.arrived << 8 |
			       now.over << 1 | now.scheduled),
		0);
	for (int i = 0; i < THREADS; i++) {
		const struct thread *t = &threads[i];
		h = mix(mix(h, t->history),
			(uint64_t)t->done << 3 | t->killed << 2 | (t->asleep_on != NULL) << 1 | t->drains);
		for (uint32_t k = 0; k < t->buffered; k++)
			h = mix(mix(h, (uint64_t)((char *)t->buffer[k].at - (char *)&shared)), t->buffer[k].value);
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
	while (from < CHOICES && !is_possible(from))
		from++;
	return from;
}

static bool all_left(void)
{
	for (int i = 0; i < THREADS; i++)
		if (!threads[i].done && !threads[i].killed && (i != STOPPER || may_run(i)))
			return false;
	return true;
}

// All that a choice changes. Stacks are restored to their places, so pointers into them stay valid.
static struct moment {
	__typeof__(shared) shared;
	__typeof__(now) now;
	struct thread threads[THREADS];
	char stack[THREADS][SAVED];
	uint16_t next; // next choice to try
} * moments;

static size_t used_of(int i)
{
	const size_t used = (size_t)(stacks[i] + STACK - threads[i].top);
	if (used > SAVED)
		abort();
	return used;
}

static void remember(struct moment *m)
{
	m->shared = shared;
	m->now = now;
	memcpy(m->threads, threads, sizeof threads);
	for (int i = 0; i < THREADS; i++)
		memcpy(m->stack[i], threads[i].top, used_of(i));
}

static void go_back_to(const struct moment *m)
{
	shared = m->shared;
	now = m->now;
	memcpy(threads, m->threads, sizeof threads);
	for (int i = 0; i < THREADS; i++)
		memcpy(threads[i].top, m->stack[i], used_of(i));
}

// Visits all choices of all states, depth first, up to the first finding.
static void visit_all(void)
{
	uint32_t depth = 0;
	begin();
	moments[0].next = 0;
	note_state();
	remember(&moments[0]);
	for (;;) {
		struct moment *m = &moments[depth];
		const uint16_t c = first_possible(m->next);
		if (m->next == 0 && c == CHOICES)
			stuck += !all_left();
		if (wrong | stuck)
			return;
		if (c < CHOICES) {
			m->next = c + 1;
			carry_out(c);
			if (note_state() && depth + 1 < DEPTH_MAX) {
				remember(&moments[++depth]);
				moments[depth].next = 0;
				deepest = depth > deepest ? depth : deepest;
				continue;
			}
		} else if (depth-- == 0) {
			return;
		}
		go_back_to(&moments[depth]);
	}
}

// Returns true if it found an error.
static bool explore(const struct scenario *what, enum variant v)
{
	scenario = what;
	variant = v;
	memset(seen, 0, sizeof seen);
	states = deepest = 0;
	wrong = stuck = 0;
	visit_all();
	printf("%s, variant %d: %llu states, %u deep, %ld wrong, %ld stuck\n", what->what, (int)v,
	       (unsigned long long)states, deepest, wrong, stuck);
	fflush(stdout);
	CHECK(states < SEEN / 2 && deepest + 1 < DEPTH_MAX);
	return wrong | stuck;
}

int main(void)
{
	static const struct scenario each[] = {
		{ "both, one, the host, one", { 0, 1 }, { 3, 2, 0, 2 }, 4, LIVES },
		{ "in two groups", { 0, 64 }, { 3, 1, 3 }, 3, LIVES },
		{ "stopped at any time", { 0, 1 }, { 1, 2 }, 2, STOPPED_ANY_TIME },
		{ "a worker is killed at any time", { 0, 1 }, { 3 }, 1, KILLED_ANY_TIME },
	};
	moments = malloc(DEPTH_MAX * sizeof *moments);
	CHECK(moments != NULL);
	for (size_t i = 0; i < sizeof each / sizeof *each; i++)
		CHECK(!explore(&each[i], SOUND));
	for (enum variant v = SOUND + 1; v < VARIANTS; v++) {
		bool caught = false;
		for (size_t i = 0; i < sizeof each / sizeof *each && !caught; i++)
			caught = explore(&each[i], v);
		CHECK(caught);
	}
	free(moments);
	return check_end();
}

#include "host/stall.h"

#include <stdio.h>
#include <time.h>

#include "free/free.h"
#include "host/accounting.h"
#include "host/host_state.h"
#include "table/desk.h"

enum { SHOWN = 4 };

// Workers that block the step.
typedef struct blockers {
	uint32_t worker[SHOWN], shown, more;
} blockers;

static char state_of(const ob_host *h, uint32_t worker)
{
	ob_worker_info info;
	return ob_universe_get_worker(h->u, worker, &info) ? ob_state_of_thread(info.pid, info.tid) : 0;
}

// Finds those that the gate waits for or, if it waits for none, the one that schedules.
static void find_at_gate(ob_host *h)
{
	uint32_t scheduler = ob_step_scheduler(h->u);
	bool waits = false; // else all have arrived, and the last has not yet opened the gate again
	for (uint32_t w = 0; w < h->workers && !waits; w++)
		waits = ob_gate_waits_for(h->u, w);
	for (uint32_t w = 0; w < h->workers; w++)
		h->blocks[w] = waits ? ob_gate_waits_for(h->u, w) : w == scheduler;
}

// Finds those that hold the common time back, and those that would do so next, for they were stopped while they waited.
static void find_in_free_run(ob_host *h)
{
	ob_free_find_parts(h->u, h->blocks);
	for (uint32_t w = 0; w < h->workers; w++)
		h->blocks[w] =
			h->blocks[w] == OB_FREE_HOLDS || (h->blocks[w] == OB_FREE_WAITS && state_of(h, w) == 'T');
}

static blockers find_blockers(ob_host *h)
{
	blockers b = { .shown = 0 };
	if (ob_free_settings_of(h->u))
		find_in_free_run(h);
	else
		find_at_gate(h);
	for (uint32_t w = 0; w < h->workers; w++) {
		if (h->blocks[w] && b.shown < SHOWN)
			b.worker[b.shown++] = w;
		else if (h->blocks[w])
			b.more++;
	}
	return b;
}

// True if a step is due: all simulators of a free run may wait for the clock.
static bool is_due(ob_host *h)
{
	return !ob_free_settings_of(h->u) || find_blockers(h).shown > 0;
}

// ---- the watch

// Hash of the objects on which the workers work: changes with each share.
static uint64_t shares_of(const ob_host *h)
{
	uint64_t hash = 0;
	for (uint32_t w = 0; w < h->workers; w++)
		hash = hash * 0x9e3779b97f4a7c15u + ob_worker_object(h->u, w);
	return hash;
}

ob_stall_watch ob_stall_watch_start(const ob_host *h)
{
	return (ob_stall_watch){ .step = ob_step_count(h->u), .shares = shares_of(h), .count = ob_hang_count_start(0) };
}

static bool one_is_runnable(ob_host *h)
{
	blockers b = find_blockers(h);
	bool found = false;
	for (uint32_t i = 0; i < b.shown && !found; i++)
		found = state_of(h, b.worker[i]) == 'R';
	return found;
}

bool ob_stall_watch_look(ob_stall_watch *s, ob_host *h)
{
	uint64_t step = ob_step_count(h->u);
	if (step != s->step || shares_of(h) != s->shares || !is_due(h) || ob_desks_await_answers(h->u)) {
		*s = ob_stall_watch_start(h);
		return false;
	}
	return ob_hang_count_is_over(&s->count, ob_host_read_cpu(h), one_is_runnable(h), h->patience);
}

// ---- blocking workers

uint32_t ob_stall_describe(ob_host *h, char *text, size_t size)
{
	const uint64_t busy_ns = 10000000; // with more CPU time than this within the tenth of a second, it computes
	blockers b = find_blockers(h);
	uint64_t before[SHOWN];
	ob_worker_info info[SHOWN];
	size_t n = 0;
	text[0] = 0;
	for (uint32_t i = 0; i < b.shown; i++) {
		ob_universe_get_worker(h->u, b.worker[i], &info[i]);
		before[i] = h->spawn->cpu(&info[i]);
	}
	nanosleep(&(struct timespec){ .tv_nsec = 100000000 }, NULL);
	for (uint32_t i = 0; i < b.shown && n < size; i++) {
		char state = ob_state_of_thread(info[i].pid, info[i].tid);
		bool computes = state == 'S' && h->spawn->cpu(&info[i]) - before[i] > busy_ns;
		n += (size_t)snprintf(text + n, size - n, "%ssimulator %u (task %d, %s)", i ? ", " : "", b.worker[i],
				      (int)info[i].tid, ob_state_word(computes ? 'R' : state));
	}
	if (b.more && n < size)
		snprintf(text + n, size - n, " and %u more", b.more);
	return b.shown ? b.worker[0] : OB_NO_WORKER;
}

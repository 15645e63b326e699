#include "table/gate.h"

#include <errno.h>
#include <string.h>
#include <time.h>

#include "base/cpu.h"
#include "table/futex.h"
#include "table/layout.h"

enum { SPIN_NS = 100000, SPINS_PER_CHECK = 32 };

static uint32_t load_acquire(const uint32_t *word)
{
	return __atomic_load_n(word, __ATOMIC_ACQUIRE);
}

static int64_t now_ns(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return t.tv_sec * INT64_C(1000000000) + t.tv_nsec;
}

static void relax_cpu(void)
{
#if defined(__x86_64__) || defined(__i386__)
	__builtin_ia32_pause();
#elif defined(__aarch64__)
	__asm__ volatile("yield");
#endif
}

void ob_gate_prepare(ob_gate *g, uint32_t workers)
{
	g->spin = workers <= (uint32_t)ob_cpu_count();
	g->phase = OB_PHASE_PAUSE;
	g->host_turn = 1;
}

// ---- workers

// done: the last turn at which the worker arrived. A contained simulator stores it in its own memory.
static bool has_turn(const ob_gate *g, const ob_gate_cell *cell, uint32_t done)
{
	return load_acquire(&cell->turn) != done || load_acquire(&g->stop);
}

static bool spin_for_turn(const ob_gate *g, const ob_gate_cell *cell, uint32_t done)
{
	int64_t end = now_ns() + SPIN_NS;
	do {
		for (int i = 0; i < SPINS_PER_CHECK; i++) {
			if (has_turn(g, cell, done))
				return true;
			relax_cpu();
		}
	} while (now_ns() < end);
	return false;
}

ob_phase ob_gate_wait(ob_universe *u, uint32_t worker, uint32_t done, bool marks)
{
	ob_gate *g = u->gate;
	const ob_gate_cell *cell = u->gate_cell + worker;
	if (!has_turn(g, cell, done) && !(g->spin && spin_for_turn(g, cell, done))) {
		ob_gate_half *half = u->gate_group[worker / 64].half + worker / 32 % 2;
		uint32_t bit = UINT32_C(1) << worker % 32;
		if (marks)
			__atomic_fetch_or(&half->asleep, bit, __ATOMIC_SEQ_CST);
		for (;;) {
			uint32_t seen = load_acquire(&half->word);
			if (has_turn(g, cell, done))
				break;
			ob_futex_wait(&half->word, seen, bit, NULL);
		}
		if (marks)
			__atomic_fetch_and(&half->asleep, ~bit, __ATOMIC_SEQ_CST);
	}
	return load_acquire(&g->stop) ? OB_PHASE_STOP : (ob_phase)__atomic_load_n(&g->phase, __ATOMIC_RELAXED);
}

bool ob_gate_arrive(ob_universe *u, uint32_t worker)
{
	ob_gate *g = u->gate;
	ob_gate_group *group = u->gate_group + worker / 64;
	ob_gate_cell *cell = u->gate_cell + worker;
	__atomic_store_n(&cell->done, load_acquire(&cell->turn), __ATOMIC_RELAXED);
	uint64_t bit = UINT64_C(1) << worker % 64;
	uint64_t expected = __atomic_load_n(&group->expected, __ATOMIC_RELAXED);
	uint64_t before = __atomic_fetch_or(&group->arrived, bit, __ATOMIC_ACQ_REL);
	if (before & bit || (before | bit) != expected)
		return false;
	return __atomic_sub_fetch(&g->groups_left, 1, __ATOMIC_ACQ_REL) == 0;
}

// ---- the opener: the scheduler or the host, alone, as all workers wait

// Atomic only for ob_gate_waits_for, which the host may call at any time.
static void set_expected(ob_gate_group *group, uint64_t workers)
{
	__atomic_store_n(&group->expected, workers, __ATOMIC_RELAXED);
}

static uint64_t expected_of(const ob_gate_group *group)
{
	return __atomic_load_n(&group->expected, __ATOMIC_RELAXED);
}

static void set_all_expected(ob_universe *u, uint32_t groups)
{
	uint32_t workers = ob_universe_simulators(u);
	for (uint32_t i = 0; i < groups; i++)
		set_expected(u->gate_group + i, workers >= 64 * i + 64 ? UINT64_MAX
						: workers <= 64 * i    ? 0
								       : (UINT64_C(1) << workers % 64) - 1);
}

// Writes the turn into the cells of a half's participants, then wakes the sleeping ones.
static void open_half(ob_universe *u, uint32_t first, ob_gate_half *half, uint32_t part, uint32_t turn)
{
	for (uint32_t rest = part; rest; rest &= rest - 1)
		__atomic_store_n(&u->gate_cell[first + (uint32_t)__builtin_ctz(rest)].turn, turn, __ATOMIC_RELEASE);
	__atomic_fetch_add(&half->word, 1, __ATOMIC_SEQ_CST);
	// A read-modify-write, not a load: the second of this and the waiter's "or" observes the first.
	uint32_t wake = __atomic_fetch_or(&half->asleep, 0, __ATOMIC_SEQ_CST) & part;
	if (ob_universe_contains(u)) // contained simulators cannot record that they sleep
		wake = part;
	if (wake)
		ob_futex_wake(&half->word, wake);
}

void ob_gate_open(ob_universe *u, ob_phase phase, const uint32_t *participants, uint32_t n)
{
	ob_gate *g = u->gate;
	if (phase == OB_PHASE_STOP) {
		ob_gate_stop(u);
		return;
	}
	uint32_t groups = (u->header.sizes.workers + 63) / 64, taking_part = 0;
	for (uint32_t i = 0; i < groups; i++) {
		set_expected(u->gate_group + i, 0);
		__atomic_store_n(&u->gate_group[i].arrived, 0, __ATOMIC_RELAXED);
	}
	if (!participants)
		set_all_expected(u, groups);
	for (uint32_t i = 0; participants && i < n; i++) {
		if (participants[i] >= u->header.sizes.workers) {
			u->step_data.count->failure = OB_STEP_DAMAGED;
			continue;
		}
		ob_gate_group *group = u->gate_group + participants[i] / 64;
		set_expected(group, expected_of(group) | UINT64_C(1) << participants[i] % 64);
	}
	for (uint32_t i = 0; i < groups; i++)
		taking_part += expected_of(u->gate_group + i) != 0;
	__atomic_store_n(&g->groups_left, taking_part, __ATOMIC_RELAXED);
	__atomic_store_n(&g->phase, phase, __ATOMIC_RELAXED);
	if (__atomic_load_n(&g->host_turn, __ATOMIC_RELAXED) & 1) // an opening worker must not clear STOP's bit
		__atomic_fetch_and(&g->host_turn, ~UINT32_C(1), __ATOMIC_RELAXED);
	uint32_t turn = ++g->turn;
	for (uint32_t i = 0; i < groups && taking_part; i++) {
		ob_gate_group *group = u->gate_group + i;
		uint64_t expected = expected_of(group);
		taking_part -= expected != 0;
		for (uint32_t k = 0; k < 2; k++)
			if ((uint32_t)(expected >> 32 * k))
				open_half(u, 64 * i + 32 * k, group->half + k, (uint32_t)(expected >> 32 * k), turn);
	}
}

void ob_gate_pause(ob_universe *u)
{
	__atomic_store_n(&u->gate->phase, OB_PHASE_PAUSE, __ATOMIC_RELAXED);
	__atomic_store_n(&u->gate->host_turn, 1, __ATOMIC_RELEASE);
	ob_futex_wake(&u->gate->host_turn, FUTEX_BITSET_MATCH_ANY);
}

// ---- the host

void ob_gate_set_pause_step(ob_universe *u, uint64_t step)
{
	__atomic_store_n(&u->control->pause_step, step, __ATOMIC_RELEASE);
}

uint64_t ob_gate_pause_step(const ob_universe *u)
{
	return __atomic_load_n(&u->control->pause_step, __ATOMIC_ACQUIRE);
}

bool ob_gate_host_wait(ob_universe *u, double timeout)
{
	ob_gate *g = u->gate;
	int64_t end = now_ns() + (int64_t)(fmin(timeout, 1e9) * 1e9);
	struct timespec until = { .tv_sec = end / 1000000000, .tv_nsec = end % 1000000000 };
	for (;;) {
		uint32_t seen = load_acquire(&g->host_turn);
		if (seen == 1 || load_acquire(&g->stop))
			return true;
		if (now_ns() >= end)
			return false;
		ob_futex_wait(&g->host_turn, seen, FUTEX_BITSET_MATCH_ANY, &until);
	}
}

bool ob_gate_waits_for(const ob_universe *u, uint32_t worker)
{
	const ob_gate_group *group = u->gate_group + worker / 64;
	uint64_t arrived = __atomic_load_n(&group->arrived, __ATOMIC_RELAXED);
	return (__atomic_load_n(&group->expected, __ATOMIC_RELAXED) & ~arrived) >> worker % 64 & 1;
}

ob_phase ob_gate_phase(const ob_universe *u)
{
	return (ob_phase)__atomic_load_n(&u->gate->phase, __ATOMIC_RELAXED);
}

bool ob_gate_stopped(const ob_universe *u)
{
	return load_acquire(&u->gate->stop);
}

void ob_gate_stop(ob_universe *u)
{
	ob_gate *g = u->gate;
	__atomic_store_n(&g->stop, 1, __ATOMIC_SEQ_CST);
	__atomic_fetch_or(&g->host_turn, 2, __ATOMIC_SEQ_CST);
	ob_futex_wake(&g->host_turn, FUTEX_BITSET_MATCH_ANY);
	for (uint32_t i = 0; i < u->header.sizes.workers; i += 32) {
		ob_gate_half *half = u->gate_group[i / 64].half + i / 32 % 2;
		__atomic_fetch_add(&half->word, 1, __ATOMIC_SEQ_CST);
		ob_futex_wake(&half->word, FUTEX_BITSET_MATCH_ANY);
	}
	if (ob_free_settings_of(u))
		ob_free_stop(u);
}

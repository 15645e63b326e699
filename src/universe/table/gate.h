// The gate leads the workers of a universe, threads or processes, from phase to phase together.
//
//            worker's cell            group of 64 workers                         gate
//          +---------------+     +------------------------+      last bit    +-------------+  last group:
//   arrive | done = turn   | --> | arrived |= bit         | ---------------> | groups -= 1 | --> the caller schedules
//          |               |     | = expected ?           |   of the group   |             |     and opens
//          +---------------+     +------------------------+                  +-------------+
//   open   | turn = n      | <-- | expected = those that  | <--------------  | turn n      |
//          |               |     |   take part            |                  | phase       |
//          +---------------+     | half[2]: word++        |                  +-------------+
//   wait     turn != done ?      |          asleep & part |
//            then run phase      |          -> futex wake |
//                                +------------------------+
//
// Turns: the opener numbers each opening and writes the number into the cells of those that take part. A worker
// runs when its cell's turn differs from the one it has done, so that it can neither miss a phase nor run one
// twice, however many phases went by without it. turn, phase and expected cannot change before it has arrived.
//
// Arrival is an atomic "or" of the worker's own bit into its group. The worker that completes the expected set counts
// the group off; the worker that counts off the last group is last of all, and schedules. The chain of atomic operations
// orders everything that was written before an arrival before everything that the last one does.
//
// Sleep: 32 workers share one futex word, and the wait names the worker's bit (FUTEX_WAIT_BITSET), so that one
// system call wakes exactly those of the 32 that take part. A waiter sets its bit in asleep, reads the word, reads its
// cell, and waits on the word as it was; the opener writes the cells, then the word, then reads asleep. Both access
// asleep with sequentially consistent read-modify-writes: the second of them sees what the other wrote. Only the waiter
// clears its bit, when it has its turn: an opener that takes no part itself may be so late that its turn is long over,
// and must not clear a bit that a worker has set for the next. A late opener can at most wake a worker for nothing, which
// then waits again. If every worker has a core, it spins on its cell for SPIN_NS before it sleeps (waking a core costs
// some 30 us).
//
// Contained simulators cannot write here: they arrive through their outboxes, keep "done" in their own memory, and are
// always woken. The arranger is the last to arrive in each phase.
//
// STOP is a flag of its own, set for good; setting it moves every word and wakes every waiter.
#ifndef OB_TABLE_GATE_H
#define OB_TABLE_GATE_H

#include <assert.h>
#include <stdint.h>

typedef struct ob_gate {
	_Alignas(64) uint32_t turn; // last opening; written by the opener
	uint32_t phase; // ob_phase of that turn
	uint32_t spin; // 1 = every worker has a core of its own
	_Alignas(64) uint32_t groups_left; // groups with workers still to arrive
	_Alignas(64) uint32_t stop; // sticky
	_Alignas(64) uint32_t host_turn; // futex word: bit 0 = the host has the turn; bit 1 moves it at STOP
	uint32_t awaited; // contained simulators: 1 + the one whose outbox the arranger waits for (outbox.h)
} ob_gate;

typedef struct ob_gate_half {
	uint32_t word; // futex word: moves at each opening for one of the 32
	uint32_t asleep; // bit per worker: waits on the word, or is about to
} ob_gate_half;

typedef struct ob_gate_group {
	_Alignas(64) uint64_t arrived; // bit per worker
	uint64_t expected; // bit per worker: takes part in this turn
	_Alignas(64) ob_gate_half half[2];
} ob_gate_group;

typedef struct ob_gate_cell {
	_Alignas(64) uint32_t turn; // the last turn given to this worker
	uint32_t done; // the last turn at which it arrived
	uint32_t taken; // contained simulators: outbox records copied by the arranger
} ob_gate_cell;

static_assert(sizeof(ob_gate) == 256 && sizeof(ob_gate_group) == 128 && sizeof(ob_gate_cell) == 64, "gate");

// Prepares the gate in zeroed memory (creator), or after a restart (host): the host has the turn.
void ob_gate_prepare(ob_gate *g, uint32_t workers);

#endif

// The gate: how the workers of a universe, threads or processes, pass from phase to phase together.
//
//            worker's cell            group of 64 workers                         gate
//          +---------------+     +------------------------+      last bit    +-------------+  last group:
//   arrive | done = turn   | --> | arrived |= bit         | ---------------> | groups -= 1 | --> the caller arranges
//          |               |     | = expected ?           |   of the group   |             |     and opens
//          +---------------+     +------------------------+                  +-------------+
//   open   | turn = n      | <-- | expected = who takes   | <--------------  | turn n      |
//          |               |     |            part        |                  | phase       |
//          +---------------+     | half[2]: word++        |                  +-------------+
//   wait     turn != done ?      |          asleep & part |
//            then run phase      |          -> futex wake |
//                                +------------------------+
//
// Turns: the opener numbers each opening and writes the number into the cells of those who take part. A worker
// runs when its cell's turn differs from the one it has done, so that it can neither miss a phase nor run one
// twice, however many phases went by without it. turn, phase and expected cannot change before it has arrived.
//
// Arrival is an atomic "or" of the worker's own bit into its group; whoever completes the expected set counts the
// group off; whoever counts off the last group is last of all. The chain of atomic operations orders everything that
// was written before an arrival before everything that the last one does.
//
// Sleep: 32 workers share one futex word, and the wait names the worker's bit (FUTEX_WAIT_BITSET), so that one
// system call wakes exactly those of the 32 who take part. A waiter raises its bit in asleep, reads the word, looks at
// its cell, and waits on the word as it was; the opener writes the cells, then the word, then looks who is asleep.
// Both meet in asleep: whichever comes second sees what the other wrote. The bit is the waiter's alone, which takes it
// down when it has its turn: an opener that takes no part itself may be so late that its turn is long over, and must
// not take away what a worker raised for the next. All it can do then is wake someone who looks and waits again.
// Where every worker has a core, it spins on its cell for SPIN_NS before it sleeps (waking a core costs some 30 us).
//
// STOP is a flag of its own, set once; it moves every word and wakes everyone.
#ifndef OB_TABLE_GATE_H
#define OB_TABLE_GATE_H

#include <assert.h>
#include <stdint.h>

typedef struct ob_gate {
	_Alignas(64) uint32_t turn; // of the last opening; the opener's
	uint32_t phase; // ob_phase of that turn
	uint32_t spin; // 1 = every worker has a core of its own
	uint32_t workers;
	_Alignas(64) uint32_t groups_left; // groups of which someone is still to arrive
	_Alignas(64) uint32_t stop; // sticky
	_Alignas(64) uint32_t host_turn; // futex word: 1 = the host has the turn
} ob_gate;

typedef struct ob_gate_half {
	uint32_t word; // futex word: moves at each opening for one of the 32
	uint32_t asleep; // bit per worker: waits on the word, or is about to
} ob_gate_half;

typedef struct ob_gate_group {
	_Alignas(64) uint64_t arrived; // bit per worker
	uint64_t expected; // those who take part in this turn
	_Alignas(64) ob_gate_half half[2];
} ob_gate_group;

typedef struct ob_gate_cell {
	_Alignas(64) uint32_t turn; // the last turn given to this worker
	uint32_t done; // the last turn at which it arrived
} ob_gate_cell;

static_assert(sizeof(ob_gate) == 256 && sizeof(ob_gate_group) == 128 && sizeof(ob_gate_cell) == 64, "gate");

// Once, by the creator, on zeroed memory: the host has the turn.
void ob_gate_prepare(ob_gate *g, uint32_t workers);

#endif

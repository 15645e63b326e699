// Publications of a free run: each simulator publishes versions of its object's motion at its own times, and others read
// the version that they need, without a lock. The slots (slot.h) then hold the motions of the common time, which the
// host writes.
//
//               version = 9                    a version's place is its number modulo the depth, here 4
//                   |
//       +-----+-----+-----+-----+
//  ring |  8  |  9  | (10)|  7  |   the writer fills the place of version 10, which was that of 6, and only then
//       +-----+-----+-----+-----+   sets version = 10: versions 7, 8, 9 stay readable all the while
//
//   writer   next = version + 1;  store-release each word into ring[next];  store-release version = next
//   reader   v = version;  load-acquire each word of ring[k], k <= v;  take it if now version <= k + depth - 2
//
// A copy of version k is never torn: its place is written again for version k + depth, which begins after version
// k + depth - 1 was stored. A reader that saw one word of k + depth has, by acquire and release on that word, also seen
// that store, so its second load of the version finds at least k + depth - 1, and it rejects the copy. With depth 2 this
// is the proof of slot.h. A writer that is killed anywhere leaves all versions readable, and its successor fills the same
// place anew. A reader that needs an older version than those kept takes the oldest.
//
// Waiting: a simulator that is too far ahead of a neighbour lowers the neighbour's `awaited` to the time that it needs, and
// sleeps on its futex word. The neighbour wakes all when it has reached that time. A time, not a count, so that a
// waiter's death leaves one wake too many behind.
//
// Flights: while nothing comes near, an object's newest version holds, in closed form. Its simulator says until when
// (`holds`), and does nothing before. Meanwhile the object's own time is `holds`, the time of `until`, or the clock's, whichever
// is least: as if the simulator had gone so far at once. A simulator that finds that its object may touch a flight sooner
// lowers `holds`, marks the flight for its worker (`lowered`), and has that worker woken. Storing `holds` and looking at
// versions once more, publishing and looking at `holds` are in one order: one side sees the other's. So own times of flights
// may fall, but not below that of whoever lowers them. `lowerings` counts that, before the lowerer goes on: a reader of all
// own times that finds the same count before and after has seen times that all have passed at once (common.c).
//
// Workers sleep at their own word (`word`), or at that of the neighbour they wait for; `at` says where. Whoever changes what
// a worker waits for moves its word first, then looks at `at`; the worker stores `at`, then looks at its word.
//
// Neighbours: bounds are published as three words of two numbers. A counter for 64 objects moves afterwards, so a reader
// compares counters. The last changes of a group stand in a ring, each with its number; a reader that finds another
// number looks at all boxes of the group.
//
// One writer per object at a time; readers in any thread or process.
#ifndef OB_TABLE_FREE_H
#define OB_TABLE_FREE_H

#include <assert.h>

#include <ob/motion.h>

#include "settings/settings.h"
#include "table/table.h"

enum { OB_FREE_GROUP = 64, OB_FREE_CHANGES = 16 };

typedef enum ob_free_kind {
	OB_FREE_ABSENT,
	OB_FREE_SIMULATED, // a simulator publishes its versions
	OB_FREE_PRESCRIBED, // static or kinematic: its motion stands in its slot
} ob_free_kind;

// Counters of an object's simulator, for the report. Its own.
typedef struct ob_free_counts {
	uint64_t updates, solved; // steps; those with a neighbour near
	uint64_t waits, wait_ns; // for a neighbour, by the bound of the lag
	uint64_t late; // readings of a neighbour whose needed version was not kept any more
	uint64_t lag_ns,
		lag_most_ns; // sum and maximum over readings: own time less the time of the version that was read
	uint64_t readings;
} ob_free_counts;

typedef struct ob_free_cell {
	_Alignas(64) uint64_t version; // 0 = never published
	uint64_t time; // bits of a double: own time, s; beyond the newest version's while that holds
	uint32_t kind; // ob_free_kind
	uint32_t generation; // as in the passport
	_Alignas(64) uint32_t moved; // futex word: times that were awaited
	uint32_t blocker; // 1 + the object that it waits for; 0 = none
	uint64_t awaited; // bits of a double: least own time, s, for which a simulator waits; all ones: nobody does
	uint64_t holds; // bits of a double: own time, s, until which its flight holds; 0: it is in none
	float update_rate; // Hz; 0: the run's
	uint32_t zero[3];
	ob_free_counts counts;
} ob_free_cell;

// 64 objects.
typedef struct ob_free_group {
	_Alignas(64) uint32_t moved; // changes of their boxes, arrivals, departures
	uint64_t lowered; // bit of each object whose flight others have lowered
	uint64_t change[OB_FREE_CHANGES]; // (number of the change, from 1) << 32 | object
} ob_free_group;

// A worker's place to sleep.
typedef struct ob_free_bed {
	_Alignas(64) uint32_t word; // futex word: reasons to look again
	uint32_t
		at; // where it sleeps: 0 = it does not; OB_FREE_OWN_WORD; else 1 + the object whose `moved` it waits for
	uint64_t
		next; // bits of a double: own time, s, of the next that it has to do; it sleeps while `until` is not beyond
	uint32_t made; // steps that all bodies of its world have completed (group.h)
	uint32_t blocker; // 1 + the worker that it waits for; 0 = none
	uint32_t awaited; // 1 = a worker may wait for it
	uint32_t waits; // how often it has waited for another
	uint64_t updates; // versions that it has published
} ob_free_bed;

enum { OB_FREE_OWN_WORD = INT32_MAX };

typedef struct ob_free_control {
	ob_free_settings settings;
	_Alignas(64) uint32_t until; // step (from 0) at which simulators stop and wait; the host's
	uint32_t entered; // changes of objects, each while all wait
	uint64_t passports; // sum of their versions at the last of these
	uint64_t lowerings; // of flights
	uint32_t looks; // of the host, after which it did nothing but wait
	uint64_t begun_ns; // clock at which own time 0 was due; 0 = not yet
	double pace; // s a second of that clock; infinity: simulators follow none
	double stands; // s: own time at which the clock stands; infinity: it goes on
} ob_free_control;

static_assert(sizeof(ob_free_cell) == 192 && sizeof(ob_free_control) == 448 && sizeof(ob_free_group) == 192 &&
		      sizeof(ob_free_bed) == 64,
	      "free run");

// NULL: the run is in lockstep.
const ob_free_settings *ob_free_settings_of(const ob_universe *u);
// Depth of the rings of versions.
uint32_t ob_free_depth(const ob_universe *u);

// ---- host

// Enters an object that the host has placed or removed. m: first motion of a simulated one, with its own time. Before
// simulators run, or while all wait.
void ob_free_enter(ob_universe *u, uint32_t id, ob_free_kind kind, uint32_t generation, const ob_motion *m);
// Sets the rate (Hz) of an object's simulator, before the object is entered; 0: the run's.
void ob_free_set_rate(ob_universe *u, uint32_t id, double rate);
// Lets simulators run until so many steps are complete. The first call starts their clock. Wakes workers that have something
// to do before.
void ob_free_run_until(ob_universe *u, uint64_t step);
// Sets the clock of all simulators: own time t (s) is due now, later times at this pace, and none from `stands` (s) on.
// While it changes, a step may begin that is due by neither clock. Infinity: no pace; it goes on.
void ob_free_set_clock(ob_universe *u, double t, double pace, double stands);
// Counts a look at all simulators after which the host waits for them, with `until` as it was.
void ob_free_looked(ob_universe *u);
// Says that objects have come, gone or changed, while all wait: ends all flights at `until`, and has all workers look.
void ob_free_note_entered(ob_universe *u, uint64_t passports);
// Sum of passports' versions at the last call of it.
uint64_t ob_free_passports(const ob_universe *u);
// Wakes all that wait, so that they see that the run stops.
void ob_free_stop(ob_universe *u);

// ---- all

ob_free_kind ob_free_kind_of(const ob_universe *u, uint32_t id, uint32_t *generation); // generation may be NULL
double ob_free_time(const ob_universe *u, uint32_t id); // own time, s
// Own time, s, until which an object's flight holds; 0: it is in none.
double ob_free_holds(const ob_universe *u, uint32_t id);
// Lowerings of flights so far.
uint64_t ob_free_lowerings(const ob_universe *u);
// Changes of objects so far.
uint32_t ob_free_entered(const ob_universe *u);
uint64_t ob_free_version(const ob_universe *u, uint32_t id);
double ob_free_rate(const ob_universe *u, uint32_t id); // Hz, of its simulator's steps
// Copies the newest version that is not after t (s), or the oldest kept, and returns its number; 0: none. next, if not
// NULL: the version after it; next->t0 is NaN if there is none.
uint64_t ob_free_read(const ob_universe *u, uint32_t id, double t, ob_motion *out, ob_motion *next);
// Step at which simulators stop and wait.
uint32_t ob_free_until(const ob_universe *u);
// Looks of the host so far. If two begin while simulators wait at one `until`, they wait for ever.
uint32_t ob_free_looks(const ob_universe *u);
// Clock (ob_clock_ns) from which on a simulator at own time t (s) may step; UINT64_MAX: the clock stands before.
uint64_t ob_free_due_ns(const ob_universe *u, double t);
// Updates include those that a flight has saved.
void ob_free_get_counts(const ob_universe *u, uint32_t id, ob_free_counts *out);
// Object that the simulator of an object waits for. False: none.
bool ob_free_blocker(const ob_universe *u, uint32_t id, uint32_t *blocker);

// ---- the object's simulator

// Publishes a version. Wakes those who wait for it.
void ob_free_publish(ob_universe *u, uint32_t id, const ob_motion *m);
// Begins a flight of the newest version, which holds until own time `holds` (s). The simulator then looks once more whether
// anything near has changed. Wakes those who wait for that time.
void ob_free_take_off(ob_universe *u, uint32_t id, double holds);
// Ends a flight at the object's own time, which it returns (s), or at `until` if that is less than `within` (s) away; in no
// flight, returns the own time. Updates that the flight has saved are added to counts; NULL: nobody counts.
double ob_free_land(ob_universe *u, uint32_t id, double within, ob_free_counts *counts);
// Has an object's flight, if it is in one, hold until t (s) at most, and its worker look at it.
void ob_free_lower(ob_universe *u, uint32_t id, double t);
// Takes the objects of a group whose flights were lowered, out of those of a mask: a bit each.
uint64_t ob_free_take_lowered(ob_universe *u, uint32_t group, uint64_t mask);
void ob_free_put_counts(ob_universe *u, uint32_t id, const ob_free_counts *c);
void ob_free_publish_bounds(ob_universe *u, uint32_t id, const float box[6]);
// Counter of changes in a group of OB_FREE_GROUP objects.
uint32_t ob_free_moved(const ob_universe *u, uint32_t group);
// Copies the object's box.
void ob_free_get_bounds(const ob_universe *u, uint32_t id, float box[6]);
// True if the object's box overlaps another.
bool ob_free_overlaps(const ob_universe *u, uint32_t id, const float box[6]);
// Object of a change, by its number (from 0: what the counter was before). OB_NO_OBJECT: it is not kept.
uint32_t ob_free_changed(const ob_universe *u, uint32_t group, uint32_t number);

// ---- a worker

// Moves on whenever a worker has a reason to look again.
uint32_t ob_free_word(const ob_universe *u, uint32_t worker);
// Sleeps until the neighbour has reached `time`, the worker's word is not `seen` any more, or some time has passed. id: the object
// whose simulator waits: it counts as waiting until ob_free_end_wait. Returns the time slept, ns.
uint64_t ob_free_wait_for(ob_universe *u, uint32_t worker, uint32_t seen, uint32_t id, uint32_t neighbour, double time);
void ob_free_end_wait(ob_universe *u, uint32_t id);
// Sleeps until the worker's word is not `seen` any more, the host has moved `until` from this step to beyond the time `next`
// (s), or so many ns have passed.
void ob_free_idle(ob_universe *u, uint32_t worker, uint32_t seen, uint32_t step, double next, uint64_t ns);

// Worker of an object's simulator: blocks of ids, so that neighbours in a scene are often one worker's.
uint32_t ob_free_worker_of(const ob_universe *u, uint32_t id);

#endif

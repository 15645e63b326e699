// The universe table for its writers: creation, publication, and the areas of the step.
//
// This module is the only one that opens and maps shared memory, and the only one that names a memory order. Everything
// in the table is an offset or an id, never a pointer: it is mapped at different addresses.
//
//   header | control | gate | worker cells | slots | passports | step data (step_data.h) | trace (trace.h)
//
// A slot is a ring of two versions of one ob_motion with a version word (slot.h explains it with a drawing). It has one
// writer, the simulator that currently runs the object.
//
// Below, the scheduler is the worker that arrived last at the gate: it prepares the next phase while all others wait.
#ifndef OB_TABLE_TABLE_H
#define OB_TABLE_TABLE_H

#include <ob/hull.h>
#include <ob/universe.h>

#include "settings/settings.h"
#include "table/counters.h"
#include "table/step_data.h"
#include "terrain/terrain.h"

// Phase that the gate opens with. The phases of a step in their order; step/step.c describes the workers' actions in
// each.
typedef enum ob_phase {
	OB_PHASE_NONE,
	OB_PHASE_RESUME, // the host gives the turn to the arranger, which schedules the first phase
	OB_PHASE_BROADPHASE_START, // neighbours of objects placed or changed by the host
	OB_PHASE_SCRIPTS, // objects' scripts run
	OB_PHASE_FORECAST, // finds pairs that may touch in the coming step
	OB_PHASE_LINKS, // links bodies to islands, if many are due
	OB_PHASE_LISTS, // lists the islands' pairs
	OB_PHASE_ISLANDS, // solve
	OB_PHASE_BROADPHASE, // neighbours of objects whose fat AABB has changed
	OB_PHASE_LATE_CONTACTS, // finds pairs that touched in this step across different islands
	OB_PHASE_COPY, // with a worker per object: copy the result of the island's solver
	OB_PHASE_SENSE, // sensors take the samples of the step
	OB_PHASE_COMPLETE, // serial: the gate never opens with it
	OB_PHASE_BASELINE, // one ODE world holds all objects: its whole step
	OB_PHASE_PAUSE, // the universe stands still at a step boundary for the host
	OB_PHASE_STOP, // leave
} ob_phase;

typedef struct ob_universe_setup {
	const char *name; // unique on this machine; NULL = "obsim-<pid>"
	bool unshared; // in this process's own memory, seen by no other; it needs no name
	uint32_t capacity; // object slots
	uint32_t workers; // >= 1
	uint32_t hulls; // maximum of hulls, of the scene and created
	uint32_t rank, ranks; // this rank, and their number (cluster/peers.h); ranks 0 or 1: a single one
	bool shares_contacts; // of several ranks: as ob_universe_shares_contacts, the same on each
	const char *isolation; // "thread" | "process": shown by readers
	ob_run_settings run;
	bool traced; // with rings for a trace (trace.h)
	bool checked; // shared data is checked after each step (step/invariants.h)
	uint32_t harden; // bits, 1 << ob_harden_measure; with OUTBOX the last of the workers is the arranger (outbox.h)
	uint32_t script_cells; // objects that can have a script at the same time (step_data.h); 0: none
	uint32_t script_bytes; // size of the scripts' texts: an ob_script_directory, and the data that it refers to
	const void *script_text;
	uint32_t history; // versions of each motion that a free run keeps, at least 2; 0: the run is in lockstep
	const struct ob_free_settings *free; // of a free run
	uint32_t joints; // at the same time
	uint32_t sensors, sensor_values; // their number, and the sum of ob_sensor_room
	const ob_terrain_set *terrains; // NULL: there are none
} ob_universe_setup;

// Creates the shared segment /dev/shm/obsim.<name>, zeroed, state STARTING. Removes stale segments, without an owner
// (segment.h). The caller owns it, as do the processes that inherit its file. Returns NULL and e on failure (name
// taken, out of memory).
ob_universe *ob_universe_create(const ob_universe_setup *setup, ob_error *e);
// Unmaps; unlink = true also removes the name. The creator calls it with true on every exit path.
void ob_universe_destroy(ob_universe *u, bool unlink);
// Owners: removes the name only, if it is still this universe's. Async-signal-safe.
void ob_universe_unlink(const ob_universe *u);
// The segment's file, kept open by processes that shall own it; and its new descriptor after a move.
int ob_universe_fd(const ob_universe *u);
void ob_universe_move_fd(ob_universe *u, int fd);

// Reserves the pages of all data of objects 0 .. ids-1 in the universe, before they are touched (pages.h). Returns
// false and e if the memory file system is full.
bool ob_universe_reserve(ob_universe *u, uint32_t ids, ob_error *e);
// Same for joints 0 .. joints-1, for pairs first .. first + count - 1, and for a record of a pair. Returns false if it is full.
bool ob_reserve_joints(ob_universe *u, uint32_t joints);
bool ob_reserve_pairs(ob_universe *u, uint32_t first, uint32_t count);
bool ob_reserve_record(ob_universe *u, uint32_t record);
// Allocates the lowest free cell for the script of an object just added: text number `script`, with this state and
// these random numbers. Returns false if none is free, or the memory file system is full. Call from the host, paused;
// so for the other.
bool ob_script_take_cell(ob_universe *u, uint32_t id, uint32_t script, const void *state, uint32_t state_bytes,
			 const uint64_t random[4]);
// Frees the object's cell, if it has one.
void ob_script_free_cell(ob_universe *u, uint32_t id);
// Stops the script of an object for good, if it has one.
void ob_script_stop(ob_universe *u, uint32_t id);
// Puts a message of these values, without a sender, into the mail of the object's script. Returns false if it has none,
// or no room for it. Call from the host, paused.
bool ob_script_deliver(ob_universe *u, uint32_t id, const void *values, uint32_t bytes);
// Writes the scene's joints, in any order of their objects, which may be absent yet. Call from the host, before the run.
void ob_joints_write(ob_universe *u, const ob_joint_passport *joint, uint32_t joints);
// Adds a joint with the lowest free number, which it returns; UINT32_MAX: there is no room. A name that ends with '#' gets
// the number. Removes one; all joints of an object. Call from the host, paused.
uint32_t ob_joint_add(ob_universe *u, const ob_joint_passport *joint);
void ob_joint_remove(ob_universe *u, uint32_t joint);
void ob_joints_remove_of(ob_universe *u, uint32_t id);
// True if all numbers of a joint from outside are plausible; objects aside.
bool ob_joint_makes_sense(const ob_joint_passport *joint);
// Iterates over an object's joints: for (uint32_t j = ob_joint_first(data, id); j; j = ob_joint_next(data, j, id)), of
// joint j - 1.
static inline uint32_t ob_joint_first(const ob_step_data *data, uint32_t id)
{
	const uint32_t first = ob_joints_end(data) ? data->first_joint[id] : 0;
	return first <= data->joints_max ? first : 0;
}
uint32_t ob_joint_next(const ob_step_data *data, uint32_t joint, uint32_t id);
// True if a joint of the universe (ob_step_data.joint) holds: its objects exist as those that it was made for, and it has not
// broken in a step before.
bool ob_joint_holds(const ob_universe *u, const ob_joint_passport *j);
// True if it broke in the last complete step.
bool ob_joint_broke_now(const ob_universe *u, uint32_t joint);
// Action of the joint in the last complete step, as ob_universe_get_joint_load; or in the step that ends when so many are
// complete.
ob_joint_load ob_joint_load_now(const ob_universe *u, uint32_t joint);
ob_joint_load ob_joint_load_of(const ob_universe *u, uint32_t joint, uint64_t step);
// Numbers that the universe keeps of a sensor's samples, with steps of h (s).
uint64_t ob_sensor_room(const ob_sensor_passport *s, double h);
// Sum of all sensors that simulators sample: all but cameras.
uint64_t ob_sensors_numbers(const ob_universe *u);
// Writes the scene's sensors; their rate may be 0: a sample in each step. Call from the host, before the run.
void ob_sensors_write(ob_universe *u, const ob_sensor_passport *sensor, uint32_t sensors);
// Number of a sensor's last sample that is due when n steps are complete, or was due `delay` (s) before.
uint64_t ob_sensor_due(const ob_sensor_passport *s, double h, uint64_t n, double delay);
// True if a sample has as many values as the kind allows, and as beams or pixels take.
bool ob_sensor_has_width(const ob_sensor_passport *s);
// True if its numbers are plausible, and its samples lie within those of the universe.
bool ob_sensor_makes_sense(const ob_universe *u, const ob_sensor_passport *s);
// Publishes its next sample, of time t (s), whose number is one more than the last one's.
void ob_sensor_publish(ob_universe *u, uint32_t sensor, double t, const double *value);
// True if the two may have contacts: neither is a sensor, their groups hit each other, and no joint lets them overlap.
bool ob_may_touch(const ob_universe *u, uint32_t a, uint32_t b);
// True if a sensor looks for such an object: it moves, is no sensor, and their groups hit each other.
bool ob_sensor_finds(const ob_passport *sensor, const ob_passport *p);
// Cell of an object; NULL: it has no script.
const ob_script_turn *ob_script_turn_of(const ob_universe *u, uint32_t id);
// Counts objects whose script an error has stopped, also those that have gone; and those whose script goes on, but is warned of. Paused.
void ob_script_count(const ob_universe *u, uint64_t *stopped, uint64_t *warned);
// Reason for which pages of the universe may be missing; NULL: none.
const char *ob_universe_lost(const ob_universe *u);
// For a program with mapped universes: an access to a missing page ends it with one line on standard error, after a
// call of on_end, which may be NULL and must be safe in a signal handler.
void ob_pages_guard(void (*on_end)(void));

const ob_run_settings *ob_universe_settings(const ob_universe *u);
uint32_t ob_universe_capacity(const ob_universe *u);
uint32_t ob_universe_workers(const ob_universe *u);
// Number of workers that simulate: all, or all but the arranger.
uint32_t ob_universe_simulators(const ob_universe *u);
// This rank, and the number of ranks; and true for a worker of this rank. Each rank has its share of the simulators, in
// the order of ranks, and an arranger.
uint32_t ob_universe_rank(const ob_universe *u);
uint32_t ob_universe_ranks(const ob_universe *u);
bool ob_worker_is_here(const ob_universe *u, uint32_t worker);
uint32_t ob_universe_rank_of(const ob_universe *u, uint32_t simulator);
// Returns the number of this rank's simulators; *first: the first of them.
uint32_t ob_universe_simulators_here(const ob_universe *u, uint32_t *first);
// Checks if another program has attached the universe; called by the host, which has its file. The second returns the
// last result.
void ob_universe_look_for_readers(ob_universe *u);
bool ob_universe_is_read(const ob_universe *u);
// True if a rank needs the contact state of all pairs at any time, not only at the steps of ob_contacts_want.
bool ob_universe_shares_contacts(const ob_universe *u);
// Host, paused, alike on each rank: when so many steps are complete, this rank needs the contact state of all pairs,
// even those found by others (cluster/holdings.h). Without several ranks it always has.
void ob_contacts_want(ob_universe *u, uint64_t step);
uint64_t ob_contacts_wanted(const ob_universe *u); // the last such step
// Measures against faulty simulators: bits, 1 << ob_harden_measure.
uint32_t ob_universe_harden(const ob_universe *u);
// True if simulators are contained (outbox.h).
bool ob_universe_contains(const ob_universe *u);
bool ob_universe_checked(const ob_universe *u); // as it was set up
// Likewise. Objects whose slots are filled may be elsewhere (free/world.h).
bool ob_universe_unshared(const ob_universe *u);
const char *ob_universe_name(const ob_universe *u);
uint32_t ob_universe_version(void); // layout version of this program
void ob_universe_set_state(ob_universe *u, ob_universe_state s);
// For readers: records another death of a simulator, with this text, and the number of objects frozen by it. Called by
// the host.
void ob_universe_note_death(ob_universe *u, const char *what);
void ob_universe_note_frozen(ob_universe *u, uint32_t objects);
uint32_t ob_universe_hulls(const ob_universe *u); // number that it has room for
// One past the highest id ever used: loops over objects end here.
uint32_t ob_universe_ids(const ob_universe *u);

// For writers. One writer per slot at a time; the gate orders a change of writer.
void ob_publish_motion(ob_universe *u, uint32_t id, const ob_motion *m);
// Same in two parts: a staged motion is not yet the object's motion for any reader, and may be staged again, until it
// is committed. If another worker commits it than the one that staged it, the gate orders the two.
void ob_stage_motion(ob_universe *u, uint32_t id, const ob_motion *m);
const ob_motion *ob_staged_motion(const ob_universe *u, uint32_t id);
void ob_commit_motion(ob_universe *u, uint32_t id);
void ob_uncommit_motion(ob_universe *u, uint32_t id); // the newest is staged again, in a universe without readers
// Called by the host, while the universe is paused or starting.
void ob_write_passport(ob_universe *u, uint32_t id, const ob_passport *p);
// Same, for a hull that no body properties refer to yet. Returns false if there is no room, or it is inconsistent.
bool ob_write_hull(ob_universe *u, uint32_t hull, const ob_hull *h);
// Direct views for the step, ordered by the gate: the newest motion, the body properties. Never for outside readers.
const ob_motion *ob_newest_motion(const ob_universe *u, uint32_t id);
const ob_motion *ob_previous_motion(const ob_universe *u, uint32_t id); // the one before; the newest, if there is none
uint64_t ob_motion_version(const ob_universe *u, uint32_t id); // number of its published motions
const ob_passport *ob_passport_of(const ob_universe *u, uint32_t id);
void ob_prefetch_versions(const ob_universe *u, uint32_t id); // read by the two before
void ob_prefetch_slot(const ob_universe *u, uint32_t id); // all of it
const ob_hull *ob_hull_at(const ob_universe *u, uint32_t hull); // NULL: no such hull
const ob_hull *ob_hull_of(const ob_universe *u, const ob_passport *p); // NULL: not a hull
// Hull of a part of a compound, from 1; part 0: as ob_hull_of.
const ob_hull *ob_part_of(const ob_universe *u, const ob_passport *p, uint32_t part);
uint32_t ob_parts_of(const ob_universe *u, const ob_passport *p); // 0: not a compound
bool ob_universe_has_terrains(const ob_universe *u);
const ob_terrain_set *ob_universe_terrains(const ob_universe *u); // NULL: there are none
const ob_terrain *ob_terrain_of(const ob_universe *u, const ob_passport *p); // NULL: not a terrain
// The data of the step (step_data.h); ordered by the gate.
ob_step_data *ob_universe_step_data(const ob_universe *u);

// The clock of the run: the scheduler advances it.
uint64_t ob_step_count(const ob_universe *u);
// Worker that scheduled last, set by itself; any thread may read it.
void ob_step_set_scheduler(ob_universe *u, uint32_t worker);
uint32_t ob_step_scheduler(const ob_universe *u);
// Sets the clock, of a universe in which nothing moves.
void ob_step_set(ob_universe *u, uint64_t step);
void ob_step_complete(ob_universe *u, uint32_t awake, uint32_t pairs, uint32_t islands);
// Starts the timing of steps: from one completion to the next; after a pause, from here.
void ob_step_begin(ob_universe *u);
// Wall time of each step so far, without pauses. Read it while the universe stands still.
const ob_latency *ob_step_latency(const ob_universe *u);
// Critical path, if the run is timed: the duration of the steps if no worker ever had to wait for a core. Before it
// arrives, each worker records its work in the phase (ns of CPU). The scheduler closes the phase before anything else,
// and adds the time of scheduling. ob_critical_path: the sum so far (ns).
//
// The same for OB_SIMULATED_WORKERS, with any actual number. Each worker records the time of each task (any worker; in
// a phase with more tasks than objects some are combined), and its time outside of tasks. The scheduling code
// distributes the tasks (step/profile.h): it takes the phase's tasks and the time beside them.
enum { OB_SIMULATED_WORKERS = 16 };
void ob_task_took(ob_universe *u, uint32_t task, uint32_t ns);
uint32_t ob_task_take_time(ob_universe *u, uint32_t task); // ns; resets it to 0
uint32_t ob_task_count(const ob_universe *u); // in the phase, as ob_task_reset
void ob_phase_worked(ob_universe *u, uint64_t ns, uint64_t beside);
uint64_t ob_phase_close(ob_universe *u); // returns the largest time of a worker outside of tasks (ns)
void ob_critical_add(ob_universe *u, uint64_t ns, uint64_t simulated);
void ob_critical_add_alone(ob_universe *u, uint64_t ns); // adds to both: one worker schedules
uint64_t ob_critical_path(const ob_universe *u);
uint64_t ob_simulated_path(const ob_universe *u);
uint64_t ob_time_alone(const ob_universe *u); // share of scheduling in either

// Worker cells. The worker itself calls announce once; the host refreshes the CPU time.
void ob_worker_announce(ob_universe *u, uint32_t worker, int32_t pid, int32_t tid, int32_t cpu);
void ob_worker_set_objects(ob_universe *u, uint32_t worker, uint32_t objects);
// Object that the worker is processing, and to blame for its failure; OB_NO_OBJECT: none. Set by the worker; read by
// the host, which must not trust it.
#define OB_NO_OBJECT UINT32_MAX
void ob_worker_set_object(ob_universe *u, uint32_t worker, uint32_t object);
uint32_t ob_worker_object(const ob_universe *u, uint32_t worker);
void ob_worker_set_cpu(ob_universe *u, uint32_t worker, uint64_t cpu_ns);
// The worker's own counters; the host reads them while the universe stands still.
ob_counters *ob_worker_counters(const ob_universe *u, uint32_t worker);
// Injected faults (ob_fault_plan): count of a worker; and of all. A simulator may have overwritten its own or
// another's: returns the number of counters that show it, which are left out. lives: number of restarts of all
// simulators, so that a successor does not repeat the fault of its predecessor.
void ob_fault_note(ob_universe *u, uint32_t worker, ob_fault_kind kind);
uint32_t ob_universe_faults(const ob_universe *u, uint64_t sum[OB_FAULT_KINDS]);
uint32_t ob_universe_lives(const ob_universe *u);
// Sums over all workers, and the largest error of all.
void ob_universe_count(const ob_universe *u, ob_counters *sum);

// ---- tasks: indices 0 .. total-1, each claimed once per phase, by the first worker to request it
//
// Contained simulators, workers 0 .. workers-1, share them in turns instead: ob_task_owner of outbox.h.
void ob_task_reset(ob_universe *u, uint32_t total, uint32_t workers);
// Same for contained simulators "first" .. first + workers - 1.
void ob_task_reset_from(ob_universe *u, uint32_t total, uint32_t first, uint32_t workers);
bool ob_task_claim(ob_universe *u, uint32_t *index);
// Appends to the list of objects whose neighbours the broad phase must query again (any worker, any order).
void ob_requery_append(ob_universe *u, uint32_t id);
// Has the object look for its neighbours, unless that is pending.
void ob_pairs_requery(ob_universe *u, uint32_t id);
// Takes an object off the list, if it is there. The host, at a pause.
void ob_requery_drop(ob_universe *u, uint32_t id);
// The list so far; reset empties it. Only for the scheduler.
const uint32_t *ob_requery_list(const ob_universe *u, uint32_t *count);
void ob_requery_reset(ob_universe *u);
bool ob_requery_lists(const ob_universe *u, uint32_t id); // true if it is on the list
// Stops the run after this phase: any worker. Among several failures, the one of the lowest object stays, so that it is
// the same in every run. object: one to blame.
void ob_step_fail(ob_universe *u, ob_step_failure why, uint32_t object);
ob_step_failure ob_step_failed(const ob_universe *u, uint32_t *object); // object may be NULL
// Adds to the step's work; returns the sum of all workers so far. The scheduler resets it.
uint64_t ob_step_work_add(ob_universe *u, uint64_t work);
void ob_step_work_reset(ob_universe *u);
// Adds to ob_step_counts.awake: any worker.
void ob_step_woken(ob_universe *u, int32_t objects);
// Adds to ob_step_counts.visits: any worker.
void ob_step_visited(ob_universe *u, uint64_t visits);
// Marks the object as involved in an island of the coming step, not yet determined: any worker. Returns false if it was
// already. They are listed in ob_step_data.scratch, unordered, ob_step_counts.involved of them.
bool ob_object_involve(ob_universe *u, uint32_t id);
// Reserves room for so many of an island's pairs in ob_step_data.island_pair: any worker. Returns its offset;
// UINT32_MAX: none, which is damage.
uint32_t ob_island_pairs_reserve(ob_universe *u, uint32_t pairs);
// Late contacts: the scheduler resets the flag; then any worker may set it for a pair that it has checked.
void ob_late_contacts_reset(ob_universe *u);
void ob_late_contacts_note(ob_universe *u);
// Fails the step because this worker has made a stray write, or submitted invalid records. Called by the arranger.
void ob_step_blame(ob_universe *u, uint32_t worker, const char *what);
// Fails the step with OB_STEP_BROKEN: shared data breaks an invariant, named in this line (truncated if it is too
// long). Called by the scheduling worker, or the host at a pause.
void ob_step_break(ob_universe *u, const char *what);
// Fails a free run whose schedule cannot be replayed, or recorded: the reason in one line. Called by a worker.
void ob_step_misses_plan(ob_universe *u, const char *why);
// Takes a record for a pair that begins to touch: any worker. Its two versions have no stamp. There are as many as
// pairs. OB_NO_RECORD: out of memory, which is a failure of the step.
uint32_t ob_record_take(ob_universe *u);
// Only for the scheduler.
void ob_record_give_back(ob_universe *u, uint32_t record);
// Frees the pair's record, if it has one. Between steps: data written in a step may be read until its end.
void ob_pair_release_record(ob_universe *u, ob_pair_key *k);
// Reserves count words in the arena of neighbours, for object id. Returns the offset, or UINT32_MAX if it is full,
// which is a failure of the step.
uint32_t ob_neighbours_reserve(ob_universe *u, uint32_t id, uint32_t count);
void ob_neighbours_reset(ob_universe *u);

// ---- the gate (gate.h explains it with a drawing)
//
// A phase ends when every participant has arrived; the last to arrive, the scheduler, prepares the next and opens the
// gate. A worker waits until the gate opens with a phase in which it takes part.
ob_phase ob_turn_wait(ob_universe *u, uint32_t worker);
// Returns true if the caller is the last: all other workers wait; it must call ob_gate_open or ob_gate_pause.
bool ob_turn_arrive(ob_universe *u, uint32_t worker);
// participants: worker numbers, n of them; NULL = all. n >= 1 unless the phase is STOP. An invalid number is damage:
// OB_STEP_DAMAGED.
void ob_gate_open(ob_universe *u, ob_phase phase, const uint32_t *participants, uint32_t n);
// Instead of opening: hands the turn to the host, which sleeps in ob_gate_host_wait.
void ob_gate_pause(ob_universe *u);
// True if the running phase still waits for this worker (any thread, as of a moment ago).
bool ob_gate_waits_for(const ob_universe *u, uint32_t worker);
// Host: sets the step of the next pause (the scheduler reads it).
void ob_gate_set_pause_step(ob_universe *u, uint64_t step);
uint64_t ob_gate_pause_step(const ob_universe *u);
// Host: waits until paused; returns false on timeout (s).
bool ob_gate_host_wait(ob_universe *u, double timeout);
// The phase that was opened last; any thread.
ob_phase ob_gate_phase(const ob_universe *u);
// True after ob_gate_stop: a worker may leave its phase, and fails the step with OB_STEP_LEFT.
bool ob_gate_stopped(const ob_universe *u);
// Host, any time: opens the gate with STOP for all, for good; also wakes ob_gate_host_wait.
void ob_gate_stop(ob_universe *u);

#endif

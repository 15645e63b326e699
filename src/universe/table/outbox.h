// Containment: simulators without write access to the universe submit their results through outboxes.
//
//   simulator w                       in the universe                             arranger (the last worker)
//                            +--------------------------------+
//   maps it read-only  <-----| motions, pairs, islands, gate ..|<-- alone writes ----- checks each record, commits
//                            +--------------------------------+                              ^
//                            | outbox of w                    |                              |
//   put: records, and  ----->|  signal  bytes  checksum       |-----> copies, compares ------+
//    their checksum          |  records ..                    |       the checksum
//                            +--------------------------------+
//
// A simulator can write its own outbox and, if the run is traced, its own ring; a store to anything else ends it
// (SIGSEGV). It puts records into the outbox while it works. The checksum is taken of each record as it is put, not of
// the outbox. So a stray write into existing records, even the own outbox, is detected. Read-only pages and the
// checksum are measures of their own (OB_HARDEN_PAGES, OB_HARDEN_CHECKSUM): a run can do without.
//
//   simulator   records; bytes, checksum, turn, last;  signal = n;  wake, if the arranger waits for this one
//   arranger    for each participant in turn: waits until signal = taken + 1;  copies;  taken = n
//
// last = 1 is the arrival at the gate. With last = 0 the outbox was full: its simulator waits for "taken", and goes on.
// "taken" lies in the gate's cell, and "awaited", the simulator that the arranger waits for, in the gate: simulators
// can write neither. Both sides access awaited and signal with sequential consistency, so one of the two sees the
// other's write. In case a stray write has hit the signal, the arranger polls ten times a second.
//
// All results of a phase are in the arranger's own memory before any of it is committed: later writes of a simulator do
// not change checked data. Thread-safety: a simulator's side is its process's one thread; the arranger's is its own.
#ifndef OB_TABLE_OUTBOX_H
#define OB_TABLE_OUTBOX_H

#include "table/table.h"

// Record at the end of each phase.
typedef struct ob_outbox_end {
	uint64_t failure; // see ob_step_fail
	uint64_t work; // see ob_step_work_add
	uint64_t worked_ns; // see ob_phase_worked
	uint32_t late; // see ob_late_contacts_note
	uint32_t next_check; // several ranks: 1 + the first step with an entry for a pair that it has checked; 0: none
	uint32_t objects; // see ob_worker_set_objects
	uint32_t worked_on; // object of the last work
	ob_counters counters;
} ob_outbox_end;

enum { OB_OUTBOX_END = 0 }; // its kind; all others are the module exchange's

// ---- the simulator's side

// From here on this process, just started, submits its results through its outbox. With OB_HARDEN_PAGES it can write
// its own outbox and ring only. Returns false, and errno, on failure.
bool ob_outbox_enter(ob_universe *u, uint32_t worker);
// True if this process is a contained simulator.
bool ob_universe_contained(const ob_universe *u);
// A record of the given kind in two parts (bytes: multiples of 8; more may be NULL), together less than a page.
void ob_outbox_put(ob_universe *u, uint32_t kind, const void *record, size_t bytes, const void *more,
		   size_t more_bytes);
// All of its outbox, whole pages.
void *ob_outbox_own(const ob_universe *u, size_t *bytes);
// Contents of its next ob_outbox_end.
ob_outbox_end *ob_outbox_end_of(const ob_universe *u);
// Called when the simulator has its turn, and when it arrives at the gate (turn.c). turns_done: the last turn at which it
// has arrived.
void ob_outbox_begin(ob_universe *u);
void ob_outbox_arrive(ob_universe *u);
uint32_t ob_outbox_turns_done(const ob_universe *u);
// Number of tasks that this simulator has claimed in the phase (ob_task_claim), before this one; and its own number.
uint32_t ob_outbox_next_task(const ob_universe *u, uint32_t *worker);

// ---- the arranger's side

// Owner of a task among "workers" that share tasks in turns: 0 1 2 2 1 0 0 1 2 .. With the largest first, loads are
// balanced.
uint32_t ob_task_owner(uint32_t index, uint32_t workers);
// Number of workers that share the tasks of the running phase, and the first of them.
uint32_t ob_task_workers(const ob_universe *u);
uint32_t ob_task_first(const ob_universe *u);

typedef struct ob_mail {
	char *bytes; // all submitted records, by simulator
	size_t used, max, at;
	size_t part; // 1 + offset of the head of the part that records are appended to; 0 = none
	bool lost; // memory has run out: what was appended since is missing
	uint32_t worker; // simulator of the records being read
	size_t end; // end of its part
} ob_mail;

typedef struct ob_mail_record {
	uint32_t worker, kind, bytes;
	const void *data;
} ob_mail_record;

// Waits until all local participants of the phase have arrived, and copies their outboxes. A wrong checksum is blamed
// on its simulator (ob_step_blame). Returns false on STOP.
bool ob_mail_collect(ob_universe *u, ob_mail *m);
// Clears it; appends bytes to its contents.
void ob_mail_clear(ob_mail *m);
void ob_mail_append(ob_mail *m, const void *bytes, size_t n);
// Appends a record, as ob_mail_next returns it. A mail has the simulators one after the other.
void ob_mail_append_record(ob_mail *m, const ob_mail_record *r);
// Next record; false: none.
bool ob_mail_next(ob_universe *u, ob_mail *m, ob_mail_record *out);
// Next end of a simulator's phase, an ob_outbox_end; false: none.
bool ob_mail_next_end(ob_mail *m, ob_mail_record *out);
void ob_mail_finish(ob_mail *m);

#endif

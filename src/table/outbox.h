// Containment: how simulators that cannot write the universe hand over what they have found.
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
// A simulator can write its own outbox and, where the run is traced, its own ring; a store to anything else ends it
// (SIGSEGV). It puts records into the outbox while it works. The checksum is taken of each record as it is put, not of
// the outbox, so a wild store into what has been put already is noticed: who harms its own outbox is found out, too.
// Read-only pages and the checksum are measures of their own (OB_HARDEN_PAGES, OB_HARDEN_CHECKSUM): a run can do without.
//
//   simulator   records; bytes, checksum, turn, last;  signal = n;  wake, if the arranger waits for this one
//   arranger    for each participant in turn: waits until signal = taken + 1;  copies;  taken = n
//
// last = 1 is the arrival at the gate. With last = 0 the outbox was full: its simulator waits for "taken", and goes on.
// "taken" lies in the gate's cell, and "awaited", whom the arranger sleeps for, in the gate: neither can a simulator
// write. Both sides access awaited and signal with sequential consistency, so one of the two sees what the other wrote;
// should a wild store have hit the signal, the arranger looks again ten times a second.
//
// What a phase has brought is in the arranger's own memory before any of it is committed: a simulator that writes on
// does not change what has been checked. Thread-safety: a simulator's side is its process's one thread; the arranger's
// is its own.
#ifndef OB_TABLE_OUTBOX_H
#define OB_TABLE_OUTBOX_H

#include "table/table.h"

// What all records of a phase are followed by.
typedef struct ob_outbox_end {
	uint64_t failure; // as of ob_step_fail
	uint64_t work; // as of ob_step_work_add
	uint64_t worked_ns; // as of ob_phase_worked
	uint32_t late; // as of ob_late_contacts_note
	uint32_t next_check; // of several ranks: 1 + the first step for which a pair that it has checked has an entry; 0: none
	uint32_t objects; // as of ob_worker_set_objects
	uint32_t worked_on; // object that the last of the work went into
	ob_counters counters;
} ob_outbox_end;

enum { OB_OUTBOX_END = 0 }; // its kind; all others are the module sim's

// ---- the simulator's side

// From here on this process, which has just been started, hands over what it finds; with OB_HARDEN_PAGES it can write
// its own outbox and ring, no more. false, and errno: it could not be done.
bool ob_outbox_enter(ob_universe *u, uint32_t worker);
// Whether this process is a simulator that is contained so.
bool ob_universe_contained(const ob_universe *u);
// A record of the given kind in two parts (bytes: multiples of 8; more may be NULL), together less than a page.
void ob_outbox_put(ob_universe *u, uint32_t kind, const void *record, size_t bytes, const void *more,
		   size_t more_bytes);
// All of its outbox, whole pages.
void *ob_outbox_own(const ob_universe *u, size_t *bytes);
// What its ob_outbox_end will say.
ob_outbox_end *ob_outbox_end_of(const ob_universe *u);
// By the gate, when the simulator has its turn, and when it arrives.
void ob_outbox_begin(ob_universe *u);
void ob_outbox_arrive(ob_universe *u);
// The next of this simulator's tasks (below).
bool ob_outbox_claim(ob_universe *u, uint32_t *index);

// ---- the arranger's side

// Whose task it is, of "workers" that share tasks in turns: 0 1 2 2 1 0 0 1 2 .. Largest first, they come out even.
uint32_t ob_task_owner(uint32_t index, uint32_t workers);
// How many share the tasks of the running phase, and the first of them.
uint32_t ob_task_workers(const ob_universe *u);
uint32_t ob_task_first(const ob_universe *u);

typedef struct ob_mail {
	char *bytes; // of all records that were handed over, by simulator
	size_t used, max, at;
	size_t part; // 1 + where the head of the part begins to which records are appended; 0 = there is none
	uint32_t worker; // of those that are read
	size_t end; // of its part
} ob_mail;

typedef struct ob_mail_record {
	uint32_t worker, kind, bytes;
	const void *data;
} ob_mail_record;

// Waits until all participants of the phase that are here have arrived, and copies what they have handed over. What does not bear its
// checksum is blamed on its simulator (ob_step_blame). false: STOP.
bool ob_mail_collect(ob_universe *u, ob_mail *m);
// Empties it, and puts bytes behind what it holds. false: no memory.
void ob_mail_clear(ob_mail *m);
bool ob_mail_append(ob_mail *m, const void *bytes, size_t n);
// Likewise a record, as ob_mail_next gives it. Into one mail by simulators, one after the other.
bool ob_mail_append_record(ob_mail *m, const ob_mail_record *r);
// The next record; false: there is none.
bool ob_mail_next(ob_universe *u, ob_mail *m, ob_mail_record *out);
// The next that is the last of what a simulator has handed over in a phase, an ob_outbox_end; false: there is none.
bool ob_mail_next_end(ob_mail *m, ob_mail_record *out);
void ob_mail_finish(ob_mail *m);

#endif

// Request log: a file with all input of a run from outside, in order: requests, objects that were frozen, and hashes of
// the state in between. A run of the same scene that carries them out in the same places ends in the same bits.
//
//   head │ record │ record │ ..       a record for each, in its layout in memory: for the same version of obsim only
//
// Thread-safety: the host's thread only.
#ifndef OB_HOST_REQUEST_LOG_H
#define OB_HOST_REQUEST_LOG_H

#include "host/request.h"
#include "settings/settings.h"
#include "table/table.h"

// ---- journal

// Journal: requests that a run has carried out since its last checkpoint in memory, with the place of each. A run that
// restarts from there carries them out again, in the same places, so it comes to the same bits.
//
//   requests ──(carried out)──> entry .. entry │           note: behind all others
//                                 next ────────┘           restart: next = the first; again: each in its place
//
// A place is a step, and whether that step's scripts have run. Workers run between two places, never between two pauses
// in the same place, so that nothing depends on how many pauses there were.
//
// Thread-safety: the host's thread only.

typedef struct ob_journal_place {
	uint64_t step; // number of complete steps
	uint32_t after_scripts; // 1 = scripts have run before the coming step, and the pause is theirs
} ob_journal_place;

// Returns the place where a universe stands, paused.
ob_journal_place ob_journal_here(const ob_universe *u);
// True if a place is the one once the scripts before the coming step have run, which they have not.
static inline bool ob_journal_is_after_scripts(ob_journal_place at, ob_journal_place here)
{
	return at.step == here.step && at.after_scripts > here.after_scripts;
}

// An object to freeze there, after all requests.
typedef struct ob_freeze {
	ob_journal_place at;
	uint32_t id, generation;
} ob_freeze;

typedef struct ob_journal_entry {
	ob_journal_place at;
	ob_request request;
} ob_journal_entry;

typedef struct ob_journal {
	ob_journal_entry *entry; // [count]
	size_t count, room, next; // next: entries before it are carried out
	bool lost; // there was no memory for an entry: no restart can repeat it
} ob_journal;

void ob_journal_finish(ob_journal *j);
// True if the journal is as long as it should get, or an entry was lost: a checkpoint is due.
bool ob_journal_is_full(const ob_journal *j);
// Before the run begins: adds entries to carry out, as if it had been restarted. false: no memory.
bool ob_journal_load(ob_journal *j, const ob_journal_entry *entry, size_t count);
// Forgets all entries that are carried out, after a checkpoint.
void ob_journal_clear(ob_journal *j);
// Starts over: the run begins again from the checkpoint.
void ob_journal_rewind(ob_journal *j);
// Place of the next entry to carry out again; step UINT64_MAX: none.
ob_journal_place ob_journal_next(const ob_journal *j);
// Next entry to carry out again in this place; NULL: none.
const ob_request *ob_journal_again(ob_journal *j, const ob_journal_place *at);
// Notes a request when it is carried out for the first time; none may be left to carry out again.
void ob_journal_note(ob_journal *j, const ob_journal_place *at, const ob_request *r);

// ---- request log

// Describes the logged run. A replay has the same.
typedef struct ob_request_log_head {
	ob_run_settings run; // resolved, without faults
	uint64_t seed; // of the scene
	uint32_t objects; // of the scene
	uint32_t spare; // slots, as ob_host_config
	uint32_t on_death, zero; // ob_on_death
} ob_request_log_head;

typedef struct ob_request_log ob_request_log;

// Replaces the file. NULL and e: it cannot be written.
ob_request_log *ob_request_log_create(const char *path, const ob_request_log_head *head, ob_error *e);
// Each is NULL-safe and appends a record. Write errors are reported once, by close.
void ob_request_log_request(ob_request_log *l, const ob_journal_place *at, const ob_request *r);
void ob_request_log_freeze(ob_request_log *l, const ob_freeze *f);
void ob_request_log_state(ob_request_log *l, uint64_t step, uint64_t hash);
void ob_request_log_flush(ob_request_log *l);
// false and e: the file is not whole. NULL: true
bool ob_request_log_close(ob_request_log *l, ob_error *e);

typedef struct ob_logged_state {
	uint64_t step, hash;
} ob_logged_state;

// Contents of a log, checked like requests from outside: steps ascend, definitions are valid.
typedef struct ob_logged_requests {
	ob_request_log_head head;
	ob_journal_entry *request; // [requests]
	ob_freeze *freeze; // [freezes]
	ob_logged_state *state; // [states]
	uint32_t requests, freezes, states;
} ob_logged_requests;

// Finish it in either case. false and e: no whole log of this version. A truncated record at the end is left out.
bool ob_request_log_read(ob_logged_requests *out, const char *path, ob_error *e);
void ob_logged_requests_finish(ob_logged_requests *l);

#endif

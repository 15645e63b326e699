// Request log: a file with all input of a run from outside, in order: requests, objects that were frozen, and hashes of
// the state in between. A run of the same scene that carries them out in the same places ends in the same bits.
//
//   head │ record │ record │ ..       a record for each, in its layout in memory: for the same version of obsim only
//
// Thread-safety: the host's thread only.
#ifndef OB_HOST_REQUEST_LOG_H
#define OB_HOST_REQUEST_LOG_H

#include "host/journal.h"
#include "settings/settings.h"

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

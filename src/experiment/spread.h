// Trials of an experiment on several ranks. The first has the records and the file, and hands out one trial after the
// other, to itself as well; the others run them. Internal to the module.
//
//      rank 0 (run.c)                                each other (ob_spread_help)
//          <-------- JOIN, a digest of its schedule --------
//          --------- RUN trial 17 ------------------------->  in a process of its own
//          <-------- RAN trial 17, its record --------------
//          --------- LEAVE: all is done ------------------->
//
// Ranks wait for the slowest only at the end. A rank that fails sends FAILED instead, or is interrupted, or dies. The
// first rank then ends with an error, and the launcher ends the others; the file has all results received by then.
#ifndef OB_EXPERIMENT_SPREAD_H
#define OB_EXPERIMENT_SPREAD_H

#include "experiment/experiment.h"
#include "ranks/courier.h"

typedef enum ob_spread_kind {
	OB_SPREAD_JOIN,
	OB_SPREAD_RUN,
	OB_SPREAD_RAN,
	OB_SPREAD_LEAVE,
	OB_SPREAD_FAILED
} ob_spread_kind;

typedef struct ob_spread_message {
	ob_spread_kind kind;
	uint64_t trial; // its number in the schedule; JOIN: the digest
	ob_record record; // RAN: of the trial; JOIN: machine and commit alone; FAILED: the reason alone
} ob_spread_message;
_Static_assert(sizeof(ob_spread_message) <= OB_COURIER_BYTES, "it fits");

// Digest of a schedule: two ranks with the same one agree on the numbers of trials.
uint64_t ob_spread_digest(const ob_experiment *x, const ob_trials *s);
// Work of a rank other than the first. Returns false and e if interrupted, or if the others cannot be reached.
bool ob_spread_help(const ob_experiment *x, const ob_trials *s, const ob_records *own, const ob_ranks *ranks,
		    ob_error *e);

#endif

// Invariants of the data that simulators share: objects, lists of pairs, spatial index, calendars, records, scripts'
// cells.
//
//   host changes objects ──(AT_RESUME)──> query, merge ──(AFTER_MERGE)──> .. solve ..> step complete ──(AFTER_STEP)
//
// The host checks before it resumes a run, the scheduling worker after each merge of pairs and each complete step. They
// do so in a universe created with `checked`, and in any build with a sanitizer; others pay nothing. Ids, indices and
// links are compared with their ranges before they are followed, so a damaged universe ends in a message, too.
//
// Thread-safety: the only writer of the step's data calls them (the scheduling worker, or the host at a pause).
// Allocates for the call; without memory it checks nothing.
#ifndef OB_STEP_INVARIANTS_H
#define OB_STEP_INVARIANTS_H

#include <ob/error.h>

#include "table/table.h"

typedef enum ob_invariant_moment {
	OB_INVARIANTS_AT_RESUME, // queries may be pending
	OB_INVARIANTS_AFTER_MERGE, // none is pending
	OB_INVARIANTS_AFTER_STEP, // likewise, and no object is in an island
} ob_invariant_moment;

// Checks all of them. false and e: names the object, and the list or record that is wrong.
bool ob_invariants_hold(const ob_universe *u, ob_invariant_moment when, ob_error *e);
// Checks if the universe is to be checked. false: the step has failed with OB_STEP_BROKEN and the reason.
bool ob_invariants_check(ob_universe *u, ob_invariant_moment when);

#endif

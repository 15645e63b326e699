// Substeps by tolerance (error control). An island is solved on a private copy of what its bodies published, and
// nothing is written before the solution is stored: so it can be solved again, from the step's start, with more
// substeps, until its error is below the run's tolerance.
//
//   load ── solve with the run's substeps ── error? ──> below: store, and tell the bodies how many will do next time
//     ^                                        │
//     └─────────── load again, 2 x, 4 x ───────┘ above
//
// The error of a solution, in metres, is the largest of
//   depth   how deep two bodies penetrate at the end of any substep, where this step has brought them there
//   creep   how far a contact that friction should hold has slipped in about a second
//   bounce  how high a rebound would have gone that the substep was too long to resolve
// All of it is a function of published state alone: the same for any worker, and after sleeping.
#ifndef OB_SIM_ERROR_CONTROL_H
#define OB_SIM_ERROR_CONTROL_H

#include "sim/state.h"

// Substeps with which the island is solved first: what its bodies ask for, or the run's own number without tolerance.
uint32_t ob_error_control_substeps(const ob_sim *s, const ob_island *is);

// Notes, each while the island is solved; all do nothing without a tolerance.
// After the narrow phase. at_start: penetrations that are there now are not this step's error.
void ob_error_control_note_depth(ob_sim *s, bool at_start);
void ob_error_control_note_slip(ob_sim *s); // after a partial substep
void ob_error_control_note_bounce(ob_sim *s); // after impacts

// After the last substep: true if the solution's error is tolerable; false: solve again with island.substeps.
bool ob_error_control_accept(ob_sim *s);

#endif

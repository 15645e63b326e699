// Substeps by tolerance. An island is solved on a private copy of what its members published, and nothing is written
// before it is stored: so it can be solved again, from the start, with more substeps, until its error is below what the
// run tolerates.
//
//   load ── solve with the run's substeps ── error? ──> below: store, and tell the members how many will do next time
//     ^                                        │
//     └─────────── load again, 2 x, 4 x ───────┘ above
//
// The error of a solution, in metres, is the largest of
//   depth   how deep two bodies are in each other at the end of any substep, where this step has brought them there
//   creep   how far what should stick by friction has slipped in about a second
//   bounce  how high a rebound would have gone that the substep was too long to resolve
// All of it is a function of published state alone: the same for any worker, and after sleeping.
#ifndef OB_SIM_TOLERANCE_H
#define OB_SIM_TOLERANCE_H

#include "sim/state.h"

// Substeps with which the island is solved first: what its members ask for, or the run's own number without tolerance.
uint32_t ob_error_control_substeps(const ob_sim *s, const ob_island *is);

// Notes, each while the island is solved; all do nothing without a tolerance.
void ob_error_control_note_depth(ob_sim *s, bool at_start); // after a look; at_start: what is there is not this step's doing
void ob_error_control_note_slip(ob_sim *s); // after a stride
void ob_error_control_note_bounce(ob_sim *s); // after impacts

// After the last substep: true if the solution stands; false: solve again with island.substeps.
bool ob_error_control_accept(ob_sim *s);

#endif

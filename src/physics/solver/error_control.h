// Substeps by tolerance (error control). An island is solved on a private copy of what its bodies published, and
// nothing is written before the solution is stored: so it can be solved again, from the step's start, with more
// substeps, until its error is below the run's tolerance.
//
//   load ── solve with the run's substeps ── error? ──> below: store, with each body's substeps for the next step
//     ^                                        │
//     └─────────── load again, 2 x, 4 x ───────┘ above
//
// Error of a solution, in metres: the largest of
//   depth   penetration of two bodies at the end of any substep, as far as this step has caused it
//   creep   slip, within about a second, of a contact that friction should hold
//   bounce  height of a rebound that the substep was too long to resolve
// A body also sinks with all that carries it. The sum of what a step adds to the depths below it is part of its deviation
// (solver/estimate.h).
// It is a function of published state alone: the same for any worker, and after sleeping.
#ifndef OB_SOLVER_ERROR_CONTROL_H
#define OB_SOLVER_ERROR_CONTROL_H

#include "solver/solver.h"

// Returns the number of substeps of an island's first solution: the largest that its bodies ask for; without a
// tolerance, the run's own.
uint32_t ob_error_control_substeps(const ob_solver *s, const ob_island_input *in);

// Note errors while the island is solved; without a tolerance they do nothing. ob_error_control_note_depth: after the
// narrow phase. at_start: present penetrations are not this step's error.
void ob_error_control_note_depth(ob_solver *s, bool at_start);
void ob_error_control_note_slip(ob_solver *s); // after a partial substep
void ob_error_control_note_bounce(ob_solver *s); // after impacts

// Called after the last substep. Returns true if the solution's error is tolerable; false: solve again with
// island.substeps.
bool ob_error_control_accept(ob_solver *s);
// Counts the errors of the solution that stands.
void ob_error_control_count(ob_solver *s);

#endif

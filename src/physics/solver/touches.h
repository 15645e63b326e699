// Contacts that begin in the step, reported to the caller with their impulses (ob_island_calls.touch).
#ifndef OB_SOLVER_TOUCHES_H
#define OB_SOLVER_TOUCHES_H

#include "solver/solver.h"

// Reports, after each partial substep, what it has added to the contacts that began in this step.
void ob_touches_note_solved(ob_solver *s);
// Reports an impact of this contact; the solver of impacts has the bodies' velocities before and after it.
void ob_touches_note_impact(ob_solver *s, const ob_impact_instant *i);

#endif

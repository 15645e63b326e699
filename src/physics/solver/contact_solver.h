// Contact solver: finds contact impulses by iterations over the pairs.
//
// Coloured: no two contacts of a colour share a body, so each pair is solved with true masses, on the velocities left
// by the colours before (Gauss-Seidel). Jacobi: all pairs are solved on the same velocities, each with its share of its
// bodies' masses (split by the number of contacts). All changes are added up. Ghost and lagged, for experiments: each
// body of a pair is solved for itself (solver/ghost.h).
#ifndef OB_SOLVER_CONTACT_SOLVER_H
#define OB_SOLVER_CONTACT_SOLVER_H

#include "solver/solver.h"

// Iterates on contact impulses and u until no velocity changes by more than the wake threshold.
void ob_solver_iterate(ob_solver *s);
// Removes from the next warm start the impulses that impacts have added. Called after ob_solver_iterate.
void ob_solver_limit_prediction(ob_solver *s);
// Converges contact impulses: conjugate iterations (solver/conjugate.h) over all contacts, until none changes a velocity
// by more than "enough" (m/s), at most max_iterations.
void ob_solver_converge(ob_solver *s, double enough, uint32_t max_iterations);
// Returns the penetration (m) up to which contacts are left as they are.
double ob_solver_slop(const ob_solver *s);
// Adds the rows of "from" to those of "to", and clears them.
void ob_solver_add_rows(ob_island_work *w, ob_body_row *to, ob_body_row *from);

// Activates a body whose velocity changed by more than the wake threshold. Its contacts are due in this iteration, if
// their turn is still to come, and in the next.
void ob_solver_activate(ob_island_work *w, uint32_t row, uint32_t iteration);

#endif

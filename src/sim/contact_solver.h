// The contact solver: contact impulses by iterations over the pairs.
//
// Coloured: of the contacts of one colour no two share a body, so each pair is solved with true masses on the
// velocities that the colours before have left (Gauss-Seidel). Jacobi: all pairs are solved on the same velocities,
// each with its share of its bodies' masses (the mass split by the number of contacts), and all changes are added
// together. Ghost and lagged, for experiments: each body of a pair is solved for itself (sim/ghost.h).
#ifndef OB_SIM_CONTACT_SOLVER_H
#define OB_SIM_CONTACT_SOLVER_H

#include "sim/state.h"

// Contact impulses: iterations on u until none changes a velocity by more than the wake threshold.
void ob_solver_iterate(ob_sim *s);
// After that: what impacts have added to impulses is no part of the next warm start.
void ob_solver_limit_prediction(ob_sim *s);
// Contact impulses to the end: conjugate iterations (sim/conjugate.h) over all contacts until none changes a velocity
// by more than "enough" (m/s), or so many have been made.
void ob_solver_converge(ob_sim *s, double enough, uint32_t max_iterations);
// m: penetrations up to it are left as they are.
double ob_solver_slop(const ob_sim *s);
// Adds to each body's row what "from" has for it, and empties that.
void ob_solver_add_rows(ob_island_work *w, ob_body_row *to, ob_body_row *from);

#endif

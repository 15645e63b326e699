// The contact solver: impacts with restitution, contact impulses by iterations over the pairs, position projection.
//
// Coloured: of the contacts of one colour no two share a body, so each pair is solved with true masses on the
// velocities that the colours before have left (Gauss-Seidel). Jacobi: all pairs are solved on the same velocities,
// each with its share of its bodies' masses (the mass split by the number of contacts), and all changes are added
// together. Ghost and lagged, for experiments: each body of a pair is solved for itself (sim/ghost.h).
#ifndef OB_SIM_CONTACT_SOLVER_H
#define OB_SIM_CONTACT_SOLVER_H

#include "sim/state.h"

// Impacts with restitution at their instants: changes v, shifts d. true if there were any.
bool ob_solver_impacts(ob_sim *s);
// The first instant (s into the partial substep) at which two bodies rebound of which one turns by more than the
// threshold until then; infinity: none. The narrow phase will test their contacts anew.
double ob_solver_first_rebound(ob_sim *s);
// Contact impulses: iterations on u until none changes a velocity by more than the wake threshold.
void ob_solver_iterate(ob_sim *s);
// After that: what impacts have added to impulses is no part of the next warm start.
void ob_solver_limit_prediction(ob_sim *s);
// Position projection: pushes penetrations apart in d.
void ob_solver_project_positions(ob_sim *s);

#endif

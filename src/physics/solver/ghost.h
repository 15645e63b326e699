// Ghosts: each simulator's own copies of its neighbours. An experiment, for the two solvers in which
// the bodies of a pair do not agree on one impulse; they exist for comparison with those that do.
//
//   OB_SOLVER_GHOST    a neighbour is infinitely heavy, and moves as it last published
//   OB_SOLVER_LAGGED   a neighbour has its true mass, but its velocity is read some iterations late
//
// A pair of two moving bodies becomes two contacts, each solved for one body alone:
//
//        a ----- contact ----- ghost of b          ghost of a ----- contact ----- b
//
// A change of a ghost's velocity is lost when the ghost is read anew, before the next iteration.
#ifndef OB_SOLVER_GHOST_H
#define OB_SOLVER_GHOST_H

#include "solver/solver.h"

// Loads a pair: twice if both bodies move, as each side is solved for itself, against a ghost of the other.
void ob_ghosts_load(ob_solver *s, const ob_island_pair *pair);
// Copies velocities, displacements and speeds of the bodies to their ghosts. Poses follow in ob_body_update_pose.
void ob_ghosts_follow(ob_solver *s);
// Stores the bodies' velocities before an iteration (counted from 0) of a phase that works on rows (v or u). Copies
// them to their ghosts, late by the lag of the run. No copy is older than the phase. Ghosts are as active as their bodies.
// Returns true.
bool ob_ghosts_read(ob_solver *s, ob_body_row *rows, uint32_t iteration);

#endif

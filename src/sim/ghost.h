// An experiment, off the hot path: each simulator's own copies (ghosts) of its neighbours, for the two solvers in which
// the bodies of a pair do not agree on one impulse. They are here to be measured against those that do.
//
//   OB_SOLVER_GHOST    a neighbour is taken for infinitely heavy, moving as it last published
//   OB_SOLVER_LAGGED   a neighbour has its true mass, but its velocity is read some iterations late
//
// A pair of two moving bodies is then two contacts, each solved for one of them alone:
//
//        a ----- contact ----- ghost of b          ghost of a ----- contact ----- b
//
// What a contact does to a ghost is lost when the ghost is read anew, before the next iteration.
#ifndef OB_SIM_GHOST_H
#define OB_SIM_GHOST_H

#include "sim/state.h"

// Does the run's solver use them?
bool ob_ghosts_used(const ob_sim *s);
// A new row that stands for body "row" towards one of its neighbours.
uint32_t ob_ghost_make(ob_sim *s, uint32_t row);
// Gives ghosts the velocities, displacements and speeds of the bodies that they stand for. Poses follow in
// ob_body_update_pose.
void ob_ghosts_follow(ob_sim *s);
// Before an iteration (counted from 0) of a phase that works on rows (v or u): keeps the bodies' velocities, and gives
// them to their ghosts, late by the lag of the run; nothing is older than the phase.
void ob_ghosts_read(ob_sim *s, ob_body_row *rows, uint32_t iteration);

#endif

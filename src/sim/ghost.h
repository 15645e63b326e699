// Ghosts: each simulator's own copies of its neighbours, for the two exchanges in which the members of a pair do not
// agree on one impulse. They are here to be measured against those that do.
//
//   OB_SOLVER_GHOST    a neighbour is taken for infinitely heavy, moving as it last published
//   OB_SOLVER_LAGGED   a neighbour has its true mass, but its published velocity is read some exchanges late
//
// A pair of two moving bodies is then two touches, each solved for one of them alone:
//
//        a ----- touch ----- ghost of b          ghost of a ----- touch ----- b
//
// What a touch does to a ghost is lost when the ghost is read anew, before the next exchange.
#ifndef OB_SIM_GHOST_H
#define OB_SIM_GHOST_H

#include "sim/state.h"

// Does the run's exchange use them?
bool ob_ghosts_used(const ob_sim *s);
// A new row that stands for member "row" in the eyes of one of its neighbours.
uint32_t ob_ghost_make(ob_sim *s, uint32_t row);
// Ghosts get the velocities, displacements and speeds of those whom they stand for. Poses follow in ob_body_update_pose.
void ob_ghosts_follow(ob_sim *s);
// Before exchange number "round" (from 0) of a phase that works on rows (v or u): keeps what the members have published
// there, and shows it to the ghosts, late by the lag of the run; nothing is older than the phase.
void ob_ghosts_read(ob_sim *s, ob_body_row *rows, uint32_t round);

#endif

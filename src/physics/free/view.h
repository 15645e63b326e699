// A simulator's view of its neighbours: their motions, read at its own time, as an island that the island solver moves
// through one step. Only the result for its own object counts.
//
//   neighbour                heavy                    else
//   in the island            moves on regardless      has its mass, and moves as published
//
// Time in the island begins at 0 with each step.
#ifndef OB_FREE_VIEW_H
#define OB_FREE_VIEW_H

#include "free/simulator.h"

// Prepares the scratch memory of a worker, which is zeroed. Returns false without memory.
bool ob_free_scratch_begin(ob_free_scratch *x, ob_universe *u);
void ob_free_scratch_finish(ob_free_scratch *x);

// Finds the motion of the simulator's object after a step of length h (s). out: all but t0, valid_until, step, island.
void ob_free_view_step(ob_free_sim *s, ob_free_scratch *x, double h, ob_motion *out);

// Own time, s, from which on the simulator steps because the object may soon touch a neighbour that moves.
double ob_free_approach(const ob_free_sim *s, const ob_free_scratch *x, const ob_free_neighbour *n);

// State of a version at a time t, between it and the next one if there is one (next->t0 not NaN).
ob_state ob_free_state_at(const ob_motion *m, const ob_motion *next, ob_vec3 inertia, double t);

#endif

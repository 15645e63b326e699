// Solves one island through one step (table of contents: solve_partial_substep in island_solver.c).
//
//   step ── ballistic advance, where that suffices: many lone bodies side by side, or a pair
//     └── load bodies and contacts
//     └── substeps, of equal length: the run's number, as many as the tolerance needs (sim/error_control.h), or one in
//     │   equilibrium (sim/equilibrium.h)
//     │     └── partial substeps, where fast bodies touch (sim/adaptive_substep.h)
//     │           narrow phase, warm start, impacts, contact solver, free motion to the end, position projection
//     └── store contacts, publish bodies
#ifndef OB_SIM_ISLAND_SOLVER_H
#define OB_SIM_ISLAND_SOLVER_H

#include "sim/flight.h"
#include "sim/state.h"

enum { OB_ISLANDS_ABREAST = OB_COURSES };

// Advances islands of one body in ballistic flight through the coming step, side by side, and stages their motions.
// Takes those among n islands (up to OB_ISLANDS_ABREAST) from `first` on. flown: [n], true: it is done.
void ob_islands_fly(ob_sim *s, uint32_t first, uint32_t n, bool *flown);
// Solves island i of the universe, which has not flown, through the coming step, stores its contacts and stages its
// bodies' motions. Results follow from published state alone: the same bits on any worker, whatever flies beside it.
void ob_island_solve(ob_sim *s, uint32_t i);
void ob_island_work_finish(ob_island_work *w);

#endif

// Solves one island through one step (table of contents: solve_partial_substep in island_solver.c).
//
//   step ── ballistic advance, where that will do
//     └── load bodies and contacts
//     └── substeps, of equal length: as many as the run says, as the tolerance needs (sim/error_control.h), or one in
//     │   equilibrium (sim/equilibrium.h)
//     │     └── partial substeps, where fast bodies touch (sim/adaptive_substep.h)
//     │           narrow phase, warm start, impacts, contact solver, free motion to the end, position projection
//     └── store contacts, publish bodies
#ifndef OB_SIM_ISLAND_SOLVER_H
#define OB_SIM_ISLAND_SOLVER_H

#include "sim/state.h"

// Solves island i of the universe through the coming step, stores its contacts and stages its bodies' motions. All that
// it finds follows from published state alone: the same bits whichever worker runs it.
void ob_island_solve(ob_sim *s, uint32_t i);
void ob_island_work_finish(ob_island_work *w);

#endif

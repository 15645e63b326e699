// Solution of an island's step, in parts (solver.h: ob_island_solve has them all).
#ifndef OB_SOLVER_ISLAND_SOLVER_H
#define OB_SOLVER_ISLAND_SOLVER_H

#include "solver/solver.h"

// Solves the step: with as many substeps as the tolerance needs, or one in equilibrium.
void ob_island_step(ob_solver *s, const ob_island_input *in);
// Solves it again, with so many substeps or as many more as the tolerance needs: this solution stands.
void ob_island_step_finer(ob_solver *s, uint32_t substeps);
// Solves it once with so many substeps, whatever the error or the equilibrium. stretch: as island.stretch.
void ob_island_probe(ob_solver *s, const ob_island_input *in, uint32_t substeps, double stretch);
// Reports contacts and motions of the step that was solved.
void ob_island_report(ob_solver *s);

#endif

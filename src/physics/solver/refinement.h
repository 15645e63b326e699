// Refinement: more substeps for a lone body whose errors exceed the tolerance while its contacts go on, where more substeps
// pay, by the partial substeps that it takes now. What lands and rattles gains nothing, so it stays at the run's substeps.
//
//   errors exceed the tolerance ──> in four steps again ──> solved with 4, 8, 16 times as many: do they fall fast?
//                                                              yes ──> so many, while contacts go on
//                                                              no  ──> no more trials, while contacts go on
//
// Islands that only joints hold have twice as many flights of the same order while their second would exceed it.
#ifndef OB_SOLVER_REFINEMENT_H
#define OB_SOLVER_REFINEMENT_H

#include "solver/solver.h"

// True if the step of a lone body is to be estimated so soon, as it was doubted.
bool ob_refinement_is_doubted(const ob_solver *s);
// Sets the next substeps of a lone body, and its stage, or of an island that only joints hold. estimated: the step was; error: m, of a second.
void ob_refinement_update(ob_solver *s, bool estimated, double error);

#endif

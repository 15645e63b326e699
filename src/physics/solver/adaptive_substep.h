// Adaptive partial substeps: the share of a substep that is solved at once. A substep is divided if fast bodies touch
// and the geometry of their contact would not last until its end. A partial substep also ends when a fast body reaches
// another: the next one begins with their contact as it is then.
#ifndef OB_SOLVER_ADAPTIVE_SUBSTEP_H
#define OB_SOLVER_ADAPTIVE_SUBSTEP_H

#include "solver/solver.h"

// Chooses the length of the next partial substep, at most "left" (s). Sets it in the island (h, h_min), and scales the
// warm-start impulses to it.
void ob_adaptive_begin(ob_solver *s, double left);
// Shortens the partial substep after the iterations if an impact made a body too fast for it. Returns true if it did:
// then the state is that before the iterations.
bool ob_adaptive_shorten(ob_solver *s);

#endif

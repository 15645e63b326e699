// Nonlinear conjugate gradients for the contact solver: iterations converge faster, by as many times as there are
// bodies in a row.
//
// A plain iteration changes the impulses along the residual's descent, and forgets its last direction: across n bodies
// it takes about n^2 iterations. Here each iteration goes on, by a share beta, along the direction of the one before,
// as in the method of Fletcher and Reeves (1964). If the residual grows, as when a contact opens or slips, the
// direction is reset (Silcowitz, Niebe and Erleben 2010):
//
//      iterate: dx = change of the impulses        beta = |dx|^2 / |dx of the iteration before|^2
//      beta > 1:  p = 0                            else:  p = beta p, x += p, p += dx
//
// |dx|^2 is the sum of A_ii dx_i^2 (J), so rows of all units count alike. The step x += p may leave the friction cones;
// the next iteration returns to them, so the method has to end with an iteration.
#ifndef OB_SOLVER_CONJUGATE_H
#define OB_SOLVER_CONJUGATE_H

#include "solver/island.h"

// Resets the direction.
void ob_conjugate_begin(ob_island_work *w);
// Notes the impulses, before an iteration over all contacts.
void ob_conjugate_note(ob_island_work *w);
// Goes on along the direction, after the iteration: in the impulses and in u.
void ob_conjugate_go_on(ob_island_work *w);
void ob_conjugate_finish(ob_conjugate *c);

#endif

// Nonlinear conjugate gradients: iterations of the contact solver that converge as many times faster as there are
// bodies in a row.
//
// An iteration changes the impulses by what it takes to be the residual's way down, and forgets where it went before:
// across n bodies it takes about n^2 iterations. Here each goes on, by a share beta, along the direction of the one
// before, as in the method of Fletcher and Reeves (1964); where the residual grows, as where a contact opens or slips,
// the direction is forgotten (Silcowitz, Niebe and Erleben 2010):
//
//      iterate: dx = change of the impulses        beta = |dx|^2 / |dx of the iteration before|^2
//      beta > 1:  p = 0                            else:  p = beta p, x += p, p += dx
//
// |dx|^2 is sum of A_ii dx_i^2 (J), so rows of all units count alike. What x leaves of the cones, the next iteration
// brings back, so it has to end with an iteration.
#ifndef OB_SIM_CONJUGATE_H
#define OB_SIM_CONJUGATE_H

#include "sim/island.h"

// Forgets the direction.
void ob_conjugate_begin(ob_island_work *w);
// Before an iteration over all contacts ..
void ob_conjugate_note(ob_island_work *w);
// .. and after it: goes on along the direction, in the impulses and in u.
void ob_conjugate_go_on(ob_island_work *w);
void ob_conjugate_finish(ob_conjugate *c);

#endif

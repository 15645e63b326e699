// Contacts whose geometry turns: edges, corners and rims on which a body rocks, pivots or rolls under load.
//
// If rows of J are constant, J u = 0 at the end of a partial substep is right for the next one. If they turn, the
// constraint of its start, or of its end, turns a share h of the motion into an approach. It is lost, in every
// partial substep. So bodies with such contacts are moved by halves (Stoermer and Verlet; Hairer, Lubich and Wanner,
// "Geometric Numerical Integration", 2006, section VII.1):
//
//     start ──── free motion, h/2 ────> midpoint ──── free motion, h/2 ────> end
//       J v = 0                           J_mid, arms, inertia                 J u = 0
//                                         v -> u: J_mid u = -c, c = J_mid v - J_start v
//
// At the midpoint the rows already move at c. The impulse reverses that, and turning on the second half of the way
// takes u to the constraint at the end. J_mid (u + v) / 2 = 0, so the impulse does no work. A residual velocity of the
// row at the start is removed, not reversed. Normals may open, and friction may slip, as everywhere.
//
// Contacts take part that carry a load, or are nearer than turning moves their rows, as where a body leaves what it
// rolled over. Their bodies touch no other moving body, and c is noticeable. A partial substep with a hit on such a
// body is of the first order anyway: then it is moved as a whole.
#ifndef OB_SOLVER_MIDPOINT_H
#define OB_SOLVER_MIDPOINT_H

#include "solver/solver.h"

// Marks the contacts that will be found at the midpoint, before the narrow phase, which need not test them.
void ob_midpoint_mark(ob_solver *s);
// Moves bodies with such contacts to the midpoint and finds the contacts there, before the iterations.
void ob_midpoint_begin(ob_solver *s);
// Moves a body that moves to the midpoint, if it is not there yet.
void ob_midpoint_halve(ob_solver *s, uint32_t row);
// Ends it, after the positions are integrated.
void ob_midpoint_end(ob_solver *s);
// Moves the bodies back to the start, where the partial substep turns out to be shorter.
void ob_midpoint_undo(ob_solver *s);

#endif

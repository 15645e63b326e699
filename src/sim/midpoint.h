// Contacts whose geometry turns: edges, corners and rims on which a body rocks, pivots or rolls under load.
//
// Where rows of J stay as they are, J u = 0 at the end of a partial substep is right for the next one. Where they turn,
// the constraint of its start, or of its end, turns a share h of the motion into an approach in every partial substep,
// which is then lost. So bodies with such contacts are moved by halves (Stoermer and Verlet; Hairer, Lubich and Wanner,
// "Geometric Numerical Integration", 2006, section VII.1):
//
//     start ──── free motion, h/2 ────> midpoint ──── free motion, h/2 ────> end
//       J v = 0                           J_mid, arms, inertia                 J u = 0
//                                         v -> u: J_mid u = -c, c = J_mid v - J_start v
//
// At the midpoint the rows already move at c; the impulse reverses that, and what turning brings on the second half of
// the way takes u to the constraint at the end. J_mid (u + v) / 2 = 0, so the impulse does no work. What was left of
// the row's velocity at the start is taken away, not reversed. Normals may open, and friction may slip, as everywhere.
//
// Contacts that carry a load take part, or that are nearer than what turning moves their rows by, as where something
// leaves what it rolled over; of bodies that touch nothing that moves, and only where c is noticeable. A partial substep
// in which something hits such a body is of the first order anyway: then it is moved as a whole.
#ifndef OB_SIM_MIDPOINT_H
#define OB_SIM_MIDPOINT_H

#include "sim/state.h"

// Before the narrow phase: marks the contacts that will be found at the midpoint, which it need not test now.
void ob_midpoint_mark(ob_sim *s);
// Before the iterations: moves bodies with such contacts to the midpoint and finds the contacts there.
void ob_midpoint_begin(ob_sim *s);
// After the positions.
void ob_midpoint_end(ob_sim *s);
// Back to the start, where the partial substep turns out to be shorter.
void ob_midpoint_undo(ob_sim *s);

#endif

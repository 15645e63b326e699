// Newton step on all contacts of an island that has few of them.
//
// Iterations over pairs (solver/contact_solver.h) converge linearly: a body between two others, or on two faces, takes
// dozens of them to rounding. The first ones soon settle the nonlinear part: the points that push, and the contacts
// that stick. Then the rows satisfy
//
//      a point that pushes:      r_n + A dx = 0
//      a contact that sticks:    r_t + A dx = 0
//      one that slides, at t = |slip| / |x_t|:   the slip stays opposite to x_t, whose length is mu times the load,
//                                slip = -t x_t:   dx_t = mu dx_n x_t / |x_t| + y p,  p (r_t + A dx) + t y = 0
//
// with p across x_t (Alart and Curnier 1991). A twist at its limit is proportional to the load as well. The next
// iteration projects impulses back to the cones. So steps and iterations in turn converge quadratically. Right after an
// impact the nonlinear part is not settled, and iterations are used.
#ifndef OB_SOLVER_FEW_CONTACTS_H
#define OB_SOLVER_FEW_CONTACTS_H

#include "solver/island.h"

enum { OB_FEW_CONTACTS = 2 }; // contacts, at most

// Changes impulses and u after an iteration, at most to the place where the first point's impulse reaches zero.
void ob_few_contacts_step(ob_island_work *w);

#endif

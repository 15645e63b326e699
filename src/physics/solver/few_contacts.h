// Newton step on all contacts of an island that has few of them.
//
// Iterations over pairs (solver/contact_solver.h) converge linearly: a body between two others, or on two faces, takes
// dozens of them to rounding. The first ones soon settle the nonlinear part: the points that push, and the contacts
// that stick. Then the rows satisfy
//
//      a point that pushes:      r_n + A dx = 0
//      a contact that sticks:    r_t + A dx = 0
//      one that slides:          dx_t = mu dx_n x_t / |x_t| + y p,  p (r_t + A dx) + t y = 0
//
// with p across x_t (disc_follow in contact/friction.h). A twist at its limit is proportional to the load as well. The
// next iteration projects impulses back to the cones. So steps and iterations in turn converge quadratically. Right
// after an impact the nonlinear part is not settled, and iterations are used.
//
// The path buys 7 to 9 % of the instructions of boxes that land, and two rows of the lab: without it, a cube under 1000
// times its weight sinks 8e-7 m and not 1e-9, and 100 falling boxes gain 2e-7 of their energy and not 1e-8.
#ifndef OB_SOLVER_FEW_CONTACTS_H
#define OB_SOLVER_FEW_CONTACTS_H

#include "solver/island.h"

enum { OB_FEW_CONTACTS = 2 }; // contacts, at most

// Changes impulses and u after an iteration, at most to the place where the first point's impulse reaches zero.
void ob_few_contacts_step(ob_island_work *w);

#endif

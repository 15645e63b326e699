// A step of Newton's method on all contacts of an island that has few of them.
//
// Iterations over pairs (sim/contact_solver.h) converge by a share of what is left in each; a body between two others,
// or on two faces, takes dozens of them to rounding. What is not linear in the law is soon settled by the first ones:
// which points push, and which contacts stick. For these rows
//
//      a point that pushes:      r_n + A dx = 0
//      what sticks:              r_t + A dx = 0
//      what slides, at t = |slip| / |x_t|:   the slip stays opposite to x_t, whose length is mu times the load,
//                                slip = -t x_t:   dx_t = mu dx_n x_t / |x_t| + y p,  p (r_t + A dx) + t y = 0
//
// with p across x_t (Alart and Curnier 1991), and a twist at its limit that goes with the load as well. The next
// iteration brings back to the cones what has left them. So steps and iterations in turn converge quadratically. Where
// something has just hit, that is not settled, and iterations do.
#ifndef OB_SIM_FEW_CONTACTS_H
#define OB_SIM_FEW_CONTACTS_H

#include "sim/island.h"

enum { OB_FEW_CONTACTS = 2 }; // at most

// After an iteration: changes impulses and u, not past the place where the first point lets go.
void ob_few_contacts_step(ob_island_work *w);

#endif

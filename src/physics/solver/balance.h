// Rest as a balance of forces: decides if a slow island may be put to sleep.
//
// Solves two contact problems for the present contacts, one from the present velocities, one from rest:
//
//      stop   M (u - v) = a h + J^T x     u ~ 0: contacts stop every motion. A rolling ball fails here.
//      hold   M u       = a h + J^T x     u ~ 0: contacts carry the external accelerations. A body fails here, slow as
//                                         it is, if its pull is 1.001 of the friction limit, or if it leans beyond its
//                                         edge.
//
// The impulses x press, within their friction cones. The second solution is a proof: its impulses are forces that
// balance.
#ifndef OB_SOLVER_BALANCE_H
#define OB_SOLVER_BALANCE_H

#include "solver/solver.h"

// True if the island may fall asleep after a step: its bodies have been slow for rest_time (s), and its forces balance.
// Tests only now and then, because a test costs about as much as a step. Overwrites u, dv and drift.
bool ob_balance_may_sleep(ob_solver *s, double rest_time);

#endif

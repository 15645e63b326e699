// Rest is a balance of forces: may an island that has become slow be stopped?
//
// Two problems of contact are solved for the contacts as they are, one from the velocities that the bodies have, one
// from rest:
//
//      stop   M (u - v) = a h + J^T x     u ~ 0: whatever moves, contacts stop it. A ball that rolls goes on.
//      hold   M u       = a h + J^T x     u ~ 0: contacts carry the external accelerations. What is pulled by 1.001 of
//                                         what friction holds, or leans beyond its edge, is slow, and goes on.
//
// with impulses x that press, within their friction cones. The second is a proof: such impulses are forces that
// balance.
#ifndef OB_SIM_BALANCE_H
#define OB_SIM_BALANCE_H

#include "sim/state.h"

// True where the island may fall asleep, after a step: its bodies have been slow for rest_time (s), and its forces
// balance. Asked now and then, for it costs about as much as a step. u, dv and drift are lost.
bool ob_balance_may_sleep(ob_sim *s, double rest_time);

#endif

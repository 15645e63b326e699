// Joints of an island through a step. Their rows are in solver/joint_rows.h.
//
// Islands that may touch nothing in the step fly: their motion is free between impulses of the joints (RATTLE: Andersen
// 1983; Leimkuhler and Skeel 1994), so energy has no trend and no row drifts.
//
//     v' = v + M^-1 J^T x, x such that g = 0 after     free flight by v'     v = v' + M'^-1 J'^T y, y such that
//     the flight                                                             J' v = 0
//
// Nine such flights of different lengths, some of them backwards, make a block of the sixth order (Kahan and Li 1997). Short ones
// have five of the fourth order.
// A step has single flights, of the second order, if its joints pull so hard that a block would have to be very short.
//
// In other islands joints are solved between the contacts' iterations. Bodies go half of the way freely; there J u = -J v
// reverses what turning has brought, as for contacts whose geometry turns (solver/midpoint.h), so the joints do no work.
// In the end positions are moved until g = 0, without velocity.
#ifndef OB_SOLVER_JOINTS_H
#define OB_SOLVER_JOINTS_H

#include "solver/solver.h"

// Moves an island without pairs through the whole step. Returns false if it needs more substeps: then
// ob_joints_substeps() of them.
bool ob_joints_fly(ob_solver *s);
// Number of substeps that the joints need, by the forces of the last flight: at most OB_MAX_SUBSTEPS.
uint32_t ob_joints_substeps(const ob_solver *s);
// Number of substeps with twice as many flights of the same order as n have; 0: there are none.
uint32_t ob_joints_finer(const ob_solver *s, uint32_t n);

// Moves bodies with joints to the midpoint of the partial substep, and finds the rows there. Before the iterations.
void ob_joints_begin(ob_solver *s);
// Moves bodies until no joint is violated, after positions are integrated.
void ob_joints_project(ob_solver *s);
// Lets the joint break that the substep has overloaded most. At its end.
void ob_joints_end(ob_solver *s);

// True if no end of a joint is on an object that goes, or may go, by itself.
bool ob_joints_may_rest(const ob_island_work *w);
// Finds the rows with which joints hold bodies at rest in their present poses over a partial substep, after ob_bodies_predict_velocities.
// Adds what acts along axes to the velocities u.
void ob_joints_find_rest(ob_solver *s);

#endif

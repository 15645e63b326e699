// Bodies of an island: loads them, moves them and reports their motions.
#ifndef OB_SOLVER_BODIES_H
#define OB_SOLVER_BODIES_H

#include "solver/solver.h"

static inline void ob_row_add(double *r, ob_vec3 linear, ob_vec3 angular)
{
	r[0] += linear.x, r[1] += linear.y, r[2] += linear.z;
	r[3] += angular.x, r[4] += angular.y, r[5] += angular.z;
}

// Loads the island's bodies in ascending id, then the fixed bodies that they may touch: one row each.
void ob_bodies_load(ob_solver *s, const ob_island_input *in);
// Adds an empty row. Returns it.
uint32_t ob_bodies_add_row(ob_island_work *w);
// Rotation vector (rad, world) from attitude a to b, by less than half a turn.
ob_vec3 ob_turn_between(ob_quat a, ob_quat b);
// Applies the displacement row to the pose, and updates the gaps of contacts that were computed for the old pose. The
// angular velocity turns with the body, so its energy stays.
void ob_body_update_pose(ob_island_work *w, uint32_t row);
// Counts a substep in which the body turned by Euler's equations: equal moments need none.
void ob_body_count_turn(ob_solver *s, uint32_t row);
// Sets the pose; leaves the gaps.
void ob_body_place(ob_body *body, ob_vec3 p, ob_quat q);
// Sets v and the speed bound that follows from it. linear: m/s; angular: rad/s.
void ob_body_set_velocity(ob_island_work *w, uint32_t row, ob_vec3 linear, ob_vec3 angular);
// Updates the speed bounds of bodies that were hit in the partial substep.
void ob_bodies_update_speed_bounds(ob_solver *s);
// Sets dv to the change of velocity by external accelerations and the last impulses, for the present contacts.
void ob_bodies_warm_start(ob_solver *s);
// Sets u = v + dv.
void ob_bodies_predict_velocities(ob_solver *s);
// Moves a body as free flight does between impulses: ob_methods.move.
void ob_body_move(ob_solver *s, uint32_t row, double smooth);
// Moves the bodies through the partial substep. Between impulses each turns as in free flight. u becomes the new v.
void ob_bodies_integrate_positions(ob_solver *s);
// Updates the rest timers after the last substep, in the world frame. Returns the time (s) for which all bodies have
// been slow and in contact.
double ob_bodies_update_rest(ob_solver *s);
// Reports the motions of the island's bodies after the step. rest: OB_MOTION_ASLEEP, OB_MOTION_EQUILIBRIUM, or 0.
void ob_bodies_report(ob_solver *s, uint32_t rest);

#endif

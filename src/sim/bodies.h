// Bodies of an island: loads them from the universe, moves and publishes them.
#ifndef OB_SIM_BODIES_H
#define OB_SIM_BODIES_H

#include "sim/state.h"

// Loads the island's bodies in ascending id, then the fixed bodies that they may touch: one row each.
void ob_bodies_load(ob_sim *s, const ob_island *is);
// Applies the displacement row to the pose, and updates the gaps of contacts that were computed for the old pose. The
// angular velocity turns with the body, so its energy stays.
void ob_body_update_pose(ob_island_work *w, uint32_t row);
// Sets the pose; leaves the gaps.
void ob_body_place(ob_body *body, ob_vec3 p, ob_quat q);
// Sets v and the speed bound that follows from it. linear: m/s; angular: rad/s.
void ob_body_set_velocity(ob_island_work *w, uint32_t row, ob_vec3 linear, ob_vec3 angular);
// Updates the speed bounds of bodies that were hit in the partial substep.
void ob_bodies_update_speed_bounds(ob_sim *s);
// Sets dv to the change of velocity by external accelerations and the last impulses, for the present contacts.
void ob_bodies_warm_start(ob_sim *s);
// Sets u = v + dv.
void ob_bodies_predict_velocities(ob_sim *s);
// Moves the bodies through the partial substep. Between impulses each turns as in free flight. u becomes the new v.
void ob_bodies_integrate_positions(ob_sim *s);
// Updates the rest timers after the last substep, in the world frame. Returns the time (s) for which all bodies have
// been slow and in contact.
double ob_bodies_update_rest(ob_sim *s);
// Publishes the motions of the island's bodies. rest: OB_MOTION_ASLEEP, OB_MOTION_EQUILIBRIUM, or 0.
void ob_bodies_publish(ob_sim *s, uint32_t rest);

#endif

// The bodies of an island: loading them from the universe, moving them, publishing them.
#ifndef OB_SIM_BODIES_H
#define OB_SIM_BODIES_H

#include "sim/state.h"

// Rows of the island's bodies in ascending id, then those of the fixed bodies that they may touch.
void ob_bodies_load(ob_sim *s, const ob_island *is);
// Brings a pose up to date with its displacement row, and the gaps of the contacts that know the old pose. Its rate
// turns with it, so its energy stays.
void ob_body_update_pose(ob_island_work *w, uint32_t row);
// Sets the pose, without a change of gaps.
void ob_body_place(ob_body *body, ob_vec3 p, ob_quat q);
// v, and with it the bound of its speed
void ob_body_set_velocity(ob_island_work *w, uint32_t row, ob_vec3 linear, ob_vec3 angular);
// Speed bounds anew of bodies that were hit in the partial substep.
void ob_bodies_update_speed_bounds(ob_sim *s);
// dv: what external acceleration and the last impulses will bring, where the contacts are now.
void ob_bodies_warm_start(ob_sim *s);
// u = v + dv
void ob_bodies_predict_velocities(ob_sim *s);
// Moves the bodies through the partial substep: between impulses each turns as in free flight. u becomes the new v.
void ob_bodies_integrate_positions(ob_sim *s);
// After the last substep, in the world's frame of reference: rest timers. Returns for how long (s) all bodies have been
// slow and touched something.
double ob_bodies_update_rest(ob_sim *s);
// rest: OB_MOTION_ASLEEP, OB_MOTION_EQUILIBRIUM, or 0
void ob_bodies_publish(ob_sim *s, uint32_t rest);

#endif

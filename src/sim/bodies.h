// The bodies of an island: loading them from the universe, moving them, publishing them.
#ifndef OB_SIM_BODIES_H
#define OB_SIM_BODIES_H

#include "sim/state.h"

// Rows of the island's bodies in ascending id, then those of the fixed bodies that they may touch.
void ob_bodies_load(ob_sim *s, const ob_island *is);
// Brings a pose up to date with its displacement row, and the gaps of the contacts that know the old pose.
void ob_body_update_pose(ob_island_work *w, uint32_t row);
// Gyroscopic change of the angular velocities v over a partial substep.
void ob_bodies_gyroscopic_step(ob_sim *s);
// Speed bounds anew, after impacts have changed v.
void ob_bodies_update_speed_bounds(ob_sim *s);
// dv: what external acceleration and the last impulses will bring, where the contacts are now.
void ob_bodies_warm_start(ob_sim *s);
// u = v + dv
void ob_bodies_predict_velocities(ob_sim *s);
// Displacements over the partial substep; u becomes the new v.
void ob_bodies_integrate_positions(ob_sim *s);
// After the last substep: rest timers. true: the island falls asleep, as each of its bodies has been slow for long
// enough.
bool ob_bodies_update_rest(ob_sim *s);
// rest: OB_MOTION_ASLEEP, OB_MOTION_EQUILIBRIUM, or 0
void ob_bodies_publish(ob_sim *s, uint32_t rest);

#endif

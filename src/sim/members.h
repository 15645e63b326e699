// Loading an island's members from the universe, moving them, and publishing them.
#ifndef OB_SIM_MEMBERS_H
#define OB_SIM_MEMBERS_H

#include "sim/state.h"

void ob_bodies_load(ob_sim *s, const ob_island *is);
// Brings poses up to date with the displacement rows (and the gaps of the touches that know the old poses).
void ob_body_update_pose(ob_island_work *w, uint32_t row);
// Gyroscopic change of the rate over one substep.
void ob_bodies_gyroscopic_step(ob_sim *s);
// Speeds anew, after impacts have changed v.
void ob_bodies_update_speed_bounds(ob_sim *s);
// dv: what the pull and the last substep's impulses will bring, where the touches are now.
void ob_bodies_warm_start(ob_sim *s);
// u = v + dv
void ob_bodies_predict_velocities(ob_sim *s);
// Displacements over the substep; u becomes the new v.
void ob_bodies_integrate_positions(ob_sim *s);
// After the last substep: rest timers, sleep by consent.
bool ob_bodies_update_rest(ob_sim *s);
// rest: OB_MOTION_ASLEEP, OB_MOTION_EQUILIBRIUM, or 0
void ob_bodies_publish(ob_sim *s, uint32_t rest);

#endif

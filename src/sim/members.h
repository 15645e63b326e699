// Loading an island's members from the universe, moving them, and publishing them.
#ifndef OB_SIM_MEMBERS_H
#define OB_SIM_MEMBERS_H

#include "sim/worker.h"

void ob_members_load(ob_sim *s, const ob_island *is);
// Brings poses up to date with the displacement rows (and the gaps of the touches that know the old poses).
void ob_member_settle(ob_island_work *w, uint32_t row);
// Gyroscopic change of the rate over one substep.
void ob_members_gyrate(ob_sim *s);
// Speeds anew, after impacts have changed v.
void ob_members_quicken(ob_sim *s);
// dv: what the pull and the last substep's impulses will bring, where the touches are now.
void ob_members_foretell(ob_sim *s);
// u = v + dv
void ob_members_predict(ob_sim *s);
// Displacements over the substep; u becomes the new v.
void ob_members_advance(ob_sim *s);
// After the last substep: quiet times, sleep by consent.
bool ob_members_rest(ob_sim *s);
// rest: OB_MOTION_ASLEEP, OB_MOTION_STILL, or 0
void ob_members_publish(ob_sim *s, uint32_t rest);
// What holds after the running step, of an object that must be visited in the next: claims bounds for that, from its
// state at the step's end, and hands m over.
void ob_member_publish(ob_sim *s, uint32_t id, ob_motion *m, const ob_state *end);
// Writes what the arranger needs to know (ob_brief), and stages m with the claimed bounds.
void ob_member_hand_over(ob_sim *s, uint32_t id, ob_motion *m, uint32_t state, uint32_t due);

#endif

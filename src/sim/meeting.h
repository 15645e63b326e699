// Two bodies in flight that may meet within the step: their hits are made at their instants, like impacts on planes,
// and each goes on as a flight. No substeps, and no frame: two that fall alike are straight on their way to each other.
#ifndef OB_SIM_MEETING_H
#define OB_SIM_MEETING_H

#include "sim/state.h"

// Moves two objects without contacts, and near nothing but each other and planes, through the running step, and
// publishes their motions. false: the contact solver must do it, and nothing was changed.
bool ob_meeting_advance(ob_sim *s, const uint32_t id[2]);

#endif

// An island at rest is made in one substep, and looked through for whether that holds.
//
// Substeps resolve what changes within a step. Where nothing does, the impulses of the last step, taken for the whole of
// this one, leave every contact as it is: the first round of exchanges finds nothing to do, nothing has to be pushed
// apart, and that is the proof. If there is something, the island is solved from the step's start with the run's
// substeps, as if this had not been tried:
//
//   all members calm? ── one substep ── did it find nothing to do? ──> stands, calm
//        │ no                                 │ no
//        └────────── the run's substeps <─────┘ ── did none find anything to do? ──> calm the next time
//
// Which members are calm is published with their motions: the same for any worker.
#ifndef OB_SIM_CALM_H
#define OB_SIM_CALM_H

#include "sim/state.h"

// Have all members been calm, so that one substep is worth a try?
bool ob_equilibrium_likely(const ob_sim *s, const ob_island *is);
// Did the contacts of the step that was just made find nothing to do?
bool ob_equilibrium_confirmed(const ob_island_work *w);
// Is the island in equilibrium? Its contacts hold what pulls at it and nothing moves, to 1e-7 m/s: the next step would find
// the same. So there is none, until something comes near; whether or not the run lets what is slow fall asleep.
bool ob_equilibrium_reached(const ob_island_work *w);
// Is a member calm after a step that was?
bool ob_equilibrium_body_steady(const ob_island_work *w, uint32_t row);

#endif

// What the last worker to arrive does before the gate opens again.
//
//   ┌─> plan ──> ISLANDS ──> [MEMBERS: perceive] ──> MEETINGS ──> commit ──> [MEMBERS: adopt] ──> step complete ─┐
//   │              ^                                    │                                                        │
//   │              └──── unite islands that met <───────┘                                              [pause] <─┘
//   │                                                                                                     │
//   └──────────────── MEETINGS: forecast alone <──── [MEMBERS: perceive, at start and after requests] <───┘
//
// Phases in which nobody has anything to do are skipped, and a few pairs are checked by the arranger itself.
#ifndef OB_SIM_STEP_H
#define OB_SIM_STEP_H

#include "sim/state.h"

// What a MEMBERS or MEETINGS phase belongs to.
enum { OB_STAGE_START, OB_STAGE_SOLVED, OB_STAGE_COPY };

void ob_schedule_next_phase(ob_sim *s, ob_phase finished);

#endif

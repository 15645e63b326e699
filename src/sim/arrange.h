// What the last worker to arrive does before the gate opens again.
//
//   a step:      ISLANDS ──> [MEMBERS: adopt, perceive] ──> step complete ──> [pause] ──> plan ──> ISLANDS ...
//                                                                              ^            │
//   at start, after requests, or when boxes are too small:      MEMBERS: perceive <─────────┘
//
// MEMBERS is skipped where nobody has anything to adopt or to look for. All functions work on the universe alone.
#ifndef OB_SIM_ARRANGE_H
#define OB_SIM_ARRANGE_H

#include "table/table.h"

void ob_arrange(ob_universe *u, ob_phase finished);

#endif

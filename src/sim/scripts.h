// The phase of the step in which objects' scripts run, before anything moves.
//
// What they read is as the step before has left it. What they ask for takes place when all of them have run, in the
// order of their cells (table/script_data.h), so it does not matter which worker ran which: forces, pushes and colours
// of their own objects, then messages, which their addressees get before the next step, and creations and removals,
// which the host carries out at once, at a pause.
#ifndef OB_SIM_SCRIPTS_H
#define OB_SIM_SCRIPTS_H

#include "sim/state.h"

// The scheduling worker's. Whether a script is due before the coming step; lists those that are, once for each step.
bool ob_scripts_due(ob_universe *u);
// After they have run: carries out what they have asked for. true: an object moves, or will, otherwise than was known.
bool ob_scripts_carry_out(ob_sim *s);
// Whether the host has creations and removals to carry out now.
bool ob_scripts_have_requests(const ob_universe *u);

// A worker's: runs those of the list that it gets.
void ob_scripts_run(ob_sim *s);

#endif

// The phase of the step in which objects' scripts run, before anything moves.
//
// Scripts read the state after the step before. Their requests are carried out when all of them have run, in the order
// of their cells (table/step_data.h), so the assignment to workers does not matter. First come forces, pushes and
// colours of their own objects, then messages, which are received before the next step. Last are creations and
// removals, which the host carries out at once, at a pause.
#ifndef OB_STEP_SCRIPTS_H
#define OB_STEP_SCRIPTS_H

#include "step/state.h"

// Lists the scripts due before the coming step, once for each step; the scheduling worker calls it. true: there are
// some, or the host wants a pause when they have run.
bool ob_scripts_due(ob_universe *u);
// True once it has been called for the coming step.
bool ob_scripts_had_run(const ob_universe *u);
// Makes it as if it had not been called, where the step fails before the scripts run.
void ob_scripts_forget(ob_universe *u);
// Carries out the scripts' requests after they have run. true: the motion of an object changes, now or later.
bool ob_scripts_carry_out(ob_sim *s);
// True if the host has creations and removals to carry out now, or wants the pause.
bool ob_scripts_have_requests(const ob_universe *u);

// Runs this worker's share of the list.
void ob_scripts_run(ob_sim *s);

#endif

// The baseline architecture: one simulator, an ODE world, owns every object and publishes all their motions each step.
// It reads passports and first motions from the universe, so that objects come and go as they do for object
// simulators. Its one worker calls it; no other worker of the universe runs an object.
#ifndef OB_SIM_ODE_BASELINE_H
#define OB_SIM_ODE_BASELINE_H

#include "table/table.h"

typedef struct ob_ode_baseline ob_ode_baseline;

// In the worker's own thread, after the objects have been placed. Runs for the settings of the universe. NULL: no
// memory.
ob_ode_baseline *ob_ode_baseline_create(ob_universe *u);
void ob_ode_baseline_destroy(ob_ode_baseline *m); // NULL is allowed

// One step: takes in and drops objects as the passports say, steps, publishes all motions as of step
// ob_step_count(u) + 1, writes the touching pairs to the step data, and
// notes those that have begun to touch for their scripts. Completing the step is left to the caller.
// What goes wrong fails the step (ob_step_failed).
void ob_ode_baseline_step(ob_ode_baseline *m);
// Between two steps: gives an object an impulse (N s) at its centre, and one of rotation (N m s).
void ob_ode_baseline_kick(ob_ode_baseline *m, uint32_t id, ob_vec3 impulse, ob_vec3 twist);
// Of the last step: dynamic objects that are not asleep; pairs that touch.
uint32_t ob_ode_baseline_awake(const ob_ode_baseline *m);
uint32_t ob_ode_baseline_pairs(const ob_ode_baseline *m);
// Of all steps: ob_ode_world_box_tests.
uint64_t ob_ode_baseline_box_tests(const ob_ode_baseline *m);

#endif

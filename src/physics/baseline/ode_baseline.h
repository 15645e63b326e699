// The baseline architecture: one simulator, an ODE world, owns every object and publishes all their motions each step.
// It reads passports and first motions from the universe, so that objects come and go as they do for object
// simulators. Its one worker calls it; no other worker of the universe runs an object.
#ifndef OB_BASELINE_ODE_BASELINE_H
#define OB_BASELINE_ODE_BASELINE_H

#include "table/table.h"

typedef struct ob_ode_baseline ob_ode_baseline;

// Creates the baseline, in the worker's own thread, after the objects have been placed, with the universe's settings.
// NULL: no memory.
ob_ode_baseline *ob_ode_baseline_create(ob_universe *u);
void ob_ode_baseline_destroy(ob_ode_baseline *m); // NULL is allowed

// Runs one step. Takes in and drops objects as the passports say, steps, and publishes all motions as of step
// ob_step_count(u) + 1. Writes the touching pairs to the step data, and notes those that have begun to touch for their
// scripts. The caller completes the step. An error fails the step (ob_step_failed).
void ob_ode_baseline_step(ob_ode_baseline *m);
// Applies, between two steps, an impulse (N s) at the object's centre and an angular impulse (N m s).
void ob_ode_baseline_kick(ob_ode_baseline *m, uint32_t id, ob_vec3 impulse, ob_vec3 twist);
// Counts of the last step: dynamic objects that are not asleep; pairs that touch.
uint32_t ob_ode_baseline_awake(const ob_ode_baseline *m);
uint32_t ob_ode_baseline_pairs(const ob_ode_baseline *m);
// Sum over all steps: ob_ode_world_box_tests.
uint64_t ob_ode_baseline_box_tests(const ob_ode_baseline *m);

#endif

// Contacts that begin in a step, noted for the scripts of the bodies that touch: their on_contact is called before the
// next step (sim/scripts.h). By the solver of a body's island (commit.h), or by the
// one ODE world.
#ifndef OB_SIM_TOUCHES_H
#define OB_SIM_TOUCHES_H

#include "sim/state.h"

// Forgets what an attempt to solve the island has noted.
void ob_touches_begin(ob_sim *s, const ob_island *is);
// The two began to touch, at this point (m), with so much more of a normal impulse (N s).
void ob_touches_note(ob_universe *u, uint32_t a, uint32_t b, double impulse, ob_vec3 point);
// After each partial substep: what it has added to the contacts that began in this step.
void ob_touches_note_solved(ob_sim *s);
// An impact of this contact, whose bodies moved so before and move so now (index into both: slot).
void ob_touches_note_impact(ob_sim *s, const ob_impact_instant *i);

#endif

// The equilibrium test: an island at rest is solved in one substep, and that is checked.
//
// Substeps resolve what changes within a step. Where nothing does, the impulses of the last step, taken for the whole
// of this one, leave every contact as it is: the first iteration of the contact solver changes no velocity, no
// penetration is projected, and that is the proof. If there is a residual, the island is solved from the step's start
// with the run's substeps, as if this had not been tried:
//
//   all bodies steady? ── one substep ── residual below the threshold? ──> stands, steady
//        │ no                                 │ no
//        └────────── the run's substeps <─────┘ ── residuals below the threshold? ──> steady the next time
//
// Which bodies are steady is published with their motions: the same for any worker.
#ifndef OB_SIM_EQUILIBRIUM_H
#define OB_SIM_EQUILIBRIUM_H

#include "sim/state.h"

// True where all bodies have been steady, so that one substep is worth a try.
bool ob_equilibrium_likely(const ob_sim *s, const ob_island *is);
// True where the contacts of the step that was just made had no residual.
bool ob_equilibrium_confirmed(const ob_island_work *w);
// True where the next step is expected to have none: this one had none, or, of a body alone on what stands, its last
// partial substep. Among others rest comes little by little; what moves as it is told does something else each time.
bool ob_equilibrium_expected(const ob_island_work *w);
// True where the island is in equilibrium: its contacts carry the external accelerations and nothing moves, to 1e-7
// m/s, so the next step would find the same. It is not solved until something comes near, whether or not the run lets
// slow islands fall asleep.
bool ob_equilibrium_reached(const ob_island_work *w);
// True where a body is steady after a step that has led to an equilibrium.
bool ob_equilibrium_body_steady(const ob_island_work *w, uint32_t row);

#endif

// Equilibrium test: solves an island at rest in one substep, and checks that this suffices.
//
// Substeps resolve changes within a step. In an island at rest nothing changes: the impulses of the last step, taken
// for the whole of this one, leave every contact as it is. Proof: the first iteration of the contact solver changes no
// velocity, and no penetration is projected. If there is a residual, the island is solved from the step's start with
// the run's substeps, as if nothing had been tried:
//
//   all bodies steady? ── one substep ── residual below the threshold? ──> stands, steady
//        │ no                                 │ no
//        └────────── the run's substeps <─────┘ ── residuals below the threshold? ──> steady the next time
//
// Steady bodies are marked in their published motions: the same for any worker.
#ifndef OB_SOLVER_EQUILIBRIUM_H
#define OB_SOLVER_EQUILIBRIUM_H

#include "solver/solver.h"

// True if all bodies have been steady, so that one substep is worth a try.
bool ob_equilibrium_likely(const ob_solver *s, const ob_island_input *in);
// True if the contacts of the step just made had no residual.
bool ob_equilibrium_confirmed(const ob_island_work *w);
// True if the next step is expected to have no residual: this step had none. For a body alone, on fixed ones, the last
// partial substep suffices. Several bodies come to rest little by little, and driven surfaces act differently each
// time: there, the whole step counts.
bool ob_equilibrium_expected(const ob_island_work *w);
// True if the island is in equilibrium: its contacts and joints carry the external accelerations and nothing moves, to
// 1e-7 m/s. So the next step would find the same. The island is not solved until something comes near, even if the run does not
// put slow islands to sleep.
bool ob_equilibrium_reached(const ob_solver *s);
// True if a body is steady after a step that has led to an equilibrium.
bool ob_equilibrium_body_steady(const ob_island_work *w, uint32_t row);

#endif

// An island at rest is made in one substep, and looked through for whether that holds.
//
// Substeps resolve what changes within a step. Where nothing does, the impulses of the last step, taken for the whole of
// this one, leave every contact as it is: the first round of exchanges finds nothing to do, nothing has to be pushed apart, and that is the proof. If it
// finds more, the island is solved from the step's start with the run's substeps, as if this had not been tried:
//
//   all members slow? ── one substep ── first round changed next to nothing? ──> stands
//        │ no                                  │ no
//        └──────────── the run's substeps <────┘
//
// A function of published state: the same for any worker.
#ifndef OB_SIM_CALM_H
#define OB_SIM_CALM_H

#include "sim/worker.h"

// Is one substep worth a try?
bool ob_calm_likely(const ob_sim *s, const ob_island *is);
// After it: did it change nothing?
bool ob_calm_proven(const ob_sim *s);

#endif

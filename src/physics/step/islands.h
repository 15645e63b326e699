// Moves islands of the universe through one step: reads an island for the solver (solver/solver.h), solves it and hands
// over its results, or advances it in closed form.
//
//   step ── ballistic advance, where that suffices: many lone bodies side by side, or a pair
//     └── read bodies and contacts
//     └── substeps, of equal length: the run's number, as many as the tolerance needs (solver/error_control.h), or one
//     │   in equilibrium (solver/equilibrium.h)
//     │     └── partial substeps, where fast bodies touch (solver/adaptive_substep.h)
//     │           narrow phase, warm start, impacts, contact solver, free motion to the end, position projection
//     └── hand over contacts, publish bodies
#ifndef OB_STEP_ISLANDS_H
#define OB_STEP_ISLANDS_H

#include "step/flight.h"
#include "step/state.h"

enum { OB_ISLANDS_ABREAST = OB_COURSES };
// Regions of terrain near an island, at most: the first, and the second for each member.
enum { OB_SURFACES_OF_AN_ISLAND = 8192, OB_SURFACES_OF_A_BODY = 64 };

// Advances, side by side, those of n islands (up to OB_ISLANDS_ABREAST) from `first` on that have one body in ballistic
// flight through the coming step, and stages their motions. flown: [n], true: it is done.
void ob_islands_fly(ob_sim *s, uint32_t first, uint32_t n, bool *flown);
// Moves island i of the universe, which has not flown, through the coming step, hands over its contacts and stages its
// bodies' motions. Results follow from published state alone: the same bits on any worker, whatever flies beside it.
void ob_island_advance(ob_sim *s, uint32_t i);

// Memory for the solver's input (ob_island_scratch), and what the solver asks of this worker.
bool ob_island_scratch_create(ob_sim *s);
void ob_island_scratch_finish(ob_sim *s);
ob_island_calls ob_island_calls_of(ob_sim *s);

#endif

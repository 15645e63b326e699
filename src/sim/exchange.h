// Exchanges: how impulses pass between the members of an island within one substep.
//
// Coloured: in each colour a body stands in at most one pair, so each pair is solved with true masses on what was
// published last, and publishes. Jacobi: all pairs are solved on the same published state, each with its share of its
// bodies' masses (the mass split by the number of contacts), and all changes are published together.
// Ghost and lagged: each member of a pair solves for itself (sim/ghost.h).
#ifndef OB_SIM_EXCHANGE_H
#define OB_SIM_EXCHANGE_H

#include "sim/state.h"

// Impacts with restitution at their instants: changes v, shifts d. true if there were any.
bool ob_solver_impacts(ob_sim *s);
// The first instant (s into the stride) at which two bodies rebound of which one turns noticeably until then; infinity:
// none. Their contacts will be looked at anew.
double ob_solver_first_rebound(ob_sim *s);
// Takes back what the prediction made of impacts.
void ob_solver_limit_prediction(ob_sim *s);
// Rounds of exchanges on u until no pair changes a velocity noticeably.
void ob_solver_iterate(ob_sim *s);
// A velocity of the row has changed noticeably in that pass: its pairs are due in it, if their turn is still to come, and
// in the next.
void ob_solver_activate(ob_island_work *w, uint32_t row, uint32_t pass);
// Pushes penetrations apart in d.
void ob_solver_project_positions(ob_sim *s);

#endif

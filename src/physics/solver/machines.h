// Bodies that joints link, hit as one: an impulse on one of them changes the velocities of all.
//
//        o──o──o     hit     raw change of the body that is hit     joints' share      changes of all
//              ↑    ────>           (contact/impact.h)              ────────────>      along no row
//
// The joints' rows are those at the instant of the hit. That is for hits with restitution. A plastic hit needs no joints, for the contact solver goes on until all have stopped.
#ifndef OB_SOLVER_MACHINES_H
#define OB_SOLVER_MACHINES_H

#include "solver/solver.h"

enum { OB_NO_SLOT = UINT32_MAX };

// Finds the machines, as partial substeps begin: a body without joints is one alone. No set has begun.
void ob_machines_find(ob_island_work *w);
// Hits of the machines of these two bodies belong to one set; the body that stands for the set of a body's machine.
void ob_machines_join(ob_impacts *x, uint32_t a, uint32_t b);
uint32_t ob_machines_set(ob_impacts *x, uint32_t row);
// Adds the joints' share to changes of velocities in the set (ob_impact_links). solver: ob_solver.
void ob_machines_share(void *solver, ob_impact_change *change);
// Adds the joints' share of the set that was solved last, if they had one, to their loads.
void ob_machines_note_loads(ob_island_work *w);

#endif

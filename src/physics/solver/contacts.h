// Contact constraints of an island: pairs in contact, their geometry, and the lane of the batch in which each is
// solved.
//
// Contacts are coloured so that no two of a colour share a moving body. So a colour's batches hold each moving body
// once, and all lanes of a batch can be solved at the same time.
#ifndef OB_SOLVER_CONTACTS_H
#define OB_SOLVER_CONTACTS_H

#include "solver/solver.h"

// Loads the contacts of the island's pairs, with the impulses at the end of the step before.
void ob_contacts_load(ob_solver *s, const ob_island_input *in);
// Loads the next contact, whose a and b are set.
void ob_contact_load(ob_solver *s, const ob_island_pair *pair);
// Runs the narrow phase for every pair whose geometry may change within the time ahead (s; 0: has changed), judged by
// the motion of its bodies so far and to come. Impulses stay with their points. Returns true if any geometry was
// updated.
bool ob_contacts_update(ob_solver *s, double ahead);
// Does the same after impacts, for bodies hit in the partial substep: only their motion has changed.
bool ob_contacts_update_hit(ob_solver *s, double ahead);
// Sets the points m of a contact with a lane, found for an instant within the partial substep; gaps: at its start. pa,
// pb: centres at that instant. The geometry stays until the narrow phase runs in the next partial substep.
void ob_contact_set_geometry(ob_solver *s, ob_contact *contact, const ob_manifold *m, ob_vec3 pa, ob_vec3 pb);
// Updates the geometry of one contact to the present poses.
void ob_contact_find(ob_solver *s, ob_contact *contact);
// Returns the smallest gap (m) of a contact with a lane, at present.
double ob_contact_gap(const ob_island_work *w, const ob_contact *contact);
// True if the contact has a lane and may close within the partial substep.
bool ob_contact_in_reach(const ob_island_work *w, const ob_contact *contact);
// Prepares batches for the contact solver: sorts them by colour, updates their matrices.
void ob_contacts_prepare(ob_solver *s);
// Reports the contacts' states.
void ob_contacts_report(ob_solver *s);

#endif

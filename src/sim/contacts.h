// The contact constraints of an island: which pairs touch, where, and in which lane of which batch they are solved.
//
// Contacts are coloured so that no two of a colour share a moving body: a colour's batches hold each moving body once,
// and all lanes of a batch can be solved at the same time.
#ifndef OB_SIM_CONTACTS_H
#define OB_SIM_CONTACTS_H

#include "sim/state.h"

// The contacts of the island's pairs, with the impulses that they had when the step before ended.
void ob_contacts_load(ob_sim *s, const ob_island *is);
// Narrow phase for every pair whose geometry may change within the time ahead (s; 0: has changed), by how far its
// bodies have moved and will move. Impulses stay with the points that they belong to. true: there were some.
bool ob_contacts_update(ob_sim *s, double ahead);
// The same, after impacts, for what was hit in the partial substep: nothing else moves otherwise than before.
bool ob_contacts_update_hit(ob_sim *s, double ahead);
// Gives a contact, which has a lane, the points m as of an instant within the partial substep, with their gaps as of its
// start; pa, pb: centres then. It keeps them until the next partial substep, where the narrow phase looks at it again.
void ob_contact_set_geometry(ob_sim *s, ob_contact *contact, const ob_manifold *m, ob_vec3 pa, ob_vec3 pb);
// Finds the geometry of one contact now.
void ob_contact_find(ob_sim *s, ob_contact *contact);
// m: how far the nearest points of a contact that has a lane are apart now.
double ob_contact_gap(const ob_island_work *w, const ob_contact *contact);
// Has it a lane, and may it close within the partial substep?
bool ob_contact_in_reach(const ob_island_work *w, const ob_contact *contact);
// Batches in order of colour, matrices up to date: ready for the contact solver.
void ob_contacts_prepare(ob_sim *s);
void ob_contacts_store(ob_sim *s);

#endif

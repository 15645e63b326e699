// The touches of an island: which pairs are in contact, where, and in which lane of which batch they are solved.
#ifndef OB_SIM_TOUCH_H
#define OB_SIM_TOUCH_H

#include "sim/state.h"

void ob_contacts_load(ob_sim *s, const ob_island *is);
// Looks again at every pair whose geometry may change within the time ahead (s; 0: has changed), by the way that its
// members have made and will make. true: there were some.
bool ob_contacts_update(ob_sim *s, double ahead);
// Batches in order of colour, matrices up to date: ready for exchanges.
void ob_contacts_prepare(ob_sim *s);
void ob_contacts_store(ob_sim *s);

#endif

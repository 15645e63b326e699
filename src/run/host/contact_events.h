// Contacts that begin and end while a program leads a run: the pairs that touch after a step, compared with those before.
//
// Thread-safety: the thread that goes and waits, between a wait and the next go.
#ifndef OB_HOST_CONTACT_EVENTS_H
#define OB_HOST_CONTACT_EVENTS_H

#include <ob/control.h>

enum { OB_CONTACT_EVENTS_MAX = 1 << 20 }; // Limit of those waiting to be fetched; later ones are counted as lost

typedef struct ob_contact_events ob_contact_events;

// Begins with the pairs that touch now. NULL: out of memory.
ob_contact_events *ob_contact_events_create(const ob_universe *u);
void ob_contact_events_destroy(ob_contact_events *c); // NULL is allowed
// After a step: adds an event for each pair that began or ended to touch, by ascending ids. silent: adds none, as the
// universe was put back. false: out of memory.
bool ob_contact_events_look(ob_contact_events *c, const ob_universe *u, bool silent);
// Takes the oldest events; returns their number. lost: number of events lost before them.
size_t ob_contact_events_take(ob_contact_events *c, ob_contact_event *out, size_t max, uint64_t *lost);

#endif

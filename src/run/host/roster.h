// The roster: all objects that exist now, with their names and workers. For threads of the host's own process
// (renderer, recorder, command line); other processes read the passports in the universe.
//
// A snapshot is immutable; a change publishes a new one under RCU (liburcu, membarrier flavour) and frees the old one
// when its last reader has left. Readers copy out, never wait, and may be any number of threads. A thread registers
// with RCU at its first read, and is unregistered when it ends. One writer at a time.
#ifndef OB_HOST_ROSTER_H
#define OB_HOST_ROSTER_H

#include <ob/universe.h>

typedef struct ob_roster_entry {
	uint32_t id, generation;
	uint32_t origin; // connection whose request has added it (host/request.h); 0: none
	uint8_t script; // 1 + its number in the scene; 0: none
	bool own_worker; // its number is the id; else one of a pool, whichever claims the object's island
	char name[OB_NAME_MAX];
} ob_roster_entry;

// True if the object is a visitor's avatar: what visitors create themselves has no script.
static inline bool ob_is_avatar(const ob_roster_entry *entry)
{
	return entry->origin > 0 && entry->script > 0;
}

typedef struct ob_roster ob_roster;

ob_roster *ob_roster_create(void); // empty; NULL: out of memory
// All readers must have left.
void ob_roster_destroy(ob_roster *r);
// Writer: replaces the whole roster by n entries, ascending by id; they are copied. false: out of memory.
bool ob_roster_publish(ob_roster *r, const ob_roster_entry *entries, size_t n);

// Readers. number: grows with each publication, so that a reader can detect a change.
uint64_t ob_roster_number(const ob_roster *r);
// copy: the first max entries, ascending by id; returns the number of entries (may exceed max).
size_t ob_roster_copy(const ob_roster *r, ob_roster_entry *out, size_t max);
// false: no object of this id exists now
bool ob_roster_find(const ob_roster *r, uint32_t id, ob_roster_entry *out);

#endif

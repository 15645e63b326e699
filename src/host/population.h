// Which objects exist: those of the scene, added and removed by its timetable, and those added and removed on request.
// Writes passports, places objects, and keeps the roster up to date.
//
// Thread-safety: the host's thread only, and only while the universe is starting or paused; but requests may be pushed by
// any thread at any time.
#ifndef OB_HOST_POPULATION_H
#define OB_HOST_POPULATION_H

#include "host/hulls.h"
#include "host/request.h"
#include "host/request_log.h"
#include "host/roster.h"
#include "scene/scene.h"
#include "table/table.h"

// Requests to add, remove or colour objects, or to send them a message, kept until the next step boundary: a wait-free queue of liburcu. Any number of
// threads push, one takes.
typedef struct ob_requests ob_requests;

ob_requests *ob_requests_create(void); // NULL: out of memory
void ob_requests_destroy(ob_requests *q);
bool ob_requests_push(ob_requests *q, const ob_request *r); // false: out of memory
bool ob_requests_take(ob_requests *q, ob_request *out); // oldest first; false: none
bool ob_requests_waiting(ob_requests *q);

typedef struct ob_population ob_population;

// true if the definition is valid: known shape, finite numbers, mass where it moves. e says what is not.
bool ob_object_check(const ob_object_def *def, ob_error *e);

// Slots 0 .. scene->objects-1 are the scene's; the rest of the table is for objects added later. All three must outlive
// it. Writes the scene's hulls. NULL and e: out of memory, of the system or of /dev/shm.
ob_population *ob_population_create(const ob_scene *scene, ob_universe *u, ob_roster *r, ob_error *e);
void ob_population_destroy(ob_population *p);

// The mesh of the scene that an object which comes from outside asks to look like, into its passport; a number that is
// there already is not believed. false and e: the scene has none of this kind. Any thread.
bool ob_population_find_look(const ob_population *p, ob_object_def *def, ob_error *e);

// Before the first step: requests that are to be carried out, each in its place. false: no memory.
bool ob_population_replay(ob_population *p, const ob_journal_entry *entry, size_t count);
// Requests that are carried out for the first time are logged from now on; NULL: no more.
void ob_population_set_log(ob_population *p, ob_request_log *log);
// Carries out what the timetable has due at this step or before, then the requests. true: objects were added or removed.
bool ob_population_update(ob_population *p, uint64_t step, ob_requests *q);
// For a checkpoint in memory (table/checkpoint.h): keeps what it knows beside the universe, and puts it back. What the
// timetable, scripts and requests do after that is done again by a run that begins anew there (host/journal.h).
bool ob_population_keep(ob_population *p); // false: out of memory
void ob_population_put_back(ob_population *p);
// True if another checkpoint is due: much would be done again, or there was no memory to note it.
bool ob_population_is_checkpoint_due(const ob_population *p);
// The next step at which something is due; UINT64_MAX: never.
uint64_t ob_population_next_step(const ob_population *p);

// What of it is saved with a universe, beside the scene: 8 bytes a slot.
typedef struct ob_saved_slot {
	uint32_t generation; // of its latest object
	uint8_t use; // 0 = free, 1 = reserved: the timetable has another event for it, 2 = present
	uint8_t removal_scheduled; // 1 = the timetable will remove its object
	uint8_t created; // 1 = by a script
	uint8_t zero;
} ob_saved_slot;

typedef struct ob_saved_population {
	uint64_t events; // of the timetable, that have been carried out
	uint32_t count; // slots that were ever used, or will be by the timetable: the scene's at least
	ob_saved_slot *slot; // [count]
	uint32_t hulls; // that have come since the run began
	ob_hull_corners *hull; // [hulls]
} ob_saved_population;

// Fills in events, count and hulls, for the arrays to be made; then the arrays.
void ob_population_count_saved(const ob_population *p, ob_saved_population *out);
void ob_population_save(const ob_population *p, ob_saved_population *out);
// Instead of the first update, after ob_universe_load. false and e: it is not that of this scene and universe.
bool ob_population_load(ob_population *p, const ob_saved_population *s, ob_error *e);

#endif

// Population of a universe: objects of the scene, added and removed by its timetable, and objects added and removed on
// request. Writes passports, places objects, and keeps the roster up to date.
//
// Thread-safety: the host's thread only, and only while the universe is starting or paused; but requests may be pushed by
// any thread at any time.
#ifndef OB_HOST_POPULATION_H
#define OB_HOST_POPULATION_H

#include "host/given_paths.h"
#include "host/hulls.h"
#include "host/pull.h"
#include "host/request.h"
#include "host/request_log.h"
#include "host/roster.h"
#include "scene/scene.h"
#include "table/table.h"

typedef struct ob_population ob_population;

// Slots 0 .. scene->objects-1 are the scene's; the rest of the table is for objects added later. All three must outlive
// it. Writes the scene's hulls. NULL and e: out of memory, of the system or of /dev/shm.
ob_population *ob_population_create(const ob_scene *scene, ob_universe *u, ob_roster *r, ob_error *e);
void ob_population_destroy(ob_population *p);

// Finds the scene's mesh for the look of an object from outside, and sets it in the passport. A number in the passport
// is ignored. false and e: the scene has none of this kind. Any thread.
bool ob_population_find_look(const ob_population *p, ob_object_def *def, ob_error *e);

// Before the first step: adds requests to carry out, each in its place. false: no memory.
bool ob_population_replay(ob_population *p, const ob_journal_entry *entry, size_t count);
// From now on, logs requests that are carried out for the first time; NULL: stops logging.
void ob_population_set_log(ob_population *p, ob_request_log *log);
// Carries out the timetable up to this step, then the requests. true: objects were added or removed.
bool ob_population_update(ob_population *p, uint64_t step, ob_requests *q);
// Adds the impulses of pulls (pull.h) at the beginning of a step, when the gate is about to open to it; update adds those at
// its end. Again in the same step: nothing.
void ob_population_pull(ob_population *p);
// Checks a request that changes an object's motion or friction, against the object as it is now, which exists. Others
// pass. Any thread.
bool ob_population_check_change(const ob_population *p, const ob_request *r, ob_error *e);
// Makes an avatar's definition: the scene's template at the place of the request, with the origin's number behind its name.
// false and e: the scene has no template, or the place is out of bounds. Any thread.
bool ob_population_check_avatar(const ob_population *p, const ob_request *r, ob_object_def *def, ob_error *e);

// Copy of all that is not in the universe. k: one to overwrite, or NULL for a new one. NULL: out of memory, and k is freed.
typedef struct ob_kept_population ob_kept_population;
ob_kept_population *ob_population_copy(const ob_population *p, ob_kept_population *k);
void ob_kept_population_free(ob_kept_population *k); // NULL is allowed
// Goes on from a copy, at a universe put back to the same step: what came later is forgotten, and never repeated. Viewers'
// pulls stay as they are now: some may have let go since, or have left.
void ob_population_restore(ob_population *p, const ob_kept_population *k);
// For a checkpoint in memory (table/checkpoint.h): keeps the state that is not in the universe, and puts it back. Later
// changes by timetable, scripts and requests are repeated by a run that restarts there (host/request_log.h). reached: number of
// steps that were complete before the restart, and one more if it failed; new requests wait until as many are complete.
bool ob_population_keep(ob_population *p); // false: out of memory
void ob_population_put_back(ob_population *p, uint64_t reached);
// True until a run that was put back so is where it was, with all requests since.
bool ob_population_is_behind(const ob_population *p);
// True if another checkpoint is due: much would be repeated, or there was no memory to note it.
bool ob_population_is_checkpoint_due(const ob_population *p);
// True if a request is to be carried out again once the scripts before the coming step have run.
bool ob_population_is_due_after_scripts(const ob_population *p);
// The next step at whose beginning something is due; UINT64_MAX: never.
uint64_t ob_population_next_step(const ob_population *p);

// Saved state of a slot, beside universe and scene: 12 bytes.
typedef struct ob_saved_slot {
	uint32_t generation; // its latest object's
	uint8_t use; // 0 = free, 1 = reserved: the timetable has another event for it, 2 = present
	uint8_t removal_scheduled; // 1 = the timetable will remove its object
	uint8_t created; // 1 = by a script
	uint8_t unplanned; // 1 = a request has ended its path, or its time-dependent force
	uint32_t origin; // viewer's connection whose request has added the object; 0: none
} ob_saved_slot;

typedef struct ob_saved_population {
	uint64_t events; // of the timetable, carried out so far
	uint32_t count; // slots that were ever used, or will be by the timetable: at least the scene's
	ob_saved_slot *slot; // [count]
	uint32_t hulls; // hulls added since the run began
	ob_hull_corners *hull; // [hulls]
	uint32_t pulls;
	ob_pull *pull; // [pulls]
	uint32_t paths, points; // paths that requests have given; points of all
	ob_given_path *path; // [paths]
	ob_path_point *point; // [points]
} ob_saved_population;

// Fills in events and numbers of elements, so that the caller can make the arrays; then fills the arrays.
void ob_population_count_saved(const ob_population *p, ob_saved_population *out);
void ob_population_save(const ob_population *p, ob_saved_population *out);
// Replaces the first update, after ob_universe_load. false and e: the data does not fit this scene and universe.
bool ob_population_load(ob_population *p, const ob_saved_population *s, ob_error *e);

#endif

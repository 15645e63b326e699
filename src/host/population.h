// Who is in the universe: objects of the scene with their births and deaths, and those added on request. Writes
// passports, places objects, and keeps the roster up to date.
//
// Thread-safety: the host's thread only, and only while the universe is starting or paused.
#ifndef OB_HOST_POPULATION_H
#define OB_HOST_POPULATION_H

#include "host/requests.h"
#include "host/roster.h"
#include "table/table.h"

typedef struct ob_population ob_population;

// true if the definition makes sense: known shape, finite numbers, mass where it moves. e says what does not.
bool ob_object_check(const ob_object_def *def, ob_error *e);

// Slots 0 .. scene->objects-1 are the scene's; the rest of the table is for objects added later. All three must outlive
// it. NULL: out of memory.
ob_population *ob_population_create(const ob_scene *scene, ob_universe *u, ob_roster *r);
void ob_population_destroy(ob_population *p);

// Carries out births and deaths that are due at this step or before, then the requests. true: who is there has changed.
bool ob_population_update(ob_population *p, uint64_t step, ob_requests *q);
// The next step at which something is due; UINT64_MAX: never.
uint64_t ob_population_next_step(const ob_population *p);

#endif

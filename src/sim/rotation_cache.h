// A worker's cached rotations (motion/spin.h): to compute the closed form of one costs more than to evaluate it twice,
// and a flight goes on for many steps. It follows from how the flight began alone, so it is the same whichever worker
// keeps it. Private to its worker.
#ifndef OB_SIM_ROTATION_CACHE_H
#define OB_SIM_ROTATION_CACHE_H

#include <stdbool.h>
#include <stdint.h>

#include "motion/spin.h"

typedef struct ob_rotation_cache {
	uint32_t slots; // a power of two
	struct ob_cached_rotation *slot; // [slots], by id: a later one takes an earlier one's place
} ob_rotation_cache;

bool ob_rotation_cache_create(ob_rotation_cache *p, uint32_t objects); // false: no memory
void ob_rotation_cache_finish(ob_rotation_cache *p);

// The rotation of object id from (q, w) on. Valid until the next call.
ob_spin *ob_rotation_cache_get(ob_rotation_cache *p, uint32_t id, ob_quat q, ob_vec3 w, ob_vec3 inertia);
// A copy of it, if it is there; and one that somebody else has made, for later.
bool ob_rotation_cache_find(ob_rotation_cache *p, uint32_t id, ob_quat q, ob_vec3 w, ob_vec3 inertia, ob_spin *out);
void ob_rotation_cache_put(ob_rotation_cache *p, uint32_t id, const ob_spin *spin);

#endif

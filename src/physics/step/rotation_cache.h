// A worker's cached rotations (motion/spin.h): computing the closed form of one costs more than evaluating it twice,
// and a flight goes on for many steps. A rotation follows from the flight's start alone, so it is the same on any
// worker. Thread-safety: private to its worker.
#ifndef OB_STEP_ROTATION_CACHE_H
#define OB_STEP_ROTATION_CACHE_H

#include <stdbool.h>
#include <stdint.h>

#include "motion/spin.h"

typedef struct ob_rotation_cache {
	uint32_t slots; // a power of two
	struct ob_cached_rotation *slot; // [slots], by id: a later rotation replaces an earlier one
} ob_rotation_cache;

bool ob_rotation_cache_create(ob_rotation_cache *p, uint32_t objects); // false: no memory
void ob_rotation_cache_finish(ob_rotation_cache *p);

// Returns the rotation of object id from attitude q and rate w (rad/s) on. Valid until the next call.
ob_spin *ob_rotation_cache_get(ob_rotation_cache *p, uint32_t id, ob_quat q, ob_vec3 w, ob_vec3 inertia);
// Copies it, if it is there; and stores one that was computed elsewhere, for later.
bool ob_rotation_cache_find(ob_rotation_cache *p, uint32_t id, ob_quat q, ob_vec3 w, ob_vec3 inertia, ob_spin *out);
void ob_rotation_cache_put(ob_rotation_cache *p, uint32_t id, const ob_spin *spin);

#endif

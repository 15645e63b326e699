#include "sim/rotation_cache.h"

#include <stdlib.h>
#include <string.h>

enum { SLOTS_MAX = 256 }; // .2 MB

// What a rotation follows from.
typedef struct rotation_key {
	ob_quat q;
	ob_vec3 w, inertia;
} rotation_key;

typedef struct ob_cached_rotation {
	rotation_key from;
	ob_spin spin;
} ob_cached_rotation;

bool ob_rotation_cache_create(ob_rotation_cache *p, uint32_t objects)
{
	p->slots = 1;
	while (p->slots < objects && p->slots < SLOTS_MAX)
		p->slots *= 2;
	p->slot = calloc(p->slots, sizeof *p->slot);
	return p->slot;
}

void ob_rotation_cache_finish(ob_rotation_cache *p)
{
	free(p->slot);
}

ob_spin *ob_rotation_cache_get(ob_rotation_cache *p, uint32_t id, ob_quat q, ob_vec3 w, ob_vec3 inertia)
{
	ob_cached_rotation *cached = &p->slot[id & (p->slots - 1)];
	rotation_key from = { q, w, inertia };
	if (memcmp(&from, &cached->from, sizeof from)) { // an empty one holds no unit quaternion
		cached->from = from;
		ob_spin_plan(&cached->spin, q, w, inertia);
	}
	return &cached->spin;
}

#include "sim/rotation_cache.h"

#include <stdlib.h>
#include <string.h>

enum { SLOTS_MOST = 1024 }; // .9 MB

// What a plan follows from.
typedef struct start {
	ob_quat q;
	ob_vec3 w, inertia;
} start;

typedef struct ob_cached_rotation {
	start from;
	ob_spin spin;
} ob_cached_rotation;

bool ob_rotation_cache_create(ob_rotation_cache *p, uint32_t objects)
{
	p->slots = 1;
	while (p->slots < objects && p->slots < SLOTS_MOST)
		p->slots *= 2;
	p->slot = calloc(p->slots, sizeof *p->slot);
	return p->slot;
}

void ob_rotation_cache_finish(ob_rotation_cache *p)
{
	free(p->slot);
}

const ob_spin *ob_rotation_cache_get(ob_rotation_cache *p, uint32_t id, ob_quat q, ob_vec3 w, ob_vec3 inertia)
{
	ob_cached_rotation *plan = &p->slot[id & (p->slots - 1)];
	start from = { q, w, inertia };
	if (memcmp(&from, &plan->from, sizeof from)) { // an empty one holds no unit quaternion
		plan->from = from;
		ob_spin_plan(&plan->spin, q, w, inertia);
	}
	return &plan->spin;
}

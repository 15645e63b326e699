#include "step/rotation_cache.h"

#include <stdlib.h>
#include <string.h>

enum { SLOTS_MAX = 256 }; // .2 MB

// Input from which a rotation follows.
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

static ob_cached_rotation *slot_of(ob_rotation_cache *p, uint32_t id)
{
	return &p->slot[id & (p->slots - 1)];
}

// True if the entry is this rotation. An empty one holds no unit quaternion.
static bool holds(const ob_cached_rotation *cached, const rotation_key *from)
{
	return memcmp(from, &cached->from, sizeof *from) == 0;
}

ob_spin *ob_rotation_cache_get(ob_rotation_cache *p, uint32_t id, ob_quat q, ob_vec3 w, ob_vec3 inertia)
{
	ob_cached_rotation *cached = slot_of(p, id);
	const rotation_key from = { q, w, inertia };
	if (!holds(cached, &from)) {
		cached->from = from;
		ob_spin_plan(&cached->spin, q, w, inertia);
	}
	return &cached->spin;
}

bool ob_rotation_cache_find(ob_rotation_cache *p, uint32_t id, ob_quat q, ob_vec3 w, ob_vec3 inertia, ob_spin *out)
{
	const ob_cached_rotation *cached = slot_of(p, id);
	const rotation_key from = { q, w, inertia };
	if (!holds(cached, &from))
		return false;
	*out = cached->spin;
	return true;
}

void ob_rotation_cache_put(ob_rotation_cache *p, uint32_t id, const ob_spin *spin)
{
	ob_cached_rotation *cached = slot_of(p, id);
	cached->from = (rotation_key){ spin->q, spin->w, spin->inertia };
	cached->spin = *spin;
}

#include "table/slot.h"

#include "table/layout.h"

void ob_publish_motion(ob_universe *u, uint32_t id, const ob_motion *m)
{
	ob_slot_publish(u->slot + id, m);
}

const ob_motion *ob_newest_motion(const ob_universe *u, uint32_t id)
{
	const ob_slot *s = u->slot + id;
	return s->ring + __atomic_load_n(&s->version, __ATOMIC_ACQUIRE) % OB_SLOT_VERSIONS;
}

const ob_passport *ob_passport_of(const ob_universe *u, uint32_t id)
{
	const ob_passport_slot *s = u->passport + id;
	return s->ring + __atomic_load_n(&s->version, __ATOMIC_ACQUIRE) % OB_PASSPORT_VERSIONS;
}

void ob_write_passport(ob_universe *u, uint32_t id, const ob_passport *p)
{
	ob_passport_slot *s = u->passport + id;
	uint32_t was = ob_passport_of(u, id)->flags & OB_OBJECT_PRESENT, is = p->flags & OB_OBJECT_PRESENT;
	ob_ring_publish(&s->version, s->ring, OB_PASSPORT_VERSIONS, sizeof *p, p);
	ob_control *c = u->control;
	if (is && !was)
		__atomic_fetch_add(&c->objects, 1, __ATOMIC_RELAXED);
	if (was && !is)
		__atomic_fetch_sub(&c->objects, 1, __ATOMIC_RELAXED);
	if (id >= __atomic_load_n(&c->ids, __ATOMIC_RELAXED))
		__atomic_store_n(&c->ids, id + 1, __ATOMIC_RELEASE);
}

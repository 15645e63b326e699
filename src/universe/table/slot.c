#include "table/slot.h"

#include <string.h>

#include "shape/shape.h"
#include "table/layout.h"
#include "table/pages.h"

void ob_publish_motion(ob_universe *u, uint32_t id, const ob_motion *m)
{
	ob_slot_publish(u->slot + id, m);
}

void ob_stage_motion(ob_universe *u, uint32_t id, const ob_motion *m)
{
	ob_slot *s = u->slot + id;
	ob_ring_stage(&s->version, s->ring, sizeof *m, sizeof *m, m);
}

const ob_motion *ob_staged_motion(const ob_universe *u, uint32_t id)
{
	const ob_slot *s = u->slot + id;
	return s->ring + (__atomic_load_n(&s->version, __ATOMIC_ACQUIRE) + 1) % OB_RING_VERSIONS;
}

void ob_commit_motion(ob_universe *u, uint32_t id)
{
	ob_ring_commit(&u->slot[id].version);
}

void ob_uncommit_motion(ob_universe *u, uint32_t id)
{
	__atomic_fetch_sub(&u->slot[id].version, 1, __ATOMIC_RELEASE);
}

const ob_motion *ob_newest_motion(const ob_universe *u, uint32_t id)
{
	const ob_slot *s = u->slot + id;
	return s->ring + __atomic_load_n(&s->version, __ATOMIC_ACQUIRE) % OB_RING_VERSIONS;
}

const ob_motion *ob_previous_motion(const ob_universe *u, uint32_t id)
{
	const ob_slot *s = u->slot + id;
	const uint64_t version = __atomic_load_n(&s->version, __ATOMIC_ACQUIRE);
	return s->ring + (version > 1 ? version - 1 : version) % OB_RING_VERSIONS;
}

uint64_t ob_motion_version(const ob_universe *u, uint32_t id)
{
	return __atomic_load_n(&u->slot[id].version, __ATOMIC_ACQUIRE);
}

const ob_passport *ob_passport_of(const ob_universe *u, uint32_t id)
{
	const ob_passport_slot *s = u->passport + id;
	return __atomic_load_n(&s->version, __ATOMIC_ACQUIRE) % OB_RING_VERSIONS ? &s->odd : u->passport_even + id;
}

void ob_prefetch_versions(const ob_universe *u, uint32_t id)
{
	__builtin_prefetch(&u->slot[id].version);
	__builtin_prefetch(&u->passport[id].version);
}

static void prefetch_lines(const void *from, size_t bytes)
{
	enum { LINE = 64 };
	for (size_t at = 0; at < bytes; at += LINE)
		__builtin_prefetch((const char *)from + at);
}

void ob_prefetch_slot(const ob_universe *u, uint32_t id)
{
	prefetch_lines(&u->slot[id], sizeof u->slot[id]);
}

const ob_hull *ob_hull_at(const ob_universe *u, uint32_t hull)
{
	return hull < u->header.sizes.hulls ? u->hull + hull : NULL;
}

const ob_hull *ob_hull_of(const ob_universe *u, const ob_passport *p)
{
	return ob_shape_is(p->shape, OB_HULLED) ? ob_hull_at(u, p->hull) : NULL;
}

const ob_terrain_set *ob_universe_terrains(const ob_universe *u)
{
	return u->terrains;
}

bool ob_universe_has_terrains(const ob_universe *u)
{
	return u->terrains;
}

const ob_terrain *ob_terrain_of(const ob_universe *u, const ob_passport *p)
{
	return ob_shape_is(p->shape, OB_SURFACED) ? ob_terrain_at(u->terrains, p->hull) : NULL;
}

uint32_t ob_parts_of(const ob_universe *u, const ob_passport *p)
{
	const ob_hull *h = ob_hull_of(u, p);
	return !h || h->parts > OB_HULL_PARTS_MAX || p->hull + h->parts >= u->header.sizes.hulls ? 0 : h->parts;
}

const ob_hull *ob_part_of(const ob_universe *u, const ob_passport *p, uint32_t part)
{
	const ob_hull *h = ob_hull_of(u, p);
	return part && part <= ob_parts_of(u, p) ? h + part : h;
}

bool ob_write_hull(ob_universe *u, uint32_t hull, const ob_hull *h)
{
	if (hull >= u->header.sizes.hulls || !ob_hull_makes_sense(h) || !ob_pages_take(u, OB_AREA_HULL, hull, 1))
		return false;
	if (hull >= u->control->hulls || memcmp(&u->hull[hull], h, sizeof *h) != 0)
		u->hull[hull] = *h;
	if (hull >= u->control->hulls)
		__atomic_store_n(&u->control->hulls, hull + 1, __ATOMIC_RELEASE);
	return true;
}

// Distance from an object's even body properties to its odd ones.
static ptrdiff_t stride_of(const ob_universe *u, uint32_t id)
{
	return (const char *)&u->passport[id].odd - (const char *)(u->passport_even + id);
}

bool ob_passport_read(const ob_universe *u, uint32_t id, ob_passport *out)
{
	return ob_ring_read(&u->passport[id].version, u->passport_even + id, stride_of(u, id), sizeof *out, out);
}

bool ob_passport_read_body(const ob_universe *u, uint32_t id, ob_passport *out)
{
	const size_t bytes = offsetof(ob_passport, friction);
	return ob_ring_read(&u->passport[id].version, u->passport_even + id, stride_of(u, id), bytes, out);
}

void ob_write_passport(ob_universe *u, uint32_t id, const ob_passport *p)
{
	// Reading body properties that were never written would touch a page of the even ones.
	bool known = __atomic_load_n(&u->passport[id].version, __ATOMIC_RELAXED);
	uint32_t was = known ? ob_passport_of(u, id)->flags & OB_OBJECT_PRESENT : 0, is = p->flags & OB_OBJECT_PRESENT;
	ob_ring_publish(&u->passport[id].version, u->passport_even + id, stride_of(u, id), sizeof *p, p);
	ob_control *c = u->control;
	if (is && !was)
		__atomic_fetch_add(&c->objects, 1, __ATOMIC_RELAXED);
	if (was && !is)
		__atomic_fetch_sub(&c->objects, 1, __ATOMIC_RELAXED);
	if (id >= __atomic_load_n(&c->ids, __ATOMIC_RELAXED))
		__atomic_store_n(&c->ids, id + 1, __ATOMIC_RELEASE);
}

#include "base/allocate.h"
#include "measure/measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "motion/flight.h"
#include "shape/shape.h"

static bool grow_objects(ob_snapshot *s, uint32_t count)
{
	if (count <= s->count_max)
		return true;
	ob_passport *passport = calloc(count, sizeof *passport);
	ob_motion *motion = calloc(count, sizeof *motion);
	ob_state *state = calloc(count, sizeof *state);
	uint32_t *home = calloc(count, sizeof *home);
	double *own_time = calloc(count, sizeof *own_time);
	float(*bounds)[6] = calloc(count, sizeof *bounds);
	if (!passport || !motion || !state || !home || !own_time || !bounds) {
		free(passport);
		free(motion);
		free(state);
		free(home);
		free(own_time);
		free(bounds);
		return false;
	}
	free(s->passport);
	free(s->motion);
	free(s->state);
	free(s->home);
	free(s->own_time);
	free(s->bounds);
	s->passport = passport;
	s->motion = motion;
	s->state = state;
	s->home = home;
	s->own_time = own_time;
	s->bounds = bounds;
	s->count_max = count;
	s->count = 0;
	return true;
}

static bool grow_contacts(ob_snapshot *s, size_t count)
{
	if (count <= s->contacts_max)
		return true;
	ob_contact_point *contact = calloc(count, sizeof *contact);
	if (!contact)
		return false;
	free(s->contact);
	s->contact = contact;
	s->contacts_max = count;
	s->contacts = 0;
	return true;
}

static void drop_hulls(ob_snapshot *s)
{
	for (uint32_t i = 0; i < s->hulls; i++)
		free(s->hull[i]);
	free(s->hull);
	s->hull = NULL;
	s->hulls = 0;
	free(s->terrains);
	s->terrains = NULL;
}

// Copies the terrains of a universe, which never change.
static bool take_terrains(ob_snapshot *s, const ob_universe *u)
{
	const size_t bytes = s->terrains ? 0 : ob_universe_get_terrains(u, NULL, 0);
	if (!bytes)
		return true;
	s->terrains = malloc(bytes);
	if (s->terrains && ob_universe_get_terrains(u, s->terrains, bytes) == bytes &&
	    ob_terrain_set_makes_sense(s->terrains, bytes))
		return true;
	free(s->terrains);
	s->terrains = NULL;
	return false;
}

// Makes room for the hulls of a universe, which never change: present ones stay, and others may come.
static bool expect_hulls(ob_snapshot *s, uint64_t created, uint32_t hulls)
{
	if (s->created != created)
		drop_hulls(s);
	s->created = created;
	if (s->hulls >= hulls)
		return true;
	if (!OB_GROW_CLEARED(s->hull, s->hulls, hulls))
		return false;
	s->hulls = hulls;
	return true;
}

static bool take_hull_of(ob_snapshot *s, const ob_universe *u, const ob_passport *p, uint32_t hull, ob_error *e)
{
	if (hull < s->hulls && s->hull[hull])
		return true;
	// it may have come since the number of hulls was read
	ob_hull *h = expect_hulls(s, s->created, hull + 1) ? malloc(sizeof *h) : NULL;
	if (!h)
		return ob_fail(e, "no memory for the hull of object %u", p->id);
	if (!ob_universe_get_hull(u, hull, h)) {
		free(h);
		return ob_fail(e, "object %u (%.*s) has a hull that makes no sense", p->id, OB_NAME_MAX, p->name);
	}
	s->hull[hull] = h;
	return true;
}

// Takes the object's hull, and those of a compound's parts, unless they are known.
static bool take_hulls(ob_snapshot *s, const ob_universe *u, const ob_passport *p, ob_error *e)
{
	if (!ob_shape_is(p->shape, OB_HULLED))
		return true;
	bool fine = take_hull_of(s, u, p, p->hull, e);
	for (uint32_t i = 1; fine && i <= s->hull[p->hull]->parts; i++)
		fine = take_hull_of(s, u, p, p->hull + i, e);
	return fine;
}

// An object that changes between two reads is read again; one that stays without a state is broken.
static bool take_object(ob_snapshot *s, const ob_universe *u, uint32_t id, ob_error *e)
{
	ob_passport *p = &s->passport[id];
	uint64_t version;
	do {
		version = ob_universe_get_passport_version(u, id);
		memset(p, 0, sizeof *p);
		memset(&s->motion[id], 0, sizeof s->motion[id]);
		s->home[id] = UINT32_MAX;
		s->own_time[id] = NAN;
		if (!ob_universe_get_passport(u, id, p) || !(p->flags & OB_OBJECT_PRESENT))
			return true;
		if (!ob_universe_get_home(u, id, &s->home[id]))
			s->home[id] = UINT32_MAX;
		if (!ob_universe_get_own_time(u, id, &s->own_time[id]))
			s->own_time[id] = NAN;
		if (ob_universe_get_motion(u, id, &s->motion[id]))
			return take_hulls(s, u, p, e);
	} while (ob_universe_get_passport_version(u, id) != version);
	return ob_fail(e, "object %u (%.*s) has published no state that makes sense", id, OB_NAME_MAX, p->name);
}

static bool take_contacts(ob_snapshot *s, const ob_universe *u, ob_error *e)
{
	size_t found = ob_universe_get_contacts(u, s->contact, s->contacts_max);
	if (found > s->contacts_max) { // some extra room: the universe of a viewer goes on meanwhile
		if (!grow_contacts(s, found + found / 4 + 64))
			return ob_fail(e, "no memory for %zu contact points", found);
		found = ob_universe_get_contacts(u, s->contact, s->contacts_max);
	}
	s->contacts = found < s->contacts_max ? found : s->contacts_max;
	return true;
}

static bool grow_joints(ob_snapshot *s, uint32_t joints)
{
	if (joints <= s->joints_max)
		return true;
	if (!OB_GROW(s->joint, joints))
		return false;
	s->joints_max = joints;
	return true;
}

static bool take_joints(ob_snapshot *s, const ob_universe *u, ob_error *e)
{
	const uint32_t joints = ob_universe_joints(u);
	if (!grow_joints(s, joints))
		return ob_fail(e, "no memory for %u joints", joints);
	for (s->joints = 0; s->joints < joints; s->joints++)
		if (!ob_universe_get_joint(u, s->joints, &s->joint[s->joints]))
			memset(&s->joint[s->joints], 0, sizeof *s->joint);
	return true;
}

static void take_bounds(ob_snapshot *s, const ob_universe *u)
{
	for (uint32_t id = 0; id < s->count; id++)
		if (!ob_universe_get_bounds(u, id, s->bounds[id]))
			s->bounds[id][0] = NAN;
}

bool ob_snapshot_take(ob_snapshot *s, const ob_universe *u, unsigned with, ob_error *e)
{
	ob_universe_info info;
	ob_universe_get_info(u, &info);
	if (!grow_objects(s, info.capacity) || !expect_hulls(s, info.created, info.hulls))
		return ob_fail(e, "no memory for a snapshot of %u objects", info.capacity);
	if (!take_terrains(s, u))
		return ob_fail(e, "no memory for the terrain, or it makes no sense");
	s->step = info.step;
	s->time = info.time;
	s->count = info.capacity;
	s->contacts = 0;
	for (uint32_t id = 0; id < s->count; id++)
		if (!take_object(s, u, id, e))
			return false;
	ob_published_all(s->motion, s->passport, s->count, s->time, s->state);
	if (with & OB_SNAPSHOT_BOUNDS)
		take_bounds(s, u);
	return take_joints(s, u, e) && (!(with & OB_SNAPSHOT_CONTACTS) || take_contacts(s, u, e));
}

static bool copy_hulls(ob_snapshot *to, const ob_snapshot *from)
{
	if (!expect_hulls(to, from->created, from->hulls))
		return false;
	for (uint32_t i = 0; i < from->hulls; i++) {
		if (!from->hull[i] || to->hull[i])
			continue;
		to->hull[i] = malloc(sizeof *to->hull[i]);
		if (!to->hull[i])
			return false;
		*to->hull[i] = *from->hull[i];
	}
	if (from->terrains && !to->terrains) {
		to->terrains = malloc(from->terrains->bytes);
		if (!to->terrains)
			return false;
		memcpy(to->terrains, from->terrains, from->terrains->bytes);
	}
	return true;
}

bool ob_snapshot_copy(ob_snapshot *to, const ob_snapshot *from)
{
	if (!grow_objects(to, from->count) || !grow_contacts(to, from->contacts) || !grow_joints(to, from->joints) ||
	    !copy_hulls(to, from))
		return false;
	to->step = from->step;
	to->time = from->time;
	to->count = from->count;
	to->contacts = from->contacts;
	to->joints = from->joints;
	if (from->count) {
		memcpy(to->passport, from->passport, from->count * sizeof *to->passport);
		memcpy(to->motion, from->motion, from->count * sizeof *to->motion);
		for (uint32_t i = 0; i < from->count; i++)
			to->state[i] = ob_snapshot_state(from, i);
		if (from->home)
			memcpy(to->home, from->home, from->count * sizeof *to->home);
		else
			memset(to->home, 0xff, from->count * sizeof *to->home);
		for (uint32_t i = 0; i < from->count; i++)
			to->own_time[i] = from->own_time ? from->own_time[i] : NAN;
		if (from->bounds)
			memcpy(to->bounds, from->bounds, from->count * sizeof *to->bounds);
	}
	if (from->joints)
		memcpy(to->joint, from->joint, from->joints * sizeof *to->joint);
	if (from->contacts)
		memcpy(to->contact, from->contact, from->contacts * sizeof *to->contact);
	return true;
}

void ob_snapshot_finish(ob_snapshot *s)
{
	free(s->passport);
	free(s->motion);
	free(s->state);
	free(s->home);
	free(s->own_time);
	free(s->bounds);
	free(s->contact);
	free(s->joint);
	drop_hulls(s);
	memset(s, 0, sizeof *s);
}

const ob_hull *ob_snapshot_hull(const ob_snapshot *s, uint32_t id)
{
	const ob_passport *p = &s->passport[id];
	return ob_shape_is(p->shape, OB_HULLED) && p->hull < s->hulls ? s->hull[p->hull] : NULL;
}

uint32_t ob_snapshot_parts(const ob_snapshot *s, uint32_t id)
{
	const ob_hull *h = ob_snapshot_hull(s, id);
	const uint32_t first = s->passport[id].hull + 1u;
	for (uint32_t i = 0; h && i < h->parts; i++)
		if (first + i >= s->hulls || !s->hull[first + i])
			return 0;
	return h ? h->parts : 0;
}

const ob_hull *ob_snapshot_part(const ob_snapshot *s, uint32_t id, uint32_t part)
{
	return part ? s->hull[s->passport[id].hull + part] : ob_snapshot_hull(s, id);
}

ob_state ob_snapshot_state(const ob_snapshot *s, uint32_t id)
{
	return s->state ? s->state[id] : ob_published_at(&s->motion[id], &s->passport[id], s->time);
}

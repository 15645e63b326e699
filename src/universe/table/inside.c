// Objects in a sensor, for readers.
#include "motion/depth.h"
#include "motion/flight.h"
#include "shape/shape.h"
#include "table/layout.h"

// Object as a reader copies it.
typedef struct copy {
	ob_passport passport;
	ob_hull hull;
	ob_pose pose;
	float bounds[6];
} copy;

// Copies an object at a time (s), with its hull. false: there is none, or its numbers are implausible.
static bool take(const ob_universe *u, uint32_t id, double time, copy *out)
{
	ob_motion m;
	const ob_passport *p = &out->passport;
	if (!ob_universe_get_motion(u, id, &m))
		return false;
	if (ob_shape_is(p->shape, OB_HULLED) && !ob_universe_get_hull(u, p->hull, &out->hull))
		return false;
	const ob_state s = ob_published_at(&m, p, time);
	out->pose = s.pose;
	return true;
}

static bool has_hull(const copy *x)
{
	return ob_shape_is(x->passport.shape, OB_HULLED);
}

// Makes the solid of part k of n of an object that was taken. n 0: it is no compound.
static bool take_part(const ob_universe *u, uint32_t k, uint32_t n, copy *x, ob_solid *out)
{
	if (n && !ob_universe_get_hull(u, x->passport.hull + k + 1, &x->hull))
		return false;
	*out = ob_solid_of(x->passport.shape, x->passport.size, x->pose, has_hull(x) ? &x->hull : NULL);
	return true;
}

// True if a part of one overlaps a part of the other. An object that is no compound is its only part.
static bool overlap(const ob_universe *u, copy *a, copy *b)
{
	const uint32_t of_a = has_hull(a) ? a->hull.parts : 0, of_b = has_hull(b) ? b->hull.parts : 0;
	ob_solid one, other;
	bool found = false;
	for (uint32_t i = 0; !found && i <= of_a - (of_a > 0); i++)
		for (uint32_t j = 0; !found && j <= of_b - (of_b > 0); j++)
			found = take_part(u, i, of_a, a, &one) && take_part(u, j, of_b, b, &other) &&
				ob_depth(&one, &other) > 0;
	return found;
}

static bool boxes_overlap(const float *a, const float *b)
{
	bool found = true;
	for (int c = 0; c < 3; c++)
		found &= a[c] <= b[c + 3] && b[c] <= a[c + 3];
	return found;
}

bool ob_sensor_finds(const ob_passport *sensor, const ob_passport *p)
{
	return !(p->flags & (OB_OBJECT_STATIC | OB_OBJECT_SENSOR)) && ob_passport_hits(sensor, p);
}

size_t ob_universe_get_inside(const ob_universe *u, uint32_t sensor, uint32_t *ids, size_t max)
{
	ob_universe_info info;
	copy one, other;
	size_t n = 0;
	ob_universe_get_info(u, &info);
	if (!ob_universe_get_passport(u, sensor, &one.passport) || !(one.passport.flags & OB_OBJECT_SENSOR) ||
	    !ob_universe_get_bounds(u, sensor, one.bounds) || !take(u, sensor, info.time, &one))
		return 0;
	for (uint32_t id = 0; id < info.capacity; id++) {
		if (!ob_universe_get_passport(u, id, &other.passport) ||
		    !ob_sensor_finds(&one.passport, &other.passport) || !ob_universe_get_bounds(u, id, other.bounds) ||
		    !boxes_overlap(one.bounds, other.bounds) || !take(u, sensor, info.time, &one) ||
		    !take(u, id, info.time, &other) || !overlap(u, &one, &other))
			continue;
		if (n < max)
			ids[n] = id;
		n++;
	}
	return n;
}

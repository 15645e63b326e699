// Objects in a sensor, for readers.
#include "motion/depth.h"
#include "motion/flight.h"
#include "shape/shape.h"
#include "table/layout.h"

// Object as a reader copies it.
typedef struct copy {
	ob_passport passport;
	ob_hull hull;
	ob_solid solid;
	float bounds[6];
} copy;

// Copies an object at a time (s). false: there is none, or its numbers are implausible.
static bool take(const ob_universe *u, uint32_t id, double time, copy *out)
{
	ob_motion m;
	const ob_passport *p = &out->passport;
	if (!ob_universe_get_motion(u, id, &m))
		return false;
	const bool hulled = ob_shape_is(p->shape, OB_HULLED);
	if (hulled && !ob_universe_get_hull(u, p->hull, &out->hull))
		return false;
	const ob_state s = ob_published_at(&m, p, time);
	out->solid = (ob_solid){ p->shape, p->size, s.pose.p, ob_quat_matrix(s.pose.q), hulled ? &out->hull : NULL };
	return true;
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
		    !boxes_overlap(one.bounds, other.bounds) || !take(u, id, info.time, &other) ||
		    !(ob_depth(&one.solid, &other.solid) > 0))
			continue;
		if (n < max)
			ids[n] = id;
		n++;
	}
	return n;
}

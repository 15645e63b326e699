// Sensors of a universe: properties, which the host writes before the run, and samples. A sensor's samples lie in a ring, sample k
// at its number modulo the number kept. Its object's simulator writes a sample's words with release, then the number
// taken. A reader loads that number, then the words with acquire, and keeps the sample if the number then says that none
// of them was being written anew. Neither side waits; slot.h has the argument.
#include <math.h>
#include <string.h>

#include "motion/depth.h"
#include "motion/flight.h"
#include "shape/shape.h"
#include "table/layout.h"

static uint64_t samples_per_step(double rate, double h)
{
	return (uint64_t)ceil((rate > 0 ? rate * h : 1) * (1 - 1e-12));
}

// Those of a step that is written while others are read, as many for readers, and those that the delay hides.
static uint64_t samples_kept(const ob_sensor_passport *s, double h)
{
	const uint64_t each = samples_per_step(s->rate, h), wanted = s->kept > each ? s->kept : each;
	return wanted + each + 1 + (uint64_t)ceil(s->delay * (s->rate > 0 ? s->rate : 1 / h));
}

uint64_t ob_sensor_room(const ob_sensor_passport *s, double h)
{
	return samples_kept(s, h) * (1 + (uint64_t)s->width);
}

uint64_t ob_sensors_numbers(const ob_universe *u)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < u->step_data.sensors; i++) {
		const ob_sensor_passport *s = &u->step_data.sensor[i];
		sum += s->kind == OB_SENSOR_CAMERA ? 0 : s->kept * (1 + (uint64_t)s->width);
	}
	return sum;
}

void ob_sensors_write(ob_universe *u, const ob_sensor_passport *sensor, uint32_t sensors)
{
	const double h = u->header.run.step_length;
	uint64_t first = 0;
	for (uint32_t i = 0; i < sensors && i < u->step_data.sensors; i++) {
		ob_sensor_passport *s = &u->step_data.sensor[i];
		*s = sensor[i];
		s->kept = (uint32_t)samples_kept(&sensor[i], h);
		s->first = first;
		s->rate = s->rate > 0 ? s->rate : 1 / h;
		first += ob_sensor_room(&sensor[i], h);
	}
}

// A product that is a whole number but for rounding is that number.
uint64_t ob_sensor_due(const ob_sensor_passport *s, double h, uint64_t n, double delay)
{
	const double due = ((double)n * h - delay) * s->rate;
	return due > 0 ? (uint64_t)(due * (1 + 1e-12) + 1e-9) : 0;
}

bool ob_sensor_has_width(const ob_sensor_passport *s)
{
	const uint64_t places = (uint64_t)s->beams * s->rows;
	if (s->kind == OB_SENSOR_CAMERA)
		return places >= 1 && places <= OB_PIXELS_MAX && s->width == ob_picture_values(s->beams, s->rows);
	return s->width >= 1 && s->width <= OB_SENSOR_VALUES_MAX && places <= OB_SENSOR_VALUES_MAX;
}

bool ob_sensor_makes_sense(const ob_universe *u, const ob_sensor_passport *s)
{
	const uint64_t room = (uint64_t)s->kept * (1 + (uint64_t)s->width), all = u->header.sizes.sensor_values;
	return s->kind < OB_SENSOR_KINDS && s->object < u->step_data.objects_max && ob_sensor_has_width(s) &&
	       s->kept > 0 && room <= all && s->first <= all - room && s->rate > 0 && isfinite(s->rate) &&
	       s->delay >= 0 && memchr(s->name, 0, sizeof s->name);
}

static ob_word *place_of(const ob_universe *u, const ob_sensor_passport *s, uint64_t number)
{
	return (ob_word *)(u->step_data.sensor_value + s->first + number % s->kept * (1 + s->width));
}

void ob_sensor_publish(ob_universe *u, uint32_t sensor, double t, const double *value)
{
	const ob_sensor_passport *s = &u->step_data.sensor[sensor];
	ob_sensor_cell *c = &u->step_data.sensor_cell[sensor];
	const uint64_t number = c->taken + 1;
	ob_word *to = place_of(u, s, number);
	const ob_word *from = (const ob_word *)value;
	__atomic_store_n(to, *(const ob_word *)&t, __ATOMIC_RELEASE);
	for (uint32_t i = 0; i < s->width; i++)
		__atomic_store_n(to + 1 + i, from[i], __ATOMIC_RELEASE);
	__atomic_store_n(&c->taken, number, __ATOMIC_RELEASE);
}

// ---- readers

uint32_t ob_universe_sensors(const ob_universe *u)
{
	return u->step_data.sensors;
}

bool ob_universe_get_sensor(const ob_universe *u, uint32_t sensor, ob_sensor_passport *out)
{
	if (sensor >= u->step_data.sensors || __atomic_load_n(&u->lost, __ATOMIC_RELAXED))
		return false;
	*out = u->step_data.sensor[sensor];
	return ob_sensor_makes_sense(u, out);
}

size_t ob_universe_get_samples(const ob_universe *u, uint32_t sensor, uint64_t after, uint64_t *number, double *time,
			       double *value, size_t max)
{
	ob_sensor_passport s;
	if (!ob_universe_get_sensor(u, sensor, &s))
		return 0;
	const uint64_t *taken = &u->step_data.sensor_cell[sensor].taken,
		       last = __atomic_load_n(taken, __ATOMIC_ACQUIRE),
		       seen = ob_sensor_due(&s, u->header.run.step_length, ob_step_count(u), s.delay),
		       end = seen < last ? seen : last;
	uint64_t k = last + 1 > s.kept ? last + 1 - s.kept : 0; // that one may be being written
	k = k > after ? k : after;
	k = end > max && k < end - max ? end - max : k;
	size_t n = 0;
	while (k++ < end) {
		const ob_word *from = place_of(u, &s, k);
		ob_word *to = value ? (ob_word *)(value + n * s.width) : NULL, *at = (ob_word *)&time[n];
		*at = __atomic_load_n(from, __ATOMIC_ACQUIRE);
		for (uint32_t i = 0; to && i < s.width; i++)
			to[i] = __atomic_load_n(from + 1 + i, __ATOMIC_ACQUIRE);
		number[n] = k;
		n += __atomic_load_n(taken, __ATOMIC_RELAXED) + 1 < k + s.kept;
	}
	return n;
}

// ---- inside

// Objects in a sensor, for readers.

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

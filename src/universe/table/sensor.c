// Sensors of a universe: properties, which the host writes before the run, and samples. A sensor's samples lie in a ring, sample k
// at its number modulo the number kept. Its object's simulator writes a sample's words with release, then the number
// taken. A reader loads that number, then the words with acquire, and keeps the sample if the number then says that none
// of them was being written anew. Neither side waits; slot.h has the argument.
#include <math.h>
#include <string.h>

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

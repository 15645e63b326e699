// Noise of sensors: normal numbers by counters, so that a sample's noise follows from its number. A random walk is Levy's
// construction: its values at powers of two have independent increments, and each further value lies between two that
// enclose it, normal about their mean (Levy 1939; Brownian bridge). A value takes some 40 numbers, wherever it is.
#include "base/random.h"
#include "elementary/elementary.h"
#include "sensor/sensor.h"

enum { WHITE, BIAS, WALK };

typedef struct stream {
	uint64_t seed;
	uint32_t channel;
} stream;

// Normal number (Box and Muller 1958) of a purpose, by its index.
static double normal(const stream *s, uint64_t purpose, uint64_t index)
{
	uint64_t state = s->seed;
	state = ob_splitmix(&state) ^ (purpose << 32 | s->channel);
	state = ob_splitmix(&state) ^ index;
	const double u = 1 - ob_splitmix_real(&state), angle = 2 * M_PI * ob_splitmix_real(&state);
	return sqrt(-2 * ob_log(u)) * ob_cos(angle);
}

// Sum of k normal increments.
static double walk_of(const stream *s, uint64_t k)
{
	uint64_t low = 0, high = 1;
	double at_low = 0, at_high = normal(s, WALK, 1);
	while (high < k) {
		low = high, at_low = at_high;
		at_high += sqrt((double)low) * normal(s, WALK, 2 * high);
		high *= 2;
	}
	while (low < k && high > k) {
		const uint64_t middle = low + (high - low) / 2;
		const double at = .5 * (at_low + at_high) + .5 * sqrt((double)(high - low)) * normal(s, WALK, middle);
		if (middle <= k)
			low = middle, at_low = at;
		else
			high = middle, at_high = at;
	}
	return low == k ? at_low : at_high;
}

void ob_sensor_add_noise(const ob_sensor_passport *s, uint64_t k, double *value)
{
	const bool halves = s->kind != OB_SENSOR_TOUCH && s->kind != OB_SENSOR_LIDAR;
	for (uint32_t i = 0; i < s->width; i++) {
		const ob_sensor_noise *n = &s->noise[halves && i >= s->width / 2];
		const stream of = { s->seed, i };
		if (n->white > 0)
			value[i] += n->white * normal(&of, WHITE, k);
		if (n->bias > 0)
			value[i] += n->bias * normal(&of, BIAS, 0);
		if (n->walk > 0)
			value[i] += n->walk / sqrt(s->rate) * walk_of(&of, k);
	}
}

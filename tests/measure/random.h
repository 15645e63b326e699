// Random numbers that give the same poses and sizes in each run of the tests.
#ifndef OB_TESTS_MEASURE_RANDOM_H
#define OB_TESTS_MEASURE_RANDOM_H

#include <stdint.h>

#include "motion/depth.h"

// In [low, high); xorshift64* (Vigna 2014)
static inline double random_between(uint64_t *state, double low, double high)
{
	*state ^= *state >> 12;
	*state ^= *state << 25;
	*state ^= *state >> 27;
	return low + (high - low) * ((double)(*state * 0x2545f4914f6cdd1du >> 11) * 0x1p-53);
}

static inline ob_vec3 random_vector(uint64_t *state, double size)
{
	double x = random_between(state, -size, size), y = random_between(state, -size, size);
	return ob_v3(x, y, random_between(state, -size, size));
}

static inline ob_solid random_solid(uint64_t *state, ob_shape shape, double spread)
{
	ob_quat turn = { random_between(state, -1, 1), random_between(state, -1, 1), random_between(state, -1, 1),
			 random_between(state, -1, 1) };
	ob_solid s = { .shape = shape, .p = random_vector(state, spread) };
	s.size.x = random_between(state, .2, 1);
	s.size.y = random_between(state, .2, 1);
	s.size.z = random_between(state, .2, 1);
	s.r = ob_quat_matrix(ob_quat_normalize(turn));
	return s;
}

#endif

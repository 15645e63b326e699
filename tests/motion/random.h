// Seeded random motions for property tests.
#ifndef OB_TESTS_MOTION_RANDOM_H
#define OB_TESTS_MOTION_RANDOM_H

#include <stdint.h>

#include <ob/vec.h>

// splitmix64 (Steele, Lea and Flood 2014), uniform in [0, 1)
static inline double uniform(uint64_t *seed)
{
	uint64_t z = *seed += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static inline double within(uint64_t *seed, double low, double high)
{
	return low + (high - low) * uniform(seed);
}

static inline ob_vec3 random_vector(uint64_t *seed, double size)
{
	double x = within(seed, -size, size), y = within(seed, -size, size), z = within(seed, -size, size);
	return ob_v3(x, y, z);
}

static inline ob_quat random_attitude(uint64_t *seed)
{
	ob_vec3 v = random_vector(seed, 1);
	return ob_quat_normalize((ob_quat){ within(seed, -1, 1), v.x, v.y, v.z });
}

// Moments of a box with random half extents: those of a real body.
static inline ob_vec3 random_inertia(uint64_t *seed)
{
	double x = within(seed, .1, 1), y = within(seed, .1, 1), z = within(seed, .1, 1);
	return ob_v3(y * y + z * z, z * z + x * x, x * x + y * y);
}

#endif

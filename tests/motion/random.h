// Seeded random motions for property tests.
#ifndef OB_TESTS_MOTION_RANDOM_H
#define OB_TESTS_MOTION_RANDOM_H

#include "base/random.h"

static inline double uniform(uint64_t *seed)
{
	return ob_splitmix_real(seed);
}

static inline double within(uint64_t *seed, double low, double high)
{
	return ob_splitmix_within(seed, low, high);
}

static inline ob_vec3 random_vector(uint64_t *seed, double size)
{
	return ob_splitmix_vector(seed, size);
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

// The random numbers of a scene: the same on every machine for the same seed.
// xoshiro256** (Blackman and Vigna 2018), seeded through splitmix64 (Steele et al. 2014).
#ifndef OB_SCENE_RANDOM_H
#define OB_SCENE_RANDOM_H

#include <stdint.h>

#include <ob/vec.h>

typedef struct ob_random {
	uint64_t s[4];
} ob_random;

void ob_random_seed(ob_random *r, uint64_t seed);
uint64_t ob_random_next(ob_random *r);
// [0, 1), a multiple of 2^-53
double ob_random_real(ob_random *r);
// 0 .. last, all equally likely
uint64_t ob_random_up_to(ob_random *r, uint64_t last);
// All attitudes equally likely (Shoemake 1992)
ob_quat ob_random_rotation(ob_random *r);

#endif

// Random numbers that are the same on every machine: SplitMix64 (Steele, Lea and Flood 2014). The state is a single
// number, changed by every draw; any value is a good seed. Thread-safety: one thread per state.
#ifndef OB_BASE_RANDOM_H
#define OB_BASE_RANDOM_H

#include <stdint.h>

#include <ob/vec.h>

static inline uint64_t ob_splitmix(uint64_t *state)
{
	uint64_t z = *state += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

// Uniform in [0, 1), a multiple of 2^-53
static inline double ob_splitmix_real(uint64_t *state)
{
	return (double)(ob_splitmix(state) >> 11) * 0x1p-53;
}

static inline double ob_splitmix_within(uint64_t *state, double low, double high)
{
	return low + (high - low) * ob_splitmix_real(state);
}

// Each component within +-size; x is drawn first.
static inline ob_vec3 ob_splitmix_vector(uint64_t *state, double size)
{
	double x = ob_splitmix_within(state, -size, size), y = ob_splitmix_within(state, -size, size);
	return ob_v3(x, y, ob_splitmix_within(state, -size, size));
}

#endif

// Four doubles side by side, one pair of objects per lane. No operation mixes lanes, so a lane's bits do not
// depend on its neighbours, nor on the instruction set that the compiler picks.
#ifndef OB_CONTACT_LANES_H
#define OB_CONTACT_LANES_H

#include <stdint.h>
#ifdef __AVX__
#include <immintrin.h>
#endif

enum { OB_LANES = 4 };

typedef double lanes __attribute__((vector_size(32)));
typedef int64_t lane_mask __attribute__((vector_size(32)));

static inline lanes lanes_of(double x)
{
	return (lanes){ x, x, x, x };
}
static inline lanes lanes_select(lane_mask m, lanes yes, lanes no)
{
	return (lanes)((m & (lane_mask)yes) | (~m & (lane_mask)no));
}
// a > b ? a : b, and a < b ? a : b, as the processor's own instructions define it
#if defined(__AVX__)
static inline lanes lanes_max(lanes a, lanes b)
{
	return (lanes)_mm256_max_pd((__m256d)a, (__m256d)b);
}
static inline lanes lanes_min(lanes a, lanes b)
{
	return (lanes)_mm256_min_pd((__m256d)a, (__m256d)b);
}
#else
static inline lanes lanes_max(lanes a, lanes b)
{
	return lanes_select(a > b, a, b);
}
static inline lanes lanes_min(lanes a, lanes b)
{
	return lanes_select(a < b, a, b);
}
#endif
static inline lanes lanes_abs(lanes a)
{
	return (lanes)((lane_mask)a & INT64_MAX);
}
static inline lanes lanes_sqrt(lanes a)
{
	return (lanes){ __builtin_sqrt(a[0]), __builtin_sqrt(a[1]), __builtin_sqrt(a[2]), __builtin_sqrt(a[3]) };
}
// Bit l is set where lane l of m is true
#if defined(__AVX__)
static inline unsigned lanes_bits(lane_mask m)
{
	return (unsigned)_mm256_movemask_pd((__m256d)m);
}
#else
static inline unsigned lanes_bits(lane_mask m)
{
	return (m[0] ? 1u : 0) | (m[1] ? 2u : 0) | (m[2] ? 4u : 0) | (m[3] ? 8u : 0);
}
#endif

#endif

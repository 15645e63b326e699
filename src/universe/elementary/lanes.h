// Four doubles side by side, one body or pair of bodies per lane. No operation mixes lanes. So a lane's bits do not
// depend on its neighbours, nor on the instruction set that the compiler picks.
#ifndef OB_ELEMENTARY_LANES_H
#define OB_ELEMENTARY_LANES_H

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
// a > b ? a : b, and a < b ? a : b, as the processor's instructions define them
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
// x where m is true, 0 elsewhere
static inline lanes lanes_where(lane_mask m, lanes x)
{
	return (lanes)(m & (lane_mask)x);
}
static inline lanes lanes_abs(lanes a)
{
	return (lanes)((lane_mask)a & INT64_MAX);
}
#if defined(__AVX__)
static inline lanes lanes_sqrt(lanes a)
{
	return (lanes)_mm256_sqrt_pd((__m256d)a);
}
#else
static inline lanes lanes_sqrt(lanes a)
{
	return (lanes){ __builtin_sqrt(a[0]), __builtin_sqrt(a[1]), __builtin_sqrt(a[2]), __builtin_sqrt(a[3]) };
}
#endif
static inline double lanes_largest(lanes a)
{
	double most = a[0];
	for (int l = 1; l < OB_LANES; l++)
		most = a[l] > most ? a[l] : most;
	return most;
}
// Loads four consecutive numbers from any address.
static inline lanes lanes_load(const double *from)
{
	lanes x;
	__builtin_memcpy(&x, from, sizeof x);
	return x;
}
static inline void lanes_store(double *to, lanes x)
{
	__builtin_memcpy(to, &x, sizeof x);
}
// Reads lane l. (See lanes_put.)
static inline double lanes_get(const lanes *x, int l)
{
	double y;
	__builtin_memcpy(&y, (const char *)x + (unsigned)l * sizeof y, sizeof y);
	return y;
}
// Writes lane l alone. (For a variable l, clang compiles x[l] = y to a copy of the whole vector and back, which waits
// for the store in between.)
static inline void lanes_put(lanes *x, int l, double y)
{
	__builtin_memcpy((char *)x + (unsigned)l * sizeof y, &y, sizeof y);
}
// Transposes four by four numbers: x[i][l] becomes x[l][i].
static inline void lanes_transpose(lanes *x)
{
	lanes a = __builtin_shufflevector(x[0], x[1], 0, 4, 2, 6), b = __builtin_shufflevector(x[0], x[1], 1, 5, 3, 7);
	lanes c = __builtin_shufflevector(x[2], x[3], 0, 4, 2, 6), d = __builtin_shufflevector(x[2], x[3], 1, 5, 3, 7);
	x[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
	x[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
	x[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
	x[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}
// Lane l is true if bit l is set.
static inline lane_mask lanes_mask(unsigned bits)
{
	lane_mask bit = { 1, 2, 4, 8 };
	return (bit & (int64_t)bits) != 0;
}
// Number of bits set. (On processors without an instruction for it, gcc's builtin calls its library.)
static inline unsigned lanes_count(unsigned bits)
{
	return (unsigned)(UINT64_C(0x4332322132212110) >> 4 * (bits & 15)) & 7;
}
// Bit l is set if lane l of m is true.
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

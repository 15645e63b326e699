// Numbers of a text that is compiled for four in lanes: see elementary/real.h.
#ifndef OB_ELEMENTARY_REAL_LANES_H
#define OB_ELEMENTARY_REAL_LANES_H

#include "elementary/lanes.h"

typedef lanes real;
typedef lane_mask mask;

static inline real real_of(double x)
{
	return lanes_of(x);
}

static inline real chosen(mask m, real yes, real no)
{
	return lanes_select(m, yes, no);
}

static inline mask both_of(mask a, mask b)
{
	return a & b;
}

static inline mask not_of(mask m)
{
	return ~m;
}

static inline int is_any(mask m)
{
	return lanes_bits(m) != 0;
}

static inline mask mask_of(unsigned bits)
{
	return lanes_mask(bits);
}

static inline unsigned bits_of(mask m)
{
	return lanes_bits(m);
}

static inline real root_of(real x)
{
	return lanes_sqrt(x);
}

static inline real size_of(real x)
{
	return lanes_abs(x);
}

static inline real larger_of(real a, real b)
{
	return lanes_max(a, b);
}

static inline real smaller_of(real a, real b)
{
	return lanes_min(a, b);
}

#endif

// Numbers of a text that is compiled for one (this header) and for four in lanes (elementary/real_lanes.h): real is the
// type of a number, mask that of a comparison's result. Both headers define the same functions, and a lane has the bits
// of a single number. A file includes one of them, and then the text.
#ifndef OB_ELEMENTARY_REAL_H
#define OB_ELEMENTARY_REAL_H

typedef double real;
typedef int mask;

static inline real real_of(double x)
{
	return x;
}

static inline real chosen(mask m, real yes, real no)
{
	return m ? yes : no;
}

static inline mask both_of(mask a, mask b)
{
	return a & b;
}

static inline mask not_of(mask m)
{
	return !m;
}

static inline int is_any(mask m)
{
	return m;
}

// Sets of lanes: a bit for each.
static inline mask mask_of(unsigned bits)
{
	return bits & 1;
}

static inline unsigned bits_of(mask m)
{
	return m != 0;
}

static inline real root_of(real x)
{
	return __builtin_sqrt(x);
}

// |x|
static inline real size_of(real x)
{
	return __builtin_fabs(x);
}

// a > b ? a : b, and a < b ? a : b
static inline real larger_of(real a, real b)
{
	return a > b ? a : b;
}

static inline real smaller_of(real a, real b)
{
	return a < b ? a : b;
}

#endif

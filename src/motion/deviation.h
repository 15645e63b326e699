// Deviation: bound of the errors of a motion since the running second began, in m, as 16 bits that a motion carries. Code
// c > 0 is 2^((c - 48 1024) / 1024) m, to 1/1000; 0 is none, or less than 4e-15 m.
#ifndef OB_MOTION_DEVIATION_H
#define OB_MOTION_DEVIATION_H

#include <math.h>
#include <stdint.h>

#include "elementary/elementary.h"

enum { OB_DEVIATION_ONE = 48 * 1024, OB_DEVIATION_MOST = UINT16_MAX }; // code of 1 m, largest code

static inline double ob_deviation(uint16_t code)
{
	return code ? ob_exp((code - OB_DEVIATION_ONE) * (M_LN2 / 1024)) : 0;
}

static inline uint16_t ob_deviation_code(double deviation)
{
	const double code = deviation > 0 ? ceil(ob_log(deviation) * (1024 / M_LN2)) + OB_DEVIATION_ONE : 0;
	return code >= OB_DEVIATION_MOST ? OB_DEVIATION_MOST : code > 0 ? (uint16_t)code : 0;
}

// Number of steps (of h s) of the running second at the end of step n, from 1 on.
static inline uint32_t ob_steps_of_second(uint64_t n, double h)
{
	const double first = ceil(floor((double)(n - 1) * h + 1e-9) / h - 1e-9); // steps before the second
	return (uint32_t)((double)n - first);
}

// Time (s) that is left of the running second at the end of step n.
static inline double ob_left_of_second(uint64_t n, double h)
{
	return fmax(1 - ob_steps_of_second(n, h) * h, 0);
}

// Returns the code of a body's deviation at the second's end after a hit: it begins where either of both bodies is off
// by "most" at most, so its direction is off by that over the radius (m), and the velocity by as much of its change
// (m/s, of surface points), for the time that is left (s).
static inline uint16_t ob_deviation_after_hit(uint16_t most, double change, double radius, double left)
{
	return ob_deviation_code(ob_deviation(most) + left * change * fmin(ob_deviation(most) / radius, 2));
}

// Returns the part of a code as of step "before" that counts at the end of step n: nothing in a new second.
static inline uint16_t ob_deviation_at(uint16_t code, uint64_t before, uint64_t n, double h)
{
	return n - before < ob_steps_of_second(n, h) ? code : 0;
}

#endif

// Deviation: bound of the errors of a motion since the running second began: of its place after a step, and of its
// velocity, by which the first grows until the second ends. A motion carries both in 16 bits each: code c > 0 is
// 2^((c - 48 1024) / 1024) m or m/s, to 1/1000; 0 is none, or less than 4e-15.
//
//   a step's errors   place and velocity add up
//   a hit             a body that is off leaves in another direction: the velocity is off by that share of its change
//   a new second      both begin at 0
#ifndef OB_MOTION_DEVIATION_H
#define OB_MOTION_DEVIATION_H

#include <math.h>
#include <stdint.h>

#include <ob/motion.h>

#include "elementary/elementary.h"

enum { OB_DEVIATION_ONE = 48 * 1024, OB_DEVIATION_MOST = UINT16_MAX }; // code of 1 m, largest code

typedef struct ob_deviation {
	double place, rate; // m, m/s
} ob_deviation;

static inline double ob_deviation_of_code(uint16_t code)
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

// Returns a motion's deviation as it was published, if its second still runs at the end of step n: nothing in a new one.
static inline ob_deviation ob_deviation_published(const ob_motion *m, uint64_t n, double h)
{
	if (n - m->step >= ob_steps_of_second(n, h))
		return (ob_deviation){ 0, 0 };
	return (ob_deviation){ ob_deviation_of_code(m->deviation), ob_deviation_of_code(m->deviation_rate) };
}

// Returns the part of it that counts at the end of step n, if no step adds to it.
static inline ob_deviation ob_deviation_at(const ob_motion *m, uint64_t n, double h)
{
	const ob_deviation d = ob_deviation_published(m, n, h);
	return (ob_deviation){ d.place + d.rate * (double)(n - m->step) * h, d.rate };
}

// Returns its place (m) at the end of the second in which step n ends.
static inline double ob_deviation_of_second(ob_deviation d, uint64_t n, double h)
{
	return d.place + d.rate * ob_left_of_second(n, h);
}

static inline void ob_deviation_put(ob_motion *m, ob_deviation d)
{
	m->deviation = ob_deviation_code(d.place);
	m->deviation_rate = ob_deviation_code(d.rate);
}

// Returns the deviation after a hit in which either of both bodies is off by "most" at most: so the direction in which it
// leaves is off by the place over the radius (m), and its velocity by that share of its change (m/s, of surface points).
static inline ob_deviation ob_deviation_after_hit(ob_deviation most, double change, double radius)
{
	return (ob_deviation){ most.place, most.rate + change * fmin(most.place / radius, 2) };
}

// Largest speed (m/s) of a point of a body of this radius: in a second no motion can be off by more than it moves.
static inline double ob_surface_speed(ob_vec3 v, ob_vec3 w, double radius)
{
	return ob_norm(v) + radius * ob_norm(w);
}

// Returns the larger of two deviations, by each part.
static inline ob_deviation ob_deviation_larger(ob_deviation a, ob_deviation b)
{
	return (ob_deviation){ fmax(a.place, b.place), fmax(a.rate, b.rate) };
}

#endif

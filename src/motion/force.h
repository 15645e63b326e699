// Forces that change in time, as a row of constants: of each step, the mean, so that its impulse is exact. Pure
// functions, thread-safe.
#ifndef OB_MOTION_FORCE_H
#define OB_MOTION_FORCE_H

#include "motion/path.h"

typedef enum ob_force_kind {
	OB_FORCE_SINE, // sin(frequency t + phase) of the force
	OB_FORCE_PULSE, // the force, from an instant until another
	OB_FORCE_LINEAR, // from point to point; the first and the last hold before and after
} ob_force_kind;

// t is the time since the object's first instant.
typedef struct ob_force {
	ob_force_kind kind;
	ob_vec3 force; // N
	double frequency, phase; // rad/s, rad
	double from, until; // s
	uint32_t points;
	ob_path_point *point; // [points]: s, N; ascending
} ob_force;

// N, over a step of h (s)
ob_vec3 ob_force_mean(const ob_force *f, double h, uint64_t step);
// The next step whose mean may be another; UINT64_MAX: none.
uint64_t ob_force_next(const ob_force *f, double h, uint64_t step);
// As ob_path_copy
ob_force *ob_force_copy(const ob_force *f);

#endif

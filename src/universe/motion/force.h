// Forces that vary in time, as a sequence of constants: the mean of each step, so that its impulse is exact. Pure
// functions, thread-safe.
#ifndef OB_MOTION_FORCE_H
#define OB_MOTION_FORCE_H

#include "motion/path.h"

typedef enum ob_force_kind {
	OB_FORCE_SINE, // force times sin(frequency t + phase)
	OB_FORCE_PULSE, // the force, between two instants
	OB_FORCE_LINEAR, // linear between points; the first and the last hold before and after
} ob_force_kind;

// Force over time. t is the time since the object's first instant.
typedef struct ob_force {
	ob_force_kind kind;
	ob_vec3 force; // N
	double frequency, phase; // rad/s, rad
	double from, until; // s
	uint32_t points;
	ob_path_point *point; // [points]: s, N; ascending
} ob_force;

// Mean force (N) over a step of h (s).
ob_vec3 ob_force_mean(const ob_force *f, double h, uint64_t step);
// Next step whose mean may differ; UINT64_MAX: none.
uint64_t ob_force_next(const ob_force *f, double h, uint64_t step);
// Copies into one block; see ob_path_copy.
ob_force *ob_force_copy(const ob_force *f);

#endif

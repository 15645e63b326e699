// What the steps have done and what they cost: counters of each worker, in its own cell of the universe, written by the
// worker alone and read by the host while the universe stands still; and a histogram of the steps' wall time.
#ifndef OB_TABLE_COUNTERS_H
#define OB_TABLE_COUNTERS_H

#include <stdint.h>

// The sections of a step whose time is taken when ob_run_settings.timed says so.
typedef enum ob_profile_section {
	OB_PROFILE_BROADPHASE, // boxes against boxes
	OB_PROFILE_SCHEDULE, // index, pairs, islands: the worker that arrives last
	OB_PROFILE_BALLISTIC, // closed forms of what touches nothing
	OB_PROFILE_LOAD, // an island's bodies and contacts out of the universe, and back
	OB_PROFILE_NARROWPHASE, // where bodies touch: collision tests
	OB_PROFILE_IMPACTS, // collisions with restitution
	OB_PROFILE_SOLVE, // iterations of the contact solver, direct solves
	OB_PROFILE_MOVE, // rotation, prediction, integration
	OB_PROFILE_PROJECT, // penetrations pushed apart
	OB_PROFILE_PUBLISH, // rest, boxes, motions into their slots
	OB_PROFILE_SCRIPTS, // objects' scripts
	OB_PROFILE_SECTIONS
} ob_profile_section;

// A word for it; "?" for what is none.
const char *ob_profile_name(uint32_t section);

enum { OB_SUBSTEP_CHOICES = 11 }; // islands take 1, 2, 4 .. 1024 substeps where a tolerance chooses

typedef struct ob_counters {
	uint64_t ballistic_advances; // steps of objects that touched nothing: their closed form
	uint64_t body_steps; // steps of objects in islands
	uint64_t body_substeps; // substeps of those, redone ones included
	uint64_t island_steps; // islands solved
	uint64_t islands_redone; // solutions thrown away because their error was above the tolerance
	uint64_t island_merges; // times that islands of a step were solved again as one, because of late contacts
	uint64_t islands_over; // islands whose error stayed above the tolerance with the most substeps
	uint64_t chosen[OB_SUBSTEP_CHOICES]; // island-steps by log2 of the substeps that they kept
	uint64_t narrowphase_tests; // collision tests of two shapes
	uint64_t swept_tests; // those that followed the pair through its substep
	uint64_t box_tests; // of two axis-aligned boxes, in whatever phase
	uint64_t solver_iterations; // of the contact solver
	uint64_t pair_solves; // pairs solved in them
	uint64_t frictionless_solves; // those of them without friction
	uint64_t impact_iterations, impacts; // passes over elastic contacts; pairs that rebounded in them
	uint64_t direct_solves; // of an island as a whole
	uint64_t gyroscopic_steps; // substeps of bodies whose inertia needed Euler's equations
	double recovered; // J, potential energy that pushing penetrations apart has added
	double error; // m, the largest that an accepted solution estimated for itself
	uint64_t time_ns[OB_PROFILE_SECTIONS]; // of CPU
	// If timed: where the rest of the worker's time went, on the wall but for gate_cpu_ns.
	uint64_t held_ns; // it had work, and no core
	uint64_t gate_ns; // waiting at the gate until its last phase, pauses included
	uint64_t gate_cpu_ns; // CPU of that waiting: spinning, falling asleep, waking
	uint64_t since_ns; // since when it waits now (ob_clock_ns); not for sums
} ob_counters;

enum { OB_LATENCY_BINS = 1100 }; // 2 % wide each, from .1 us to 290 s

// How long steps took: of fixed size, so that a run of any length takes 9 kB, and a percentile is right to 1 %.
// One thread at a time.
typedef struct ob_latency {
	uint64_t count[OB_LATENCY_BINS], total;
} ob_latency;

// A step of that wall time (s).
void ob_latency_add(ob_latency *l, double seconds);
// The time (s) that the given fraction of the steps did not exceed; 0 when there were none.
double ob_latency_percentile(const ob_latency *l, double fraction);

#endif

// Counters of the steps' work and cost: one set per worker, in its own cell of the universe, written by the worker
// alone and read by the host while the universe stands still. Also a histogram of the steps' wall time.
#ifndef OB_TABLE_COUNTERS_H
#define OB_TABLE_COUNTERS_H

#include <stdint.h>

// Sections of a step that are timed if ob_run_settings.timed is set.
typedef enum ob_profile_section {
	OB_PROFILE_BROADPHASE, // boxes against boxes
	OB_PROFILE_SCHEDULE, // index, pairs, islands: the worker that arrives last
	OB_PROFILE_BALLISTIC, // closed forms of bodies without contacts
	OB_PROFILE_LOAD, // copying an island's bodies and contacts from the universe, and back
	OB_PROFILE_NARROWPHASE, // collision tests of shapes
	OB_PROFILE_IMPACTS, // collisions with restitution
	OB_PROFILE_SOLVE, // iterations of the contact solver, direct solves
	OB_PROFILE_MOVE, // rotation, prediction, integration
	OB_PROFILE_PROJECT, // position correction of penetrations
	OB_PROFILE_PUBLISH, // rest timers, boxes, motions into their slots
	OB_PROFILE_SCRIPTS, // objects' scripts
	OB_PROFILE_ESTIMATE, // solving islands again with other substeps, to estimate their errors
	OB_PROFILE_VERIFY, // solving islands again with many substeps, to know their errors
	OB_PROFILE_SECTIONS
} ob_profile_section;

// Name of a section; "?" if it is none.
const char *ob_profile_name(uint32_t section);

enum { OB_SUBSTEP_CHOICES = 11 }; // islands take 1, 2, 4 .. 1024 substeps if a tolerance chooses

// Bins of errors, by powers of two: from 2^-40 m (1e-12; the first bin has smaller ones, too) to 16 m.
enum { OB_ERROR_BINS = 44, OB_ERROR_LEAST_EXPONENT = -40 };

typedef struct ob_counters {
	uint64_t ballistic_advances; // steps of objects without contacts: their closed form
	uint64_t body_steps; // steps of objects in islands
	uint64_t body_substeps; // substeps of those, redone ones included
	uint64_t island_steps; // islands solved
	uint64_t islands_redone; // solutions discarded because their error was above the tolerance
	uint64_t island_merges; // merges of a step's islands, solved again as one because of late contacts
	uint64_t islands_over; // islands whose error stayed above the tolerance with the most substeps
	uint64_t chosen[OB_SUBSTEP_CHOICES]; // island-steps by log2 of the substeps that they kept
	uint64_t narrowphase_tests; // collision tests of two shapes
	uint64_t swept_tests; // those swept through the substep
	uint64_t box_tests; // tests of two axis-aligned boxes, in all phases
	uint64_t solver_iterations; // iterations of the contact solver
	uint64_t pair_solves; // pairs solved in them
	uint64_t frictionless_solves; // those of them without friction
	uint64_t impact_iterations, impacts; // iterations over elastic contacts; pairs that rebounded in them
	uint64_t direct_solves; // solves of an island as a whole
	uint64_t gyroscopic_steps; // substeps of bodies whose inertia needed Euler's equations
	double recovered; // J, potential energy added by position correction
	double error; // m, largest error estimate of an accepted solution: of these
	double depth, creep, bounce; // m
	uint64_t estimates; // body steps whose error was estimated by another solution (solver/estimate.h)
	uint64_t unbounded; // body steps of seconds in which the errors of motion may exceed the tolerance
	double deviation; // m, largest of such errors
	// Errors of body steps that were verified: of a step, and of a second, if all errors add up. Their largest (m); and
	// body steps of the sample that took too much work.
	uint32_t verified_step[OB_ERROR_BINS], verified_second[OB_ERROR_BINS];
	double verified_most[2];
	uint64_t unverified;
	uint64_t time_ns[OB_PROFILE_SECTIONS]; // CPU time
	// If timed: the rest of the worker's time, wall time except for gate_cpu_ns.
	uint64_t held_ns; // it had work, but no core
	uint64_t gate_ns; // waiting at the gate until its last phase, pauses included
	uint64_t gate_cpu_ns; // CPU time of that waiting: spinning, falling asleep, waking
	uint64_t since_ns; // start of the present wait (ob_clock_ns); not for sums
} ob_counters;

// Copies word by word: a free worker may write while others look, who then have some words of before. Any thread.
void ob_counters_copy(ob_counters *to, const ob_counters *from);

enum { OB_LATENCY_BINS = 1100 }; // 2 % wide each, from .1 us to 290 s

// Histogram of step durations. Its size is fixed, so that a run of any length takes 9 kB, and a percentile is accurate
// to 1 %. One thread at a time.
typedef struct ob_latency {
	uint64_t count[OB_LATENCY_BINS], total;
} ob_latency;

// Adds a step of that wall time (s).
void ob_latency_add(ob_latency *l, double seconds);
// Time (s) that the given fraction of the steps did not exceed; 0 without steps.
double ob_latency_percentile(const ob_latency *l, double fraction);

#endif

// The report of a run: its results for people and programs. docs/obsim.1 defines each figure.
#ifndef OB_CLI_REPORT_H
#define OB_CLI_REPORT_H

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "cli/request.h"
#include "experiment/json.h"
#include "scene/expect.h"
#include "table/table.h"

// Members of a report that are in its JSON, in this order: texts of so many bytes, counts, and real numbers, which are NaN if
// they were not measured. The names are a stable interface for scripts.
// clang-format off
#define OB_REPORT_MEMBERS(TEXT, COUNT, REAL) \
	TEXT(scene, PATH_MAX) \
	TEXT(outcome, 16) /* "finished" | "interrupted" | "failed" */ \
	TEXT(arch, 16) TEXT(isolation, 16) \
	COUNT(workers) \
	COUNT(objects) COUNT(bodies) /* present at the end: all; those that move */ \
	REAL(step) COUNT(steps) \
	COUNT(substeps) /* 0: chosen by a tolerance */ \
	REAL(tolerance) REAL(error_reached) /* m */ \
	REAL(depth_reached) REAL(creep_reached) REAL(bounce_reached) /* m, of error_reached, by cause */ \
	REAL(deviation_reached) /* m, the largest estimate of the errors of motion in a second */ \
	REAL(bounded_share) /* share of body-time in which that is within the tolerance */ \
	COUNT(unbounded_steps) COUNT(estimates) /* of bodies: with more; steps with an estimate */ \
	/* substeps of island-steps, if a tolerance chose; else 0 */ \
	COUNT(substeps_min) COUNT(substeps_median) COUNT(substeps_max) \
	COUNT(islands_redone) COUNT(islands_over) \
	COUNT(verified_steps) COUNT(unverified_steps) /* of bodies, in the sample of --set verify=on; too much work */ \
	/* m: errors of those steps at surface points, in a step; and in a second if all errors add up */ \
	REAL(verified_p50_m) REAL(verified_p90_m) REAL(verified_p99_m) REAL(verified_max_m) \
	REAL(verified_second_p50_m) REAL(verified_second_p90_m) REAL(verified_second_p99_m) REAL(verified_second_max_m) \
	REAL(verified_share) /* share of them whose error of a second is within the tolerance */ \
	COUNT(iterations) TEXT(solver, 16) COUNT(lag) TEXT(integrator, 16) TEXT(narrow, 16) \
	COUNT(load) COUNT(box_tests) /* numbers added up in each test of two boxes; number of tests */ \
	COUNT(seed) \
	REAL(simulated_s) \
	REAL(resumed_s) /* s, simulated: start of a process that resumed the run; NaN = it began it */ \
	REAL(wall_s) REAL(cpu_s) REAL(total_s) \
	REAL(body_step_cpu_us) \
	REAL(startup_s) REAL(step_p50_s) REAL(step_p90_s) REAL(step_p99_s) REAL(step_max_s) \
	/* sums over all workers; NaN unless timed */ \
	REAL(critical_s) REAL(critical_16_s) REAL(work_s) REAL(held_s) REAL(gate_s) REAL(gate_cpu_s) REAL(idle_s) \
	REAL(elapsed_s) \
	REAL(host_cpu_s) REAL(renderer_cpu_s) \
	COUNT(switches) \
	COUNT(deaths) COUNT(frozen) /* frozen: objects, because of deaths */ \
	COUNT(scripts_stopped) COUNT(scripts_warned) /* objects: stopped by an error; at the end, something in vain */ \
	COUNT(faults) TEXT(fault_kinds, 160) /* injected; "kill 3, exit 1": by kind; "" = none */ \
	COUNT(faults_overwritten) /* counters of faults that simulators have overwritten: there were more */ \
	COUNT(worker_memory_bytes) COUNT(memory_bytes) \
	TEXT(state_hash, 24) /* 16 hex digits */ \
	REAL(energy_start) REAL(energy_end) REAL(energy_gain_max) \
	REAL(energy_recovered) /* J */ \
	REAL(momentum_error) \
	REAL(penetration_max_m) REAL(penetration_mean_m) REAL(worst_penetration_m) REAL(worst_penetration_time_s) \
	REAL(separation_max_m) REAL(separation_mean_m) \
	COUNT(frames) REAL(frame_rate) REAL(fps) \
	COUNT(checkpoints) COUNT(checkpoint_bytes) /* written; of the last */ \
	REAL(checkpoint_s) /* s, wall: pauses for checkpoints; NaN = none requested */ \
	COUNT(trace_events) COUNT(trace_lost) /* events of all; events that the file lacks */ \
	/* of a free run; else "" and NaN */ \
	TEXT(sync, 16) TEXT(coupling, 16) \
	REAL(update_rate) REAL(max_lag) REAL(jitter) REAL(delay) /* Hz, s; max_lag NaN = no bound; from there on NaN in groups, but for updates and waits */ \
	REAL(updates) REAL(waits) REAL(wait_s) /* sums over simulators */ \
	REAL(lag_mean_s) REAL(lag_max_s) /* own time less that of the version read, over all readings */ \
	TEXT(commit, 64)
// clang-format on

#define OB_REPORT_TEXT(name, bytes) char name[bytes];
#define OB_REPORT_COUNT(name) uint64_t name;
#define OB_REPORT_REAL(name) double name;
typedef struct ob_report {
	OB_REPORT_MEMBERS(OB_REPORT_TEXT, OB_REPORT_COUNT, OB_REPORT_REAL)
	ob_death death[OB_DEATHS_KEPT]; // the last of them, oldest first
	uint32_t deaths_told; // number of entries in death
	ob_script_error script_error[OB_SCRIPT_ERRORS_KEPT]; // the first of them, by step and object
	uint32_t script_errors_told; // number of entries in script_error
	const ob_expected *expected; // what the scene expects, and what came; NULL: it says nothing
} ob_report;

void ob_report_write_json(const ob_report *r, FILE *f);

// Prints some aligned lines for a person: five, and one for each thing that a run should not have; or all.
void ob_report_print(const ob_report *r, bool full, FILE *f);

// Writes only the members, into an object that the caller has opened.
void ob_report_write_members(const ob_report *r, ob_json *j);

// Fills the figures of the tolerance, and the workers' time if the run was timed, from counters summed over all workers.
void ob_report_count(ob_report *r, const ob_counters *c, bool timed);
// Fills the figures of faults.
void ob_report_faults(ob_report *r, const uint64_t faults[OB_FAULT_KINDS], uint32_t overwritten);

// True if an expectation of the scene was not met.
bool ob_report_missed_expectation(const ob_report *r);
// True if a tolerance is set or the default, and an island's error stayed above it.
bool ob_report_missed_tolerance(const ob_report *r);
// True if the errors of motion of every second are within the tolerance, by estimate, and by verifying, or no tolerance is set.
bool ob_report_motion_is_bounded(const ob_report *r);

typedef struct ob_explained {
	const ob_run_request *request; // resolved
	const ob_scene *scene;
	const ob_run_settings *settings;
	ob_counters counters; // of all workers
	double body_steps; // steps times bodies
	double cpu_s; // of all workers
} ob_explained;

// Explains what a run modelled, what it left out and why, and the cost of each section of its steps.
void ob_explain_print(const ob_explained *x, FILE *f);

#endif

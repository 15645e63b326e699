// The report of a run: its results for people and programs. docs/obsim.1 defines each figure.
#ifndef OB_CLI_REPORT_H
#define OB_CLI_REPORT_H

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "cli/request.h"
#include "experiment/json.h"
#include "table/table.h"

// Numbers that were not measured are NaN.
typedef struct ob_report {
	char scene[PATH_MAX];
	char outcome[16]; // "finished" | "interrupted" | "failed"
	char arch[16], isolation[16], solver[16], integrator[16], narrow[16];
	char commit[64];
	char state_hash[24]; // 16 hex digits
	uint64_t objects, bodies; // present at the end: all; those that move
	uint64_t steps, substeps, iterations, lag, seed, workers; // substeps 0: chosen by a tolerance
	uint64_t load, box_tests; // numbers added up in each test of two boxes; number of tests
	uint64_t frames;
	uint64_t checkpoints, checkpoint_bytes; // written; of the last
	uint64_t trace_events, trace_lost; // events of all; events that the file lacks
	uint64_t memory_bytes;
	uint64_t substeps_min, substeps_median, substeps_max; // substeps of island-steps, if a tolerance chose; else 0
	uint64_t islands_redone, islands_over;
	double tolerance, error_reached; // m
	double depth_reached, creep_reached, bounce_reached; // m, of error_reached, by cause
	double deviation_reached; // m, the largest estimate of the errors of motion in a second
	double bounded_share; // share of body-time in which that is within the tolerance
	uint64_t unbounded_steps, estimates; // of bodies: with more; steps with an estimate
	uint64_t verified_steps, unverified_steps; // of bodies, in the sample of --verify; too much work
	// m: errors of those steps at surface points, in a step; and in a second if all errors add up
	double verified_p50_m, verified_p90_m, verified_p99_m, verified_max_m;
	double verified_second_p50_m, verified_second_p90_m, verified_second_p99_m, verified_second_max_m;
	double verified_share; // share of them whose error of a second is within the tolerance
	double energy_recovered; // J
	double step, simulated_s;
	double resumed_s; // s, simulated: start of a process that resumed the run; NaN = it began it
	double checkpoint_s; // s, wall: pauses for checkpoints; NaN = none requested
	double wall_s, cpu_s, total_s;
	double body_step_cpu_us;
	double startup_s, step_p50_s, step_p90_s, step_p99_s, step_max_s;
	// sums over all workers; NaN unless timed
	double critical_s, critical_16_s, work_s, held_s, gate_s, gate_cpu_s, idle_s, elapsed_s;
	double host_cpu_s, renderer_cpu_s;
	char fault_kinds[160]; // "kill 3, exit 1": injected faults by kind; "" = none
	uint64_t faults; // of all kinds
	uint64_t faults_overwritten; // counters of faults that simulators have overwritten: there were more
	uint64_t scripts_stopped, scripts_warned; // objects at the end: failed; something in vain
	uint64_t switches, deaths, frozen, worker_memory_bytes; // frozen: objects, because of deaths
	ob_death death[OB_DEATHS_KEPT]; // the last of them, oldest first
	uint32_t deaths_told; // number of entries in death
	double energy_start, energy_end, energy_gain_max;
	double momentum_error;
	double penetration_max_m, penetration_mean_m, worst_penetration_m, worst_penetration_time_s;
	double separation_max_m, separation_mean_m;
	double fps, frame_rate;
	// of a free run; else "" and NaN
	char sync[16], coupling[16];
	double update_rate, max_lag, jitter, delay; // Hz, s; max_lag NaN = no bound
	double updates, waits, wait_s; // sums over simulators
	double lag_mean_s, lag_max_s; // own time less that of the version read, over all readings
} ob_report;

void ob_report_write_json(const ob_report *r, FILE *f);

// Prints some aligned lines for a person.
void ob_report_print(const ob_report *r, FILE *f);

// Writes only the members, into an object that the caller has opened.
void ob_report_write_members(const ob_report *r, ob_json *j);

// Fills the figures of the tolerance, and the workers' time if the run was timed, from counters summed over all workers.
void ob_report_count(ob_report *r, const ob_counters *c, bool timed);
// Fills the figures of faults.
void ob_report_faults(ob_report *r, const uint64_t faults[OB_FAULT_KINDS], uint32_t overwritten);

// True if a tolerance is set or the default, and an island's error stayed above it.
bool ob_report_missed_tolerance(const ob_report *r);
// True if the errors of motion of every second are within the tolerance, by estimate, or no tolerance is set.
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

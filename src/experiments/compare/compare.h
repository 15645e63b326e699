// obsim compare: one scene in all configurations (one world, threads, processes, numbers of objects per worker), at one
// or several values of a parameter; their costs and errors, and a verdict. An experiment (experiment/) in which a trial
// is an `obsim run` of its own, so that none warms another's caches or memory.
//
// A case of the experiment is a sweep point. Its trials are of three kinds (ob_compare_kind). Errors measured along one
// run of an architecture hold for all runs that end in the same bits.
#ifndef OB_COMPARE_COMPARE_H
#define OB_COMPARE_COMPARE_H

#include "experiment/analysis.h"
#include "experiment/table.h"
#include "settings/settings.h"

typedef enum ob_worker_count {
	OB_WORKERS_ONE,
	OB_WORKERS_TWO,
	OB_WORKERS_POOL,
	OB_WORKERS_GROUPS, // one for each OB_COMPARE_GROUP objects
	OB_WORKERS_EACH // one for each object
} ob_worker_count;
enum { OB_COMPARE_GROUP = 60 };

typedef struct ob_configuration {
	const char *key; // in files
	const char *title; // in tables
	const char *arch, *isolation; // as the options of obsim run
	ob_worker_count workers;
	uint32_t objects_max; // skipped with more objects; 0 = no limit
	bool other_narrow; // runs with the other narrow phase
	const char *harden; // list of --harden: runs only if these measures are requested; "" = all; NULL = none
} ob_configuration;

typedef enum ob_configuration_id {
	OB_CONFIGURATION_MONOLITH,
	OB_CONFIGURATION_THREAD,
	OB_CONFIGURATION_THREADS_2,
	OB_CONFIGURATION_THREADS,
	OB_CONFIGURATION_PROCESSES,
	OB_CONFIGURATION_GROUPS,
	OB_CONFIGURATION_THREADS_EACH,
	OB_CONFIGURATION_PROCESSES_EACH,
	OB_CONFIGURATION_OUTBOX, // measures of --harden, with those that they need
	OB_CONFIGURATION_CHECKSUM,
	OB_CONFIGURATION_PAGES,
	OB_CONFIGURATION_PRIVILEGES,
	OB_CONFIGURATION_LIMITS,
	OB_CONFIGURATION_CALLS,
	OB_CONFIGURATION_HARDENED, // all of them
	OB_CONFIGURATION_HARDENED_EACH,
	OB_CONFIGURATION_MONOLITH_OTHER, // from here on: the other narrow phase
	OB_CONFIGURATION_THREADS_OTHER,
	OB_CONFIGURATIONS
} ob_configuration_id;
extern const ob_configuration ob_configuration_table[OB_CONFIGURATIONS];

typedef enum ob_compare_kind {
	OB_COMPARE_SAMPLE, // an undisturbed run, for cost and latency, and one with clocks, for the shares of time
	OB_COMPARE_MEASURED, // a run that measures errors at each step
	OB_COMPARE_DRAWN, // a run with frames
	OB_COMPARE_KINDS,
	OB_COMPARE_TIMED = OB_COMPARE_KINDS, // of metrics: the run with clocks; any
	OB_COMPARE_ANY
} ob_compare_kind;

typedef enum ob_compare_metric {
	OB_COMPARE_COST, // CPU per body and step
	OB_COMPARE_WALL,
	OB_COMPARE_CPU,
	OB_COMPARE_P50,
	OB_COMPARE_P90,
	OB_COMPARE_P99,
	OB_COMPARE_LONGEST,
	OB_COMPARE_CRITICAL,
	OB_COMPARE_SPEEDUP,
	OB_COMPARE_WORK,
	OB_COMPARE_GATE,
	OB_COMPARE_GATE_CPU,
	OB_COMPARE_HELD,
	OB_COMPARE_EXPLAINED,
	OB_COMPARE_PER_SIMULATOR,
	OB_COMPARE_HOST,
	OB_COMPARE_RENDERER,
	OB_COMPARE_FPS,
	OB_COMPARE_SWITCHES,
	OB_COMPARE_STARTUP,
	OB_COMPARE_STARTUP_EACH,
	OB_COMPARE_MEMORY,
	OB_COMPARE_MEMORY_EACH,
	OB_COMPARE_MEMORY_WORKER,
	OB_COMPARE_PENETRATION,
	OB_COMPARE_WORST,
	OB_COMPARE_SEPARATION,
	OB_COMPARE_ENERGY,
	OB_COMPARE_MOMENTUM,
	OB_COMPARE_SHOWN, // from here on: descriptions of the run, for files only
	OB_COMPARE_OBJECTS = OB_COMPARE_SHOWN,
	OB_COMPARE_WORKERS,
	OB_COMPARE_STEPS,
	OB_COMPARE_METRICS
} ob_compare_metric;
extern const ob_metric ob_compare_metric_table[OB_COMPARE_METRICS];

enum { OB_SWEEP_POINTS = 16, OB_COMPARE_OPTIONS = 128, OB_COMPARE_RUNS = 99 };

// The scene with one value of the varied parameter.
typedef struct ob_sweep_point {
	char define[128]; // "n=100"; "" = no parameter
	uint32_t objects, joints;
	uint64_t steps, seed;
	double step, simulated; // s
	char key[OB_CASE_KEY]; // the case of its records: names the scene, its contents and all options
	uint32_t workers[OB_CONFIGURATIONS];
	char skipped[OB_CONFIGURATIONS][96]; // reason for skipping it; "" = it runs
} ob_sweep_point;

typedef struct ob_compare_option {
	char *text; // "--step=1/120", for obsim run; malloc'd
	bool objects_only; // does not apply to a monolith
} ob_compare_option;

typedef struct ob_comparison {
	const char *scene; // path
	const char *narrow, *other; // narrow phases
	uint32_t repeats, seeds, pool;
	uint32_t harden; // measures to price one by one, 1 << ob_harden_measure, and then all together; 0 = none
	bool drawn; // runs each configuration once with frames, too
	char options[512]; // as on the command line
	uint32_t passed; // options passed to each run
	ob_compare_option pass[OB_COMPARE_OPTIONS];
	uint32_t points;
	ob_sweep_point point[OB_SWEEP_POINTS];
	ob_records records; // records of this comparison alone, after ob_comparison_run
} ob_comparison;

// ---- runs

// Makes one point for each value of "n=100,1000"; NULL makes one point without a parameter.
bool ob_comparison_read_points(ob_comparison *c, const char *vary, ob_error *e);
// Sets keys, worker counts, and skipped configurations, once objects, steps and seed of the points are known.
bool ob_comparison_plan(ob_comparison *c, ob_error *e);
// Runs the trials missing in the folder (NULL: nothing is stored); fresh: all. Returns false and e if interrupted, or
// if the folder cannot be written. On several ranks: as ob_experiment_run.
bool ob_comparison_run(ob_comparison *c, const char *commit, const char *folder, bool fresh, ob_error *e);
void ob_comparison_finish(ob_comparison *c);
// Command line of one run, without the shell's quotes. Each string and the array malloc'd; NULL: out of memory.
char **ob_comparison_arguments(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id,
			       ob_compare_kind kind, bool timed, uint64_t seed);
// Configuration key of its records.
void ob_configuration_key(ob_configuration_id id, ob_compare_kind kind, char to[OB_CONFIGURATION_KEY]);

// ---- results. NaN: not measured

// Median of all samples.
ob_estimate ob_comparison_spread(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id,
				 ob_compare_metric m);
// Ratio of one configuration's metric to another's, sample by sample: variation between repeats cancels out.
ob_estimate ob_comparison_ratio(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id of,
				ob_configuration_id to, ob_compare_metric m);
// Same configuration without the measure that it prices; for all measures: without any. OB_CONFIGURATIONS: it prices
// none.
ob_configuration_id ob_configuration_without(ob_configuration_id id);
// True if it was run, and no run failed.
bool ob_comparison_is_done(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id);
const char *ob_comparison_failure(const ob_comparison *c, const ob_sweep_point *p,
				  ob_configuration_id id); // NULL: none
// True if all object simulators with the same narrow phase and seed end in the same bits.
bool ob_comparison_agrees(const ob_comparison *c, const ob_sweep_point *p);

// Verdict of a sweep point, by rules. headline: "Thread or process?" in a few words; answer: with figures.
typedef struct ob_verdict {
	char headline[160], answer[768], architecture[512], narrow[768], sum[512];
} ob_verdict;
void ob_verdict_make(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p);

// ---- output as text, as JSON, as a folder

// A sweep point as a table: metrics downwards, configurations across. intervals: in each cell; otherwise only those of the cost, in a row of their own. NULL: no runs.
ob_table *ob_comparison_table(const ob_comparison *c, const ob_sweep_point *p, bool intervals);
// Cost of each measure of --harden: CPU and wall time over the same run without it. NULL: none was priced.
ob_table *ob_comparison_prices(const ob_comparison *c, const ob_sweep_point *p);
// Prints why the tables lack a configuration: it failed, or was skipped, for which this is the word. False: they have it.
bool ob_comparison_left_out(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id,
			    const char *skipped, char *to, size_t room);
// Prints "6 runs of each", "3 runs of each of 4 seeds".
void ob_comparison_print_runs(const ob_comparison *c, char *to, size_t room);

// Prints the verdict, then the table. width: of a line
void ob_comparison_print(const ob_comparison *c, FILE *f, size_t width);
void ob_comparison_write_json(const ob_comparison *c, FILE *f);
// Writes report.html, results.json and plots/, beside the records in results.csv.
bool ob_comparison_write_folder(const ob_comparison *c, const char *folder, ob_error *e);

#endif

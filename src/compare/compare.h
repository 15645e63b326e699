// obsim compare: one scene in all configurations (one world, threads, processes, how many objects share a worker), at
// one or several values of a parameter; what each costs and gets wrong, and what follows. A definition on experiment/:
// a trial is an `obsim run` of its own, so that none warms another's caches or memory.
//
// A case of the experiment is a sweep point. Its trials are of three kinds (ob_compare_kind); what is measured along
// one run of an architecture holds for all that end in the same bits.
#ifndef OB_COMPARE_COMPARE_H
#define OB_COMPARE_COMPARE_H

#include "experiment/experiment.h"
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
	uint32_t objects_max; // with more objects it is not tried; 0 = any number
	bool other_narrow; // runs with the narrow phase that was not asked for
	const char *harden; // the list of --harden: runs only if these measures are asked for; "" = all; NULL = none
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
	OB_CONFIGURATION_OUTBOX, // measures of --harden, with what they need
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
	OB_COMPARE_SAMPLE, // a run undisturbed, for cost and latency, and one with clocks, for where the time goes
	OB_COMPARE_MEASURED, // a run whose errors are measured at each step
	OB_COMPARE_DRAWN, // a run with frames
	OB_COMPARE_KINDS
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
	OB_COMPARE_SHOWN, // what follows says what was run, and stands in files alone
	OB_COMPARE_OBJECTS = OB_COMPARE_SHOWN,
	OB_COMPARE_WORKERS,
	OB_COMPARE_STEPS,
	OB_COMPARE_METRICS
} ob_compare_metric;
extern const ob_metric ob_compare_metric_table[OB_COMPARE_METRICS];

enum { OB_SWEEP_POINTS = 16, OB_COMPARE_OPTIONS = 128, OB_COMPARE_RUNS = 99 };

// The scene with one value of what is varied
typedef struct ob_sweep_point {
	char define[128]; // "n=100"; "" = nothing is varied
	uint32_t objects;
	uint64_t steps, seed;
	double step, simulated; // s
	char key[OB_CASE_KEY]; // the case of its records: names the scene, its contents and all options
	uint32_t workers[OB_CONFIGURATIONS];
	char skipped[OB_CONFIGURATIONS][96]; // why it is not tried; "" = it is
} ob_sweep_point;

typedef struct ob_compare_option {
	char *text; // "--step=1/120", for obsim run; malloc'd
	bool objects_only; // means nothing to a monolith
} ob_compare_option;

typedef struct ob_comparison {
	const char *scene; // path
	const char *narrow, *other; // narrow phases
	uint32_t repeats, seeds, pool;
	uint32_t harden; // measures that are priced one by one, 1 << ob_harden_measure, and then all together; 0 = none
	bool drawn; // each configuration is run once with frames, too
	char options[512]; // as the command line had them
	uint32_t passed; // options that each run gets
	ob_compare_option pass[OB_COMPARE_OPTIONS];
	uint32_t points;
	ob_sweep_point point[OB_SWEEP_POINTS];
	ob_records records; // of this comparison alone, after ob_comparison_run
} ob_comparison;

// ---- what is run

// One point for each value of "n=100,1000"; NULL makes one point at which nothing is varied.
bool ob_comparison_read_points(ob_comparison *c, const char *vary, ob_error *e);
// Keys, worker counts, and what is skipped, of points whose objects, steps and seed are known.
bool ob_comparison_plan(ob_comparison *c, ob_error *e);
// Runs what the folder (NULL: nothing is kept) does not have; fresh: all. false and e: interrupted, or the folder
// cannot be written. On several ranks: as ob_experiment_run.
bool ob_comparison_run(ob_comparison *c, const char *commit, const char *folder, bool fresh, ob_error *e);
void ob_comparison_finish(ob_comparison *c);
// The command line of one run, without the shell's quotes. Each string and the array malloc'd; NULL: no memory.
char **ob_comparison_arguments(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id,
			       ob_compare_kind kind, bool timed, uint64_t seed);
void ob_comparison_free_arguments(char **argv);
// The key of its records' configuration
void ob_configuration_key(ob_configuration_id id, ob_compare_kind kind, char to[OB_CONFIGURATION_KEY]);

// ---- what came of it. NaN: not measured

// Of all samples; interval of 95 % from 6 on, else least to most; low and high are NaN for one alone.
typedef struct ob_spread {
	double median, low, high;
	size_t n;
	bool interval;
} ob_spread;
ob_spread ob_comparison_spread(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id,
			       ob_compare_metric m);
// Sample by sample, one configuration's metric over another's: what changes from one repeat to the next cancels out.
ob_spread ob_comparison_ratio(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id of,
			      ob_configuration_id to, ob_compare_metric m);
// The same without the measure that it prices; of all measures: without any. OB_CONFIGURATIONS: it prices none.
ob_configuration_id ob_configuration_without(ob_configuration_id id);
// Was it run, and did no run fail?
bool ob_comparison_is_done(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id);
const char *ob_comparison_failure(const ob_comparison *c, const ob_sweep_point *p,
				  ob_configuration_id id); // NULL: none
// Did all object simulators with the same narrow phase and seed end in the same bits?
bool ob_comparison_agrees(const ob_comparison *c, const ob_sweep_point *p);

// What a sweep point shows, by rules. headline: "Thread or process?" in a few words; answer: with its figures.
typedef struct ob_verdict {
	char headline[160], answer[768], architecture[512], narrow[768], sum[512];
} ob_verdict;
void ob_verdict_make(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p);

// ---- as a text, as JSON, as a folder

// Verdict, then table. width: of a line
void ob_comparison_print(const ob_comparison *c, FILE *f, size_t width);
void ob_comparison_write_json(const ob_comparison *c, FILE *f);
// report.html, results.json and plots/, beside the records in results.csv
bool ob_comparison_write_folder(const ob_comparison *c, const char *folder, ob_error *e);

#endif

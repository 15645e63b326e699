// An experiment: cases, each run in several configurations, several times. Every trial runs in a process of its own.
// Results go to one file, the source of tables, diagrams and reports. Each kind of measurement defines an experiment:
//
//      definition                 ob_experiment: its metrics, the run function, the order of fineness
//          |
//          v
//      schedule                   ob_trials_add: the trials, in the order in which they are to run,
//          |                      with a guess of the time each takes; ob_trials_repeat: the same, repeat by repeat
//          v
//      ob_experiment_run ------>  one child process a trial (process.h): time limits, crashes, Ctrl-C; a line of
//          |     ^                progress (progress.h), and an estimate of the total time at the start
//          v     |                skips trials that the records already have
//          |     |                runs on several ranks at once, if started by mpirun
//      ob_records  <---------->   DIR/results.csv: a line for each trial, appended as trials end
//          |
//          v
//      analysis.h                 medians with intervals, ratios sample by sample, cost at equal error
//          |
//          v
//      table.h, page.h, json.h      figures in words; text, Markdown, HTML; diagrams; DIR/report.html; JSON
//
// To define one:
//
// 1. A table of ob_metric; metric[i] of a record is described by metric i of the table, in SI units.
// 2. bool run(const ob_trial *t, ob_record *out, ob_error *e): runs one trial; it is called in a fresh child. It fills
//     out->metric[] (NAN until then), may fill out->note, and sets out->reason if the trial was completed, but its
//     outcome counts as failed ("fell"). It returns false and e if there is no outcome.
// 3. The schedule: keys of case and configuration are texts for people and files, stable from one call to the next.
//     A trial matches the record that has its key, seed and repeat.
// 4. ob_experiment_open(x, DIR, ..), ob_experiment_run(x, schedule, ..), then analysis of the records.
//
// Results of different commits or machines are never mixed: ob_experiment_open sets older ones aside.
#ifndef OB_EXPERIMENT_EXPERIMENT_H
#define OB_EXPERIMENT_EXPERIMENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <ob/error.h>

enum { OB_METRICS = 48, OB_CASE_KEY = 256, OB_CONFIGURATION_KEY = 128 }; // per experiment; bytes with the final 0

typedef struct ob_metric {
	const char *key; // in files
	const char *title; // for people
	const char *unit; // for people: "ms", "mm", "1" = a bare ratio
	double scale; // factor from the unit of files (SI) to the one for people
	double target; // upper bound, in the unit of files; NAN = none
	const char *group; // heading above it in a table; NULL = same group as the metric before
	const char *meaning; // one sentence for the reader of a report
	// For trials that are runs of obsim: the kind of run that measures it, by the definition, and members of its report: the
	// value, then what it is divided by. NULL: the definition finds it otherwise
	int kind;
	const char *from[3];
} ob_metric;

// Reason for which a trial counts as failed.
typedef enum ob_failure {
	OB_FAILURE_NONE,
	OB_FAILURE_OUTCOME, // completed with an outcome that counts as failed; metrics are valid
	OB_FAILURE_ERROR, // could not be run; metrics are NAN for this and the following values
	OB_FAILURE_CRASH,
	OB_FAILURE_TIME, // ran out of time
	OB_FAILURES
} ob_failure;

typedef struct ob_trial {
	char of[OB_CASE_KEY]; // the case
	char configuration[OB_CONFIGURATION_KEY];
	uint32_t repeat; // from 0
	uint64_t seed; // for the definition to use; 0 = the case's own
	double guess_s; // expected duration; only ratios matter once something has run
	const void *what; // the definition's own: not copied, not read
} ob_trial;

// Result of one trial. Plain data: it crosses a pipe.
typedef struct ob_record {
	char of[OB_CASE_KEY], configuration[OB_CONFIGURATION_KEY];
	uint32_t repeat;
	uint64_t seed;
	ob_failure failure;
	char reason[160]; // one line; "" = it did not fail
	double took_s, took_cpu_s; // wall-clock and CPU time of the child
	char note[64]; // a measured text: a hash
	double metric[OB_METRICS];
	char machine[192], commit[64];
} ob_record;

typedef struct ob_records {
	size_t count, max;
	ob_record *record;
	char machine[192], commit[64]; // of this process: marks the records that it adds
} ob_records;

typedef struct ob_trials {
	size_t count, max;
	ob_trial *trial;
} ob_trials;

typedef struct ob_experiment {
	const char *name; // "lab"
	const char *commit; // of the program
	size_t metrics;
	const ob_metric *metric;
	bool (*run)(const ob_trial *t, ob_record *out, ob_error *e);
	double limit_s; // CPU time of a trial, and four times as much wall-clock time; 0 = none
	// Further columns of the file, for its readers: meanings of a record's keys. They are not read back.
	size_t columns;
	const char *const *column;
	void (*describe)(const ob_record *r, size_t column, char *to, size_t room);
	// True if the trial, of the same case, is so much finer than this record that it takes at least as long. It is
	// then skipped if the record ran out of time. NULL = never
	bool (*is_finer)(const ob_trial *t, const ob_record *than);
	// Order of records in the file; NULL = order of the runs
	int (*order)(const ob_record *a, const ob_record *b);
	bool quiet; // no progress on standard error
} ob_experiment;

// ---- schedule

// Appends a copy of *t. Returns false if memory runs out.
bool ob_trials_add(ob_trials *s, const ob_trial *t);

typedef enum ob_order {
	OB_ORDER_SAME, // each repeat in the order of the first
	OB_ORDER_TO_AND_FRO, // every second one backwards
	OB_ORDER_ROTATED // each starts one trial later than the one before
} ob_order;

// Takes the trials from "from" on as one repeat, and appends the following ones, "repeats" in all, so that a busy
// minute of the machine affects all configurations alike. seeds: repeat r of a trial has its seed + r; otherwise all
// have the same seed. Returns false if memory runs out.
bool ob_trials_repeat(ob_trials *s, size_t from, uint32_t repeats, ob_order order, bool seeds);
void ob_trials_finish(ob_trials *s);

// ---- records

bool ob_records_add(ob_records *r, const ob_record *one); // false: no memory
// Finds a record; NULL: none.
const ob_record *ob_records_find(const ob_records *r, const char *of, const char *configuration, uint32_t repeat,
				 uint64_t seed);
// Removes records with the case and the configuration of a trial of the schedule.
void ob_records_drop(ob_records *r, const ob_trials *s);
void ob_records_finish(ob_records *r);

// CSV file (base/csv.h): a line for each record, columns by name; numbers read back to the same bits. A missing file is
// empty. An unterminated last line, from an interrupted write, is ignored.
bool ob_records_read(ob_records *r, const ob_experiment *x, const char *path, ob_error *e);
// Lines of such a file, for appending to it.
void ob_result_head_write(FILE *f, const ob_experiment *x);
void ob_result_line_write(FILE *f, const ob_experiment *x, const ob_record *r);
// Replaces the file atomically: readers see the old one or the new one.
bool ob_records_write(const ob_records *r, const ob_experiment *x, const char *path, ob_error *e);

// Reads the metrics of a kind from the report of a run.
void ob_record_read(ob_record *r, const ob_experiment *x, int kind, const char *report);

// ---- running

// Makes the folder, with its parents, and reads its results.csv. Results of another commit or machine, or a file in
// another format, are renamed, with a note. folder NULL: results are not stored. On ranks other than the first, it
// neither makes nor reads anything.
bool ob_experiment_open(const ob_experiment *x, const char *folder, ob_records *r, ob_error *e);
// Runs the trials that r lacks, and adds their records to r and folder/results.csv (NULL: no file). Trials of the same
// case, configuration and seed are not run again after a failure, except those that had less time than now. Prints an
// estimate of the total time first. Returns false and e if interrupted, or if the file cannot be written; results up to
// then are in both. Call it from a process without other threads.
//
// On several ranks (ranks/ranks.h), each calls it with the same schedule. The first gets all records, as if alone
// except for times, and writes the file. The others return, with none, when all trials are done. A trial waits for
// earlier ones that might make it unnecessary.
bool ob_experiment_run(const ob_experiment *x, const ob_trials *s, ob_records *r, const char *folder, ob_error *e);

#endif

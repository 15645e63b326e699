// An experiment: cases, each run in several configurations, several times; every trial in a process of its own; what it
// measured in one file, from which tables, diagrams and reports are made. Whoever has something to measure defines it:
//
//	definition                 ob_experiment: its metrics, how a trial is run, what is finer than what
//	    |
//	    v
//	schedule                   ob_trials_add: the trials, in the order in which they are to run,
//	    |                      with a guess of the time each takes; ob_trials_repeat: the same, repeat by repeat
//	    v
//	ob_experiment_run ------>  one child process a trial (process.h): limits of time, crashes, Ctrl-C; a line of
//	    |     ^                progress (progress.h) and, before anything runs, how long it will take
//	    v     |                what the records have already is not run again
//	    |     |                on several ranks at once, where mpirun has started them (spread.h)
//	ob_records  <---------->   DIR/results.csv: a line for each trial, appended as trials end
//	    |
//	    v
//	analysis.h                 medians with intervals, ratios sample by sample, cost at equal error
//	    |
//	    v
//	table.h, chart.h, page.h, json.h      text, Markdown, HTML; diagrams; DIR/report.html; JSON
//
// To define one:
//  1. A table of ob_metric; metric[i] of a record is what metric i of the table describes, in SI units.
//  2. bool run(const ob_trial *t, ob_record *out, ob_error *e): runs one trial; it is called in a fresh child. It fills
//     out->metric[] (NAN until then), may fill out->note, and sets out->reason where the trial came to its end, but its
//     outcome counts as failed ("fell"). false and e: there is no outcome.
//  3. The schedule: keys of case and configuration are texts for people and files, stable from one call to the next:
//     a trial that has the key, seed and repeat of a record is that record's.
//  4. ob_experiment_open(x, DIR, ..), ob_experiment_run(x, schedule, ..), then analysis of the records.
//
// What is measured at another commit, or on another machine, is never mixed: ob_experiment_open puts it aside.
#ifndef OB_EXPERIMENT_EXPERIMENT_H
#define OB_EXPERIMENT_EXPERIMENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <ob/error.h>

enum { OB_METRICS = 48, OB_CASE_KEY = 256, OB_CONFIGURATION_KEY = 128 }; // of an experiment; bytes with the final 0

typedef struct ob_metric {
	const char *key; // in files
	const char *title; // for people
	const char *unit; // for people: "ms", "mm", "1" = a bare ratio
	double scale; // from the unit of files (SI) to that for people
	double target; // at most this much, in the unit of files; NAN = nothing is promised
	const char *group; // heading above it in a table; NULL = under the one before
	const char *meaning; // one sentence for the reader of a report
} ob_metric;

// Why a trial counts as failed
typedef enum ob_failure {
	OB_FAILURE_NONE,
	OB_FAILURE_OUTCOME, // it came to its end, with an outcome that counts as failed; metrics hold
	OB_FAILURE_ERROR, // it could not be run; metrics are NAN in this and what follows
	OB_FAILURE_CRASH,
	OB_FAILURE_TIME, // it ran out of time
	OB_FAILURES
} ob_failure;

typedef struct ob_trial {
	char of[OB_CASE_KEY]; // the case
	char configuration[OB_CONFIGURATION_KEY];
	uint32_t repeat; // from 0
	uint64_t seed; // what the definition makes of it; 0 = the case's own
	double guess_s; // how long it may take; only ratios matter once something has run
	const void *what; // the definition's own: not copied, not looked at
} ob_trial;

// What one trial gave. Plain data: it crosses a pipe.
typedef struct ob_record {
	char of[OB_CASE_KEY], configuration[OB_CONFIGURATION_KEY];
	uint32_t repeat;
	uint64_t seed;
	ob_failure failure;
	char reason[160]; // one line; "" = it did not fail
	double took_s, took_cpu_s; // wall-clock and CPU time of the child
	char note[64]; // a text that was measured: a hash
	double metric[OB_METRICS];
	char machine[192], commit[64];
} ob_record;

typedef struct ob_records {
	size_t count, max;
	ob_record *record;
	char machine[192], commit[64]; // of this process: what it adds is marked so
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
	// Further columns of the file, for its readers: what the keys of a record mean. They are not read back.
	size_t columns;
	const char *const *column;
	void (*describe)(const ob_record *r, size_t column, char *to, size_t room);
	// Is the trial, of the same case, so much finer than this record that it takes at least as long? It is then not
	// tried when the record ran out of time. NULL = never
	bool (*is_finer)(const ob_trial *t, const ob_record *than);
	// The order of records in the file; NULL = that of the runs
	int (*order)(const ob_record *a, const ob_record *b);
	bool quiet; // no progress on standard error
} ob_experiment;

// ---- schedule

// A copy of *t goes to the end. false: no memory.
bool ob_trials_add(ob_trials *s, const ob_trial *t);

typedef enum ob_order {
	OB_ORDER_SAME, // each repeat in the order of the first
	OB_ORDER_TO_AND_FRO, // every second one backwards
	OB_ORDER_ROTATED // each begins one trial later than the one before
} ob_order;

// Trials from "from" on are one repeat: adds those of the repeats that follow, "repeats" in all, so that a busy minute
// of the machine meets all configurations alike. seeds: repeat r of a trial has its seed + r; else they have the same
// seed. false: no memory.
bool ob_trials_repeat(ob_trials *s, size_t from, uint32_t repeats, ob_order order, bool seeds);
void ob_trials_finish(ob_trials *s);

// ---- records

bool ob_records_add(ob_records *r, const ob_record *one); // false: no memory
// NULL: there is none
const ob_record *ob_records_find(const ob_records *r, const char *of, const char *configuration, uint32_t repeat,
				 uint64_t seed);
// Takes away what has the case and the configuration of a trial of the schedule.
void ob_records_drop(ob_records *r, const ob_trials *s);
void ob_records_finish(ob_records *r);

// A file of CSV (base/csv.h): a line for each record, columns by name; numbers read back to the same bits. A missing
// file is empty, and a last line without its end is left out: somebody was interrupted while writing it.
bool ob_records_read(ob_records *r, const ob_experiment *x, const char *path, ob_error *e);
// Replaces the file at once: whoever looks sees the old one or the new one.
bool ob_records_write(const ob_records *r, const ob_experiment *x, const char *path, ob_error *e);

// ---- running

// Makes the folder, with all above it, and reads its results.csv. Results of another commit or machine, or of what is
// no results file, get a name of their own, and it is said so. folder NULL: nothing is kept. On another rank than the
// first: neither made nor read.
bool ob_experiment_open(const ob_experiment *x, const char *folder, ob_records *r, ob_error *e);
// Runs what r does not have yet, and keeps it in r and in folder/results.csv (NULL: nowhere). Of the same case,
// configuration and seed nothing is run again after a failure, but for what had less time than there is now. Says
// before it begins how long it will take. false and e: interrupted, or the file cannot be written; what was done until
// then is in both. From a process without other threads.
// On several ranks (ranks/ranks.h) each calls it with the same schedule. The first gets all records, the same as alone but for
// what they say of time, and writes the file; the others return, with none, when all is done. A trial waits for an earlier
// one by which it might become needless.
bool ob_experiment_run(const ob_experiment *x, const ob_trials *s, ob_records *r, const char *folder, ob_error *e);

#endif

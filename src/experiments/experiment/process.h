// Runs each trial in a child process, so that the caller survives whatever happens there: time limits, crashes, its last
// message, interruption. Can also start this program anew from there. Thread-safety: one process at a time per program, by its
// only thread.
#ifndef OB_EXPERIMENT_PROCESS_H
#define OB_EXPERIMENT_PROCESS_H

#include "experiment/experiment.h"

// Empty record of a trial; marked with machine and commit of "of".
ob_record ob_trial_record(const ob_records *of, const ob_trial *t);
// Limit of wall-clock time (s); CPU time is the actual limit.
double ob_trial_wall_limit(const ob_experiment *x);

// Callbacks while a trial runs.
typedef struct ob_meanwhile {
	void (*tick)(void *of); // a few times a second; NULL = not wanted
	bool (*attend)(void *of); // as soon as "ear" is readable. Returns false to end the trial. NULL = not wanted
	int ear; // file descriptor
	void *of;
} ob_meanwhile;

// Runs a trial; its standard input and output are closed, and its standard error is reported only if it dies. Processes that it
// has started end with it. Returns false and e on a failure that is not the trial's own: the child could not be started, or was
// interrupted, by a signal to this process or by attend.
bool ob_trial_run(const ob_experiment *x, const ob_trial *t, const ob_meanwhile *meanwhile, ob_record *r, ob_error *e);

// From begin to end, SIGINT, SIGTERM and SIGHUP end the current trial, or the next one, and nothing else.
void ob_processes_begin(void);
void ob_processes_end(void);
bool ob_processes_interrupted(void);
// Between both: waits until a file descriptor is readable, for some seconds, or until such a signal.
void ob_processes_wait(int ear, double s);

// Runs this program with other arguments (argv[0] is for show), in memory of their own, which it frees. Call it within a trial:
// it ends together with that. Returns its standard output, to be freed; NULL and e: it could not be run, or did not end with 0.
// argv NULL: out of memory.
char *ob_program_report(char **argv, ob_error *e);
void ob_program_free_arguments(char **argv);

#endif

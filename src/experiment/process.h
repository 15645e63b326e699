// Runs a piece of work in a child process, so that the caller survives whatever happens there: time limits, crashes,
// its last message, interruption. Can also start this program anew from there. Thread-safety: one process at a time per
// program, by its only thread.
#ifndef OB_EXPERIMENT_PROCESS_H
#define OB_EXPERIMENT_PROCESS_H

#include <stdbool.h>
#include <stddef.h>

#include <ob/error.h>

enum { OB_PROCESS_ANSWER = 32768 }; // bytes, at most: less than a pipe holds

typedef struct ob_process {
	// Runs in the child. Returns false and e if the work could not be done. Its standard input and output are
	// closed; its standard error is reported only if it dies.
	bool (*work)(const void *with, void *answer, ob_error *e);
	const void *with;
	size_t size; // of the answer; plain data
	double cpu_limit_s, wall_limit_s; // 0 = none
	void (*tick)(void *of); // called a few times a second while the child runs; NULL = not wanted
	// Called while the child runs, as soon as "ear" is readable. Returns false to end the child. NULL = not wanted
	bool (*attend)(void *of);
	int ear; // file descriptor
	void *of;
} ob_process;

typedef enum ob_process_end {
	OB_PROCESS_ANSWERED,
	OB_PROCESS_GAVE_UP, // work returned false
	OB_PROCESS_CRASHED, // ended by a signal, or without an answer
	OB_PROCESS_OUT_OF_TIME,
	OB_PROCESS_INTERRUPTED, // by a signal to this process, or by hear
	OB_PROCESS_NOT_STARTED
} ob_process_end;

typedef struct ob_process_cost {
	double wall_s, cpu_s;
} ob_process_cost;

// answer holds its initial contents; if the child answered (and only then), the child's result. e: the reason, unless
// answered. Processes started by the child are terminated, then killed.
ob_process_end ob_process_run(const ob_process *p, void *answer, ob_process_cost *cost, ob_error *e);

// From begin to end, SIGINT, SIGTERM and SIGHUP end the current process, or the next one, and nothing else.
void ob_processes_begin(void);
void ob_processes_end(void);
bool ob_processes_interrupted(void);
// Between both: waits until a file descriptor is readable, for some seconds, or until such a signal.
void ob_processes_wait(int ear, double s);

typedef struct ob_program_result {
	int code; // exit status; 128 + number if a signal ended it
	char *out; // its standard output, with a final 0; never NULL after success
	char complaint[256]; // last line of its standard error as "obsim: ..."; "" = none
} ob_program_result;

// Runs this program with other arguments (argv[0] is for show), and collects its output. Call it within a process's
// work: it ends together with that process. Returns false and e if it could not be started or read. free(r->out).
bool ob_program_run(char *const argv[], ob_program_result *r, ob_error *e);
// Same, for arguments in memory of their own, which it frees. Returns the output, to be freed; NULL and e: it could not be
// run, or did not end with 0. argv NULL: out of memory.
char *ob_program_report(char **argv, ob_error *e);
void ob_program_free_arguments(char **argv);

#endif

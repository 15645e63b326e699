// A piece of work in a child process of its own, so that whatever it does there, its caller goes on: limits of time,
// crashes, what it said last, interruption. And this program itself, run afresh from there.
// Thread-safety: one process at a time per program, by its only thread.
#ifndef OB_EXPERIMENT_PROCESS_H
#define OB_EXPERIMENT_PROCESS_H

#include <stdbool.h>
#include <stddef.h>

#include <ob/error.h>

enum { OB_PROCESS_ANSWER = 32768 }; // bytes, at most: less than a pipe holds

typedef struct ob_process {
	// In the child. false and e: it could not be done. Standard input and output are closed to it, and what it says
	// on standard error is heard only if it dies.
	bool (*work)(const void *with, void *answer, ob_error *e);
	const void *with;
	size_t size; // of the answer; plain data
	double cpu_limit_s, wall_limit_s; // 0 = none
	void (*tick)(void *of); // a few times a second while the child runs; NULL = not wanted
	// While the child runs, as soon as there is something to read from "ear"; false: the child shall end. NULL =
	// not wanted
	bool (*hear)(void *of);
	int ear; // file descriptor
	void *of;
} ob_process;

typedef enum ob_process_end {
	OB_PROCESS_ANSWERED,
	OB_PROCESS_GAVE_UP, // work was false
	OB_PROCESS_CRASHED, // a signal ended it, or it ended without an answer
	OB_PROCESS_OUT_OF_TIME,
	OB_PROCESS_INTERRUPTED, // by a signal to this process, or by hear
	OB_PROCESS_NOT_STARTED
} ob_process_end;

typedef struct ob_process_cost {
	double wall_s, cpu_s;
} ob_process_cost;

// answer holds what it begins with, and (only) if answered what the child made of it. e: why, unless answered. All that
// the child has started is asked to end, and then killed.
ob_process_end ob_process_run(const ob_process *p, void *answer, ob_process_cost *cost, ob_error *e);

// From begin to end SIGINT, SIGTERM and SIGHUP end the process that is under way, or the next one, and nothing else.
void ob_processes_begin(void);
void ob_processes_end(void);
bool ob_processes_interrupted(void);
// Between both: waits until there is something to read from a file descriptor, or for some seconds, or for such a
// signal.
void ob_processes_wait(int ear, double s);

typedef struct ob_program_result {
	int code; // exit status; 128 + number if a signal ended it
	char *out; // its standard output, with a final 0; never NULL after success
	char complaint[256]; // the last line that it wrote to standard error as "obsim: ..."; "" = none
} ob_program_result;

// Runs this program with other arguments (argv[0] is for show), and collects what it says. From within a process's
// work: it ends with it. false and e if it could not be started or read. free(r->out).
bool ob_program_run(char *const argv[], ob_program_result *r, ob_error *e);

#endif

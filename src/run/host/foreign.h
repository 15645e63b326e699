// Owner of foreign code: starts a process for each FMU at the desk of a worker (table/desk.h), and bounds it. The fork server
// is the owner, whether simulators are threads or processes.
//
//   it crashes, exits        the worker is sent the cause, and fails the object at work
//   it hangs                 it is killed when the run's patience is over, and as above
//   it forks, sends signals  it is killed (SIGSYS; host/confine.h)
//   it writes                standard error is handed on by lines that begin with the FMU's name, without control characters,
//                            up to 8 KiB for each FMU in a run; standard output is dropped
//   the run ends             it is killed
//
// Thread-safety: one thread.
#ifndef OB_HOST_FOREIGN_H
#define OB_HOST_FOREIGN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "base/clock.h"
#include "table/desk.h"

typedef struct ob_foreign_process {
	pid_t pid;
	ob_desk desk;
	uint32_t number, foreign; // foreign: number of its FMU
	bool hung, again; // again: another takes its place when it has ended
	bool wrote; // since the last look; this process may not have read all of it at once
	uint32_t question, done; // the worker's, at the last look
	ob_hang_count count;
	uint32_t line_bytes;
	char line[200]; // text since its last whole line
} ob_foreign_process;

typedef struct ob_foreign_owner {
	ob_universe *u;
	double patience, looked; // s; looked: wall, at the last look for hangs
	int bell, words; // bell: calls of workers; words: standard error of processes
	uint32_t processes, room;
	ob_foreign_process *process; // [processes]
	uint32_t *written; // [foreign]: bytes handed on
} ob_foreign_owner;

// Starts the processes that workers have called for.
void ob_foreign_answer_calls(ob_foreign_owner *o);
// Takes the end of a child; false: it was none of these processes.
bool ob_foreign_reap(ob_foreign_owner *o, pid_t pid, int status);
// Takes text that a child has written; likewise.
bool ob_foreign_take_words(ob_foreign_owner *o, pid_t pid, const char *text, size_t n);
// Kills processes that hang; call it at least ten times a second.
void ob_foreign_watch(ob_foreign_owner *o);
void ob_foreign_kill_all(const ob_foreign_owner *o);

// ---- words

// Text that child processes write on standard error, on its way to the host's.

// Writes to standard error as much as it takes now, without blocking.
void ob_words_hand_on(const char *text, size_t n);

#endif

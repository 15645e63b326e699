// The keeper: a small process forked from the host before the host has threads, RCU readers or a GL context.
//
// Two duties. It forks the simulators of an isolated run (a fork from a small process is cheap, and the children
// inherit nothing but the universe), and it outlives a host that was killed: when its link to the host breaks, it
// removes the universe's name, kills the simulators that are left, and ends.
//
//   host ----- link (seqpacket) ----- keeper ---fork--> simulator 0, 1, 2 ...   (each dies with the keeper)
//        workers first .. first+count  >                   (count 0: an end to all)
//        <  ob_worker_end, one per simulator that ended, by whatever cause
//
// The keeper is the simulators' parent, so it hears of each death at once (SIGCHLD) and with its exact cause, and the
// host needs neither a file descriptor nor a poll entry per simulator. It has a session of its own: Ctrl-C at the
// terminal is the host's to handle.
//
// Thread-safety: one thread at a time per ob_fork_server.
#ifndef OB_HOST_FORK_SERVER_H
#define OB_HOST_FORK_SERVER_H

#include <sys/types.h>

#include "table/table.h"

// The life of one worker, in its own thread or process. 0 = it was told to stop and left.
typedef int (*ob_worker_run)(ob_universe *u, uint32_t worker);

typedef struct ob_worker_end {
	uint32_t worker;
	int32_t pid; // of its process
	int32_t error; // errno when it could not be started at all; else 0
	int32_t signal; // that killed it; else 0
	int32_t code; // with which it left; 0 = as told
} ob_worker_end;

typedef struct ob_fork_server ob_fork_server;

// run is what its simulators will execute, on the universe mapped here. NULL and e on failure.
ob_fork_server *ob_fork_server_start(ob_universe *u, ob_worker_run run, ob_error *e);
pid_t ob_fork_server_pid(const ob_fork_server *k);
// Readable when there is an ob_worker_end to fetch; POLLHUP when the keeper is gone.
int ob_fork_server_fd(const ob_fork_server *k);
// Asks for simulators first .. first+count-1. false: the keeper is gone.
bool ob_fork_server_fork(ob_fork_server *k, uint32_t first, uint32_t count);
// Kills all simulators that there are. Their ends are reported.
bool ob_fork_server_kill(ob_fork_server *k);
// Fetches one, without waiting; false: none at the moment.
bool ob_fork_server_next_end(ob_fork_server *k, ob_worker_end *end);
// Ends the keeper and with it every simulator that is left, and waits for it. NULL is allowed.
void ob_fork_server_stop(ob_fork_server *k);

#endif

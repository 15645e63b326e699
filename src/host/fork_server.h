// The fork server: a small process forked from the host before the host has threads, RCU readers or a GL context.
//
// It has two duties. It forks the worker processes of an isolated run: a fork from a small process is cheap, and the
// children inherit nothing but the universe. And it cleans up after a host that was killed: when its link to the host
// breaks, it removes the universe's name, kills the workers that are left, and exits. It owns the universe beside the host
// (table/segment.h).
//
//   host ----- link (seqpacket) ----- fork server ---fork--> worker process 0, 1, 2 ...   (each dies with the fork server)
//        workers first .. first+count  >                   (count 0: kill all)
//        <  ob_worker_end, one per worker that ended, by whatever cause
//
//   workers' standard error --- one socket ---> fork server ---> its own standard error, the host's
//
// What workers write on standard error passes through the fork server, which keeps the last of each for its
// ob_worker_end. All write into one socket; the kernel says whose it was (SCM_CREDENTIALS). It is handed on at once, but
// where that would block: a reader that does not read loses it, and holds nobody up.
//
// The fork server is the workers' parent, so it learns of each death at once (SIGCHLD) and with its exact cause, and the
// host needs neither a file descriptor nor a poll entry per worker. It has a session of its own: the host alone handles
// Ctrl-C at the terminal.
//
// Thread-safety: one thread at a time per ob_fork_server.
#ifndef OB_HOST_FORK_SERVER_H
#define OB_HOST_FORK_SERVER_H

#include <sys/types.h>

#include "host/worker.h"

typedef struct ob_fork_server ob_fork_server;

// run is what its workers will execute, on the universe mapped here. NULL and e on failure.
ob_fork_server *ob_fork_server_start(ob_universe *u, ob_worker_run run, ob_error *e);
pid_t ob_fork_server_pid(const ob_fork_server *s);
// Readable when there is an ob_worker_end to fetch; POLLHUP when the fork server is gone.
int ob_fork_server_fd(const ob_fork_server *s);
// Asks for workers first .. first+count-1. false: the fork server is gone.
bool ob_fork_server_fork(ob_fork_server *s, uint32_t first, uint32_t count);
// Kills all workers that there are. Their ends are reported.
bool ob_fork_server_kill(ob_fork_server *s);
// Fetches one report, without waiting; false: none at the moment.
bool ob_fork_server_next_end(ob_fork_server *s, ob_worker_end *end);
// Ends the fork server and with it every worker that is left. It is killed if it does not end within some seconds, or at
// once if it is stopped. NULL is allowed.
void ob_fork_server_stop(ob_fork_server *s);

#endif

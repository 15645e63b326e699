// The fork server: a small process forked from the host before the host has threads, RCU readers or a GL context.
//
// It has two duties. It forks the worker processes of an isolated run: a fork from a small process is cheap, and the
// It has two duties. It forks the worker processes of an isolated run: a fork from a small process is cheap, and the
// children inherit nothing but the universe. It also cleans up after a host that was killed: when the link to the host
// breaks, it removes the universe's name, kills the remaining workers, and exits. It owns the universe beside the host
// (table/segment.h).
//
//   host ----- link (seqpacket) ----- fork server ---fork--> worker process 0, 1, 2 ...   (each dies with the fork server)
//        workers first .. first+count: fork, or kill  >
//        <  ob_worker_end, one per worker that ended, whatever the cause
//
//   workers' standard error --- one socket ---> fork server ---> its own standard error, the host's
//
// Standard error of workers passes through the fork server, which keeps the end of each worker's text for its
// ob_worker_end. All write into one socket; the kernel names the writer (SCM_CREDENTIALS). The fork server passes the
// text on at once, unless that would block: a reader that does not read loses text, and delays no worker.
//
// The fork server is the workers' parent, so SIGCHLD reports each death at once with its exact cause. The host needs
// neither a file descriptor nor a poll entry per worker. The fork server has a session of its own: the host alone
// handles Ctrl-C at the terminal.
//
// Thread-safety: one thread at a time per ob_fork_server.
#ifndef OB_HOST_FORK_SERVER_H
#define OB_HOST_FORK_SERVER_H

#include <sys/types.h>

#include "host/worker.h"

typedef struct ob_fork_server ob_fork_server;

// Starts the fork server; its workers will execute run on the universe mapped here. patience: s that an FMU may take for a
// step. NULL and e on failure.
ob_fork_server *ob_fork_server_start(ob_universe *u, ob_worker_run run, double patience, ob_error *e);
pid_t ob_fork_server_pid(const ob_fork_server *s);
// Readable when there is an ob_worker_end to fetch; POLLHUP when the fork server is gone.
int ob_fork_server_fd(const ob_fork_server *s);
// Requests workers first .. first+count-1. false: the fork server is gone.
bool ob_fork_server_fork(ob_fork_server *s, uint32_t first, uint32_t count);
// Kills the workers first .. first+count-1. Their ends are reported. Any thread.
bool ob_fork_server_kill(ob_fork_server *s, uint32_t first, uint32_t count);
// Fetches one report, without waiting; false: none at the moment.
bool ob_fork_server_next_end(ob_fork_server *s, ob_worker_end *end);
// Ends the fork server and all its remaining workers. Kills it if it does not end within some seconds, or at once if it
// is stopped by a signal. NULL is allowed.
void ob_fork_server_stop(ob_fork_server *s);

#endif

#include "host/fork_server.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

struct ob_fork_server {
	pid_t pid;
	int link;
};

// count 0: kill them all instead
typedef struct fork_request {
	uint32_t first, count;
} fork_request;

// ---- the keeper's side

typedef struct keeper {
	ob_universe *u;
	ob_worker_run run;
	int link, children_fd; // the host; SIGCHLD
	uint32_t workers;
	pid_t *pid; // [workers]; 0 = none
} keeper;

enum { LINK_FD = 3 };

// Nothing of the host's is wanted here: no file of a recorder, no device of a renderer, no terminal input.
static void shed_inheritance(int link)
{
	int null = open("/dev/null", O_RDWR);
	if (null >= 0) {
		dup2(null, STDIN_FILENO);
		dup2(null, STDOUT_FILENO);
	}
	if (link != LINK_FD)
		dup2(link, LINK_FD);
	close_range(LINK_FD + 1, ~0U, 0);
}

// Left to their defaults in the keeper, a signal to the whole group would end the one that has to tidy up.
static void set_signals(void (*on_end)(int))
{
	static const int ends[] = { SIGINT, SIGTERM, SIGHUP, SIGQUIT };
	for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
		signal(ends[i], on_end);
}

_Noreturn static void live_as_simulator(const keeper *k, uint32_t worker, pid_t parent)
{
	sigset_t none;
	char name[16];
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent)
		_exit(EXIT_FAILURE); // the keeper died before the line above took effect
	set_signals(SIG_DFL);
	signal(SIGINT, SIG_IGN);
	sigemptyset(&none);
	sigprocmask(SIG_SETMASK, &none, NULL);
	close_range(LINK_FD, ~0U, 0);
	snprintf(name, sizeof name, "sim %u", worker);
	prctl(PR_SET_NAME, name);
	_exit(k->run(k->u, worker));
}

static bool report(const keeper *k, const ob_worker_end *end)
{
	ssize_t n;
	do {
		n = send(k->link, end, sizeof *end, MSG_NOSIGNAL);
	} while (n < 0 && errno == EINTR);
	return n == sizeof *end;
}

static void fork_simulators(keeper *k, fork_request r)
{
	pid_t self = getpid();
	int error = 0; // once a fork has failed, the rest is not tried
	for (uint32_t w = r.first; w < k->workers && w - r.first < r.count; w++) {
		pid_t pid = error ? -1 : fork();
		if (pid == 0)
			live_as_simulator(k, w, self);
		if (pid > 0) {
			k->pid[w] = pid;
			continue;
		}
		error = error ? error : errno;
		report(k, &(ob_worker_end){ .worker = w, .error = error });
	}
}

static void kill_simulators(const keeper *k)
{
	for (uint32_t w = 0; w < k->workers; w++) {
		if (k->pid[w] > 0)
			kill(k->pid[w], SIGKILL);
	}
}

static void reap(keeper *k)
{
	int status;
	pid_t pid;
	while ((pid = waitpid(-1, &status, WNOHANG)) > 0) {
		uint32_t w = 0;
		while (w < k->workers && k->pid[w] != pid)
			w++;
		if (w == k->workers)
			continue;
		k->pid[w] = 0;
		report(k, &(ob_worker_end){ .worker = w,
					    .pid = pid,
					    .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
					    .code = WIFEXITED(status) ? WEXITSTATUS(status) : 0 });
	}
}

// The host has closed the link or is dead. The name goes first: it is what would outlive us.
_Noreturn static void tidy_up(const keeper *k)
{
	ob_universe_unlink(ob_universe_name(k->u));
	kill_simulators(k);
	while (waitpid(-1, NULL, 0) > 0 || errno == EINTR)
		;
	_exit(EXIT_SUCCESS);
}

_Noreturn static void keep(keeper *k)
{
	struct pollfd fds[2] = { { .fd = k->link, .events = POLLIN }, { .fd = k->children_fd, .events = POLLIN } };
	for (;;) {
		if (poll(fds, 2, -1) < 0 && errno != EINTR)
			tidy_up(k);
		if (fds[1].revents) {
			struct signalfd_siginfo drained;
			if (read(k->children_fd, &drained, sizeof drained) > 0)
				reap(k);
		}
		if (fds[0].revents) {
			fork_request r;
			if (recv(k->link, &r, sizeof r, MSG_DONTWAIT) == sizeof r)
				r.count ? fork_simulators(k, r) : kill_simulators(k);
			else if (fds[0].revents & (POLLHUP | POLLERR))
				tidy_up(k);
		}
	}
}

_Noreturn static void live_as_keeper(ob_universe *u, ob_worker_run run, int link)
{
	keeper k = { .u = u, .run = run, .link = LINK_FD, .workers = ob_universe_workers(u) };
	sigset_t child;
	setsid();
	prctl(PR_SET_NAME, "obsim-keeper");
	set_signals(SIG_IGN);
	signal(SIGCHLD, SIG_DFL);
	sigemptyset(&child);
	sigaddset(&child, SIGCHLD);
	sigprocmask(SIG_SETMASK, &child, NULL);
	shed_inheritance(link);
	k.children_fd = signalfd(-1, &child, SFD_CLOEXEC | SFD_NONBLOCK);
	k.pid = calloc(k.workers, sizeof *k.pid);
	if (k.children_fd < 0 || !k.pid)
		tidy_up(&(keeper){ .u = u });
	keep(&k);
}

// ---- the host's side

ob_fork_server *ob_fork_server_start(ob_universe *u, ob_worker_run run, ob_error *e)
{
	int ends[2];
	ob_fork_server *k = calloc(1, sizeof *k);
	if (!k || socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
		free(k);
		ob_fail(e, "cannot make the link to the keeper process: %s", strerror(errno));
		return NULL;
	}
	k->pid = fork();
	if (k->pid == 0)
		live_as_keeper(u, run, ends[1]);
	close(ends[1]);
	if (k->pid < 0) {
		ob_fail(e, "cannot fork the keeper process: %s", strerror(errno));
		close(ends[0]);
		free(k);
		return NULL;
	}
	k->link = ends[0];
	return k;
}

pid_t ob_fork_server_pid(const ob_fork_server *k)
{
	return k->pid;
}
int ob_fork_server_fd(const ob_fork_server *k)
{
	return k->link;
}

static bool ask(ob_fork_server *k, fork_request r)
{
	return send(k->link, &r, sizeof r, MSG_NOSIGNAL) == sizeof r;
}

bool ob_fork_server_fork(ob_fork_server *k, uint32_t first, uint32_t count)
{
	return ask(k, (fork_request){ first, count });
}

bool ob_fork_server_kill(ob_fork_server *k)
{
	return ask(k, (fork_request){ 0 });
}

bool ob_fork_server_next_end(ob_fork_server *k, ob_worker_end *end)
{
	ssize_t n;
	do {
		n = recv(k->link, end, sizeof *end, MSG_DONTWAIT);
	} while (n < 0 && errno == EINTR);
	return n == sizeof *end;
}

void ob_fork_server_stop(ob_fork_server *k)
{
	if (!k)
		return;
	close(k->link);
	while (waitpid(k->pid, NULL, 0) < 0 && errno == EINTR)
		;
	free(k);
}

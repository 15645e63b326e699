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
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "host/accounting.h"

struct ob_fork_server {
	pid_t pid;
	int link;
};

// count 0: kill them all instead
typedef struct fork_request {
	uint32_t first, count;
} fork_request;

// ---- the fork server's side

typedef struct server {
	ob_universe *u;
	ob_worker_run run;
	int link, children_fd; // the host; SIGCHLD
	uint32_t workers;
	pid_t *pid; // [workers]; 0 = none
} server;

enum { LINK_FD = 3, SEGMENT_FD = 4 };

// The fork server needs nothing that the host has open: no file of a recorder, no device of a renderer, no terminal
// input. It keeps the universe's segment, which it owns beside the host.
static void close_inherited_files(ob_universe *u, int link)
{
	int null = open("/dev/null", O_RDWR);
	if (null >= 0) {
		dup2(null, STDIN_FILENO);
		dup2(null, STDOUT_FILENO);
	}
	// first out of the way of each other
	link = fcntl(link, F_DUPFD, SEGMENT_FD + 1);
	int segment = fcntl(ob_universe_fd(u), F_DUPFD, SEGMENT_FD + 1);
	dup2(link, LINK_FD);
	dup2(segment, SEGMENT_FD);
	ob_universe_move_fd(u, SEGMENT_FD);
	close_range(SEGMENT_FD + 1, ~0U, 0);
}

// With the default actions, a signal to the whole process group would end the fork server, which has to clean up.
static void set_signals(void (*on_end)(int))
{
	static const int ends[] = { SIGINT, SIGTERM, SIGHUP, SIGQUIT };
	for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
		signal(ends[i], on_end);
}

_Noreturn static void run_simulator(const server *s, uint32_t worker, pid_t parent)
{
	sigset_t none;
	char name[16];
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent)
		_exit(EXIT_FAILURE); // the fork server died before the line above took effect
	set_signals(SIG_DFL);
	signal(SIGINT, SIG_IGN);
	sigemptyset(&none);
	sigprocmask(SIG_SETMASK, &none, NULL);
	close_range(LINK_FD, ~0U, 0);
	snprintf(name, sizeof name, "sim %u", worker);
	prctl(PR_SET_NAME, name);
	_exit(s->run(s->u, worker));
}

static bool report_end(const server *s, const ob_worker_end *end)
{
	ssize_t n;
	do {
		n = send(s->link, end, sizeof *end, MSG_NOSIGNAL);
	} while (n < 0 && errno == EINTR);
	return n == sizeof *end;
}

static void fork_simulators(server *s, fork_request r)
{
	pid_t self = getpid();
	int error = 0; // once a fork has failed, the rest is not tried
	for (uint32_t w = r.first; w < s->workers && w - r.first < r.count; w++) {
		pid_t pid = error ? -1 : fork();
		if (pid == 0)
			run_simulator(s, w, self);
		if (pid > 0) {
			s->pid[w] = pid;
			continue;
		}
		error = error ? error : errno;
		report_end(s, &(ob_worker_end){ .worker = w, .error = error });
	}
}

static void kill_simulators(const server *s)
{
	for (uint32_t w = 0; w < s->workers; w++) {
		if (s->pid[w] > 0)
			kill(s->pid[w], SIGKILL);
	}
}

static void reap(server *s)
{
	int status;
	pid_t pid;
	while ((pid = waitpid(-1, &status, WNOHANG)) > 0) {
		uint32_t w = 0;
		while (w < s->workers && s->pid[w] != pid)
			w++;
		if (w == s->workers)
			continue;
		s->pid[w] = 0;
		report_end(s, &(ob_worker_end){ .worker = w,
						.pid = pid,
						.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
						.code = WIFEXITED(status) ? WEXITSTATUS(status) : 0 });
	}
}

// The host has closed the link or is dead. The name is removed first, for it would outlive all processes.
_Noreturn static void clean_up(const server *s)
{
	ob_universe_unlink(s->u);
	kill_simulators(s);
	while (waitpid(-1, NULL, 0) > 0 || errno == EINTR)
		;
	_exit(EXIT_SUCCESS);
}

_Noreturn static void serve(server *s)
{
	struct pollfd fds[2] = { { .fd = s->link, .events = POLLIN }, { .fd = s->children_fd, .events = POLLIN } };
	for (;;) {
		if (poll(fds, 2, -1) < 0 && errno != EINTR)
			clean_up(s);
		if (fds[1].revents) {
			struct signalfd_siginfo drained;
			if (read(s->children_fd, &drained, sizeof drained) > 0)
				reap(s);
		}
		if (fds[0].revents) {
			fork_request r;
			if (recv(s->link, &r, sizeof r, MSG_DONTWAIT) == sizeof r)
				r.count ? fork_simulators(s, r) : kill_simulators(s);
			else if (fds[0].revents & (POLLHUP | POLLERR))
				clean_up(s);
		}
	}
}

_Noreturn static void run_fork_server(ob_universe *u, ob_worker_run run, int link)
{
	server s = { .u = u, .run = run, .link = LINK_FD, .workers = ob_universe_workers(u) };
	sigset_t child;
	setsid();
	prctl(PR_SET_NAME, "obsim-fork");
	set_signals(SIG_IGN);
	signal(SIGCHLD, SIG_DFL);
	signal(SIGBUS, SIG_DFL); // of a simulator: the host says what it means
	sigemptyset(&child);
	sigaddset(&child, SIGCHLD);
	sigprocmask(SIG_SETMASK, &child, NULL);
	close_inherited_files(u, link);
	s.children_fd = signalfd(-1, &child, SFD_CLOEXEC | SFD_NONBLOCK);
	s.pid = calloc(s.workers, sizeof *s.pid);
	if (s.children_fd < 0 || !s.pid)
		clean_up(&(server){ .u = u });
	serve(&s);
}

// ---- the host's side

static const double end_timeout = 5; // s to wait for the fork server's end, before and after it is killed
static const long longest_pause_ns = 5000000;

ob_fork_server *ob_fork_server_start(ob_universe *u, ob_worker_run run, ob_error *e)
{
	int ends[2];
	ob_fork_server *s = calloc(1, sizeof *s);
	if (!s || socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
		free(s);
		ob_fail(e, "cannot make the link to the fork server: %s", strerror(errno));
		return NULL;
	}
	s->pid = fork();
	if (s->pid == 0)
		run_fork_server(u, run, ends[1]);
	close(ends[1]);
	if (s->pid < 0) {
		ob_fail(e, "cannot fork the fork server: %s", strerror(errno));
		close(ends[0]);
		free(s);
		return NULL;
	}
	s->link = ends[0];
	return s;
}

pid_t ob_fork_server_pid(const ob_fork_server *s)
{
	return s->pid;
}
int ob_fork_server_fd(const ob_fork_server *s)
{
	return s->link;
}

static bool send_request(ob_fork_server *s, fork_request r)
{
	return send(s->link, &r, sizeof r, MSG_NOSIGNAL) == sizeof r;
}

bool ob_fork_server_fork(ob_fork_server *s, uint32_t first, uint32_t count)
{
	return send_request(s, (fork_request){ first, count });
}

bool ob_fork_server_kill(ob_fork_server *s)
{
	return send_request(s, (fork_request){ 0 });
}

bool ob_fork_server_next_end(ob_fork_server *s, ob_worker_end *end)
{
	ssize_t n;
	do {
		n = recv(s->link, end, sizeof *end, MSG_DONTWAIT);
	} while (n < 0 && errno == EINTR);
	return n == sizeof *end;
}

// Whether the fork server has ended within so many seconds. One that somebody has stopped is not waited for.
static bool wait_for_end(pid_t pid, double timeout)
{
	ob_hang_clock clock = ob_hang_clock_start();
	for (long pause_ns = 50000; ob_hang_clock_tick(&clock) < timeout;) {
		int status;
		pid_t found = waitpid(pid, &status, WNOHANG | WUNTRACED);
		if (found == pid && WIFSTOPPED(status))
			return false;
		if (found == pid || (found < 0 && errno != EINTR))
			return true;
		nanosleep(&(struct timespec){ .tv_nsec = pause_ns }, NULL);
		pause_ns = pause_ns < longest_pause_ns ? pause_ns + pause_ns / 4 : longest_pause_ns;
	}
	return false;
}

void ob_fork_server_stop(ob_fork_server *s)
{
	if (!s)
		return;
	close(s->link);
	if (!wait_for_end(s->pid, end_timeout)) {
		ob_log_warn("the fork server (process %d, %s) does not end: killed", (int)s->pid,
			    ob_state_word(ob_state_of_thread(s->pid, s->pid)));
		kill(s->pid, SIGKILL); // and with it its workers
		wait_for_end(s->pid, end_timeout);
	}
	free(s);
}

#include "host/fork_server.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stddef.h>
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
#include "base/utf8.h"
#include "host/accounting.h"
#include "host/confine.h"
#include "host/foreign.h"

struct ob_fork_server {
	pid_t pid;
	int link;
	int bell; // for workers of this process; -1: none
};

// count 0: kill them all instead
typedef struct fork_request {
	uint32_t first, count, kill; // kill: 1, else fork
} fork_request;

// ---- the fork server's side

typedef struct server {
	ob_universe *u;
	ob_worker_run run;
	int link, children_fd; // link: to the host; children_fd: SIGCHLD
	int words_in, words_out; // workers write standard error to words_out; words_in: where the fork server reads it
	uint32_t workers;
	pid_t *pid; // [workers]; 0 = none
	char (*words)[OB_LAST_WORDS]; // [workers]: the end of that text
	ob_foreign_owner foreign;
} server;

enum { BELL_FD = OB_CALL_FD, BELL_IN_FD, LINK_FD, SEGMENT_FD, FIRST_FREE_FD }; // bell: see table/desk.h
#define NO_WORKER UINT32_MAX

// Closes all inherited files but the universe's segment, which the fork server owns beside the host. It needs no file
// of a recorder, no device of a renderer, no terminal input.
static bool close_inherited_files(ob_universe *u, int link, const int bell[2])
{
	int null = open("/dev/null", O_RDWR);
	if (null >= 0) {
		dup2(null, STDIN_FILENO);
		dup2(null, STDOUT_FILENO);
	}
	// moves all aside first, so that none overwrites another
	const int from[] = { bell[1], bell[0], link, ob_universe_fd(u) };
	int aside[sizeof from / sizeof *from];
	for (int i = 0; i < SEGMENT_FD - BELL_FD + 1; i++) {
		aside[i] = from[i] < 0 ? null : fcntl(from[i], F_DUPFD, FIRST_FREE_FD);
		if (aside[i] < 0)
			return false;
	}
	for (int i = 0; i < SEGMENT_FD - BELL_FD + 1; i++)
		if (dup2(aside[i], BELL_FD + i) < 0)
			return false;
	ob_universe_move_fd(u, SEGMENT_FD);
	close_range(FIRST_FREE_FD, ~0U, 0);
	return true;
}

// Sets the actions of ending signals. With the defaults, a signal to the process group would end the fork server before
// it cleans up.
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
	dup2(s->words_out, STDERR_FILENO);
	close_range(s->foreign.bell < 0 ? BELL_FD : BELL_FD + 1, ~0U, 0);
	snprintf(name, sizeof name, "sim %u", worker);
	prctl(PR_SET_NAME, name);
	_exit(s->run(s->u, worker));
}

// ---- last words

static uint32_t worker_of(const server *s, pid_t pid)
{
	uint32_t w = 0;
	while (w < s->workers && s->pid[w] != pid)
		w++;
	return w;
}

// Appends a worker's new text; the oldest drops out.
static void keep_words(char kept[OB_LAST_WORDS], const char *text, size_t n)
{
	const size_t most = OB_LAST_WORDS - 1;
	size_t before = strlen(kept);
	if (n > most) {
		text += n - most;
		n = most;
	}
	if (before + n > most) {
		const size_t fall = before + n - most;
		memmove(kept, kept + fall, before - fall);
		before -= fall;
	}
	for (size_t i = 0; i < n; i++)
		kept[before + i] = text[i] ? text[i] : '?';
	kept[before + n] = 0;
}

// Reads one process's text; false: there is no more now.
static bool take_words(server *s)
{
	char text[1 << 14], control[CMSG_SPACE(sizeof(struct ucred))];
	struct iovec to = { text, sizeof text };
	struct msghdr m = { .msg_iov = &to, .msg_iovlen = 1, .msg_control = control, .msg_controllen = sizeof control };
	const ssize_t n = recvmsg(s->words_in, &m, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
	if (n <= 0)
		return false;
	for (const struct cmsghdr *c = CMSG_FIRSTHDR(&m); c; c = CMSG_NXTHDR(&m, (struct cmsghdr *)c)) {
		struct ucred who;
		if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_CREDENTIALS)
			continue;
		memcpy(&who, CMSG_DATA(c), sizeof who);
		const uint32_t w = worker_of(s, who.pid);
		if (w < s->workers) {
			keep_words(s->words[w], text, (size_t)n);
			ob_words_hand_on(text, (size_t)n);
		} else {
			ob_foreign_take_words(&s->foreign, who.pid, text, (size_t)n);
		}
	}
	return true;
}

// Reads all text written before now, in a limited number of reads: a worker may write without end.
static void take_all_words(server *s)
{
	for (int i = 0; i < 64 && take_words(s); i++)
		;
}

// Turns whole lines, if there are any, into one line with | between them, free of control characters.
static void last_lines(char words[OB_LAST_WORDS])
{
	size_t n = strlen(words);
	while (n > 0 && words[n - 1] == '\n')
		words[--n] = 0;
	const char *second = n >= OB_LAST_WORDS - 2 ? strchr(words, '\n') : NULL;
	if (second)
		memmove(words, second + 1, strlen(second + 1) + 1);
	for (char *at = words; *at; at++)
		*at = *at == '\n' ? '|' : *at;
	ob_utf8_make_plain(words);
}

static bool open_words(server *s)
{
	int ends[2];
	const int on = 1;
	if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
		return false;
	s->words_in = ends[0];
	s->words_out = ends[1];
	s->words = calloc(s->workers, sizeof *s->words);
	return s->words && setsockopt(s->words_in, SOL_SOCKET, SO_PASSCRED, &on, sizeof on) == 0;
}

// ---- ends

static void report_end(int link, const ob_worker_end *end)
{
	ssize_t n;
	do {
		n = send(link, end, offsetof(ob_worker_end, words) + strlen(end->words) + 1, MSG_NOSIGNAL);
	} while (n < 0 && errno == EINTR);
}

// First report: error = errno, 0 if the fork server is ready.
static void report_ready(int link, int error)
{
	report_end(link, &(ob_worker_end){ .worker = NO_WORKER, .error = error });
}

static void fork_simulators(server *s, fork_request r)
{
	pid_t self = getpid();
	int error = 0; // after a failed fork, the rest is not tried
	for (uint32_t w = r.first; w < s->workers && w - r.first < r.count; w++) {
		pid_t pid = error ? -1 : fork();
		if (pid == 0)
			run_simulator(s, w, self);
		if (pid > 0) {
			s->pid[w] = pid;
			continue;
		}
		error = error ? error : errno;
		report_end(s->link, &(ob_worker_end){ .worker = w, .error = error });
	}
}

static void kill_simulators(const server *s, fork_request r)
{
	for (uint32_t w = r.first; w < s->workers && w - r.first < r.count; w++) {
		if (s->pid[w] > 0)
			kill(s->pid[w], SIGKILL);
	}
}

static void reap(server *s)
{
	int status;
	pid_t pid;
	while ((pid = waitpid(-1, &status, WNOHANG)) > 0) {
		const uint32_t w = worker_of(s, pid);
		take_all_words(s);
		if (w == s->workers) {
			ob_foreign_reap(&s->foreign, pid, status);
			continue;
		}
		ob_worker_end end = { .worker = w,
				      .pid = pid,
				      .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
				      .code = WIFEXITED(status) ? WEXITSTATUS(status) : 0 };
		last_lines(s->words[w]);
		memcpy(end.words, s->words[w], sizeof end.words);
		s->words[w][0] = 0;
		s->pid[w] = 0;
		report_end(s->link, &end);
	}
}

// Cleans up when the host has closed the link or is dead. Removes the name first: it would outlive all processes.
_Noreturn static void clean_up(const server *s)
{
	ob_universe_unlink(s->u);
	kill_simulators(s, (fork_request){ .count = UINT32_MAX });
	ob_foreign_kill_all(&s->foreign);
	while (waitpid(-1, NULL, 0) > 0 || errno == EINTR)
		;
	_exit(EXIT_SUCCESS);
}

_Noreturn static void serve(server *s)
{
	enum { LOOK_MS = 100 };
	struct pollfd fds[4] = { { .fd = s->link, .events = POLLIN },
				 { .fd = s->children_fd, .events = POLLIN },
				 { .fd = s->words_in, .events = POLLIN },
				 { .fd = s->foreign.bell, .events = POLLIN } };
	for (;;) {
		if (poll(fds, 4, s->foreign.processes ? LOOK_MS : -1) < 0 && errno != EINTR)
			clean_up(s);
		ob_foreign_watch(&s->foreign);
		if (fds[3].revents)
			ob_foreign_answer_calls(&s->foreign);
		if (fds[2].revents)
			take_words(s);
		if (fds[1].revents) {
			struct signalfd_siginfo drained;
			if (read(s->children_fd, &drained, sizeof drained) > 0)
				reap(s);
		}
		if (fds[0].revents) {
			fork_request r;
			if (recv(s->link, &r, sizeof r, MSG_DONTWAIT) == sizeof r)
				r.kill ? kill_simulators(s, r) : fork_simulators(s, r);
			else if (fds[0].revents & (POLLHUP | POLLERR))
				clean_up(s);
		}
	}
}

// Prepares for processes with foreign code, if the universe has any. false: no memory.
static bool open_foreign(server *s, double patience)
{
	const uint32_t desks = ob_desks_count(s->u);
	s->foreign = (ob_foreign_owner){ .u = s->u, .patience = patience, .bell = -1, .words = s->words_out };
	if (!desks)
		return true;
	s->foreign.bell = BELL_IN_FD;
	ob_desks_set_bell(s->u, BELL_FD);
	s->foreign.written = calloc(desks, sizeof *s->foreign.written);
	return s->foreign.written && fcntl(BELL_IN_FD, F_SETFL, O_NONBLOCK) == 0;
}

_Noreturn static void run_fork_server(ob_universe *u, ob_worker_run run, int link, const int bell[2], double patience)
{
	server s = { .u = u, .run = run, .link = LINK_FD, .workers = ob_universe_workers(u) };
	sigset_t child;
	setsid();
	prctl(PR_SET_NAME, "obsim-fork");
	set_signals(SIG_IGN);
	signal(SIGCHLD, SIG_DFL);
	signal(SIGBUS, SIG_DFL); // in a simulator: the host explains the signal
	sigemptyset(&child);
	sigaddset(&child, SIGCHLD);
	sigprocmask(SIG_SETMASK, &child, NULL);
	if (!close_inherited_files(u, link, bell)) {
		report_ready(link, errno);
		_exit(EXIT_FAILURE);
	}
	s.children_fd = signalfd(-1, &child, SFD_CLOEXEC | SFD_NONBLOCK);
	s.pid = calloc(s.workers, sizeof *s.pid);
	if (s.children_fd < 0 || !s.pid || !open_words(&s) || !open_foreign(&s, patience)) {
		report_ready(s.link, errno);
		clean_up(&(server){ .u = u });
	}
	report_ready(s.link, 0);
	serve(&s);
}

// ---- the host's side

static const double start_timeout = 10; // s to wait until the fork server is ready
static const double end_timeout = 5; // s to wait for the fork server's end
static const double killed_timeout = 60; // s after the kill: the kernel reclaims its memory, and its workers'
static const long longest_pause_ns = 5000000;

static const char *remedy(int error)
{
	return error == EMFILE ? "; raise the limit (ulimit -n)" : "";
}

// Waits for the fork server's first report. 0 = it is ready; else errno.
static int wait_until_ready(const ob_fork_server *s)
{
	ob_hang_clock clock = ob_hang_clock_start();
	while (ob_hang_clock_tick(&clock) < start_timeout) {
		struct pollfd p = { .fd = s->link, .events = POLLIN };
		ob_worker_end first;
		if (poll(&p, 1, 100) <= 0)
			continue;
		const ssize_t n = recv(s->link, &first, sizeof first, MSG_DONTWAIT);
		if (n > 0)
			return first.error;
		if (n == 0 || errno != EINTR)
			return ECHILD; // the fork server has ended
	}
	return ETIMEDOUT;
}

ob_fork_server *ob_fork_server_start(ob_universe *u, ob_worker_run run, double patience, ob_error *e)
{
	int ends[2], bell[2] = { -1, -1 };
	ob_fork_server *s = calloc(1, sizeof *s);
	const bool calls = s && ob_desks_count(u) > 0;
	if (!s || (calls && pipe2(bell, O_CLOEXEC) != 0) ||
	    socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
		free(s);
		ob_fail(e, "cannot make the link to the fork server: %s%s", strerror(errno), remedy(errno));
		return NULL;
	}
	if (calls)
		ob_desks_set_bell(u, bell[1]);
	s->pid = fork();
	if (s->pid == 0)
		run_fork_server(u, run, ends[1], bell, patience);
	close(ends[1]);
	if (bell[0] >= 0)
		close(bell[0]);
	s->bell = bell[1];
	if (s->pid < 0) {
		ob_fail(e, "cannot fork the fork server: %s", strerror(errno));
		close(ends[0]);
		free(s);
		return NULL;
	}
	s->link = ends[0];
	const int error = wait_until_ready(s);
	if (error) {
		ob_fork_server_stop(s);
		ob_fail(e, "the fork server does not start: %s%s", strerror(error), remedy(error));
		return NULL;
	}
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
	return send_request(s, (fork_request){ first, count, 0 });
}

bool ob_fork_server_kill(ob_fork_server *s, uint32_t first, uint32_t count)
{
	return send_request(s, (fork_request){ first, count, 1 });
}

bool ob_fork_server_next_end(ob_fork_server *s, ob_worker_end *end)
{
	ssize_t n;
	do {
		n = recv(s->link, end, sizeof *end, MSG_DONTWAIT);
	} while (n < 0 && errno == EINTR);
	if (n <= (ssize_t)offsetof(ob_worker_end, words))
		return false;
	end->words[n - (ssize_t)offsetof(ob_worker_end, words) - 1] = 0;
	return true;
}

// True if the fork server ends within the timeout (s). Returns at once if it is stopped by a signal.
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
	if (s->bell >= 0)
		close(s->bell);
	if (!wait_for_end(s->pid, end_timeout)) {
		ob_log_warn("the fork server (process %d, %s) does not end: killed", (int)s->pid,
			    ob_state_word(ob_state_of_thread(s->pid, s->pid)));
		kill(s->pid, SIGKILL); // its workers die with it
		wait_for_end(s->pid, killed_timeout);
	}
	free(s);
}

#include "lab/attempt.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"

static const double tick_s = .2, shortest_nap_s = 1e-3;
static const double wall_for_cpu = 4; // the limits of time
static const char out_of_time[] = "ran longer than";
static const int stops[] = { SIGINT, SIGTERM, SIGHUP };
enum { STOPS = sizeof stops / sizeof *stops };

// What a child sends home; less than a pipe holds, so it is written at once and in one piece.
typedef struct message {
	bool ran;
	ob_outcome outcome;
	ob_error why; // it did not run
} message;

// The end of what a child wrote to standard error
typedef struct words {
	char text[512];
	size_t length;
} words;

typedef struct child {
	pid_t pid;
	int exit, result, said; // file descriptors: readable at its exit, its message, its standard error
	double begun, wall, cpu; // s: when, and what it has taken so far
} child;

static volatile sig_atomic_t interrupted;
static struct sigaction actions_before[STOPS];
static sigset_t mask_before;

static void on_signal(int number)
{
	interrupted = number;
}

// Signals come only while a child is awaited, so that none is missed.
void ob_attempts_begin(void)
{
	struct sigaction action = { .sa_handler = on_signal };
	sigset_t mask;
	interrupted = 0;
	sigemptyset(&mask);
	for (int i = 0; i < STOPS; i++)
		sigaddset(&mask, stops[i]);
	sigprocmask(SIG_BLOCK, &mask, &mask_before);
	for (int i = 0; i < STOPS; i++)
		sigaction(stops[i], &action, &actions_before[i]);
}

void ob_attempts_end(void)
{
	sigprocmask(SIG_SETMASK, &mask_before, NULL); // what waits is still taken by on_signal
	for (int i = 0; i < STOPS; i++)
		sigaction(stops[i], &actions_before[i], NULL);
}

bool ob_attempts_interrupted(void)
{
	return interrupted != 0;
}

bool ob_attempt_ran_out(const ob_outcome *out)
{
	return strncmp(out->failed, out_of_time, sizeof out_of_time - 1) == 0;
}

bool ob_attempt_had_less(const ob_outcome *out, double limit)
{
	return ob_attempt_ran_out(out) && out->cpu_s < limit && out->wall_s < wall_for_cpu * limit;
}

static void work(const ob_attempt *a, int result)
{
	message m = { 0 };
	m.ran = ob_case_run(a->of, a->engine, &a->settings, &m.outcome, &m.why);
	while (write(result, &m, sizeof m) < 0 && errno == EINTR)
		;
	_exit(0);
}

// Nothing that an engine says may get between the lab's own lines, and it may not outlive the lab. Ctrl-C at a terminal
// reaches both: the parent decides.
static void begin_child(pid_t parent, int said)
{
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent) // it died before the line above
		_exit(1);
	int nothing = open("/dev/null", O_RDWR);
	dup2(nothing, STDIN_FILENO);
	dup2(nothing, STDOUT_FILENO);
	dup2(said, STDERR_FILENO);
	setrlimit(RLIMIT_CORE, &(struct rlimit){ 0, 0 });
	for (int i = 0; i < STOPS; i++)
		signal(stops[i], stops[i] == SIGINT ? SIG_IGN : SIG_DFL);
	sigprocmask(SIG_SETMASK, &mask_before, NULL);
}

static bool start(const ob_attempt *a, child *c, ob_error *e)
{
	int result[2], said[2];
	if (pipe2(result, O_CLOEXEC | O_NONBLOCK) != 0)
		return ob_fail(e, "cannot make a pipe: %s", strerror(errno));
	if (pipe2(said, O_CLOEXEC) != 0) {
		ob_fail(e, "cannot make a pipe: %s", strerror(errno));
		close(result[0]);
		close(result[1]);
		return false;
	}
	pid_t parent = getpid();
	*c = (child){ .pid = fork(), .exit = -1, .result = result[0], .said = said[0], .begun = ob_clock_wall() };
	if (c->pid == 0) {
		begin_child(parent, said[1]);
		work(a, result[1]);
	}
	int why = errno;
	close(result[1]);
	close(said[1]);
	fcntl(said[0], F_SETFL, O_NONBLOCK);
	if (c->pid > 0)
		c->exit = pidfd_open(c->pid, 0);
	if (c->exit >= 0)
		return true;
	why = c->pid > 0 ? errno : why;
	if (c->pid > 0) {
		kill(c->pid, SIGKILL);
		waitpid(c->pid, NULL, 0);
	}
	close(result[0]);
	close(said[0]);
	return ob_fail(e, "cannot start a process: %s", strerror(why));
}

// Reads what there is and keeps the end of it; false when nothing more will come.
static bool listen_to(int fd, words *w)
{
	char more[256];
	for (;;) {
		ssize_t n = read(fd, more, sizeof more);
		if (n <= 0)
			return n < 0 && (errno == EAGAIN || errno == EINTR);
		size_t keep = sizeof w->text - 1 - (size_t)n;
		if (w->length > keep) {
			memmove(w->text, w->text + w->length - keep, keep);
			w->length = keep;
		}
		memcpy(w->text + w->length, more, (size_t)n);
		w->length += (size_t)n;
	}
}

// s until one of the limits may be reached
static double time_left(const ob_attempt *a, child *c)
{
	c->wall = ob_clock_wall() - c->begun;
	c->cpu = fmax(c->cpu, 1e-9 * (double)ob_clock_cpu_of_process(c->pid)); // which is 0 when it is gone
	return fmin(a->limit - c->cpu, wall_for_cpu * a->limit - c->wall);
}

// Waits for the child's end; false: its time is over, or the lab's is.
static bool await(const ob_attempt *a, child *c, words *w)
{
	struct pollfd polls[] = { { .fd = c->exit, .events = POLLIN }, { .fd = c->said, .events = POLLIN } };
	for (;;) {
		double left = time_left(a, c), nap = fmax(fmin(left, tick_s), shortest_nap_s);
		struct timespec t = { .tv_nsec = (long)(nap * 1e9) };
		int n = ppoll(polls, 2, &t, &mask_before);
		if (interrupted)
			return false;
		if (n > 0 && polls[1].revents && !listen_to(c->said, w))
			polls[1].fd = -1;
		if (n > 0 && polls[0].revents)
			return true;
		if (left <= 0)
			return false;
		if (a->tick)
			a->tick(a->with);
	}
}

// The last line that was said, from "said" on
static const char *last_line(words *w)
{
	while (w->length > 0 && strchr("\n\r ", w->text[w->length - 1]))
		w->length--;
	w->text[w->length] = 0;
	const char *line = strrchr(w->text, '\n');
	return line ? line + 1 : w->text;
}

static void explain(const ob_attempt *a, bool ended, int status, const message *m, words *w, ob_outcome *out)
{
	const char *last = last_line(w), *colon = *last ? ": " : "", *name = NULL;
	size_t room = sizeof out->failed;
	if (!ended && out->cpu_s >= a->limit)
		snprintf(out->failed, room, "%s %g s of CPU", out_of_time, a->limit);
	else if (!ended)
		snprintf(out->failed, room, "%s %g s", out_of_time, wall_for_cpu * a->limit);
	else if (WIFSIGNALED(status) && (name = sigabbrev_np(WTERMSIG(status))))
		snprintf(out->failed, room, "crashed, SIG%s%s%.70s", name, colon, last);
	else if (!m)
		snprintf(out->failed, room, "ended with status %d%s%.60s", WEXITSTATUS(status), colon, last);
	else
		snprintf(out->failed, room, "%.95s", m->why.text);
}

static void finish(const ob_attempt *a, const child *c, bool ended, words *w, ob_outcome *out)
{
	struct rusage used = { 0 };
	int status = 0;
	if (!ended)
		kill(c->pid, SIGKILL);
	while (wait4(c->pid, &status, 0, &used) < 0 && errno == EINTR)
		;
	listen_to(c->said, w);
	message m;
	bool told = ended && read(c->result, &m, sizeof m) == (ssize_t)sizeof m;
	if (told && m.ran) {
		*out = m.outcome;
		return;
	}
	double cpu = (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
		     1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
	*out = (ob_outcome){ .wall_s = c->wall, .cpu_s = fmax(cpu, c->cpu), .body_seconds = NAN };
	for (int i = 0; i < OB_FIGURES; i++)
		out->figure[i] = INFINITY;
	explain(a, ended, status, told ? &m : NULL, w, out);
}

bool ob_attempt_run(const ob_attempt *a, ob_outcome *out, ob_error *e)
{
	child c = { 0 };
	words w = { 0 };
	if (!start(a, &c, e))
		return false;
	bool ended = await(a, &c, &w);
	c.wall = ob_clock_wall() - c.begun;
	finish(a, &c, ended, &w, out);
	close(c.exit);
	close(c.result);
	close(c.said);
	return (ended || !interrupted) || ob_fail(e, "interrupted");
}

#include "experiment/process.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"

static const double tick_s = .2, shortest_nap_s = 1e-3;
static const int grace_ms = 2000; // from SIGTERM to SIGKILL
static const int stops[] = { SIGINT, SIGTERM, SIGHUP };
enum { STOPS = sizeof stops / sizeof *stops, PROGRAM_TEXT = 1 << 20 };

// Header of the answer in the pipe; the following bytes may be of any type.
typedef struct verdict {
	_Alignas(max_align_t) bool fine;
	ob_error why;
} verdict;

// Tail of a child's standard error.
typedef struct tail {
	char text[512];
	size_t length;
} tail;

typedef struct child {
	pid_t pid; // and its process group
	int exit, answer, said; // file descriptors: readable at its exit, its answer, its standard error
	double begun;
	ob_process_cost cost; // so far
	bool called_off; // by `hear`
} child;

static volatile sig_atomic_t interrupted;
static struct sigaction actions_before[STOPS];
static sigset_t mask_before;

static void on_signal(int number)
{
	interrupted = number;
}

// Signals are accepted only while waiting for a child, so that none is missed.
void ob_processes_begin(void)
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

void ob_processes_end(void)
{
	sigprocmask(SIG_SETMASK, &mask_before, NULL); // on_signal still takes pending ones
	for (int i = 0; i < STOPS; i++)
		sigaction(stops[i], &actions_before[i], NULL);
}

bool ob_processes_interrupted(void)
{
	return interrupted != 0;
}

void ob_processes_wait(int ear, double s)
{
	const struct timespec time = { (time_t)s, (long)(fmod(s, 1) * 1e9) };
	ppoll(&(struct pollfd){ .fd = ear, .events = POLLIN }, 1, &time, &mask_before);
}

// Prepares a child. It has its own process group: Ctrl-C at a terminal reaches the parent alone, which decides. The
// child does not outlive the parent, and its output does not mix with the parent's lines.
static void begin_child(pid_t parent, int said)
{
	setpgid(0, 0);
	prctl(PR_SET_PDEATHSIG, SIGTERM);
	if (getppid() != parent) // the parent died before the line above
		_exit(1);
	int nothing = open("/dev/null", O_RDWR);
	dup2(nothing, STDIN_FILENO);
	dup2(nothing, STDOUT_FILENO);
	dup2(said, STDERR_FILENO);
	setrlimit(RLIMIT_CORE, &(struct rlimit){ 0, 0 });
	for (int i = 0; i < STOPS; i++)
		signal(stops[i], SIG_DFL);
	sigprocmask(SIG_SETMASK, &mask_before, NULL);
}

static void work(const ob_process *p, const void *answer, int to)
{
	char *message = malloc(sizeof(verdict) + p->size);
	if (!message)
		_exit(1);
	verdict v = { .fine = false };
	memcpy(message + sizeof v, answer, p->size);
	v.fine = p->work(p->with, message + sizeof v, &v.why);
	memcpy(message, &v, sizeof v);
	while (write(to, message, sizeof v + p->size) < 0 && errno == EINTR)
		;
	_exit(0);
}

static bool start(const ob_process *p, const void *answer, child *c, ob_error *e)
{
	int home[2], said[2];
	if (pipe2(home, O_CLOEXEC | O_NONBLOCK) != 0)
		return ob_fail(e, "cannot make a pipe: %s", strerror(errno));
	if (pipe2(said, O_CLOEXEC) != 0) {
		ob_fail(e, "cannot make a pipe: %s", strerror(errno));
		close(home[0]);
		close(home[1]);
		return false;
	}
	fflush(NULL);
	pid_t parent = getpid();
	*c = (child){ .pid = fork(), .exit = -1, .answer = home[0], .said = said[0], .begun = ob_clock_wall() };
	if (c->pid == 0) {
		begin_child(parent, said[1]);
		work(p, answer, home[1]);
	}
	int why = errno;
	close(home[1]);
	close(said[1]);
	fcntl(said[0], F_SETFL, O_NONBLOCK);
	if (c->pid > 0) {
		setpgid(c->pid, c->pid); // parent and child both set it: either may be first
		c->exit = pidfd_open(c->pid, 0);
	}
	if (c->exit >= 0)
		return true;
	why = c->pid > 0 ? errno : why;
	if (c->pid > 0) {
		kill(c->pid, SIGKILL);
		waitpid(c->pid, NULL, 0);
	}
	close(home[0]);
	close(said[0]);
	return ob_fail(e, "cannot start a process: %s", strerror(why));
}

// Reads available output and keeps the end of it; returns false at its end.
static bool listen_to(int fd, tail *t)
{
	char more[256];
	for (;;) {
		ssize_t n = read(fd, more, sizeof more);
		if (n <= 0)
			return n < 0 && (errno == EAGAIN || errno == EINTR);
		size_t keep = sizeof t->text - 1 - (size_t)n;
		if (t->length > keep) {
			memmove(t->text, t->text + t->length - keep, keep);
			t->length = keep;
		}
		memcpy(t->text + t->length, more, (size_t)n);
		t->length += (size_t)n;
	}
}

// Seconds until one of the limits may be reached.
static double time_left(const ob_process *p, child *c)
{
	double left = INFINITY;
	c->cost.wall_s = ob_clock_wall() - c->begun;
	c->cost.cpu_s =
		fmax(c->cost.cpu_s, 1e-9 * (double)ob_clock_cpu_of_process(c->pid)); // which is 0 once it has ended
	if (p->cpu_limit_s > 0)
		left = p->cpu_limit_s - c->cost.cpu_s;
	if (p->wall_limit_s > 0)
		left = fmin(left, p->wall_limit_s - c->cost.wall_s);
	return left;
}

// Waits for the child's end; returns false if its time is over, or the parent's is.
static bool await(const ob_process *p, child *c, tail *t)
{
	struct pollfd polls[] = { { .fd = c->exit, .events = POLLIN },
				  { .fd = c->said, .events = POLLIN },
				  { .fd = p->attend ? p->ear : -1, .events = POLLIN } };
	for (;;) {
		double left = time_left(p, c), nap = fmax(fmin(left, tick_s), shortest_nap_s);
		struct timespec time = { .tv_nsec = (long)(nap * 1e9) };
		int n = ppoll(polls, 3, &time, &mask_before);
		if (interrupted)
			return false;
		if (n > 0 && polls[1].revents && !listen_to(c->said, t))
			polls[1].fd = -1;
		if (n > 0 && polls[0].revents)
			return true;
		c->called_off = n > 0 && polls[2].revents && !p->attend(p->of);
		if (left <= 0 || c->called_off)
			return false;
		if (p->tick)
			p->tick(p->of);
	}
}

// Requests the end of the whole group, waits a little for its first process, and kills the rest.
static void end_group(const child *c, bool ended)
{
	struct pollfd exit = { .fd = c->exit, .events = POLLIN };
	if (!ended) {
		kill(-c->pid, SIGTERM);
		poll(&exit, 1, grace_ms);
	}
	kill(-c->pid, SIGKILL);
}

// Last line of the output.
static const char *last_line(tail *t)
{
	while (t->length > 0 && strchr("\n\r ", t->text[t->length - 1]))
		t->length--;
	t->text[t->length] = 0;
	const char *line = strrchr(t->text, '\n');
	return line ? line + 1 : t->text;
}

static ob_process_end explain_crash(int status, tail *t, ob_error *e)
{
	const char *last = last_line(t), *colon = *last ? ": " : "";
	const char *name = WIFSIGNALED(status) ? sigabbrev_np(WTERMSIG(status)) : NULL;
	if (name)
		ob_fail(e, "crashed, SIG%s%s%.100s", name, colon, last);
	else if (WIFSIGNALED(status))
		ob_fail(e, "crashed, signal %d%s%.100s", WTERMSIG(status), colon, last);
	else
		ob_fail(e, "ended with status %d%s%.100s", WEXITSTATUS(status), colon, last);
	return OB_PROCESS_CRASHED;
}

static ob_process_end finish(const ob_process *p, child *c, bool ended, tail *t, void *answer, ob_error *e)
{
	struct rusage used = { 0 };
	int status = 0;
	char *message = malloc(sizeof(verdict) + p->size);
	end_group(c, ended);
	while (wait4(c->pid, &status, 0, &used) < 0 && errno == EINTR)
		;
	c->cost.wall_s = ob_clock_wall() - c->begun;
	c->cost.cpu_s = fmax(c->cost.cpu_s, (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
						    1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec));
	listen_to(c->said, t);
	ssize_t size = (ssize_t)(sizeof(verdict) + p->size);
	bool answered = message && ended && read(c->answer, message, (size_t)size) == size;
	ob_process_end end = OB_PROCESS_ANSWERED;
	verdict v = { .fine = false };
	if (answered)
		memcpy(&v, message, sizeof v);
	if (answered && v.fine)
		memcpy(answer, message + sizeof v, p->size);
	else if (answered)
		end = OB_PROCESS_GAVE_UP;
	if (answered && !v.fine)
		ob_fail(e, "%s", v.why.text);
	if (!ended && (interrupted || c->called_off)) {
		ob_fail(e, "interrupted");
		end = OB_PROCESS_INTERRUPTED;
	} else if (!ended) {
		bool cpu = p->cpu_limit_s > 0 && c->cost.cpu_s >= p->cpu_limit_s;
		ob_fail(e, "ran longer than %g s%s", cpu ? p->cpu_limit_s : p->wall_limit_s, cpu ? " of CPU" : "");
		end = OB_PROCESS_OUT_OF_TIME;
	} else if (!answered) {
		end = explain_crash(status, t, e);
	}
	free(message);
	return end;
}

ob_process_end ob_process_run(const ob_process *p, void *answer, ob_process_cost *cost, ob_error *e)
{
	child c = { 0 };
	tail t = { 0 };
	*cost = (ob_process_cost){ 0 };
	if (p->size > OB_PROCESS_ANSWER) {
		ob_fail(e, "%zu bytes are too long an answer", p->size);
		return OB_PROCESS_NOT_STARTED;
	}
	if (!start(p, answer, &c, e))
		return OB_PROCESS_NOT_STARTED;
	bool ended = await(p, &c, &t);
	ob_process_end end = finish(p, &c, ended, &t, answer, e);
	*cost = c.cost;
	close(c.exit);
	close(c.answer);
	close(c.said);
	return end;
}

// ---- this program, started anew

typedef struct text {
	char *bytes;
	size_t length;
} text;

// Returns false at the end of the pipe. Beyond PROGRAM_TEXT, output is read and dropped, so that the child can go on.
static bool collect_some(int fd, text *t)
{
	char buffer[4096];
	ssize_t n = read(fd, buffer, sizeof buffer);
	if (n < 0)
		return errno == EINTR;
	size_t room = PROGRAM_TEXT - 1 - t->length, take = (size_t)n < room ? (size_t)n : room;
	memcpy(t->bytes + t->length, buffer, take);
	t->length += take;
	t->bytes[t->length] = 0;
	return n > 0;
}

static void collect(int out, int said, text texts[2])
{
	struct pollfd polls[2] = { { .fd = out, .events = POLLIN }, { .fd = said, .events = POLLIN } };
	while (polls[0].fd >= 0 || polls[1].fd >= 0) {
		int n = poll(polls, 2, -1);
		for (int i = 0; n > 0 && i < 2; i++)
			if (polls[i].revents && !collect_some(polls[i].fd, &texts[i]))
				polls[i].fd = -1;
	}
}

// Finds the last line that begins with "obsim: ", and removes that prefix.
static void find_complaint(const char *said, char to[256])
{
	static const char mark[] = "obsim: ";
	to[0] = 0;
	for (const char *line = said; line; line = strchr(line, '\n'), line = line ? line + 1 : NULL)
		if (strncmp(line, mark, sizeof mark - 1) == 0)
			snprintf(to, 256, "%.*s", (int)strcspn(line + sizeof mark - 1, "\n"), line + sizeof mark - 1);
}

static pid_t start_program(char *const argv[], int out, int said)
{
	pid_t parent = getpid(), pid = fork();
	if (pid != 0)
		return pid;
	prctl(PR_SET_PDEATHSIG, SIGTERM);
	if (getppid() != parent)
		_exit(1);
	dup2(out, STDOUT_FILENO);
	dup2(said, STDERR_FILENO);
	execv("/proc/self/exe", argv);
	_exit(127);
}

bool ob_program_run(char *const argv[], ob_program_result *r, ob_error *e)
{
	int out[2], said[2], status = 0;
	text texts[2] = { { calloc(1, PROGRAM_TEXT), 0 }, { calloc(1, PROGRAM_TEXT), 0 } };
	*r = (ob_program_result){ .out = texts[0].bytes };
	bool fine = (texts[0].bytes && texts[1].bytes) || ob_fail(e, "out of memory");
	if (fine && (pipe2(out, O_CLOEXEC) != 0 || pipe2(said, O_CLOEXEC) != 0))
		fine = ob_fail(e, "cannot make a pipe: %s", strerror(errno));
	if (fine) {
		pid_t pid = start_program(argv, out[1], said[1]);
		int why = errno;
		close(out[1]);
		close(said[1]);
		if (pid > 0)
			collect(out[0], said[0], texts);
		close(out[0]);
		close(said[0]);
		while (pid > 0 && waitpid(pid, &status, 0) < 0 && errno == EINTR)
			;
		r->code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
		fine = pid > 0 || ob_fail(e, "cannot start a process: %s", strerror(why));
	}
	if (texts[1].bytes)
		find_complaint(texts[1].bytes, r->complaint);
	free(texts[1].bytes);
	if (!fine) {
		free(r->out);
		r->out = NULL;
	}
	return fine;
}

void ob_program_free_arguments(char **argv)
{
	for (char **at = argv; at && *at; at++)
		free(*at);
	free(argv);
}

char *ob_program_report(char **argv, ob_error *e)
{
	ob_program_result r = { 0 };
	bool fine = argv ? ob_program_run(argv, &r, e) : ob_fail(e, "out of memory");
	if (fine && r.code != 0)
		fine = ob_fail(e, "%s", *r.complaint ? r.complaint : "it died without a word");
	ob_program_free_arguments(argv);
	if (fine)
		return r.out;
	free(r.out);
	return NULL;
}

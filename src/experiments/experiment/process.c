#include "experiment/process.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "ranks/ranks.h"

static const double tick_s = .2, shortest_nap_s = 1e-3;
static const double wall_for_cpu = 4; // a slow machine is not the trial's fault
static const int grace_ms = 2000; // from SIGTERM to SIGKILL
static const int stops[] = { SIGINT, SIGTERM, SIGHUP };
enum { STOPS = sizeof stops / sizeof *stops, PROGRAM_TEXT = 1 << 20 };

// Message of a child; the pipe holds all of it.
typedef struct answer {
	bool fine;
	ob_error why;
	ob_record record;
} answer;
_Static_assert(sizeof(answer) < 65536, "it fits a pipe");

// Tail of a child's standard error.
typedef struct tail {
	char text[512];
	size_t length;
} tail;

typedef struct child {
	pid_t pid; // and its process group
	int exit, answer, said; // file descriptors: readable at its exit, its answer, its standard error
	double begun, wall_s, cpu_s; // the times so far
	double wall_limit_s, cpu_limit_s; // 0 = none
	bool called_off; // by attend
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

static void work(const ob_experiment *x, const ob_trial *t, const ob_record *r, int to)
{
	answer a = { .record = *r };
	ob_ranks_forget(); // a trial is alone, even in an experiment on several ranks
	a.fine = x->run(t, &a.record, &a.why);
	while (write(to, &a, sizeof a) < 0 && errno == EINTR)
		;
	_exit(0);
}

static bool start(const ob_experiment *x, const ob_trial *t, const ob_record *r, child *c, ob_error *e)
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
	*c = (child){ .pid = fork(),
		      .exit = -1,
		      .answer = home[0],
		      .said = said[0],
		      .begun = ob_clock_wall(),
		      .cpu_limit_s = x->limit_s,
		      .wall_limit_s = ob_trial_wall_limit(x) };
	if (c->pid == 0) {
		begin_child(parent, said[1]);
		work(x, t, r, home[1]);
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
static double time_left(child *c)
{
	double left = INFINITY;
	c->wall_s = ob_clock_wall() - c->begun;
	c->cpu_s = fmax(c->cpu_s, 1e-9 * (double)ob_clock_cpu_of_process(c->pid)); // which is 0 once it has ended
	if (c->cpu_limit_s > 0)
		left = c->cpu_limit_s - c->cpu_s;
	if (c->wall_limit_s > 0)
		left = fmin(left, c->wall_limit_s - c->wall_s);
	return left;
}

// Waits for the child's end; returns false if its time is over, or the parent's is.
static bool await(const ob_meanwhile *p, child *c, tail *t)
{
	struct pollfd polls[] = { { .fd = c->exit, .events = POLLIN },
				  { .fd = c->said, .events = POLLIN },
				  { .fd = p->attend ? p->ear : -1, .events = POLLIN } };
	for (;;) {
		double left = time_left(c), nap = fmax(fmin(left, tick_s), shortest_nap_s);
		struct timespec time = { .tv_nsec = (long)(nap * 1e9) };
		int n = ppoll(polls, 3, &time, &mask_before);
		if (interrupted)
			return false;
		if (n > 0 && polls[1].revents && !listen_to(c->said, t))
			polls[1].fd = -1;
		if (n > 0 && polls[0].revents)
			return true;
		c->called_off = n > 0 && polls[2].revents && p->attend && !p->attend(p->of);
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

static void explain_crash(int status, tail *t, ob_record *r)
{
	const char *last = last_line(t), *colon = *last ? ": " : "";
	const char *name = WIFSIGNALED(status) ? sigabbrev_np(WTERMSIG(status)) : NULL;
	r->failure = OB_FAILURE_CRASH;
	if (name)
		snprintf(r->reason, sizeof r->reason, "crashed, SIG%s%s%.100s", name, colon, last);
	else if (WIFSIGNALED(status))
		snprintf(r->reason, sizeof r->reason, "crashed, signal %d%s%.100s", WTERMSIG(status), colon, last);
	else
		snprintf(r->reason, sizeof r->reason, "ended with status %d%s%.100s", WEXITSTATUS(status), colon, last);
}

// Waits for the child and the end of its processes; takes its answer, or the reason why there is none.
static void finish(child *c, bool ended, tail *t, ob_record *r)
{
	struct rusage used = { 0 };
	int status = 0;
	answer a;
	end_group(c, ended);
	while (wait4(c->pid, &status, 0, &used) < 0 && errno == EINTR)
		;
	c->wall_s = ob_clock_wall() - c->begun;
	c->cpu_s = fmax(c->cpu_s, (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
					  1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec));
	listen_to(c->said, t);
	const bool answered = ended && read(c->answer, &a, sizeof a) == sizeof a;
	const bool cpu = c->cpu_limit_s > 0 && c->cpu_s >= c->cpu_limit_s;
	if (answered && a.fine) {
		*r = a.record;
		r->failure = *r->reason ? OB_FAILURE_OUTCOME : OB_FAILURE_NONE;
	} else if (answered) {
		r->failure = OB_FAILURE_ERROR;
		snprintf(r->reason, sizeof r->reason, "%.159s", *a.why.text ? a.why.text : "it failed without a word");
	} else if (ended) {
		explain_crash(status, t, r);
	} else {
		r->failure = OB_FAILURE_TIME;
		snprintf(r->reason, sizeof r->reason, "ran longer than %g s%s", cpu ? c->cpu_limit_s : c->wall_limit_s,
			 cpu ? " of CPU" : "");
	}
	r->took_s = c->wall_s;
	r->took_cpu_s = c->cpu_s;
	for (char *at = r->reason; (at = strpbrk(at, "\r\n"));)
		*at = ' '; // a record is a line of the file
}

bool ob_trial_run(const ob_experiment *x, const ob_trial *t, const ob_meanwhile *meanwhile, ob_record *r, ob_error *e)
{
	child c = { 0 };
	tail said = { 0 };
	if (!start(x, t, r, &c, e))
		return false;
	const bool ended = await(meanwhile, &c, &said), stopped = !ended && (interrupted || c.called_off);
	finish(&c, ended, &said, r);
	close(c.exit);
	close(c.answer);
	close(c.said);
	return !stopped || ob_fail(e, "interrupted");
}

ob_record ob_trial_record(const ob_records *of, const ob_trial *t)
{
	ob_record r = { .repeat = t->repeat, .seed = t->seed };
	memcpy(r.of, t->of, sizeof r.of);
	memcpy(r.configuration, t->configuration, sizeof r.configuration);
	memcpy(r.machine, of->machine, sizeof r.machine);
	memcpy(r.commit, of->commit, sizeof r.commit);
	for (int i = 0; i < OB_METRICS; i++)
		r.metric[i] = NAN;
	return r;
}

double ob_trial_wall_limit(const ob_experiment *x)
{
	return wall_for_cpu * x->limit_s;
}

// ---- this program, started anew

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

void ob_program_free_arguments(char **argv)
{
	for (char **at = argv; at && *at; at++)
		free(*at);
	free(argv);
}

// Text of a file, malloc'd; NULL: no memory.
static char *text_of(int file)
{
	char *text = calloc(1, PROGRAM_TEXT);
	if (text && pread(file, text, PROGRAM_TEXT - 1, 0) < 0)
		*text = 0;
	return text;
}

char *ob_program_report(char **argv, ob_error *e)
{
	if (!argv) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	const int out = memfd_create("obsim-out", MFD_CLOEXEC), said = memfd_create("obsim-said", MFD_CLOEXEC);
	bool fine = (out >= 0 && said >= 0) || ob_fail(e, "cannot make a file: %m");
	char *report = NULL, *words = NULL, complaint[256];
	int status = 0;
	if (fine) {
		const pid_t pid = start_program(argv, out, said);
		fine = pid > 0 || ob_fail(e, "cannot start a process: %m");
		while (pid > 0 && waitpid(pid, &status, 0) < 0 && errno == EINTR)
			;
		report = text_of(out);
		words = text_of(said);
		find_complaint(words ? words : "", complaint);
		fine = fine && ((report && words) || ob_fail(e, "out of memory")) &&
		       (status == 0 || ob_fail(e, "%s", *complaint ? complaint : "it died without a word"));
	}
	close(out);
	close(said);
	free(words);
	ob_program_free_arguments(argv);
	if (fine)
		return report;
	free(report);
	return NULL;
}

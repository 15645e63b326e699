// A trial in a process of its own, so that none warms another's caches, and none is forked from a process that has
// drawn already.
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "paper/trial.h"

// Less than a pipe holds, so it is written at once and in one piece.
typedef struct message {
	bool ran;
	ob_paper_sample sample;
	char why[512];
} message;

static volatile sig_atomic_t stopped;

static void on_signal(int number)
{
	stopped = number;
}

static void work(const ob_paper_trial *t, const ob_paper_sample *s, int result)
{
	message m = { .sample = *s };
	ob_error e;
	m.ran = ob_paper_trial_run(t, &m.sample, &e);
	snprintf(m.why, sizeof m.why, "%.511s", e.text);
	while (write(result, &m, sizeof m) < 0 && errno == EINTR)
		;
	_exit(0);
}

static pid_t start(const ob_paper_trial *t, const ob_paper_sample *s, const int result[2])
{
	pid_t parent = getpid(), child = fork();
	if (child != 0)
		return child;
	prctl(PR_SET_PDEATHSIG, SIGTERM);
	if (getppid() != parent) // it died before the line above
		_exit(1);
	signal(SIGINT, SIG_DFL);
	signal(SIGTERM, SIG_DFL);
	close(result[0]);
	work(t, s, result[1]);
	return 0;
}

static bool receive(pid_t child, int result, message *m)
{
	ssize_t n;
	while ((n = read(result, m, sizeof *m)) < 0 && errno == EINTR)
		kill(child, SIGTERM);
	return n == (ssize_t)sizeof *m;
}

bool ob_paper_attempt(const ob_paper_trial *t, ob_paper_sample *s, bool *interrupted, ob_error *e)
{
	struct sigaction action = { .sa_handler = on_signal }, before[2];
	int result[2], status = 0;
	message m;
	if (pipe2(result, O_CLOEXEC) != 0)
		return ob_fail(e, "cannot make a pipe: %s", strerror(errno));
	stopped = 0;
	sigaction(SIGINT, &action, &before[0]);
	sigaction(SIGTERM, &action, &before[1]);
	pid_t child = start(t, s, result);
	int failure = errno;
	close(result[1]);
	bool told = child > 0 && receive(child, result[0], &m);
	while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR)
		;
	close(result[0]);
	sigaction(SIGINT, &before[0], NULL);
	sigaction(SIGTERM, &before[1], NULL);
	*interrupted = stopped != 0;
	if (child < 0)
		return ob_fail(e, "cannot start a process: %s", strerror(failure));
	if (!told)
		return WIFSIGNALED(status) ? ob_fail(e, "it was killed by signal %d", WTERMSIG(status))
					   : ob_fail(e, "it ended without a word");
	*s = m.sample;
	snprintf(e->text, sizeof e->text, "%s", m.why);
	return m.ran;
}

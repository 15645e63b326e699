#include "cli/child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TEXT_MAX = 1 << 20, PIPES = 2 }; // bytes kept of each pipe

static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
	interrupted = number;
}

bool ob_child_interrupted(void)
{
	return interrupted != 0;
}

typedef struct text {
	char *bytes;
	size_t length;
} text;

// false at the end of the pipe. What is over TEXT_MAX is read, so that the child goes on, and dropped.
static bool fetch(int fd, text *t)
{
	char buffer[4096];
	ssize_t n = read(fd, buffer, sizeof buffer);
	if (n < 0)
		return errno == EINTR;
	size_t room = TEXT_MAX - 1 - t->length, take = (size_t)n < room ? (size_t)n : room;
	memcpy(t->bytes + t->length, buffer, take);
	t->length += take;
	t->bytes[t->length] = 0;
	return n > 0;
}

// Signals are let in only while waiting, so that none is lost before it.
static void collect(pid_t child, const int fds[PIPES], text texts[PIPES], const sigset_t *open_mask)
{
	struct pollfd polls[PIPES] = { { .fd = fds[0], .events = POLLIN }, { .fd = fds[1], .events = POLLIN } };
	bool told = false;
	while (polls[0].fd >= 0 || polls[1].fd >= 0) {
		int n = ppoll(polls, PIPES, NULL, open_mask);
		if (interrupted && !told) {
			kill(child, SIGTERM);
			told = true;
		}
		for (int i = 0; n > 0 && i < PIPES; i++) {
			if (polls[i].revents && !fetch(polls[i].fd, &texts[i]))
				polls[i].fd = -1;
		}
	}
}

static pid_t start(char *const argv[], int pipes[PIPES][2], const sigset_t *mask)
{
	pid_t parent = getpid(), child = fork();
	if (child != 0)
		return child;
	prctl(PR_SET_PDEATHSIG, SIGTERM);
	if (getppid() != parent) // it died before the line above
		_exit(1);
	dup2(pipes[0][1], STDOUT_FILENO);
	dup2(pipes[1][1], STDERR_FILENO);
	signal(SIGINT, SIG_DFL);
	signal(SIGTERM, SIG_DFL);
	sigprocmask(SIG_SETMASK, mask, NULL);
	execv("/proc/self/exe", argv);
	_exit(127);
}

// The last line that begins with "obsim: ", without that
static char *find_complaint(const char *said)
{
	static const char mark[] = "obsim: ";
	const char *found = NULL;
	for (const char *line = said; line; line = strchr(line, '\n'), line = line ? line + 1 : NULL) {
		if (strncmp(line, mark, sizeof mark - 1) == 0)
			found = line + sizeof mark - 1;
	}
	return found ? strndup(found, strcspn(found, "\n")) : strdup("");
}

static bool talk(char *const argv[], int pipes[PIPES][2], text texts[PIPES], ob_child_result *r, ob_error *e)
{
	struct sigaction action = { .sa_handler = on_signal }, before[2];
	sigset_t stops, mask;
	sigemptyset(&stops);
	sigaddset(&stops, SIGINT);
	sigaddset(&stops, SIGTERM);
	sigprocmask(SIG_BLOCK, &stops, &mask);
	sigaction(SIGINT, &action, &before[0]);
	sigaction(SIGTERM, &action, &before[1]);

	pid_t child = start(argv, pipes, &mask);
	int failure = errno, status = 0;
	for (int i = 0; i < PIPES; i++) {
		close(pipes[i][1]);
		pipes[i][1] = -1;
	}
	if (child > 0) {
		collect(child, (int[]){ pipes[0][0], pipes[1][0] }, texts, &mask);
		while (waitpid(child, &status, 0) < 0 && errno == EINTR)
			;
	}
	// what came between the last look and here is not lost either
	sigprocmask(SIG_SETMASK, &mask, NULL);
	sigaction(SIGINT, &before[0], NULL);
	sigaction(SIGTERM, &before[1], NULL);
	r->code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
	return child > 0 ? true : ob_fail(e, "cannot start a child process: %s", strerror(failure));
}

static bool run_with_pipes(char *const argv[], text texts[PIPES], ob_child_result *r, ob_error *e)
{
	int pipes[PIPES][2] = { { -1, -1 }, { -1, -1 } };
	bool fine = true;
	for (int i = 0; fine && i < PIPES; i++) {
		if (pipe2(pipes[i], O_CLOEXEC) != 0)
			fine = ob_fail(e, "cannot make a pipe: %s", strerror(errno));
	}
	fine = fine && talk(argv, pipes, texts, r, e);
	for (int i = 0; i < PIPES; i++) {
		for (int end = 0; end < 2; end++) {
			if (pipes[i][end] >= 0)
				close(pipes[i][end]);
		}
	}
	return fine;
}

bool ob_child_run(char *const argv[], ob_child_result *r, ob_error *e)
{
	*r = (ob_child_result){ .out = calloc(1, TEXT_MAX) };
	char *said = calloc(1, TEXT_MAX);
	bool fine = false;
	if (r->out && said) {
		text texts[PIPES] = { { r->out, 0 }, { said, 0 } };
		fine = run_with_pipes(argv, texts, r, e);
		r->complaint = find_complaint(said);
	}
	if (!r->complaint)
		fine = ob_fail(e, "out of memory");
	free(said);
	return fine;
}

void ob_child_finish(ob_child_result *r)
{
	free(r->out);
	free(r->complaint);
	*r = (ob_child_result){ 0 };
}

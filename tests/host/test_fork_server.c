// The fork server and its worker processes: 200 start and leave; a death is reported with its cause; after the host is
// killed, no process is left.
#include <poll.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "host/spawn.h"
#include "workers.h"

enum { WORKERS = 200, WAIT_MS = 1000 * WAIT_S };

static bool next_end(const ob_spawn *s, ob_worker_group *g, int timeout_ms, ob_worker_end *end)
{
	struct pollfd p = { .fd = s->fd(g), .events = POLLIN };
	return poll(&p, 1, timeout_ms) == 1 && s->next_end(g, end);
}

static void test_start_and_leave(const ob_spawn *s, uint32_t workers)
{
	ob_error e = { "" };
	char name[OB_NAME_MAX];
	snprintf(name, sizeof name, "test-workers-%d", (int)getpid());
	ob_universe *u = make_universe(name, workers);
	ob_fork_server *k = ob_fork_server_start(u, idle_worker, 60, &e);
	ob_worker_group *g = s->start(&(ob_worker_group_setup){ .u = u, .fork_server = k, .run = idle_worker }, &e);
	CHECK(g != NULL);
	uint32_t there = 0;
	for (uint32_t w = 0; g && w < workers; w++)
		there += pid_of_worker(u, w) != 0;
	CHECK(there == workers);
	for (int turn = 0; turn < 3; turn++) {
		ob_gate_open(u, OB_PHASE_BROADPHASE, NULL, 0);
		CHECK(ob_gate_host_wait(u, WAIT_S));
	}
	ob_worker_end end;
	CHECK(!next_end(s, g, 0, &end)); // no worker has left yet
	ob_gate_stop(u);
	CHECK(s->join(g, WAIT_S));
	ob_fork_server_stop(k);
	CHECK(!segment_exists(name));
	ob_universe_destroy(u, true);
	CHECK(waitpid(-1, NULL, WNOHANG) < 0); // no child is left
}

static int misbehave(ob_universe *u, uint32_t worker)
{
	ob_worker_announce(u, worker, getpid(), gettid(), -1);
	if (worker == 1)
		return 7;
	return idle_worker(u, worker);
}

static void test_deaths(void)
{
	ob_error e = { "" };
	ob_worker_end end;
	char name[OB_NAME_MAX];
	snprintf(name, sizeof name, "test-deaths-%d", (int)getpid());
	ob_universe *u = make_universe(name, 4);
	ob_fork_server *k = ob_fork_server_start(u, misbehave, 60, &e);
	const ob_spawn *s = &ob_spawn_processes;
	ob_worker_group *g = s->start(&(ob_worker_group_setup){ .u = u, .fork_server = k, .run = misbehave }, &e);
	CHECK(next_end(s, g, WAIT_MS, &end) && end.worker == 1 && end.code == 7 && end.signal == 0);
	static const int signals[] = { SIGKILL, SIGTERM, SIGABRT };
	static const uint32_t victims[] = { 3, 0, 2 };
	for (int i = 0; i < 3; i++) {
		pid_t pid = pid_of_worker(u, victims[i]);
		pause_ms(20); // most likely, it sleeps at the gate by now
		kill(pid, SIGINT); // only the host handles Ctrl-C
		kill(pid, signals[i]);
		CHECK(next_end(s, g, WAIT_MS, &end) && end.worker == victims[i] && end.pid == pid);
		CHECK(end.signal == signals[i]);
	}
	ob_gate_stop(u);
	CHECK(s->join(g, WAIT_S));
	// the fork server itself dies: its link hangs up
	kill(ob_fork_server_pid(k), SIGKILL);
	struct pollfd p = { .fd = ob_fork_server_fd(k) };
	CHECK(poll(&p, 1, WAIT_MS) == 1 && p.revents & POLLHUP);
	CHECK(!ob_fork_server_fork(k, 0, 1));
	ob_fork_server_stop(k);
	ob_universe_destroy(u, true);
}

// Writes a number of lines on standard error, and dies in the middle of its work.
static int talk(ob_universe *u, uint32_t worker)
{
	static const int lines[] = { 0, 1, 3, 5000 };
	ob_worker_announce(u, worker, getpid(), gettid(), -1);
	for (int i = 0; i < lines[worker]; i++)
		dprintf(STDERR_FILENO, "word %d of %u\n", i, worker);
	if (worker == 1)
		dprintf(STDERR_FILENO, "\033[2J without an end");
	abort();
}

// Each end reports the worker's last words, the last lines whole. They also reach standard error, where no reader can
// block a worker.
static void test_last_words(void)
{
	ob_error e = { "" };
	char name[OB_NAME_MAX];
	snprintf(name, sizeof name, "test-words-%d", (int)getpid());
	int before = dup(STDERR_FILENO), said[2];
	if (pipe(said) != 0)
		abort();
	dup2(said[1], STDERR_FILENO); // a pipe without a reader yet
	ob_universe *u = make_universe(name, 4);
	ob_fork_server *k = ob_fork_server_start(u, talk, 60, &e);
	dup2(before, STDERR_FILENO);
	const ob_spawn *s = &ob_spawn_processes;
	ob_worker_group *g = s->start(&(ob_worker_group_setup){ .u = u, .fork_server = k, .run = talk }, &e);
	ob_worker_end end;
	for (int i = 0; i < 4; i++) {
		CHECK(next_end(s, g, WAIT_MS, &end) && end.signal == SIGABRT);
		size_t n = strlen(end.words);
		if (end.worker == 0)
			CHECK(n == 0);
		else if (end.worker == 1)
			CHECK(strcmp(end.words, "word 0 of 1| [2J without an end") == 0);
		else if (end.worker == 2)
			CHECK(strcmp(end.words, "word 0 of 2|word 1 of 2|word 2 of 2") == 0);
		else
			CHECK(n > OB_LAST_WORDS / 2 && strncmp(end.words, "word 49", 7) == 0 &&
			      strcmp(end.words + n - 14, "word 4999 of 3") == 0);
	}
	char text[4096];
	CHECK(read(said[0], text, sizeof text) > 0);
	ob_gate_stop(u);
	CHECK(s->join(g, WAIT_S));
	ob_fork_server_stop(k);
	ob_universe_destroy(u, true);
	close(before);
	close(said[0]);
	close(said[1]);
}

_Noreturn static void run_host(const ob_spawn *s, const char *name, uint32_t workers, int ready)
{
	prctl(PR_SET_PDEATHSIG, SIGKILL); // if the test is ended
	ob_error e;
	ob_universe *u = make_universe(name, workers);
	ob_fork_server *k = ob_fork_server_start(u, idle_worker, 60, &e);
	ob_worker_group *g = s->start(&(ob_worker_group_setup){ .u = u, .fork_server = k, .run = idle_worker }, &e);
	for (uint32_t w = 0; g && w < workers; w++)
		pid_of_worker(u, w);
	ssize_t ignored = write(ready, "r", 1);
	(void)ignored;
	for (;;)
		pause();
}

static void test_killed_host(const ob_spawn *s, uint32_t workers)
{
	int ready[2];
	char name[OB_NAME_MAX], byte;
	snprintf(name, sizeof name, "test-killed-%d", (int)getpid());
	if (pipe(ready) != 0)
		abort();
	pid_t host = fork();
	if (host == 0)
		run_host(s, name, workers, ready[1]);
	close(ready[1]);
	CHECK(read(ready[0], &byte, 1) == 1);
	CHECK(segment_exists(name));
	kill(host, SIGKILL);
	CHECK(nothing_left(name));
	close(ready[0]);
}

int main(void)
{
	adopt_orphans();
	test_start_and_leave(&ob_spawn_processes, WORKERS);
	test_start_and_leave(&ob_spawn_threads, WORKERS);
	test_deaths();
	test_last_words();
	test_killed_host(&ob_spawn_processes, WORKERS / 2);
	test_killed_host(&ob_spawn_threads, 8);
	return check_end();
}

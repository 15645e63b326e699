// The keeper and processes: 200 start and leave; a death is reported at once, with its cause; when the host is killed,
// nothing is left within a second.
#include <poll.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "crowd.h"
#include "host/spawn.h"

enum { CROWD = 200, PATIENCE_MS = 20000 };

static bool next_end(const ob_spawn *s, ob_crew *c, int timeout_ms, ob_worker_end *end)
{
	struct pollfd p = { .fd = s->fd(c), .events = POLLIN };
	return poll(&p, 1, timeout_ms) == 1 && s->next_end(c, end);
}

static void test_crowd(const ob_spawn *s, uint32_t workers)
{
	ob_error e = { "" };
	char name[OB_NAME_MAX];
	snprintf(name, sizeof name, "test-crowd-%d", (int)getpid());
	ob_universe *u = make_universe(name, workers);
	ob_fork_server *k = ob_fork_server_start(u, idle_worker, &e);
	double began = ob_clock_wall();
	ob_crew *c = s->start(&(ob_crew_order){ .u = u, .keeper = k, .run = idle_worker }, &e);
	CHECK(c != NULL);
	uint32_t there = 0;
	for (uint32_t w = 0; c && w < workers; w++)
		there += pid_of_worker(u, w) != 0;
	CHECK(there == workers);
	printf("%u workers (%s) ready in %.1f ms\n", workers, s->name, 1e3 * (ob_clock_wall() - began));
	for (int turn = 0; turn < 3; turn++) {
		ob_gate_open(u, OB_PHASE_BROADPHASE, NULL, 0);
		CHECK(ob_gate_host_wait(u, 10));
	}
	ob_worker_end end;
	CHECK(!next_end(s, c, 0, &end)); // nobody has left yet
	ob_gate_stop(u);
	CHECK(s->join(c, 10));
	ob_fork_server_stop(k);
	CHECK(!segment_exists(name));
	ob_universe_destroy(u, true);
	CHECK(waitpid(-1, NULL, WNOHANG) < 0); // no child is left
}

// Of this process and its keeper, s
static double in_line(const ob_fork_server *k)
{
	return waited_for_core(getpid()) + waited_for_core(ob_fork_server_pid(k));
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
	ob_fork_server *k = ob_fork_server_start(u, misbehave, &e);
	const ob_spawn *s = &ob_spawn_processes;
	ob_crew *c = s->start(&(ob_crew_order){ .u = u, .keeper = k, .run = misbehave }, &e);
	CHECK(next_end(s, c, PATIENCE_MS, &end) && end.worker == 1 && end.code == 7 && end.signal == 0);
	static const int signals[] = { SIGKILL, SIGTERM, SIGABRT };
	static const uint32_t victims[] = { 3, 0, 2 };
	for (int i = 0; i < 3; i++) {
		pid_t pid = pid_of_worker(u, victims[i]);
		pause_ms(20); // it sleeps at the gate
		double began = ob_clock_wall(), waited = in_line(k);
		kill(pid, SIGINT); // Ctrl-C is the host's to handle
		kill(pid, signals[i]);
		CHECK(next_end(s, c, PATIENCE_MS, &end) && end.worker == victims[i] && end.pid == pid);
		double took = ob_clock_wall() - began - OTHERS_IN_LINE * (in_line(k) - waited);
		CHECK(end.signal == signals[i]);
		CHECK(took < .1 * SLOWED);
		printf("death by signal %d known after %.2f ms\n", signals[i], 1e3 * took);
	}
	ob_gate_stop(u);
	CHECK(s->join(c, 1));
	// the keeper itself dies: its link hangs up
	kill(ob_fork_server_pid(k), SIGKILL);
	struct pollfd p = { .fd = ob_fork_server_fd(k) };
	CHECK(poll(&p, 1, PATIENCE_MS) == 1 && p.revents & POLLHUP);
	CHECK(!ob_fork_server_fork(k, 0, 1));
	ob_fork_server_stop(k);
	ob_universe_destroy(u, true);
}

_Noreturn static void live_as_host(const ob_spawn *s, const char *name, uint32_t workers, int ready)
{
	prctl(PR_SET_PDEATHSIG, SIGKILL); // should the test be ended
	ob_error e;
	ob_universe *u = make_universe(name, workers);
	ob_fork_server *k = ob_fork_server_start(u, idle_worker, &e);
	ob_crew *c = s->start(&(ob_crew_order){ .u = u, .keeper = k, .run = idle_worker }, &e);
	for (uint32_t w = 0; c && w < workers; w++)
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
		live_as_host(s, name, workers, ready[1]);
	close(ready[1]);
	CHECK(read(ready[0], &byte, 1) == 1);
	CHECK(segment_exists(name));
	kill(host, SIGKILL);
	double took = wait_until_nothing_left(name);
	CHECK(took >= 0 && took < SLOWED);
	printf("host with %u workers (%s) killed: nothing left after %.1f ms\n", workers, s->name, 1e3 * took);
	close(ready[0]);
}

int main(void)
{
	adopt_orphans();
	test_crowd(&ob_spawn_processes, CROWD);
	test_crowd(&ob_spawn_threads, CROWD);
	test_deaths();
	test_killed_host(&ob_spawn_processes, CROWD / 2);
	test_killed_host(&ob_spawn_threads, 8);
	return check_end();
}

// For the tests that start and kill workers. No test asserts a duration: a wait ends when its event has happened, and
// gives up after a time that no machine needs.
#ifndef OB_TESTS_HOST_WORKERS_H
#define OB_TESTS_HOST_WORKERS_H

#include <signal.h>
#include <stdio.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "table/table.h"

enum { WAIT_S = 120 };

static inline void pause_us(int us)
{
	nanosleep(&(struct timespec){ us / 1000000, us % 1000000 * 1000L }, NULL);
}

static inline void pause_ms(int ms)
{
	pause_us(1000 * ms);
}

// A worker without a simulator: announces itself and works through phases until STOP.
static inline int idle_worker(ob_universe *u, uint32_t worker)
{
	ob_worker_announce(u, worker, getpid(), gettid(), -1);
	while (ob_turn_wait(u, worker) != OB_PHASE_STOP) {
		if (ob_turn_arrive(u, worker))
			ob_gate_pause(u);
	}
	return 0;
}

static inline ob_universe *make_universe(const char *name, uint32_t workers)
{
	ob_error e;
	ob_universe_setup s = { .name = name, .capacity = 4, .workers = workers, .isolation = "test" };
	s.run.step_length = .01;
	s.run.substeps = s.run.iterations = 1;
	ob_universe *u = ob_universe_create(&s, &e);
	if (!u)
		fprintf(stderr, "%s\n", e.text);
	return u;
}

static inline bool segment_exists(const char *name)
{
	char path[128];
	snprintf(path, sizeof path, "/dev/shm/obsim.%s", name);
	return access(path, F_OK) == 0;
}

// pid of a worker, waiting for it to announce itself; 0 after WAIT_S
static inline pid_t pid_of_worker(const ob_universe *u, uint32_t worker)
{
	ob_worker_info info;
	for (double until = ob_clock_wall() + WAIT_S; ob_clock_wall() < until;) {
		if (ob_universe_get_worker(u, worker, &info) && info.pid)
			return info.pid;
		pause_ms(1);
	}
	return 0;
}

// Adopts orphans of the test's children, so that the test sees them end.
static inline void adopt_orphans(void)
{
	prctl(PR_SET_CHILD_SUBREAPER, 1);
}

// Waits until no process descends from this one and the segment is gone. false: some are left after WAIT_S.
static inline bool nothing_left(const char *segment)
{
	double until = ob_clock_wall() + WAIT_S;
	while (ob_clock_wall() < until) {
		while (waitpid(-1, NULL, WNOHANG) > 0)
			;
		if (waitpid(-1, NULL, WNOHANG) < 0 && !segment_exists(segment))
			return true;
		pause_ms(1);
	}
	return false;
}

#endif

// Helpers of the tests that start and lose processes.
#ifndef OB_TESTS_HOST_CROWD_H
#define OB_TESTS_HOST_CROWD_H

#include <dirent.h>
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "table/table.h"

// How much longer everything may take in this build
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
enum { SLOWED = 10 };
#else
enum { SLOWED = 1 };
#endif

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
	while (ob_gate_wait(u, worker) != OB_PHASE_STOP) {
		if (ob_gate_arrive(u, worker))
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

// pid of a worker, waiting for it to announce itself; 0 after 10 s
static inline pid_t pid_of_worker(const ob_universe *u, uint32_t worker)
{
	ob_worker_info info;
	for (int i = 0; i < 10000; i++) {
		if (ob_universe_get_worker(u, worker, &info) && info.pid)
			return info.pid;
		pause_ms(1);
	}
	return 0;
}

// Orphans of the test's children become its own, so that the test sees them end.
static inline void adopt_orphans(void)
{
	prctl(PR_SET_CHILD_SUBREAPER, 1);
}

// A bound on how soon something happens holds for the program, not for the line in front of a busy machine's cores.
// Those whose time in line can be read after the event (who looks on, who reports) stand for the others (a victim,
// those who have to leave), of whom there are about as many times more.
enum { OTHERS_IN_LINE = 4 };

// Seconds that all threads of a process together have stood in line for a core until now; 0 if it is gone.
static inline double waited_for_core(pid_t pid)
{
	char path[64];
	double sum = 0;
	uint64_t line;
	snprintf(path, sizeof path, "/proc/%d/task", (int)pid);
	DIR *tasks = opendir(path);
	for (const struct dirent *d; tasks && (d = readdir(tasks));) {
		snprintf(path, sizeof path, "/proc/%d/task/%.20s/schedstat", (int)pid, d->d_name);
		FILE *f = fopen(path, "r");
		if (f && fscanf(f, "%*u %" SCNu64, &line) == 1)
			sum += 1e-9 * (double)line;
		if (f)
			fclose(f);
	}
	if (tasks)
		closedir(tasks);
	return sum;
}

// Waits until no process descends from this one and the segment is gone; seconds it took, less the time in line, or -1
// after 60 s.
static inline double wait_until_nothing_left(const char *segment)
{
	double began = ob_clock_wall(), waited = waited_for_core(getpid());
	while (ob_clock_wall() - began < 60) {
		while (waitpid(-1, NULL, WNOHANG) > 0)
			;
		if (waitpid(-1, NULL, WNOHANG) < 0 && !segment_exists(segment))
			return fmax(0, ob_clock_wall() - began - OTHERS_IN_LINE * (waited_for_core(getpid()) - waited));
		pause_ms(1);
	}
	return -1;
}

#endif

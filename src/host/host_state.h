// What host.c, run.c and supervisor.c share: the host itself.
#ifndef OB_HOST_HOST_STATE_H
#define OB_HOST_HOST_STATE_H

#include <pthread.h>
#include <stdatomic.h>

#include "host/host.h"
#include "host/population.h"
#include "host/spawn.h"

// A leg: from one opening of the gate to the next pause. Host and supervisor may both shorten it.
typedef struct ob_leg {
	pthread_mutex_t lock;
	bool running, halted; // halted: there will be no other
	uint64_t end; // the step at which it pauses
} ob_leg;

struct ob_host {
	ob_universe *u;
	uint32_t workers;
	const ob_spawn *spawn;
	ob_keeper *keeper;
	ob_crew *crew;
	ob_roster *roster;
	ob_requests *requests;
	ob_population *population;
	ob_timeline *timeline; // NULL = not traced

	pthread_t supervisor;
	bool supervised;
	int wake_fd, interrupt_fd; // ends the supervisor; SIGINT and its kin
	atomic_bool interrupted, failed, ending;
	pthread_mutex_t failure_lock;
	ob_error failure; // the first cause; valid once failed

	ob_leg leg;
	uint64_t target; // the caller's
	bool perceived; // the gate was opened once
	double patience; // s

	uint64_t leg_first; // step at which the leg began
	double leg_start; // s, wall
	bool cpu_counted; // cpu_before holds
	uint64_t cpu_before; // ns, all workers when stepping began
	uint64_t switches_before; // of all workers then
	double own_cpu_before; // s, of the whole process then
	double first_start, last_end; // s, wall: of the first leg that stepped; of the last one
	double gate_before; // s, all workers' waiting when the first leg began
	double startup, wall; // s
};

// Notes the cause (the first one stays) and stops the gate, so that everyone leaves. Any thread.
void ob_host_set_failure(ob_host *h, const char *format, ...) __attribute__((format(printf, 2, 3)));
// Tells the workers to leave. Any thread.
void ob_host_halt(ob_host *h);
// Makes the running leg end at the next step boundary. Any thread.
void ob_host_shorten_leg(ob_host *h);
// Reads the CPU clocks of all workers, for the readers of the universe; returns their sum (ns).
uint64_t ob_host_read_cpu(ob_host *h);
// How often all workers together were switched off a core so far.
uint64_t ob_host_count_switches(const ob_host *h);
// If timed: for how long all workers together have waited at the gate until "now" (s, wall), while the universe stands.
double ob_host_gate_time(const ob_host *h, double now);

#endif

// What host.c, run.c, supervisor.c and rebirth.c share: the host itself.
#ifndef OB_HOST_HOST_STATE_H
#define OB_HOST_HOST_STATE_H

#include <pthread.h>
#include <stdatomic.h>

#include "host/host.h"
#include "host/population.h"
#include "host/spawn.h"
#include "table/checkpoint.h"

// A leg: from one opening of the gate to the next pause. Host and supervisor may both shorten it.
typedef struct ob_leg {
	pthread_mutex_t lock;
	bool running, halted; // halted: there will be no other
	uint64_t end; // the step at which it pauses
} ob_leg;

// See rebirth.h.
typedef struct ob_restart_state {
	ob_checkpoint *checkpoint; // NULL: a loss is a failure
	atomic_bool current; // it holds those objects that are there now
	atomic_bool lost; // somebody: loss says who
	ob_error loss;
	double taken_at, cost; // s, wall: when the checkpoint was taken, and how long that took
	double began, spent; // s, wall: since when there could be one; what all have taken
	double got_on_at; // s, wall: when one was farther than those before
	unsigned losses, deaths; // since then; since the start
	_Atomic uint64_t cpu; // ns, of those that are gone
	uint64_t switches; // theirs
} ob_restart_state;

struct ob_host {
	ob_universe *u;
	uint32_t workers;
	const ob_spawn *spawn;
	ob_fork_server *keeper;
	ob_crew *crew;
	ob_roster *roster;
	ob_requests *requests;
	ob_population *population;
	ob_timeline *timeline; // NULL = not traced

	pthread_t supervisor;
	bool supervised;
	int wake_fd, interrupt_fd; // ends the supervisor; SIGINT and its kin
	atomic_uint living; // workers that have not ended
	atomic_bool interrupted, failed, ending;
	pthread_mutex_t failure_lock;
	ob_error failure; // the first cause; valid once failed

	ob_restart_state rebirth;
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
// Until every worker has announced itself. false and e: it takes too long, or somebody ended.
bool ob_host_wait_for_workers(ob_host *h, ob_error *e);
// Makes the running leg end at the next step boundary. Any thread.
void ob_host_shorten_leg(ob_host *h);
// Reads the CPU clocks of all workers, for the readers of the universe; returns their sum (ns).
uint64_t ob_host_read_cpu(ob_host *h);
// How often all workers together were switched off a core so far.
uint64_t ob_host_count_switches(const ob_host *h);
// If timed: for how long all workers together have waited at the gate until "now" (s, wall), while the universe stands.
double ob_host_gate_time(const ob_host *h, double now);

#endif

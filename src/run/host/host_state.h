// State of the host, shared by its files: host.c starts and ends a run, run.c leads it, supervisor.c watches the workers,
// restart.c starts them again, accounting.c and halt.c serve them all.
#ifndef OB_HOST_HOST_STATE_H
#define OB_HOST_HOST_STATE_H

#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>

#include "host/ask.h"
#include "host/cameras.h"
#include "host/control.h"
#include "host/host.h"
#include "host/population.h"
#include "host/restart.h"
#include "host/spawn.h"
#include "table/checkpoint.h"

// A run interval: from one opening of the gate to the next pause. Host and supervisor may both make it end early.
typedef struct ob_interval {
	pthread_mutex_t lock;
	bool running, halted; // halted: there will be no other
	uint64_t end; // step at which it pauses
	uint64_t most; // end at its beginning: no step goes beyond
} ob_interval;

// See restart.h.
typedef struct ob_restart_state {
	ob_checkpoint *checkpoint; // NULL: the death of a worker is a failure
	atomic_bool current; // the checkpoint is whole, and all later changes can be done again
	atomic_bool requested; // the latest death is the cause
	double taken_at, cost; // s, wall: when the checkpoint was taken, and how long that took
	double progress_at; // s, wall: when a checkpoint was last farther than the one before
	unsigned attempts, deaths; // restarts since then; deaths since the start
	unsigned faults, limited; // attempts that no SIGKILL caused; deaths that count for the limit
	double fault_at; // s, wall: first of these faults
	uint64_t half_way; // steps: half the progress before the last death
	ob_death last[OB_DEATHS_KEPT]; // the latest is last[(deaths - 1) % OB_DEATHS_KEPT]; under failure_lock
	double *when; // [limit.deaths]: s, wall, of the last deaths, in turn; NULL = no limit
	ob_freeze *freeze; // [freezes]: objects to freeze; by id within a place
	uint32_t freezes, freezes_max, frozen; // frozen: so far
	_Atomic uint64_t cpu; // ns, of workers that have ended
	uint64_t switches; // theirs
	uint64_t stalled_step; // of a free run, whose stall the host ends by kills; under failure_lock, as the next
	char *stalled; // [workers]: the kernel's letter for the state in which a worker was found and killed; 0: it was not
} ob_restart_state;

struct ob_host {
	ob_universe *u;
	uint32_t workers;
	const ob_spawn *spawn;
	ob_fork_server *fork_server;
	ob_worker_group *group;
	ob_roster *roster;
	ob_requests *requests, *operations, *wishes; // operations: on the run as a whole; wishes: to its leader
	ob_population *population;
	ob_timeline *timeline; // NULL = not traced
	ob_request_log *log; // NULL = none

	pthread_t supervisor;
	bool supervised;
	atomic_bool dismissed; // the supervisor is to end
	int wake_fd, interrupt_fd; // ends the supervisor; SIGINT and its kin
	ob_asked asked; // requests of other programs
	ob_control *control; // see ob_host_config
	// Socket of the program that controls the run (-1: none), for the leading thread. An event, the program's next command
	// or that it has left, ends the wait for steps.
	struct pollfd caller;
	ob_snapshots snapshots;
	ob_cameras *cameras; // NULL: the scene has none
	uint64_t start, kept; // snapshots for visitors; 0 = none
	bool returns; // see ob_host_config; likewise the next
	const ob_scene *scene;
	bool takes_wishes;
	const char *fixed, *checkpoint;
	struct ob_pace *pace;
	atomic_uint running_workers; // workers that have not ended
	atomic_bool interrupted, failed, ending;
	pthread_mutex_t failure_lock;
	ob_error failure; // the first cause; valid once failed

	ob_restart_state restart;
	ob_interval interval;
	ob_script_log scripts;
	uint64_t target; // the caller's
	uint64_t free_end; // last step of a free run
	uint64_t free_window; // steps that simulators may be ahead of the common time
	double free_pace; // as ob_host_free_pace
	uint64_t free_stands;
	atomic_bool free_hold; // simulators of a free run are to stop and wait where they may run to now
	bool started; // the gate was opened once
	unsigned char *blocks; // [workers]: those that block the step, as of the last look (stall.h)
	double patience; // s
	bool saved; // see ob_host_config
	ob_on_death on_death;
	ob_restart_limit limit;

	uint64_t interval_first_step;
	double interval_start; // s, wall
	bool cpu_counted; // cpu_before holds
	uint64_t cpu_before; // ns, all workers when stepping began
	uint64_t switches_before; // all workers' when stepping began
	double own_cpu_before; // s, of the whole process, when stepping began
	double first_start, last_end; // s, wall: start of the first interval that stepped; end of the last one
	double gate_before; // s, all workers' waiting when the first interval began
	double startup, wall; // s
};

// ---- run.c

// Notes the cause (the first one stays) and stops the gate, so that all workers leave. Any thread.
void ob_host_set_failure(ob_host *h, const char *format, ...) __attribute__((format(printf, 2, 3)));
// Orders the workers to leave. Any thread.
void ob_host_halt(ob_host *h);
// Makes the running interval end at the next step boundary. Any thread.
void ob_host_pause_early(ob_host *h);

// ---- request.c

// Checks a request from outside against the universe as it is now, and completes it: mesh and hull. Any thread.
bool ob_request_check(const ob_host *h, ob_request *r, ob_error *e);

// ---- host.c

// Waits until every worker has announced itself. false and e: it takes too long, or a worker ended.
bool ob_host_wait_for_workers(ob_host *h, ob_error *e);
// Context switches of all workers together so far.
uint64_t ob_host_count_switches(const ob_host *h);
// If timed: for how long all workers together have waited at the gate until "now" (s, wall), while the universe stands.
double ob_host_gate_time(const ob_host *h, double now);

// ---- supervisor.c: a thread of the host that handles workers' deaths, signals, and the fork server's end, and keeps
// the workers' CPU times in the universe up to date. It sleeps in poll otherwise.

bool ob_supervisor_start(ob_host *h, ob_error *e);
void ob_supervisor_stop(ob_host *h); // allowed if it was never started
// Reads the CPU clocks of all workers, for the readers of the universe; returns their sum (ns). Any thread.
uint64_t ob_host_read_cpu(ob_host *h);

#endif

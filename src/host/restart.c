#include "host/restart.h"

#include <stdarg.h>
#include <stdio.h>
#include <time.h>

#include "base/clock.h"
#include "base/log.h"
#include "host/accounting.h"
#include "host/host_state.h"

enum { QUICK_ATTEMPTS = 3 }; // without progress are made at once, ..
static const double attempts_timeout = 10; // s, .. and others for so long
static const double checkpoint_interval = .25; // s, between checkpoints
static const double checkpoint_share = .05; // of the time, that checkpoints may take, ..
static const double allowance = 1; // s, .. this much aside, where objects are added and removed
static const double kill_timeout = 10; // s to wait until killed processes are gone, ..
static const double interrupted_kill_timeout = .05; // .. and after Ctrl-C

void ob_restart_prepare(ob_host *h)
{
	if (h->spawn->restart && !ob_universe_settings(h->u)->monolith)
		h->restart.checkpoint = ob_checkpoint_create(h->u);
	h->restart.began = h->restart.progress_at = ob_clock_wall();
}

void ob_restart_finish(ob_host *h)
{
	ob_checkpoint_destroy(h->restart.checkpoint);
}

// Where simulators die again and again, half of the way that they made last is likely to be made: so the run gets on,
// however soon they die.
uint64_t ob_restart_next_step(const ob_host *h)
{
	const ob_restart_state *r = &h->restart;
	return r->attempts > 0 ? ob_checkpoint_step(r->checkpoint) + r->half_way : UINT64_MAX;
}

bool ob_restart_checkpoint_due(const ob_host *h)
{
	const ob_restart_state *r = &h->restart;
	double now = ob_clock_wall();
	if (!r->checkpoint)
		return false;
	if (!r->current)
		return r->spent <= checkpoint_share * (now - r->began) + allowance;
	if (ob_step_count(h->u) >= ob_restart_next_step(h))
		return true;
	return now - r->taken_at >= fmax(checkpoint_interval, r->cost / checkpoint_share);
}

void ob_restart_checkpoint(ob_host *h, bool changed)
{
	ob_restart_state *r = &h->restart;
	r->current &= !changed;
	if (!ob_restart_checkpoint_due(h))
		return;
	double began = ob_clock_wall();
	bool progress = ob_step_count(h->u) > ob_checkpoint_step(r->checkpoint);
	r->current = ob_checkpoint_take(r->checkpoint, h->u);
	r->taken_at = ob_clock_wall();
	r->cost = r->taken_at - began;
	r->spent += r->cost;
	if (progress) {
		r->attempts = 0;
		r->progress_at = r->taken_at;
	}
}

void ob_restart_request(ob_host *h, const char *format, ...)
{
	ob_restart_state *r = &h->restart;
	ob_error reason;
	va_list args;
	va_start(args, format);
	vsnprintf(reason.text, sizeof reason.text, format, args);
	va_end(args);
	if (!r->current) {
		ob_host_set_failure(h, "%s", reason.text);
		return;
	}
	pthread_mutex_lock(&h->failure_lock);
	if (!r->requested)
		r->reason = reason;
	r->requested = true;
	pthread_mutex_unlock(&h->failure_lock);
	ob_gate_stop(h->u); // the others leave, and the host wakes
}

static bool kill_all_workers(ob_host *h)
{
	ob_hang_clock clock = ob_hang_clock_start();
	h->spawn->kill(h->group);
	while (h->running_workers > 0 && !h->failed &&
	       ob_hang_clock_tick(&clock) < (h->interrupted ? interrupted_kill_timeout : kill_timeout))
		nanosleep(&(struct timespec){ .tv_nsec = 100000 }, NULL);
	if (h->running_workers > 0 && !h->interrupted) {
		pid_t server = ob_fork_server_pid(h->fork_server);
		ob_host_set_failure(h, "%s; the fork server (process %d, %s) has not killed %u simulators within %g s",
				    h->restart.reason.text, (int)server,
				    ob_state_word(ob_state_of_thread(server, server)), h->running_workers,
				    kill_timeout);
	}
	return h->running_workers == 0 && !h->failed;
}

// Simulators that die at once are restarted about once a second.
static void back_off(const ob_host *h)
{
	for (int i = 0; i < 10 && h->restart.attempts > QUICK_ATTEMPTS && !h->interrupted; i++)
		nanosleep(&(struct timespec){ .tv_nsec = 100000000 }, NULL);
}

// Keeps what the dead workers have used, for the sums of the run.
static void save_accounts(ob_host *h)
{
	ob_restart_state *r = &h->restart;
	r->switches += ob_host_count_switches(h);
	r->cpu = ob_host_read_cpu(h);
	for (uint32_t w = 0; w < h->workers; w++)
		ob_worker_set_cpu(h->u, w, 0);
}

bool ob_restart(ob_host *h)
{
	ob_restart_state *r = &h->restart;
	ob_error e;
	unsigned long long step = ob_checkpoint_step(r->checkpoint);
	if (!r->current) {
		ob_host_set_failure(h, "%s; objects had been added or removed since the last checkpoint",
				    r->reason.text);
		return false;
	}
	if (++r->attempts > QUICK_ATTEMPTS && ob_clock_wall() - r->progress_at > attempts_timeout) {
		ob_host_set_failure(h, "%s; giving up: simulators failed %u times since the checkpoint of step %llu",
				    r->reason.text, r->attempts, step);
		return false;
	}
	r->half_way = ob_step_count(h->u) > step + 1 ? (ob_step_count(h->u) - step) / 2 : 1;
	save_accounts(h);
	if (!kill_all_workers(h))
		return false;
	ob_log_warn("%s; restarting all simulators from the checkpoint of step %llu", r->reason.text, step);
	r->deaths++;
	back_off(h);
	ob_checkpoint_put_back(r->checkpoint, h->u);
	r->requested = false;
	if (h->interrupted)
		return false;
	h->running_workers = h->workers;
	if (!h->spawn->restart(h->group)) {
		ob_host_set_failure(h, "%s; the fork server has ended", r->reason.text);
		return false;
	}
	if (ob_host_wait_for_workers(h, &e))
		return true;
	if (!r->requested && !h->interrupted)
		ob_host_set_failure(h, "%s", e.text);
	return false;
}

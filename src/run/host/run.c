// From go to wait: run intervals between pauses, the work done in pauses, and stall detection.
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/cpu.h"
#include "base/log.h"
#include "free/free.h"
#include "host/free_run.h"
#include "host/host_state.h"
#include "host/restart.h"
#include "host/stall.h"
#include "step/sim.h"

static const double poll_interval = .05; // s, between checks of a run that does not pause
enum { LOOKS_PER_POLL = 5 }; // checks for Ctrl-C in each of these intervals
// Steps of a run that a program leads until it looks for a command: where no simulator has work, the leading thread itself
// passes all steps of an interval.
enum { LED_STEPS = 1 << 14 };
static const double spin_time = 5e-5; // s
static const double interrupt_grace = .03; // s that a step may still take after Ctrl-C, unless the run is to be saved

static bool is_called(ob_host *h)
{
	return h->caller.fd >= 0 && poll(&h->caller, 1, 0) == 1;
}

static void draw_cameras(ob_host *h)
{
	const uint64_t begin = ob_clock_ns();
	ob_error e;
	if (!h->cameras)
		return;
	if (!ob_cameras_draw(h->cameras, &e))
		ob_host_set_failure(h, "%s", e.text);
	if (h->timeline)
		ob_trace_span(h->u, ob_trace_host(h->u), OB_TRACE_DRAW, begin, 0, 0);
}

static uint64_t lesser(uint64_t a, uint64_t b)
{
	return a < b ? a : b;
}

// Paused: draws the pictures of cameras, adds and removes objects, then opens the gate for the next interval, if the target is
// still ahead. A program that calls ends the way there, but not before the run is where it was when a simulator died.
static void begin_interval(ob_host *h)
{
	ob_interval *interval = &h->interval;
	uint64_t step = ob_step_count(h->u);
	ob_script_log_look(&h->scripts, h->u); // before their objects may go
	draw_cameras(h); // likewise
	if (!ob_host_free_is_ahead(h))
		ob_population_update(h->population, step, h->requests);
	ob_restart_checkpoint(h, ob_restart_freeze(h));
	ob_sim_pause_after_scripts(h->u, ob_restart_is_due_after_scripts(h));
	ob_script_log_look(&h->scripts, h->u);
	if (is_called(h) && step < h->target && !ob_population_is_behind(h->population))
		h->target = step;
	if (h->started && step >= h->target)
		return;
	uint64_t next = lesser(ob_population_next_step(h->population), ob_restart_next_step(h));
	next = h->cameras ? lesser(next, ob_cameras_next_step(h->cameras)) : next;
	next = h->caller.fd >= 0 && next > step + LED_STEPS ? step + LED_STEPS : next;
	if (!h->started)
		ob_universe_set_state(h->u, OB_UNIVERSE_RUNNING);
	h->started = true;
	if (!h->cpu_counted && h->target > step) {
		h->cpu_before = ob_host_read_cpu(h);
		h->own_cpu_before = ob_clock_process_cpu();
		h->switches_before = ob_host_count_switches(h);
		h->first_start = ob_clock_wall();
		h->gate_before = ob_host_gate_time(h, h->first_start);
		h->cpu_counted = true;
	}
	pthread_mutex_lock(&interval->lock);
	interval->running = true;
	interval->end = interval->most = next < h->target ? next : h->target;
	if (!interval->halted)
		ob_gate_set_pause_step(h->u, interval->end);
	pthread_mutex_unlock(&interval->lock);
	if (next > step && h->target > step)
		ob_population_pull(h->population);
	h->interval_first_step = step;
	h->interval_start = ob_clock_wall();
	if (ob_free_settings_of(h->u))
		ob_host_free_resume(h);
	else
		ob_sim_resume(h->u);
}

static void end_interval(ob_host *h)
{
	double wall = ob_clock_wall() - h->interval_start;
	uint64_t steps = ob_step_count(h->u) - h->interval_first_step;
	pthread_mutex_lock(&h->interval.lock);
	h->interval.running = false;
	pthread_mutex_unlock(&h->interval.lock);
	if (steps == 0)
		return;
	h->wall += wall;
	h->last_end = h->interval_start + wall;
}

// Restarts after a request. If another request comes at once, the interval counts as running, and is restarted again.
static void restart_interval(ob_host *h)
{
	end_interval(h);
	if (ob_restart(h)) {
		h->started = ob_step_count(h->u) > 0;
		begin_interval(h);
	} else {
		pthread_mutex_lock(&h->interval.lock);
		h->interval.running = true;
		pthread_mutex_unlock(&h->interval.lock);
	}
}

static void report_stall(ob_host *h, uint64_t step)
{
	char blocking[300];
	ob_death d = { .cause = OB_DEATH_STALL, .step = step + 1 };
	d.worker = ob_stall_describe(h, blocking, sizeof blocking);
	ob_worker_info info = { 0 };
	if (ob_universe_get_worker(h->u, d.worker, &info))
		d.pid = info.pid;
	ob_death_find_object(&d, h->u);
	snprintf(d.text, sizeof d.text, "step %llu was not complete after %g s; waiting for %s",
		 (unsigned long long)step + 1, h->patience, blocking);
	if (!ob_restart_stalled(h, &d))
		ob_restart_request(h, &d);
}

// Between pauses: detects a stall, and ends the interval early if a thread waits for a pause. false: interrupted, and
// the step does not end.
static bool check_progress(ob_host *h, ob_stall_watch *stall, double *interrupted_at)
{
	double now = ob_clock_wall();
	if (ob_universe_ranks(h->u) > 1)
		ob_universe_look_for_readers(h->u);
	if (ob_stall_watch_look(stall, h)) {
		report_stall(h, stall->step);
		*stall = ob_stall_watch_start(h);
	}
	if (h->interrupted && *interrupted_at == 0)
		*interrupted_at = now;
	if (h->interrupted || is_called(h) || ob_requests_waiting(h->requests) || ob_restart_checkpoint_due(h))
		ob_host_pause_early(h);
	return h->saved || !(h->interrupted && now - *interrupted_at > interrupt_grace);
}

void ob_host_go(ob_host *h, uint64_t step)
{
	h->target = step;
	if (!h->interval.running && !h->failed && !h->interrupted)
		begin_interval(h);
}

void ob_host_set_pace(ob_host *h, double pace, uint64_t stands)
{
	ob_host_free_pace(h, pace, stands);
}

void ob_host_finish(ob_host *h)
{
	if (!h->failed)
		ob_universe_set_state(h->u, OB_UNIVERSE_FINISHED);
}

void ob_host_want_contacts(ob_host *h, uint64_t step)
{
	ob_contacts_want(h->u, step);
}

// A gate that was stopped looks like a pause: the step then falls short of the interval's end.
static bool at_interval_end(ob_host *h)
{
	pthread_mutex_lock(&h->interval.lock);
	bool there = ob_step_count(h->u) >= h->interval.end;
	pthread_mutex_unlock(&h->interval.lock);
	return there;
}

// Returns the damage in data that simulators wrote, which is not trusted; NULL: none. Damage counts as a death.
static const char *find_damage(const ob_host *h)
{
	if (ob_step_count(h->u) > h->interval.most)
		return "the universe's clock is ahead of the run: a simulator has written where it should not";
	return ob_sim_damaged(h->u) ? ob_sim_failure(h->u) : NULL;
}

static void report_damage(ob_host *h, const char *damage)
{
	ob_death d = { .cause = OB_DEATH_DAMAGE, .worker = ob_sim_culprit(h->u), .step = ob_step_count(h->u) + 1 };
	ob_worker_info info = { 0 };
	if (ob_universe_get_worker(h->u, d.worker, &info))
		d.pid = info.pid;
	ob_death_find_object(&d, h->u);
	snprintf(d.text, sizeof d.text, "%s", damage);
	ob_restart_request(h, &d);
}

// Reports a step that cannot be solved because of an object. Counts as the simulator's death where such an object is
// frozen; else the run ends.
static void report_failure(ob_host *h, const char *failure)
{
	ob_death d = { .cause = OB_DEATH_FAILURE, .worker = OB_NO_WORKER, .step = ob_step_count(h->u) + 1 };
	if (!ob_on_death_freezes_failed(h->on_death) || !ob_sim_failed_alone(h->u, &d.object)) {
		ob_host_set_failure(h, "%s", failure);
		return;
	}
	ob_death_find_object(&d, h->u);
	snprintf(d.text, sizeof d.text, "%s", failure);
	ob_restart_request(h, &d);
}

static bool result_of_run(ob_host *h, ob_error *e)
{
	if (h->interrupted)
		return ob_fail(e, "interrupted after step %llu", (unsigned long long)ob_step_count(h->u));
	if (!h->failed)
		return true;
	pthread_mutex_lock(&h->failure_lock);
	ob_fail(e, "%s", h->failure.text);
	pthread_mutex_unlock(&h->failure_lock);
	return false;
}

// Waits a little without sleeping, if there is a core for it: a program that leads the run waits for a step, and to wake a
// core takes longer than a short step. Returns true if the host has its turn.
static bool spin_for_turn(ob_host *h)
{
	const bool has_core = h->control && h->workers < (uint32_t)ob_cpu_count();
	const double end = ob_clock_wall() + spin_time;
	bool turn = false;
	while (has_core && !turn && ob_clock_wall() < end)
		turn = ob_gate_host_wait(h->u, 0);
	return turn;
}

// True if the host gets its turn within one poll interval, or by working itself.
static bool wait_for_turn(ob_host *h)
{
	if (h->spawn->pass) {
		if (!h->spawn->pass(h->group))
			ob_host_set_failure(h, "out of memory after step %llu",
					    (unsigned long long)ob_step_count(h->u));
		return true;
	}
	bool turn = spin_for_turn(h);
	for (int i = 0; i < LOOKS_PER_POLL && !turn; i++) {
		turn = ob_free_settings_of(h->u) ? ob_host_free_wait(h, poll_interval / LOOKS_PER_POLL)
						 : ob_gate_host_wait(h->u, poll_interval / LOOKS_PER_POLL);
		if (h->interrupted || is_called(h))
			break;
	}
	return turn;
}

bool ob_host_wait(ob_host *h, ob_error *e)
{
	ob_stall_watch stall = ob_stall_watch_start(h);
	double interrupted_at = 0;
	while (h->interval.running && !h->failed) {
		bool turn = wait_for_turn(h);
		const char *failure = turn ? ob_sim_failure(h->u) : NULL;
		if (h->restart.requested) { // the gate was stopped for the restart: this is not a pause
			restart_interval(h);
			stall = ob_stall_watch_start(h);
			if (h->interrupted)
				break;
		} else if (turn && find_damage(h)) {
			report_damage(h, find_damage(h));
		} else if (failure) {
			report_failure(h, failure);
		} else if (turn && (at_interval_end(h) || ob_sim_awaits_requests(h->u))) {
			end_interval(h);
			if (!h->interrupted)
				begin_interval(h);
		} else {
			if (turn)
				nanosleep(&(struct timespec){ .tv_nsec = 1000000 }, NULL);
			if (!check_progress(h, &stall, &interrupted_at)) {
				ob_host_halt(h); // workers leave while the report is made
				break;
			}
		}
	}
	return result_of_run(h, e);
}

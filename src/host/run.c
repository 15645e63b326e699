// From go to wait: legs between pauses, what happens in the pauses, and the watch over the time they take.
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "host/stall.h"
#include "host/host_state.h"
#include "host/restart.h"
#include "sim/sim.h"

static const double look_interval = .1; // s, between looks at a run that does not pause
static const double interrupt_grace = 1; // s that a step may still take after Ctrl-C

void ob_host_set_failure(ob_host *h, const char *format, ...)
{
	va_list args;
	pthread_mutex_lock(&h->failure_lock);
	if (!h->failed) {
		va_start(args, format);
		vsnprintf(h->failure.text, sizeof h->failure.text, format, args);
		va_end(args);
		h->failed = true;
	}
	pthread_mutex_unlock(&h->failure_lock);
	ob_host_halt(h);
}

void ob_host_halt(ob_host *h)
{
	pthread_mutex_lock(&h->leg.lock);
	h->leg.halted = true;
	ob_gate_set_pause_step(h->u, 0); // where all sleep, steps pass by the thousand without a look at the gate
	pthread_mutex_unlock(&h->leg.lock);
	ob_gate_stop(h->u);
}

void ob_host_shorten_leg(ob_host *h)
{
	ob_leg *leg = &h->leg;
	pthread_mutex_lock(&leg->lock);
	uint64_t next = ob_step_count(h->u) + 1;
	if (leg->running && next < leg->end) {
		leg->end = next;
		ob_gate_set_pause_step(h->u, next);
	}
	pthread_mutex_unlock(&leg->lock);
}

// Paused: changes who is there, then opens the gate for the next leg, if the target is still ahead.
static void begin_leg(ob_host *h)
{
	ob_leg *leg = &h->leg;
	uint64_t step = ob_step_count(h->u);
	ob_restart_checkpoint(h, ob_population_update(h->population, step, h->requests));
	if (h->perceived && step >= h->target)
		return;
	uint64_t next = ob_population_next_step(h->population);
	if (!h->perceived)
		ob_universe_set_state(h->u, OB_UNIVERSE_RUNNING);
	h->perceived = true;
	if (!h->cpu_counted && h->target > step) {
		h->cpu_before = ob_host_read_cpu(h);
		h->own_cpu_before = ob_clock_process_cpu();
		h->switches_before = ob_host_count_switches(h);
		h->first_start = ob_clock_wall();
		h->gate_before = ob_host_gate_time(h, h->first_start);
		h->cpu_counted = true;
	}
	pthread_mutex_lock(&leg->lock);
	leg->running = true;
	leg->end = next < h->target ? next : h->target;
	if (!leg->halted)
		ob_gate_set_pause_step(h->u, leg->end);
	pthread_mutex_unlock(&leg->lock);
	h->leg_first = step;
	h->leg_start = ob_clock_wall();
	ob_sim_resume(h->u);
}

static void end_leg(ob_host *h)
{
	double wall = ob_clock_wall() - h->leg_start;
	uint64_t steps = ob_step_count(h->u) - h->leg_first;
	pthread_mutex_lock(&h->leg.lock);
	h->leg.running = false;
	pthread_mutex_unlock(&h->leg.lock);
	if (steps == 0)
		return;
	h->wall += wall;
	h->last_end = h->leg_start + wall;
}

// After a loss. If there is another at once, the leg is still to be gone to its end.
static void begin_again(ob_host *h)
{
	end_leg(h);
	if (ob_restart(h)) {
		h->perceived = ob_step_count(h->u) > 0;
		begin_leg(h);
	} else {
		pthread_mutex_lock(&h->leg.lock);
		h->leg.running = true;
		pthread_mutex_unlock(&h->leg.lock);
	}
}

static void give_up(ob_host *h, uint64_t step)
{
	char waits_for[400];
	ob_stall_describe(h, waits_for, sizeof waits_for);
	ob_restart_lose(h, "step %llu was not complete after %g s; it waits for %s", (unsigned long long)step + 1,
			h->patience, waits_for);
}

// Not paused yet. Sees to whoever waits for a pause; false: no use in waiting any longer.
static bool keep_patience(ob_host *h, uint64_t *seen_step, double *seen_at, double *interrupted_at)
{
	double now = ob_clock_wall();
	uint64_t step = ob_step_count(h->u);
	if (step != *seen_step) {
		*seen_step = step;
		*seen_at = now;
	}
	if (now - *seen_at > h->patience)
		give_up(h, step);
	if (h->interrupted && *interrupted_at == 0)
		*interrupted_at = now;
	if (h->interrupted || ob_requests_waiting(h->requests) || ob_restart_checkpoint_due(h))
		ob_host_shorten_leg(h);
	return !(h->interrupted && now - *interrupted_at > interrupt_grace);
}

void ob_host_go(ob_host *h, uint64_t step)
{
	h->target = step;
	if (!h->leg.running && !h->failed && !h->interrupted)
		begin_leg(h);
}

// A gate that was stopped looks like a pause: the step then falls short of the leg's end.
static bool at_leg_end(ob_host *h)
{
	pthread_mutex_lock(&h->leg.lock);
	bool there = ob_step_count(h->u) >= h->leg.end;
	pthread_mutex_unlock(&h->leg.lock);
	return there;
}

static bool outcome(ob_host *h, ob_error *e)
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

bool ob_host_wait(ob_host *h, ob_error *e)
{
	uint64_t seen_step = ob_step_count(h->u);
	double seen_at = ob_clock_wall(), interrupted_at = 0;
	while (h->leg.running && !h->failed) {
		bool turn = ob_gate_host_wait(h->u, look_interval);
		const char *failure = turn ? ob_sim_failure(h->u) : NULL;
		if (h->rebirth.lost) { // what looks like a pause is none
			begin_again(h);
			seen_at = ob_clock_wall();
		} else if (failure) {
			ob_host_set_failure(h, "%s", failure);
		} else if (turn && at_leg_end(h)) {
			end_leg(h);
			if (!h->interrupted)
				begin_leg(h);
		} else {
			if (turn)
				nanosleep(&(struct timespec){ .tv_nsec = 1000000 }, NULL);
			if (!keep_patience(h, &seen_step, &seen_at, &interrupted_at))
				break;
		}
	}
	return outcome(h, e);
}

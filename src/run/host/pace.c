#include "host/pace.h"

#include <math.h>
#include <time.h>

#include "base/clock.h"

void ob_pace_begin(ob_pace *p, double rate, bool paused)
{
	pthread_condattr_t monotonic;
	*p = (ob_pace){ .state = { rate, paused }, .stop = UINT64_MAX };
	pthread_mutex_init(&p->lock, NULL);
	pthread_condattr_init(&monotonic);
	pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
	pthread_cond_init(&p->changed, &monotonic);
	pthread_condattr_destroy(&monotonic);
}

void ob_pace_end(ob_pace *p)
{
	pthread_cond_destroy(&p->changed);
	pthread_mutex_destroy(&p->lock);
}

ob_pace_state ob_pace_get(ob_pace *p)
{
	pthread_mutex_lock(&p->lock);
	ob_pace_state state = p->state;
	pthread_mutex_unlock(&p->lock);
	return state;
}

// Wakes the waiting thread. Under the lock. The line begins anew with the next wait.
static void tell(ob_pace *p)
{
	p->allowed = 0;
	p->drawn = false;
	pthread_cond_signal(&p->changed);
}

void ob_pace_set_rate(ob_pace *p, double rate)
{
	pthread_mutex_lock(&p->lock);
	p->state.rate = rate;
	tell(p);
	pthread_mutex_unlock(&p->lock);
}

void ob_pace_set_paused(ob_pace *p, bool paused)
{
	pthread_mutex_lock(&p->lock);
	p->state.paused = paused;
	p->stop = UINT64_MAX;
	tell(p);
	pthread_mutex_unlock(&p->lock);
}

void ob_pace_run_until(ob_pace *p, uint64_t step)
{
	pthread_mutex_lock(&p->lock);
	p->state.paused = false;
	p->stop = step;
	tell(p);
	pthread_mutex_unlock(&p->lock);
}

void ob_pace_restart(ob_pace *p)
{
	pthread_mutex_lock(&p->lock);
	tell(p);
	pthread_mutex_unlock(&p->lock);
}

void ob_pace_allow(ob_pace *p, uint64_t steps)
{
	pthread_mutex_lock(&p->lock);
	p->allowed += p->state.paused ? steps : 0;
	pthread_cond_signal(&p->changed);
	pthread_mutex_unlock(&p->lock);
}

// Step that is due now. wait: s until a step beyond "done" is due. Under the lock.
static uint64_t due_step(ob_pace *p, uint64_t done, double step_length, uint64_t most, double *wait)
{
	double now = ob_clock_wall(), each = step_length / p->state.rate;
	*wait = INFINITY;
	if (done >= p->stop) {
		p->state.paused = true;
		p->stop = UINT64_MAX;
	}
	if (p->state.paused) {
		const uint64_t steps = p->allowed < most ? p->allowed : most;
		p->allowed -= steps;
		return done + steps;
	}
	if (isinf(p->state.rate))
		return p->stop;
	double lag = p->drawn ? now - p->from_wall - (double)(done - p->from_step) * each : 0;
	if (!p->drawn || lag > OB_PACE_BEHIND + each) {
		p->drawn = true;
		p->from_step = done;
		p->from_wall = now;
	}
	double steps = floor((now - p->from_wall) / each);
	uint64_t due = p->from_step + (steps < 1e18 ? (uint64_t)steps : 0);
	*wait = p->from_wall + (double)(done + 1 - p->from_step) * each - now;
	due = due < p->stop ? due : p->stop;
	return due > done ? due : done;
}

uint64_t ob_pace_wait(ob_pace *p, uint64_t done, double step_length, uint64_t most, double patience)
{
	double until = ob_clock_wall() + patience, wait;
	pthread_mutex_lock(&p->lock);
	uint64_t due = due_step(p, done, step_length, most, &wait);
	for (double now; due <= done && (now = ob_clock_wall()) < until;) {
		double wake = fmin(until, now + fmax(wait, 0));
		struct timespec at = { .tv_sec = (time_t)wake, .tv_nsec = (long)(1e9 * (wake - floor(wake))) };
		pthread_cond_timedwait(&p->changed, &p->lock, &at);
		due = due_step(p, done, step_length, most, &wait);
	}
	pthread_mutex_unlock(&p->lock);
	return due;
}

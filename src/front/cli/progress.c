#include "cli/progress.h"

#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/interrupt.h"
#include "experiment/progress.h"

enum { SILENCE_MS = 2000, PERIOD_MS = 200 };

struct ob_progress {
	const ob_universe *universe;
	uint64_t first, steps; // first: step at the beginning; steps: the whole run's
	double begun; // s
	pthread_t thread;
	pthread_mutex_t lock; // guards over
	pthread_cond_t ended;
	bool over;
};

static void show(const ob_progress *p)
{
	ob_universe_info info;
	ob_universe_get_info(p->universe, &info);
	double wall = ob_clock_wall() - p->begun, rate = (double)(info.step - p->first) / wall;
	double left = info.step > p->first ? (double)(p->steps - info.step) / rate : NAN;
	char what[64];
	snprintf(what, sizeof what, "%.0f steps/s, %.2f s simulated", rate, info.time);
	ob_progress_show(&(ob_progress_view){ 0 }, (double)info.step, (double)p->steps, left, what);
}

// true when the end came within ms
static bool wait_for_end(ob_progress *p, int ms)
{
	struct timespec until;
	clock_gettime(CLOCK_MONOTONIC, &until);
	until.tv_sec += ms / 1000;
	until.tv_nsec += ms % 1000 * 1000000L;
	if (until.tv_nsec >= 1000000000L) {
		until.tv_sec++;
		until.tv_nsec -= 1000000000L;
	}
	pthread_mutex_lock(&p->lock);
	int late = 0;
	while (!p->over && late == 0)
		late = pthread_cond_timedwait(&p->ended, &p->lock, &until);
	bool over = p->over;
	pthread_mutex_unlock(&p->lock);
	return over;
}

static void *run(void *context)
{
	ob_progress *p = context;
	if (wait_for_end(p, SILENCE_MS))
		return NULL;
	do
		show(p);
	while (!wait_for_end(p, PERIOD_MS));
	fputs("\r\033[K", stderr);
	return NULL;
}

ob_progress *ob_progress_begin(const ob_universe *u, uint64_t steps)
{
	ob_progress *p = isatty(STDERR_FILENO) ? calloc(1, sizeof *p) : NULL;
	if (!p)
		return NULL;
	p->universe = u;
	ob_universe_info info;
	ob_universe_get_info(u, &info);
	p->first = info.step;
	p->steps = steps;
	p->begun = ob_clock_wall();
	pthread_mutex_init(&p->lock, NULL);
	pthread_condattr_t monotonic;
	pthread_condattr_init(&monotonic);
	pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
	pthread_cond_init(&p->ended, &monotonic);
	pthread_condattr_destroy(&monotonic);

	// leaves signals to the main thread, which ends the run
	sigset_t before;
	ob_interrupt_leave_to_main(&before);
	int failed = pthread_create(&p->thread, NULL, run, p);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	if (failed) {
		pthread_cond_destroy(&p->ended);
		pthread_mutex_destroy(&p->lock);
		free(p);
		return NULL;
	}
	return p;
}

void ob_progress_end(ob_progress *p)
{
	if (!p)
		return;
	pthread_mutex_lock(&p->lock);
	p->over = true;
	pthread_cond_signal(&p->ended);
	pthread_mutex_unlock(&p->lock);
	pthread_join(p->thread, NULL);
	pthread_cond_destroy(&p->ended);
	pthread_mutex_destroy(&p->lock);
	free(p);
}

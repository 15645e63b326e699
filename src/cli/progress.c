#include "cli/progress.h"

#include <inttypes.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"

enum { SILENCE_MS = 2000, PERIOD_MS = 200 };

struct ob_progress {
	const ob_universe *universe;
	uint64_t steps;
	double begun; // s
	pthread_t thread;
	pthread_mutex_t lock; // over over
	pthread_cond_t ended;
	bool over;
};

void ob_progress_print_rest(char *text, size_t size, double s)
{
	if (s < 100)
		snprintf(text, size, "%.0f s", s);
	else if (s < 6000)
		snprintf(text, size, "%d min %d s", (int)s / 60, (int)s % 60);
	else
		snprintf(text, size, "%.1f h", s / 3600);
}

static void show(const ob_progress *p)
{
	ob_universe_info info;
	ob_universe_get_info(p->universe, &info);
	double wall = ob_clock_wall() - p->begun, rate = (double)info.step / wall;
	char rest[48] = "-";
	if (info.step > 0)
		ob_progress_print_rest(rest, sizeof rest, (double)(p->steps - info.step) / rate);
	fprintf(stderr, "\r\033[K%3.0f %%  %.2f s simulated, %" PRIu64 " of %" PRIu64 " steps, %.0f/s, %s left",
		100 * (double)info.step / (double)p->steps, info.time, info.step, p->steps, rate, rest);
	fflush(stderr);
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
	p->steps = steps;
	p->begun = ob_clock_wall();
	pthread_mutex_init(&p->lock, NULL);
	pthread_condattr_t monotonic;
	pthread_condattr_init(&monotonic);
	pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
	pthread_cond_init(&p->ended, &monotonic);
	pthread_condattr_destroy(&monotonic);

	// signals are for the main thread, which knows how to end the run
	sigset_t all, before;
	sigfillset(&all);
	pthread_sigmask(SIG_BLOCK, &all, &before);
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

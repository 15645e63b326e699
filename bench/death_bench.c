// Delay until a simulator's death is noticed, and until the run steps again: a thousand balls fall onto each other, in
// processes; one is killed at a random moment, some dozens of times.
//
//   detection   from the kill to the supervisor's request for a restart
//   stepping    from the kill to the first step completed after the restart
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "../tests/host/little_scene.h"
#include "base/clock.h"
#include "host/host_state.h"

enum { BALLS = 1000, MOST_DEATHS = 60 };

typedef struct killer {
	ob_host *h;
	atomic_bool over;
	unsigned deaths, dealt;
	double detection[MOST_DEATHS], stepping[MOST_DEATHS]; // s
} killer;

static void sleep_for(double s)
{
	nanosleep(&(struct timespec){ .tv_sec = (time_t)s, .tv_nsec = (long)((s - (double)(time_t)s) * 1e9) }, NULL);
}

static bool kill_one(killer *k, unsigned i)
{
	ob_worker_info info;
	const ob_universe *u = ob_host_universe(k->h);
	const uint32_t deaths = k->h->restart.deaths;
	if (!ob_universe_get_worker(u, i % k->h->workers, &info) || !info.pid)
		return false;
	double killed = ob_clock_wall();
	if (kill(info.pid, SIGKILL) != 0)
		return false;
	while (!k->h->restart.requested && k->h->restart.deaths == deaths)
		sleep_for(1e-5);
	k->detection[i] = ob_clock_wall() - killed;
	while (k->h->restart.deaths == deaths || k->h->restart.requested || !ob_universe_get_worker(u, 0, &info) ||
	       !info.pid)
		sleep_for(1e-5);
	uint64_t step = ob_step_count(u);
	while (ob_step_count(u) <= step)
		sleep_for(1e-5);
	k->stepping[i] = ob_clock_wall() - killed;
	return true;
}

static void *deal(void *argument)
{
	killer *k = argument;
	srand(1);
	while (k->dealt < k->deaths) {
		sleep_for(.3 + .2 * rand() / RAND_MAX); // lets the run continue
		k->dealt += kill_one(k, k->dealt);
	}
	k->over = true;
	ob_host_pause_early(k->h);
	return NULL;
}

static int by_size(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static void print(const char *what, double *s, unsigned n)
{
	qsort(s, n, sizeof *s, by_size);
	printf("  %-10s median %7.3f ms, 90 %% %7.3f ms, worst %7.3f ms\n", what, 1e3 * s[n / 2], 1e3 * s[n * 9 / 10],
	       1e3 * s[n - 1]);
}

static void measure(uint32_t workers, unsigned deaths)
{
	static killer k;
	ob_scene s = little_scene(BALLS);
	ob_host_config c = little_config(&s, OB_ISOLATION_PROCESS, workers);
	ob_error e = { "" };
	pthread_t thread;
	k = (killer){ .h = ob_host_start(&s, &c, &e), .deaths = deaths };
	if (!k.h) {
		puts(e.text);
		exit(1);
	}
	pthread_create(&thread, NULL, deal, &k);
	for (uint64_t step = 1; !k.over; step++) {
		ob_host_go(k.h, step);
		if (!ob_host_wait(k.h, &e)) {
			puts(e.text);
			exit(1);
		}
	}
	pthread_join(thread, NULL);
	printf("%u workers, %d objects, %d deaths\n", k.h->workers, BALLS, deaths);
	print("detection", k.detection, deaths);
	print("stepping", k.stepping, deaths);
	ob_host_stop(k.h);
	free(s.object);
}

int main(void)
{
	measure(2, MOST_DEATHS);
	measure(0, 10);
	return 0;
}

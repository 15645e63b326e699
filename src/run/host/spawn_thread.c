#include "host/spawn.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/interrupt.h"

// Stack sizes: thousands of threads must fit; a few, the monolith among them, may be as deep as a usual program's.
enum { MANY_WORKERS = 64, SMALL_STACK = 256 << 10, USUAL_STACK = 8 << 20 };

typedef struct worker_thread {
	ob_worker_group *group;
	pthread_t thread;
	uint32_t worker;
} worker_thread;

struct ob_worker_group {
	ob_universe *u;
	ob_worker_run run;
	int ends[2]; // pipe: each thread writes an ob_worker_end as its last act
	uint32_t workers, started, ended;
	worker_thread threads[];
};

static void *thread_main(void *argument)
{
	worker_thread *t = argument;
	char name[16];
	snprintf(name, sizeof name, "sim %u", t->worker);
	pthread_setname_np(pthread_self(), name);
	ob_worker_end end = { .worker = t->worker, .pid = getpid() };
	end.code = t->group->run(t->group->u, t->worker);
	while (write(t->group->ends[1], &end, sizeof end) < 0 && errno == EINTR)
		;
	return NULL;
}

static int thread_fd(const ob_worker_group *g)
{
	return g->ends[0];
}

static bool thread_next_end(ob_worker_group *g, ob_worker_end *end)
{
	bool got = read(g->ends[0], end, sizeof *end) == sizeof *end;
	if (got) // else no write is allowed: a restart may be under way
		g->ended++;
	return got;
}

static uint64_t thread_cpu(const ob_worker_info *w)
{
	return ob_clock_cpu_of_thread(w->tid);
}

static void join_all(ob_worker_group *g)
{
	for (uint32_t i = 0; i < g->started; i++)
		pthread_join(g->threads[i].thread, NULL);
	g->started = g->ended = 0;
}

static bool thread_join(ob_worker_group *g, double timeout)
{
	ob_worker_end end;
	ob_hang_clock clock = ob_hang_clock_start();
	while (g->ended < g->started) {
		double left = timeout - ob_hang_clock_tick(&clock);
		if (left <= 0)
			return false; // g must live on: a stalled thread may still use it
		struct pollfd p = { .fd = g->ends[0], .events = POLLIN };
		poll(&p, 1, ob_spawn_poll_ms(left));
		while (thread_next_end(g, &end))
			;
	}
	join_all(g);
	close(g->ends[0]);
	close(g->ends[1]);
	free(g);
	return true;
}

static int start_threads(ob_worker_group *g, uint32_t workers)
{
	pthread_attr_t attributes;
	sigset_t before;
	int error = 0;
	pthread_attr_init(&attributes);
	pthread_attr_setstacksize(&attributes, workers > MANY_WORKERS ? SMALL_STACK : USUAL_STACK);
	ob_interrupt_leave_to_main(&before);
	for (uint32_t i = 0; i < workers && !error; i++) {
		worker_thread *t = &g->threads[i];
		*t = (worker_thread){ .group = g, .worker = i };
		error = pthread_create(&t->thread, &attributes, thread_main, t);
		g->started += !error;
	}
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	pthread_attr_destroy(&attributes);
	return error;
}

static bool fail_start(const ob_worker_group *g, int error, ob_error *e)
{
	return ob_fail(e,
		       "thread %u of %u does not start: %s; use fewer workers, or raise the limit on processes "
		       "(ulimit -u, or pids.max of the container)",
		       g->started + 1, g->workers, strerror(error));
}

static void thread_end(ob_worker_group *g)
{
	ob_gate_stop(g->u);
}

static bool thread_restart(ob_worker_group *g, ob_error *e)
{
	join_all(g);
	int error = start_threads(g, g->workers);
	return !error || fail_start(g, error, e);
}

static ob_worker_group *thread_start(const ob_worker_group_setup *setup, ob_error *e)
{
	uint32_t workers = ob_universe_workers(setup->u);
	ob_worker_group *g = calloc(1, sizeof *g + workers * sizeof *g->threads);
	if (!g || pipe2(g->ends, O_CLOEXEC) != 0) {
		free(g);
		ob_fail(e, "cannot allocate %u workers: %s", workers, strerror(errno));
		return NULL;
	}
	fcntl(g->ends[0], F_SETFL, O_NONBLOCK);
	g->u = setup->u;
	g->run = setup->run;
	g->workers = workers;
	int error = start_threads(g, workers);
	if (error) {
		fail_start(g, error, e);
		ob_gate_stop(setup->u);
		thread_join(g, 5);
		return NULL;
	}
	return g;
}

const ob_spawn ob_spawn_threads = {
	.name = "thread",
	.start = thread_start,
	.fd = thread_fd,
	.next_end = thread_next_end,
	.end = thread_end,
	.restart = thread_restart,
	.cpu = thread_cpu,
	.join = thread_join,
	.leave_timeout = 5,
	.own_memory = false,
};

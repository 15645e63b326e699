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

// Thousands of threads must fit; a few may be as deep as a usual program's (the single world is one of them).
enum { MANY_WORKERS = 64, SMALL_STACK = 256 << 10, USUAL_STACK = 8 << 20 };

typedef struct seat {
	ob_crew *crew;
	pthread_t thread;
	uint32_t worker;
} seat;

struct ob_crew {
	ob_universe *u;
	ob_worker_run run;
	int ends[2]; // pipe: each thread writes an ob_worker_end as its last act
	uint32_t started, ended;
	seat seats[];
};

static void *live(void *argument)
{
	seat *s = argument;
	char name[16];
	snprintf(name, sizeof name, "sim %u", s->worker);
	pthread_setname_np(pthread_self(), name);
	ob_worker_end end = { .worker = s->worker, .pid = getpid() };
	end.code = s->crew->run(s->crew->u, s->worker);
	while (write(s->crew->ends[1], &end, sizeof end) < 0 && errno == EINTR)
		;
	return NULL;
}

static int thread_fd(const ob_crew *c)
{
	return c->ends[0];
}

static bool thread_next_end(ob_crew *c, ob_worker_end *end)
{
	bool got = read(c->ends[0], end, sizeof *end) == sizeof *end;
	c->ended += got;
	return got;
}

static uint64_t thread_cpu(const ob_worker_info *w)
{
	return ob_clock_cpu_of_thread(w->tid);
}

static bool thread_join(ob_crew *c, double timeout)
{
	ob_worker_end end;
	double until = ob_clock_wall() + timeout;
	while (c->ended < c->started) {
		double left = until - ob_clock_wall();
		if (left <= 0)
			return false; // c must live on: a thread that hangs may come back to it
		struct pollfd p = { .fd = c->ends[0], .events = POLLIN };
		poll(&p, 1, (int)(left * 1000) + 1);
		while (thread_next_end(c, &end))
			;
	}
	for (uint32_t i = 0; i < c->started; i++)
		pthread_join(c->seats[i].thread, NULL);
	close(c->ends[0]);
	close(c->ends[1]);
	free(c);
	return true;
}

// Signals are the main thread's; only those that a fault of the thread itself raises stay open.
static void block_signals(sigset_t *before)
{
	static const int faults[] = { SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS };
	sigset_t all;
	sigfillset(&all);
	for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
		sigdelset(&all, faults[i]);
	pthread_sigmask(SIG_SETMASK, &all, before);
}

static int start_seats(ob_crew *c, uint32_t workers)
{
	pthread_attr_t attributes;
	sigset_t before;
	int error = 0;
	pthread_attr_init(&attributes);
	pthread_attr_setstacksize(&attributes, workers > MANY_WORKERS ? SMALL_STACK : USUAL_STACK);
	block_signals(&before);
	for (uint32_t i = 0; i < workers && !error; i++) {
		seat *s = &c->seats[i];
		*s = (seat){ .crew = c, .worker = i };
		error = pthread_create(&s->thread, &attributes, live, s);
		c->started += !error;
	}
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	pthread_attr_destroy(&attributes);
	return error;
}

static ob_crew *thread_start(const ob_crew_order *order, ob_error *e)
{
	uint32_t workers = ob_universe_workers(order->u);
	ob_crew *c = calloc(1, sizeof *c + workers * sizeof *c->seats);
	if (!c || pipe2(c->ends, O_CLOEXEC) != 0) {
		free(c);
		ob_fail(e, "cannot make room for %u workers: %s", workers, strerror(errno));
		return NULL;
	}
	fcntl(c->ends[0], F_SETFL, O_NONBLOCK);
	c->u = order->u;
	c->run = order->run;
	int error = start_seats(c, workers);
	if (error) {
		ob_fail(e,
			"thread %u of %u does not start: %s; use fewer workers, or raise the limit on processes "
			"(ulimit -u, or pids.max of the container)",
			c->started + 1, workers, strerror(error));
		ob_gate_stop(order->u);
		thread_join(c, 5);
		return NULL;
	}
	return c;
}

const ob_spawn ob_spawn_threads = {
	.name = "thread",
	.start = thread_start,
	.fd = thread_fd,
	.next_end = thread_next_end,
	.cpu = thread_cpu,
	.join = thread_join,
	.leave_patience = 5,
	.own_memory = false,
};

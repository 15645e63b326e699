#include "host/spawn.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"

struct ob_worker_group {
	ob_fork_server *fork_server;
	const ob_universe *u;
	uint32_t workers, ended; // workers: of this rank
};

// Forks the workers of this rank: its simulators, and the arranger.
static bool fork_workers(ob_worker_group *g)
{
	const uint32_t all = ob_universe_workers(g->u), simulators = ob_universe_simulators(g->u),
		       here = simulators / ob_universe_ranks(g->u), first = ob_universe_rank(g->u) * here;
	g->workers = here + all - simulators;
	return here == simulators ? ob_fork_server_fork(g->fork_server, 0, all)
				  : ob_fork_server_fork(g->fork_server, first, here) &&
					    ob_fork_server_fork(g->fork_server, simulators, all - simulators);
}

static int process_fd(const ob_worker_group *g)
{
	return ob_fork_server_fd(g->fork_server);
}

static bool process_next_end(ob_worker_group *g, ob_worker_end *end)
{
	bool got = ob_fork_server_next_end(g->fork_server, end);
	if (got) // else no write is allowed: a restart may be under way
		g->ended++;
	return got;
}

static void process_end(ob_worker_group *g)
{
	ob_fork_server_kill(g->fork_server, 0, UINT32_MAX);
}

static bool process_restart(ob_worker_group *g, ob_error *e)
{
	g->ended = 0;
	return fork_workers(g) || ob_fail(e, "the fork server has ended");
}

static bool process_revive(ob_worker_group *g, uint32_t worker)
{
	const bool revived = ob_fork_server_fork(g->fork_server, worker, 1);
	g->ended -= revived;
	return revived;
}

static bool process_kill(ob_worker_group *g, uint32_t worker)
{
	return ob_fork_server_kill(g->fork_server, worker, 1);
}

static uint64_t process_cpu(const ob_worker_info *w)
{
	return ob_clock_cpu_of_process(w->pid);
}

// Waits for the ends. A worker that does not leave in time is killed when the fork server is stopped.
static bool process_join(ob_worker_group *g, double timeout)
{
	ob_worker_end end;
	ob_hang_clock clock = ob_hang_clock_start();
	while (g->ended < g->workers) {
		struct pollfd p = { .fd = ob_fork_server_fd(g->fork_server), .events = POLLIN };
		double left = timeout - ob_hang_clock_tick(&clock);
		if (left <= 0 || (poll(&p, 1, ob_spawn_poll_ms(left)) < 0 && errno != EINTR))
			break;
		while (process_next_end(g, &end))
			;
		if (p.revents & POLLHUP)
			break;
	}
	free(g);
	return true;
}

static ob_worker_group *process_start(const ob_worker_group_setup *setup, ob_error *e)
{
	ob_worker_group *g = calloc(1, sizeof *g);
	if (!g) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	g->fork_server = setup->fork_server;
	g->u = setup->u;
	if (!fork_workers(g)) {
		ob_fail(e, "the fork server has ended: %s", strerror(errno));
		free(g);
		return NULL;
	}
	return g;
}

const ob_spawn ob_spawn_processes = {
	.name = "process",
	.start = process_start,
	.fd = process_fd,
	.next_end = process_next_end,
	.end = process_end,
	.restart = process_restart,
	.revive = process_revive,
	.kill = process_kill,
	.cpu = process_cpu,
	.join = process_join,
	.leave_timeout = 1,
	.own_memory = true,
};

#include "host/spawn.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"

struct ob_crew {
	ob_fork_server *keeper;
	uint32_t workers, ended;
};

static int process_fd(const ob_crew *c)
{
	return ob_fork_server_fd(c->keeper);
}

static bool process_next_end(ob_crew *c, ob_worker_end *end)
{
	bool got = ob_fork_server_next_end(c->keeper, end);
	if (got) // else nothing may be written: a restart may be under way
		c->ended++;
	return got;
}

static void process_kill(ob_crew *c)
{
	ob_fork_server_kill(c->keeper);
}

static bool process_restart(ob_crew *c)
{
	c->ended = 0;
	return ob_fork_server_fork(c->keeper, 0, c->workers);
}

static uint64_t process_cpu(const ob_worker_info *w)
{
	return ob_clock_cpu_of_process(w->pid);
}

// Those that do not leave in time are the keeper's to kill, when it is stopped.
static bool process_join(ob_crew *c, double timeout)
{
	ob_worker_end end;
	double until = ob_clock_wall() + timeout;
	while (c->ended < c->workers) {
		struct pollfd p = { .fd = ob_fork_server_fd(c->keeper), .events = POLLIN };
		double left = until - ob_clock_wall();
		if (left <= 0 || (poll(&p, 1, (int)(left * 1000) + 1) < 0 && errno != EINTR))
			break;
		while (process_next_end(c, &end))
			;
		if (p.revents & POLLHUP)
			break;
	}
	free(c);
	return true;
}

static ob_crew *process_start(const ob_crew_order *order, ob_error *e)
{
	ob_crew *c = calloc(1, sizeof *c);
	if (!c) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	c->keeper = order->keeper;
	c->workers = ob_universe_workers(order->u);
	if (!ob_fork_server_fork(c->keeper, 0, c->workers)) {
		ob_fail(e, "the keeper process has ended: %s", strerror(errno));
		free(c);
		return NULL;
	}
	return c;
}

const ob_spawn ob_spawn_processes = {
	.name = "process",
	.start = process_start,
	.fd = process_fd,
	.next_end = process_next_end,
	.kill = process_kill,
	.restart = process_restart,
	.cpu = process_cpu,
	.join = process_join,
	.leave_patience = 1,
	.own_memory = true,
};

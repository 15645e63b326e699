// The only worker is the thread that waits for the run: of a universe within a program (cli/inside.c).
//
//   program's thread   step ──> host: go ──> wait: pass ──────────────> host: has its turn ──> step returns
//                                             phase, phase, phase ..
#include <stdlib.h>

#include "base/clock.h"
#include "host/spawn.h"

struct ob_worker_group {
	ob_universe *u;
	ob_worker *worker; // NULL: between an end and a restart
};

static bool inside_restart(ob_worker_group *g, ob_error *e)
{
	g->worker = ob_worker_begin(g->u, 0, false, e);
	return g->worker;
}

static ob_worker_group *inside_start(const ob_worker_group_setup *setup, ob_error *e)
{
	ob_worker_group *g = calloc(1, sizeof *g);
	if (!g) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	g->u = setup->u;
	if (inside_restart(g, e))
		return g;
	free(g);
	return NULL;
}

static void inside_end(ob_worker_group *g)
{
	ob_gate_stop(g->u);
	ob_worker_leave(g->worker);
	g->worker = NULL;
}

static bool inside_join(ob_worker_group *g, double timeout)
{
	(void)timeout;
	ob_worker_leave(g->worker);
	free(g);
	return true;
}

static bool inside_pass(ob_worker_group *g)
{
	return ob_worker_pass(g->worker);
}

static uint64_t inside_cpu(const ob_worker_info *w)
{
	return ob_clock_cpu_of_thread(w->tid);
}

const ob_spawn ob_spawn_inside = {
	.name = "inside",
	.start = inside_start,
	.end = inside_end,
	.restart = inside_restart,
	.cpu = inside_cpu,
	.join = inside_join,
	.pass = inside_pass,
	.leave_timeout = 0,
	.own_memory = false,
};

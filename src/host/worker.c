#include "host/worker.h"

#include <setjmp.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/allocate.h"
#include "base/cpu.h"
#include "base/log.h"
#include "free/free.h"
#include "host/confine.h"
#include "ode/ode_body.h"
#include "ranks/ranks.h"
#include "script/script.h"
#include "step/sim.h"

static _Thread_local jmp_buf no_memory;

// Leaves from any point of the worker's code; memory held there is not freed.
static void leave_without_memory(void)
{
	longjmp(no_memory, 1);
}

static const char *gather(void *wire, const void *mine, size_t n, const size_t **at)
{
	return ob_wire_gather(wire, mine, n, at);
}

static const char *deal(void *wire, const void *const *mine, const size_t *bytes, const size_t **at)
{
	return ob_wire_deal(wire, mine, bytes, at);
}

// Connects the arranger of a rank to those of the others. false and e: it cannot.
static bool join(ob_sim *s, const ob_universe *u, ob_wire **wire, ob_error *e)
{
	const ob_ranks own = { ob_universe_rank(u), ob_universe_ranks(u) };
	if (own.ranks == 1)
		return true;
	*wire = ob_wire_open(&own, e);
	if (!*wire)
		return false;
	const ob_peers peers = { .rank = own.rank, .ranks = own.ranks, .gather = gather, .deal = deal, .wire = *wire };
	return ob_sim_join(s, &peers, e);
}

static int live(ob_universe *u, uint32_t worker)
{
	ob_error e;
	ob_wire *wire = NULL;
	const bool arranges = ob_universe_contains(u) && worker == ob_universe_simulators(u);
	int cpu = arranges ? -1 // any core
			   : ob_cpu_pin(worker); // in turn, where workers or ranks of this machine exceed its cores
	ob_ode_init();
	ob_ode_thread_init();
	ob_sim *s = ob_sim_create(u, worker, &e);
	ob_script_runner *scripts = NULL;
	if (s && ob_universe_step_data(u)->script_counts) {
		scripts = ob_script_runner_create(u, worker);
		if (scripts) {
			ob_sim_set_scripts(s, ob_script_runner_run, scripts);
		} else {
			ob_sim_destroy(s);
			s = NULL;
		}
	}
	if (s)
		ob_worker_announce(u, worker, getpid(), gettid(), cpu); // from now on it is ready for the gate
	bool ready = s && ob_confine(u, worker, &e) && (!arranges || join(s, u, &wire, &e));
	if (ready && ob_free_settings_of(u))
		ready = ob_free_work(u, worker, &e);
	else if (ready)
		ob_sim_run(s);
	else if (s)
		ob_log_warn("worker %u: %s", worker, e.text);
	if (wire)
		ob_sim_leave(s);
	ob_wire_close(wire);
	ob_sim_destroy(s);
	ob_script_runner_destroy(scripts);
	ob_ode_thread_finish();
	return ready ? EXIT_SUCCESS : s ? EXIT_FAILURE : OB_WORKER_NO_MEMORY;
}

int ob_worker_live(ob_universe *u, uint32_t worker)
{
	if (setjmp(no_memory) != 0)
		return OB_WORKER_NO_MEMORY;
	ob_allocate_or_else(leave_without_memory);
	return live(u, worker);
}

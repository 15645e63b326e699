#include "host/worker.h"

#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
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

struct ob_worker {
	ob_universe *u;
	uint32_t number;
	ob_sim *sim;
	ob_script_runner *scripts; // NULL: the scene has none
};

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

ob_worker *ob_worker_begin(ob_universe *u, uint32_t number, bool pinned, ob_error *e)
{
	ob_worker *w = calloc(1, sizeof *w);
	const bool arranges = ob_universe_contains(u) && number == ob_universe_simulators(u);
	const int cpu =
		arranges || !pinned
			? -1 // any core
			: ob_cpu_pin(number); // in turn, where workers or ranks of this machine exceed its cores
	ob_ode_init();
	ob_ode_thread_init();
	if (w)
		*w = (ob_worker){ .u = u, .number = number, .sim = ob_sim_create(u, number, e) };
	bool fine = w && w->sim;
	if (fine && ob_universe_step_data(u)->script_counts) {
		w->scripts = ob_script_runner_create(u, number);
		fine = w->scripts;
		if (fine)
			ob_sim_set_scripts(w->sim, ob_script_runner_run, w->scripts);
	}
	if (fine) {
		ob_worker_announce(u, number, getpid(), gettid(), cpu); // from now on it is ready for the gate
		return w;
	}
	ob_worker_leave(w);
	ob_fail(e, "worker %u: no memory", number);
	return NULL;
}

void ob_worker_leave(ob_worker *w)
{
	if (!w)
		return;
	ob_sim_destroy(w->sim);
	ob_script_runner_destroy(w->scripts);
	ob_ode_thread_finish();
	free(w);
}

bool ob_worker_pass(ob_worker *w)
{
	if (setjmp(no_memory) != 0)
		return false;
	ob_allocate_or_else(leave_without_memory);
	while (!ob_gate_host_wait(w->u, 0) && ob_step(w->sim))
		;
	ob_allocate_or_else(NULL);
	return true;
}

// Runs a worker to the end of the run. false and e: it cannot.
static bool run(ob_worker *w, ob_error *e)
{
	ob_wire *wire = NULL;
	const bool arranges = ob_universe_contains(w->u) && w->number == ob_universe_simulators(w->u);
	bool fine = ob_confine(w->u, w->number, e) && (!arranges || join(w->sim, w->u, &wire, e));
	if (fine && ob_free_settings_of(w->u))
		fine = ob_free_work(w->u, w->number, e);
	else if (fine)
		ob_sim_run(w->sim);
	if (wire)
		ob_sim_leave(w->sim);
	ob_wire_close(wire);
	return fine;
}

int ob_worker_live(ob_universe *u, uint32_t worker)
{
	ob_error e;
	if (setjmp(no_memory) != 0)
		return OB_WORKER_NO_MEMORY;
	ob_allocate_or_else(leave_without_memory);
	ob_worker *w = ob_worker_begin(u, worker, true, &e);
	if (!w)
		return OB_WORKER_NO_MEMORY;
	const bool fine = run(w, &e);
	if (!fine)
		ob_log_warn("worker %u: %s", worker, e.text);
	ob_worker_leave(w);
	return fine ? EXIT_SUCCESS : EXIT_FAILURE;
}

// ---- death

void ob_death_find_object(ob_death *d, const ob_universe *u)
{
	ob_passport p;
	const bool own = ob_universe_settings(u)->one_per_object && d->worker < ob_universe_simulators(u);
	if (d->worker != OB_NO_WORKER)
		d->object = own ? d->worker : ob_worker_object(u, d->worker);
	if (d->object != OB_NO_OBJECT && ob_universe_get_passport(u, d->object, &p))
		memcpy(d->name, p.name, sizeof d->name);
	else
		d->object = OB_NO_OBJECT;
}

void ob_death_print(const ob_death *d, char *line, size_t size)
{
	const bool named = d->object == OB_NO_OBJECT || d->cause == OB_DEATH_FAILURE || d->object == d->worker;
	int n = snprintf(line, size, "%s", d->text);
	if (!named && n >= 0 && (size_t)n < size)
		n += snprintf(line + n, size - (size_t)n, ", busy with object %u%s%.*s%s", d->object,
			      *d->name ? " (" : "", OB_NAME_MAX, d->name, *d->name ? ")" : "");
	if (*d->words && n >= 0 && (size_t)n < size)
		snprintf(line + n, size - (size_t)n, "; its last words: %s", d->words);
}

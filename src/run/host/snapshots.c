#include "host/snapshots.h"

#include <stdlib.h>

#include "base/allocate.h"
#include "base/log.h"
#include "free/free.h"
#include "host/host_state.h"
#include "host/restart.h"

static void forget(ob_kept_snapshot *s)
{
	ob_checkpoint_destroy(s->universe);
	ob_kept_population_free(s->population);
	*s = (ob_kept_snapshot){ NULL, NULL };
}

void ob_snapshots_finish(ob_snapshots *s)
{
	for (size_t i = 0; i < s->count; i++)
		forget(&s->at[i]);
	free(s->at);
}

uint64_t ob_host_keep_snapshot(ob_host *h, ob_error *e)
{
	ob_snapshots *all = &h->snapshots;
	if (ob_universe_settings(h->u)->monolith)
		return ob_fail(e,
			       "the one ODE world has no snapshots, as ODE does not show its whole state: take object "
			       "simulators");
	if (!OB_GROW(all->at, all->count + 1))
		return ob_fail(e, "no memory for another snapshot: forget some");
	ob_kept_snapshot s = { ob_checkpoint_create(), ob_population_copy(h->population, NULL) };
	if (!s.universe || !s.population || !ob_checkpoint_take(s.universe, h->u)) {
		forget(&s);
		return ob_fail(e, "no memory for another snapshot: forget some");
	}
	all->at[all->count] = s;
	return ++all->count;
}

static ob_kept_snapshot *find(ob_host *h, uint64_t number, ob_error *e)
{
	const ob_snapshots *all = &h->snapshots;
	if (number >= 1 && number <= all->count && all->at[number - 1].universe)
		return &all->at[number - 1];
	ob_fail(e, "there is no snapshot %llu", (unsigned long long)number);
	return NULL;
}

bool ob_host_restore_snapshot(ob_host *h, uint64_t number, ob_error *e)
{
	const ob_kept_snapshot *s = find(h, number, e);
	return s && (ob_restart_restore(h, s->universe, s->population) ||
		     ob_fail(e, "%s", h->failed ? h->failure.text : "the run has ended"));
}

bool ob_host_forget_snapshot(ob_host *h, uint64_t number, ob_error *e)
{
	ob_kept_snapshot *s = find(h, number, e);
	if (s)
		forget(s);
	return s;
}

// ---- visitors' requests

static bool operate(ob_host *h, const ob_request *r, ob_error *e)
{
	ob_error ignored;
	const uint64_t old = h->kept, back = r->kind == OB_REQUEST_RETURN && old ? old : h->start;
	if (r->kind != OB_REQUEST_KEEP)
		return ob_host_restore_snapshot(h, back, e);
	const uint64_t new = ob_host_keep_snapshot(h, e);
	if (new &&old)
		ob_host_forget_snapshot(h, old, &ignored);
	h->kept = new ? new : old;
	return false;
}

bool ob_host_take_wish(ob_host *h, ob_request *out)
{
	return ob_requests_take(h->wishes, out);
}

bool ob_host_operate(ob_host *h)
{
	ob_request r;
	ob_error e = { "" };
	bool returned = false;
	if (h->returns && !h->log && !h->start && !ob_universe_settings(h->u)->monolith && !ob_free_settings_of(h->u))
		h->start = ob_host_keep_snapshot(h, &e);
	while (ob_requests_take(h->operations, &r)) {
		returned |= operate(h, &r, &e);
		if (*e.text)
			ob_log_warn("a request was left out: %s", e.text);
	}
	if (returned && !h->failed)
		ob_universe_set_state(h->u, OB_UNIVERSE_RUNNING); // it may have been at its end
	return returned;
}

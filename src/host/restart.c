#include "host/restart.h"

#include <stdarg.h>
#include <stdio.h>
#include <time.h>

#include "base/clock.h"
#include "base/log.h"
#include "host/host_state.h"

enum { MOST_LOSSES = 3 }; // without getting on ..
static const double most_trying = 10; // s, .. for so long
static const double usual_interval = .25; // s, between checkpoints
static const double share = .05; // of the time, that checkpoints may take, ..
static const double allowance = 1; // s, .. but for this much, where objects come and go
static const double end_patience = 10; // s until killed processes are gone

void ob_restart_prepare(ob_host *h)
{
	if (h->spawn->restart && !ob_universe_settings(h->u)->monolith)
		h->rebirth.checkpoint = ob_checkpoint_create(h->u);
	h->rebirth.began = h->rebirth.got_on_at = ob_clock_wall();
}

void ob_restart_finish(ob_host *h)
{
	ob_checkpoint_destroy(h->rebirth.checkpoint);
}

bool ob_restart_checkpoint_due(const ob_host *h)
{
	const ob_restart_state *r = &h->rebirth;
	double now = ob_clock_wall();
	if (!r->checkpoint)
		return false;
	if (!r->current)
		return r->spent <= share * (now - r->began) + allowance;
	return now - r->taken_at >= fmax(usual_interval, r->cost / share);
}

void ob_restart_checkpoint(ob_host *h, bool changed)
{
	ob_restart_state *r = &h->rebirth;
	r->current &= !changed;
	if (!ob_restart_checkpoint_due(h))
		return;
	double began = ob_clock_wall();
	bool farther = ob_step_count(h->u) > ob_checkpoint_step(r->checkpoint);
	r->current = ob_checkpoint_take(r->checkpoint, h->u);
	r->taken_at = ob_clock_wall();
	r->cost = r->taken_at - began;
	r->spent += r->cost;
	if (farther) {
		r->losses = 0;
		r->got_on_at = r->taken_at;
	}
}

void ob_restart_lose(ob_host *h, const char *format, ...)
{
	ob_restart_state *r = &h->rebirth;
	ob_error loss;
	va_list args;
	va_start(args, format);
	vsnprintf(loss.text, sizeof loss.text, format, args);
	va_end(args);
	if (!r->current) {
		ob_host_set_failure(h, "%s", loss.text);
		return;
	}
	pthread_mutex_lock(&h->failure_lock);
	if (!r->lost)
		r->loss = loss;
	r->lost = true;
	pthread_mutex_unlock(&h->failure_lock);
	ob_gate_stop(h->u); // the others leave, and the host wakes
}

static bool end_all(ob_host *h)
{
	double until = ob_clock_wall() + end_patience;
	h->spawn->kill(h->crew);
	while (h->living > 0 && !h->failed && ob_clock_wall() < until)
		nanosleep(&(struct timespec){ .tv_nsec = 100000 }, NULL);
	if (h->living > 0)
		ob_host_set_failure(h, "%s; %u simulators could not be ended", h->rebirth.loss.text, h->living);
	return !h->failed;
}

// What dies at once need not be tried a thousand times.
static void rest(const ob_host *h)
{
	for (int i = 0; i < 10 && h->rebirth.losses > MOST_LOSSES && !h->interrupted; i++)
		nanosleep(&(struct timespec){ .tv_nsec = 100000000 }, NULL);
}

// What the dead have used counts on.
static void close_accounts(ob_host *h)
{
	ob_restart_state *r = &h->rebirth;
	r->switches += ob_host_count_switches(h);
	r->cpu = ob_host_read_cpu(h);
	for (uint32_t w = 0; w < h->workers; w++)
		ob_worker_set_cpu(h->u, w, 0);
}

bool ob_restart(ob_host *h)
{
	ob_restart_state *r = &h->rebirth;
	ob_error e;
	unsigned long long step = ob_checkpoint_step(r->checkpoint);
	if (!r->current) {
		ob_host_set_failure(h, "%s; objects had come or gone since the universe was last kept", r->loss.text);
		return false;
	}
	if (++r->losses > MOST_LOSSES && ob_clock_wall() - r->got_on_at > most_trying) {
		ob_host_set_failure(h, "%s; that was loss %u since step %llu", r->loss.text, r->losses, step);
		return false;
	}
	close_accounts(h);
	if (!end_all(h))
		return false;
	ob_log_warn("%s; all simulators begin again after step %llu", r->loss.text, step);
	r->deaths++;
	rest(h);
	ob_checkpoint_put_back(r->checkpoint, h->u);
	r->lost = false;
	h->living = h->workers;
	if (!h->spawn->restart(h->crew)) {
		ob_host_set_failure(h, "%s; the keeper process has ended", r->loss.text);
		return false;
	}
	if (ob_host_wait_for_workers(h, &e))
		return true;
	if (!r->lost && !h->interrupted)
		ob_host_set_failure(h, "%s", e.text);
	return false;
}

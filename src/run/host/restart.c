#include "host/restart.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/allocate.h"
#include "base/clock.h"
#include "base/log.h"
#include "free/free.h"
#include "host/accounting.h"
#include "host/host_state.h"
#include "step/sim.h"
#include "table/free.h"

enum { QUICK_ATTEMPTS = 3 }; // without progress are made at once
static const double faults_timeout = 10; // s, for further attempts after the first fault
static const double checkpoint_interval = .25; // s, between checkpoints
static const double checkpoint_share = .05; // share of the time that checkpoints may take
static const double least_start_patience = 5; // s
static const double kill_timeout = 10; // s to wait at least until workers have ended
static const double interrupted_kill_timeout = .05; // s, same after Ctrl-C

void ob_restart_prepare(ob_host *h)
{
	ob_restart_state *r = &h->restart;
	const bool possible = h->spawn->own_memory || ob_on_death_freezes_failed(h->on_death);
	if (possible && h->on_death != OB_ON_DEATH_ABORT && !ob_universe_settings(h->u)->monolith)
		r->checkpoint = ob_checkpoint_create();
	if (h->limit.deaths)
		r->when = calloc(h->limit.deaths, sizeof *r->when);
	r->progress_at = ob_clock_wall();
}

void ob_restart_finish(ob_host *h)
{
	ob_checkpoint_destroy(h->restart.checkpoint);
	free(h->restart.stalled);
	free(h->restart.when);
	free(h->restart.freeze);
}

// Next step with a checkpoint. If simulators die again and again, it lies half as far ahead as their last progress. So
// the run advances, however soon they die.
uint64_t ob_restart_next_step(const ob_host *h)
{
	const ob_restart_state *r = &h->restart;
	const ob_journal_place here = ob_journal_here(h->u);
	uint64_t next = r->checkpoint && r->attempts > 0 ? ob_checkpoint_step(r->checkpoint) + r->half_way : UINT64_MAX;
	for (uint32_t i = 0; i < r->freezes; i++)
		if (r->freeze[i].at.step < next && !ob_journal_is_after_scripts(r->freeze[i].at, here))
			next = r->freeze[i].at.step;
	return next;
}

bool ob_restart_is_due_after_scripts(const ob_host *h)
{
	const ob_journal_place here = ob_journal_here(h->u);
	for (uint32_t i = 0; i < h->restart.freezes; i++)
		if (ob_journal_is_after_scripts(h->restart.freeze[i].at, here))
			return true;
	return ob_population_is_due_after_scripts(h->population);
}

bool ob_restart_checkpoint_due(const ob_host *h)
{
	const ob_restart_state *r = &h->restart;
	double now = ob_clock_wall();
	if (!r->checkpoint)
		return false;
	if (ob_population_is_checkpoint_due(h->population) || ob_step_count(h->u) >= ob_restart_next_step(h))
		return true;
	return now - r->taken_at >= fmax(checkpoint_interval, r->cost / checkpoint_share);
}

void ob_restart_checkpoint(ob_host *h, bool frozen)
{
	ob_restart_state *r = &h->restart;
	if (!r->checkpoint || (!frozen && !ob_restart_checkpoint_due(h)))
		return;
	double began = ob_clock_wall();
	bool progress = frozen || ob_step_count(h->u) > ob_checkpoint_step(r->checkpoint);
	r->current = ob_checkpoint_take(r->checkpoint, h->u) && ob_population_keep(h->population);
	r->taken_at = ob_clock_wall();
	r->cost = r->taken_at - began;
	if (progress) {
		r->attempts = r->faults = 0;
		r->progress_at = r->taken_at;
	}
}

// ---- deaths

static ob_death *latest(ob_restart_state *r)
{
	return &r->last[(r->deaths - 1) % OB_DEATHS_KEPT];
}

// Describes the latest death for messages.
static const char *describe(ob_host *h, ob_error *text)
{
	pthread_mutex_lock(&h->failure_lock);
	ob_death_print(latest(&h->restart), text->text, sizeof text->text);
	pthread_mutex_unlock(&h->failure_lock);
	return text->text;
}

// True if the newest death exceeds the limit. An object that is frozen because it cannot be solved has killed nothing.
static bool is_over_limit(ob_host *h)
{
	ob_restart_state *r = &h->restart;
	if (!r->when || latest(r)->cause == OB_DEATH_FAILURE)
		return false;
	double *oldest = &r->when[r->limited++ % h->limit.deaths], now = ob_clock_wall(), before = *oldest;
	*oldest = now;
	return r->limited > h->limit.deaths && now - before <= h->limit.seconds;
}

void ob_restart_request(ob_host *h, const ob_death *d)
{
	ob_restart_state *r = &h->restart;
	const bool hangs = d->cause == OB_DEATH_STALL && !h->spawn->own_memory; // a thread cannot be killed
	pthread_mutex_lock(&h->failure_lock);
	const bool first = !r->requested && !h->failed;
	if (first) {
		r->deaths++;
		*latest(r) = *d;
		latest(r)->when = ob_clock_ns();
		r->requested = r->current && !hangs;
		ob_error text;
		ob_death_print(d, text.text, sizeof text.text);
		ob_universe_note_death(h->u, text.text);
	}
	pthread_mutex_unlock(&h->failure_lock);
	if (first && !r->requested) {
		ob_error text;
		const bool missed = r->checkpoint && !hangs;
		ob_host_set_failure(h, "%s%s", describe(h, &text),
				    missed ? "; there was no memory for a checkpoint" : "");
	}
	ob_gate_stop(h->u); // the others leave, and the host wakes
}

// Counts a death of a free run. Returns true if there were too many, or no step was completed for long.
static bool is_hopeless(ob_host *h)
{
	ob_restart_state *r = &h->restart;
	const double now = ob_clock_wall();
	if (ob_step_count(h->u) > r->half_way || r->attempts == 0) {
		r->half_way = ob_step_count(h->u);
		r->attempts = 0;
		r->progress_at = now;
	}
	return ++r->attempts > QUICK_ATTEMPTS && now - r->progress_at > fmax(faults_timeout, h->patience);
}

bool ob_restart_stalled(ob_host *h, const ob_death *d)
{
	ob_restart_state *r = &h->restart;
	ob_worker_info info;
	if (!ob_free_settings_of(h->u) || !h->spawn->kill || h->on_death == OB_ON_DEATH_ABORT)
		return false;
	pthread_mutex_lock(&h->failure_lock);
	const bool hopeless = is_hopeless(h);
	r->stalled_step = d->step;
	for (uint32_t w = 0; w < h->workers && !hopeless; w++)
		if (h->blocks[w] && ob_universe_get_worker(h->u, w, &info))
			r->stalled[w] = ob_state_of_thread(info.pid, info.tid);
	pthread_mutex_unlock(&h->failure_lock);
	for (uint32_t w = 0; w < h->workers && !hopeless; w++)
		if (h->blocks[w])
			h->spawn->kill(h->group, w);
	return !hopeless;
}

// Describes the death of a worker that the host has killed because it blocked the run.
static void name_stall(const ob_host *h, ob_death *d)
{
	const ob_restart_state *r = &h->restart;
	const bool own = d->object == d->worker;
	d->cause = OB_DEATH_STALL;
	d->signal = 0;
	d->step = r->stalled_step;
	snprintf(d->text, sizeof d->text,
		 "step %llu was not complete after %g s; waiting for simulator %u (%s%.*s%sprocess %d, %s)",
		 (unsigned long long)d->step, h->patience, d->worker, own ? "object \"" : "", own ? OB_NAME_MAX : 0,
		 d->name, own ? "\", " : "", d->pid, ob_state_word(r->stalled[d->worker]));
}

void ob_restart_worker(ob_host *h, const ob_death *death)
{
	ob_restart_state *r = &h->restart;
	ob_worker_info info;
	ob_error text;
	ob_death d = *death;
	pthread_mutex_lock(&h->failure_lock);
	const bool stalled = r->stalled[d.worker];
	if (stalled)
		name_stall(h, &d);
	r->stalled[d.worker] = 0;
	ob_death_print(&d, text.text, sizeof text.text);
	r->deaths++;
	*latest(r) = d;
	latest(r)->when = ob_clock_ns();
	const bool over = h->on_death == OB_ON_DEATH_ABORT || is_over_limit(h) || (!stalled && is_hopeless(h));
	pthread_mutex_unlock(&h->failure_lock);
	ob_universe_note_death(h->u, text.text);
	if (ob_universe_get_worker(h->u, d.worker, &info))
		r->cpu += info.cpu_ns;
	ob_worker_set_cpu(h->u, d.worker, 0);
	if (over || !h->spawn->revive || !h->spawn->revive(h->group, d.worker)) {
		ob_host_set_failure(h, "%s%s", text.text, over ? "; giving up" : "");
		return;
	}
	h->running_workers++;
	ob_log_warn("%s; it goes on where it had published", text.text);
}

void ob_restart_add_words(ob_host *h, const ob_worker_end *end)
{
	ob_restart_state *r = &h->restart;
	pthread_mutex_lock(&h->failure_lock);
	if (r->deaths > 0 && latest(r)->worker == end->worker && !*latest(r)->words)
		memcpy(latest(r)->words, end->words, sizeof end->words);
	pthread_mutex_unlock(&h->failure_lock);
}

uint32_t ob_host_get_deaths(ob_host *h, ob_death out[OB_DEATHS_KEPT])
{
	const ob_restart_state *r = &h->restart;
	pthread_mutex_lock(&h->failure_lock);
	const uint32_t n = r->deaths < OB_DEATHS_KEPT ? r->deaths : OB_DEATHS_KEPT;
	for (uint32_t i = 0; i < n; i++)
		out[i] = r->last[(r->deaths - n + i) % OB_DEATHS_KEPT];
	pthread_mutex_unlock(&h->failure_lock);
	return n;
}

// ---- freezing

static bool add_freeze(ob_restart_state *r, ob_freeze f)
{
	for (uint32_t i = 0; i < r->freezes; i++)
		if (r->freeze[i].id == f.id && r->freeze[i].generation == f.generation)
			return true;
	if (r->freezes == r->freezes_max) {
		const uint32_t more = 2 * r->freezes_max + 16;
		if (!OB_GROW(r->freeze, more))
			return false;
		r->freezes_max = more;
	}
	r->freeze[r->freezes++] = f;
	return true;
}

// Notes the objects that the latest death freezes, before the checkpoint is put back, and appends their names to text.
// false: none can be frozen, and without that the run would fail again.
static bool plan_freeze(ob_host *h, ob_error *text)
{
	enum { SHOWN = 3 };
	ob_restart_state *r = &h->restart;
	const uint32_t most = ob_universe_ids(h->u);
	uint32_t *ids = malloc((most + 1) * sizeof *ids), n = 0, frozen = 0;
	ob_death *d = latest(r);
	ob_journal_place place = ob_journal_here(h->u);
	place.after_scripts &= ob_gate_phase(h->u) != OB_PHASE_SCRIPTS; // they ran
	const bool alone = ob_universe_settings(h->u)->one_per_object && d->cause != OB_DEATH_FAILURE;
	if (ids && d->object < most)
		n = alone ? 1 : ob_sim_failed_objects(h->u, d->object, ids, most);
	if (alone && n)
		ids[0] = d->object;
	for (uint32_t i = 0; i < n && i < most; i++) {
		ob_passport p;
		if (ids[i] >= most || !ob_universe_get_passport(h->u, ids[i], &p) || p.flags & OB_OBJECT_STATIC ||
		    !add_freeze(r, (ob_freeze){ place, ids[i], p.generation }))
			continue;
		size_t at = strlen(text->text);
		if (frozen++ < SHOWN)
			snprintf(text->text + at, sizeof text->text - at, "%s object %u%s%.*s%s",
				 frozen > 1 ? "," : "; frozen:", ids[i], *p.name ? " (" : "", OB_NAME_MAX, p.name,
				 *p.name ? ")" : "");
	}
	size_t at = strlen(text->text);
	if (frozen > SHOWN)
		snprintf(text->text + at, sizeof text->text - at, " and %u more", frozen - SHOWN);
	free(ids);
	pthread_mutex_lock(&h->failure_lock);
	d->frozen = frozen;
	pthread_mutex_unlock(&h->failure_lock);
	return frozen > 0 || d->cause != OB_DEATH_FAILURE;
}

bool ob_restart_replay(ob_host *h, const ob_logged_requests *l)
{
	for (uint32_t i = 0; i < l->freezes; i++)
		if (l->freeze[i].id >= ob_universe_capacity(h->u) || !add_freeze(&h->restart, l->freeze[i]))
			return false;
	return true;
}

bool ob_restart_freeze(ob_host *h)
{
	ob_restart_state *r = &h->restart;
	const ob_journal_place here = ob_journal_here(h->u);
	uint32_t left = 0, frozen = 0;
	for (uint32_t i = 0; i < r->freezes; i++) {
		const ob_freeze f = r->freeze[i];
		if (f.at.step > here.step || ob_journal_is_after_scripts(f.at, here))
			r->freeze[left++] = f;
		else if (ob_passport_of(h->u, f.id)->generation == f.generation && ob_sim_freeze(h->u, f.id)) {
			ob_script_stop(h->u, f.id);
			ob_request_log_freeze(h->log, &f);
			frozen++;
		}
	}
	r->freezes = left;
	r->frozen += frozen;
	if (frozen)
		ob_universe_note_frozen(h->u, frozen);
	return frozen > 0;
}

// ---- restart

// The kernel's word on the first worker that is still there: "process 42, waits for a disk"; "" if none is.
static const char *describe_left(const ob_host *h, char *text, size_t size)
{
	ob_worker_info w;
	*text = 0;
	for (uint32_t i = 0; i < h->workers && !*text; i++)
		if (ob_universe_get_worker(h->u, i, &w) && w.pid && ob_state_of_thread(w.pid, w.tid))
			snprintf(text, size, ", one of them process %d, %s", (int)w.pid,
				 ob_state_word(ob_state_of_thread(w.pid, w.tid)));
	return text;
}

static void fail_to_end_workers(ob_host *h, double waited)
{
	ob_error text;
	char left[160];
	const pid_t server = ob_fork_server_pid(h->fork_server);
	if (h->spawn->own_memory)
		ob_host_set_failure(h,
				    "%s; the fork server (process %d, %s) has not killed %u simulators%s within %g s",
				    describe(h, &text), (int)server, ob_state_word(ob_state_of_thread(server, server)),
				    h->running_workers, describe_left(h, left, sizeof left), waited);
	else
		ob_host_set_failure(h, "%s; %u simulators' threads have not left within %g s", describe(h, &text),
				    h->running_workers, waited);
}

// Keeps the resource use of dead workers, for the sums of the run.
static void save_accounts(ob_host *h)
{
	ob_restart_state *r = &h->restart;
	r->switches += ob_host_count_switches(h);
	r->cpu = ob_host_read_cpu(h);
	for (uint32_t w = 0; w < h->workers; w++)
		ob_worker_set_cpu(h->u, w, 0);
}

static bool end_all_workers(ob_host *h)
{
	save_accounts(h);
	// processes that were killed end, however busy the machine is; threads may hang for good
	const double most = h->spawn->own_memory ? fmax(kill_timeout, h->patience) : kill_timeout;
	ob_hang_clock clock = ob_hang_clock_start();
	h->spawn->end(h->group);
	while (h->running_workers > 0 && !h->failed &&
	       ob_hang_clock_tick(&clock) < (h->interrupted ? interrupted_kill_timeout : most))
		nanosleep(&(struct timespec){ .tv_nsec = 100000 }, NULL);
	if (h->running_workers > 0 && !h->interrupted)
		fail_to_end_workers(h, most);
	return h->running_workers == 0 && !h->failed;
}

// Slows restarts of simulators that die at once: to about one a second, or ten if only others kill them.
static void back_off(const ob_host *h)
{
	const int tenths = h->restart.faults > QUICK_ATTEMPTS ? 10 : h->restart.attempts > QUICK_ATTEMPTS ? 1 : 0;
	for (int i = 0; i < tenths && !h->interrupted; i++)
		nanosleep(&(struct timespec){ .tv_nsec = 100000000 }, NULL);
}

// Number of kept deaths of the latest death's worker.
static uint32_t count_alike(const ob_restart_state *r)
{
	uint32_t n = 0;
	for (uint32_t i = 0; i < OB_DEATHS_KEPT && i < r->deaths; i++)
		n += r->last[i].worker == r->last[(r->deaths - 1) % OB_DEATHS_KEPT].worker;
	return n;
}

// Counts the latest death as an attempt without progress. Returns true if there were too many. A simulator that fails
// by itself does so again soon. Only others send SIGKILL: an operator, or the kernel for want of memory. Then a loaded
// machine may get no step done between two of them, and has the patience that a step has.
static bool gets_nowhere(ob_host *h)
{
	ob_restart_state *r = &h->restart;
	const double now = ob_clock_wall();
	const bool killed = latest(r)->cause == OB_DEATH_SIGNAL && latest(r)->signal == SIGKILL;
	r->attempts++;
	if (!killed && r->faults++ == 0)
		r->fault_at = now;
	if (killed)
		return r->attempts > QUICK_ATTEMPTS && now - r->progress_at > fmax(faults_timeout, h->patience);
	return r->faults > QUICK_ATTEMPTS && now - r->fault_at > faults_timeout;
}

static bool give_up(ob_host *h)
{
	ob_restart_state *r = &h->restart;
	ob_error text;
	const uint32_t kept = r->deaths < OB_DEATHS_KEPT ? r->deaths : OB_DEATHS_KEPT;
	if (is_over_limit(h))
		ob_host_set_failure(h,
				    "%s; giving up: simulators died more than %u times within %g s (--set restarts), "
				    "%u of the last %u times this one",
				    describe(h, &text), h->limit.deaths, h->limit.seconds, count_alike(r), kept);
	else if (gets_nowhere(h))
		ob_host_set_failure(
			h,
			"%s; giving up: simulators failed %u times since the checkpoint of step %llu, %u of the "
			"last %u times this one",
			describe(h, &text), r->attempts, (unsigned long long)ob_checkpoint_step(r->checkpoint),
			count_alike(r), kept);
	return h->failed;
}

// Fails the start because of a worker that does not get ready. It counts as stalled: all are started again where
// possible.
static bool fail_start(ob_host *h, uint32_t worker, double patience, ob_error *e)
{
	pid_t server = ob_fork_server_pid(h->fork_server);
	ob_death d = {
		.cause = OB_DEATH_STALL, .worker = worker, .step = ob_step_count(h->u) + 1, .object = OB_NO_OBJECT
	};
	snprintf(d.text, sizeof d.text,
		 "simulator %u of %u was not ready after %g s; the fork server is process %d, %s", worker + 1,
		 h->workers, patience, (int)server, ob_state_word(ob_state_of_thread(server, server)));
	ob_restart_request(h, &d);
	return ob_fail(e, "%s", h->failed ? h->failure.text : d.text);
}

bool ob_host_wait_for_workers(ob_host *h, ob_error *e)
{
	const double patience = fmax(h->patience, least_start_patience);
	ob_hang_clock clock = ob_hang_clock_start();
	ob_worker_info info;
	for (uint32_t w = 0; w < h->workers;) {
		if (h->interrupted)
			return ob_fail(e, "interrupted");
		if (h->failed || h->restart.requested)
			return ob_fail(e, "%s", h->failed ? h->failure.text : "a simulator has died");
		if (!ob_worker_is_here(h->u, w) || (ob_universe_get_worker(h->u, w, &info) && info.pid != 0)) {
			w++;
			clock = ob_hang_clock_start();
			continue;
		}
		if (ob_hang_clock_tick(&clock) > patience)
			return fail_start(h, w, patience, e);
		nanosleep(&(struct timespec){ .tv_nsec = 100000 }, NULL);
	}
	return true;
}

// Starts all workers again. why: for the error. false: they do not start, or one has died, which is a request again.
static bool start_workers(ob_host *h, const char *why)
{
	ob_error e;
	h->restart.requested = false;
	if (h->interrupted)
		return false;
	h->running_workers = h->spawn->pass ? 0 : h->workers;
	if (!h->spawn->restart(h->group, &e)) {
		ob_host_set_failure(h, "%s; %s", why, e.text);
		return false;
	}
	if (ob_host_wait_for_workers(h, &e))
		return true;
	if (!h->restart.requested && !h->interrupted)
		ob_host_set_failure(h, "%s", e.text);
	return false;
}

bool ob_restart(ob_host *h)
{
	ob_restart_state *r = &h->restart;
	ob_error text;
	if (give_up(h))
		return false;
	const uint64_t step = ob_checkpoint_step(r->checkpoint);
	r->half_way = ob_step_count(h->u) > step + 1 ? (ob_step_count(h->u) - step) / 2 : 1;
	if (!end_all_workers(h))
		return false;
	describe(h, &text);
	const bool freezes = latest(r)->cause == OB_DEATH_FAILURE ? ob_on_death_freezes_failed(h->on_death)
								  : h->on_death == OB_ON_DEATH_FREEZE;
	if (freezes && !plan_freeze(h, &text)) {
		ob_host_set_failure(h, "%s", text.text);
		return false;
	}
	ob_log_warn("%s; restarting all simulators from the checkpoint of step %llu", text.text,
		    (unsigned long long)step);
	back_off(h);
	const uint64_t count = ob_step_count(h->u), // a simulator may have overwritten it
		reached = count < h->interval.most ? count : h->interval.most;
	// a step that was too much is complete before newcomers come: else each attempt would find more of them
	const bool failed = latest(r)->cause == OB_DEATH_FAILURE;
	ob_checkpoint_put_back(r->checkpoint, h->u);
	ob_checkpoint_forget_workers(h->u);
	ob_population_put_back(h->population, reached + failed);
	return start_workers(h, text.text);
}

static bool end_for_snapshot(ob_host *h)
{
	h->restart.requested = true; // workers that end are expected to
	ob_gate_stop(h->u);
	return end_all_workers(h);
}

bool ob_restart_restore(ob_host *h, const ob_checkpoint *c, const ob_kept_population *k)
{
	ob_restart_state *r = &h->restart;
	const bool stay = h->spawn->pass; // the caller is in no phase, and keeps nothing that a state decides
	if (!stay && !end_for_snapshot(h))
		return false;
	ob_checkpoint_put_back(c, h->u);
	if (!stay)
		ob_checkpoint_forget_workers(h->u);
	ob_population_restore(h->population, k);
	r->freezes = 0;
	ob_restart_checkpoint(h, true);
	if (stay)
		return !h->failed;
	bool ready = start_workers(h, "restoring a snapshot");
	while (!ready && r->requested && !h->failed)
		ready = ob_restart(h);
	return ready;
}

// ---- snapshots

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

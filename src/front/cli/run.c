// obsim run: one scene, from its file to frames, records and a report.
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <ob/universe.h>

#include "base/clock.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "checkpoint/writer.h"
#include "cli/capture.h"
#include "cli/command.h"
#include "cli/observe.h"
#include "cli/quantity.h"
#include "cli/report.h"
#include "cli/version.h"
#include "experiment/progress.h"
#include "free/free.h"
#include "free/schedule.h"
#include "ranks/ranks.h"
#include "record/record.h"

// ---- progress

// Progress line of a long show_progress on a terminal. Its own thread reads the universe, so that nothing has to pause for it.

typedef struct ob_progress ob_progress;

enum { SILENCE_MS = 2000, PERIOD_MS = 200 };

struct ob_progress {
	const ob_universe *universe;
	uint64_t first, steps; // first: step at the beginning; steps: the whole show_progress's
	double begun; // s
	pthread_t thread;
	pthread_mutex_t lock; // guards over
	pthread_cond_t ended;
	bool over;
};

static void show(const ob_progress *p)
{
	ob_universe_info info;
	ob_universe_get_info(p->universe, &info);
	double wall = ob_clock_wall() - p->begun, rate = (double)(info.step - p->first) / wall;
	double left = info.step > p->first ? (double)(p->steps - info.step) / rate : NAN;
	char what[64];
	snprintf(what, sizeof what, "%.0f steps/s, %.2f s simulated", rate, info.time);
	ob_progress_show(&(ob_progress_view){ 0 }, (double)info.step, (double)p->steps, left, what);
}

// true when the end came within ms
static bool wait_for_end(ob_progress *p, int ms)
{
	struct timespec until;
	clock_gettime(CLOCK_MONOTONIC, &until);
	until.tv_sec += ms / 1000;
	until.tv_nsec += ms % 1000 * 1000000L;
	if (until.tv_nsec >= 1000000000L) {
		until.tv_sec++;
		until.tv_nsec -= 1000000000L;
	}
	pthread_mutex_lock(&p->lock);
	int late = 0;
	while (!p->over && late == 0)
		late = pthread_cond_timedwait(&p->ended, &p->lock, &until);
	bool over = p->over;
	pthread_mutex_unlock(&p->lock);
	return over;
}

static void *show_progress(void *context)
{
	ob_progress *p = context;
	if (wait_for_end(p, SILENCE_MS))
		return NULL;
	do
		show(p);
	while (!wait_for_end(p, PERIOD_MS));
	fputs("\r\033[K", stderr);
	return NULL;
}

// NULL if standard error is no terminal. Nothing is shown in the first two seconds.
// u must live until progress_end. steps: number of the whole show_progress.
static ob_progress *progress_begin(const ob_universe *u, uint64_t steps)
{
	ob_progress *p = isatty(STDERR_FILENO) ? calloc(1, sizeof *p) : NULL;
	if (!p)
		return NULL;
	p->universe = u;
	ob_universe_info info;
	ob_universe_get_info(u, &info);
	p->first = info.step;
	p->steps = steps;
	p->begun = ob_clock_wall();
	pthread_mutex_init(&p->lock, NULL);
	pthread_condattr_t monotonic;
	pthread_condattr_init(&monotonic);
	pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
	pthread_cond_init(&p->ended, &monotonic);
	pthread_condattr_destroy(&monotonic);

	// leaves signals to the main thread, which ends the show_progress
	sigset_t before;
	ob_interrupt_leave_to_main(&before);
	int failed = pthread_create(&p->thread, NULL, show_progress, p);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	if (failed) {
		pthread_cond_destroy(&p->ended);
		pthread_mutex_destroy(&p->lock);
		free(p);
		return NULL;
	}
	return p;
}

// removes the line; NULL is allowed
static void progress_end(ob_progress *p)
{
	if (!p)
		return;
	pthread_mutex_lock(&p->lock);
	p->over = true;
	pthread_cond_signal(&p->ended);
	pthread_mutex_unlock(&p->lock);
	pthread_join(p->thread, NULL);
	pthread_cond_destroy(&p->ended);
	pthread_mutex_destroy(&p->lock);
	free(p);
}

// ---- run

typedef struct run {
	ob_run_request request;
	ob_ranks ranks;
	char own_checkpoint[PATH_MAX]; // set on ranks other than 0
	ob_scene *scene;
	ob_host *host;
	ob_capture *capture; // NULL = no frames
	ob_recorder *recorder; // NULL = none
	ob_pace pace;
	ob_observer observer;
	ob_snapshot now, prev; // prev: the snapshot before now, for frames between both
	ob_saved_run saved; // start of a resumed run; else zeroed
	ob_checkpoint_file saved_file; // storage of saved
	ob_checkpoint_writer *checkpoints; // NULL = none
	uint64_t first; // step at which this process began
	uint64_t steps; // to do, from the start of the run
	uint64_t every, kept; // every: steps between checkpoints; kept: step of the last one; UINT64_MAX = none yet
	uint64_t frames;
	bool whole; // it came to its end
	bool misjudged; // a function of the scene's expectations failed
	double begun; // s
	double own_cpu, drawing_cpu; // CPU time of this thread (s): when stepping began; while it drew
	ob_timeline_sums trace;
	ob_checkpoint_sums checkpoint_sums;
} run;

static uint64_t earlier(uint64_t a, uint64_t b)
{
	return a < b ? a : b;
}

static uint64_t next_checkpoint(const run *r)
{
	return earlier((r->now.step / r->every + 1) * r->every, r->steps);
}

// Next step boundary that an output needs; UINT64_MAX when the run is done.
static uint64_t next_boundary(const run *r)
{
	uint64_t now = r->now.step, next = r->steps;
	if (now >= r->steps)
		return UINT64_MAX;
	if (r->request.asked.measure == OB_MEASURE_STEPS)
		return now + 1;
	if (r->recorder)
		next = earlier(next, (now / r->scene->record_every + 1) * r->scene->record_every);
	if (r->checkpoints)
		next = earlier(next, next_checkpoint(r));
	if (r->capture)
		next = earlier(next, ob_capture_need(r->capture, now));
	return next;
}

// Lets the scene look at the newest snapshot, and at the last one once more. Each step must be there, from the start.
static bool look(run *r, ob_error *e)
{
	ob_expected *x = r->scene->expected;
	const ob_run_settings *settings = &r->request.run;
	if (!x || r->request.asked.measure != OB_MEASURE_STEPS || r->first > 0 || r->ranks.rank > 0)
		return true;
	r->misjudged = !ob_expected_look(x, &r->now, settings, e) ||
		       (r->now.step >= r->steps && !ob_expected_end(x, &r->now, settings, e));
	return !r->misjudged;
}

// Uses the newest snapshot while the universe steps on.
static bool use_snapshot(run *r, ob_error *e)
{
	const ob_snapshot *prev = r->now.step > r->first ? &r->prev : NULL;
	bool ends = r->now.step == 0 || r->now.step >= r->steps;
	uint64_t begin = ob_clock_ns();
	if (r->request.asked.measure == OB_MEASURE_STEPS || ends) {
		if (!ob_observer_measure(&r->observer, &r->now, r->host, e))
			return false;
		if (!look(r, e))
			return false;
		ob_host_trace(r->host, OB_TRACE_MEASURE, begin, 0);
	}
	begin = ob_clock_ns();
	if (r->recorder && r->now.step % r->scene->record_every == 0) {
		if (!ob_recorder_append(r->recorder, &r->now, e))
			return false;
		ob_host_trace(r->host, OB_TRACE_RECORD, begin, 0);
	}
	if (!r->capture)
		return true;
	double before = ob_clock_thread_cpu();
	bool shown = ob_capture_show(r->capture, prev, &r->now, e);
	r->drawing_cpu += ob_clock_thread_cpu() - before;
	return shown;
}

static bool take_snapshot(run *r, ob_error *e)
{
	if (r->capture) {
		ob_snapshot older = r->prev;
		r->prev = r->now;
		r->now = older;
	}
	const ob_frames_request *f = &r->request.frames;
	const unsigned with = (f->contacts ? OB_SNAPSHOT_CONTACTS : 0) | (f->reads ? OB_SNAPSHOT_BOUNDS : 0);
	uint64_t begin = ob_clock_ns();
	bool taken = ob_snapshot_take(&r->now, ob_host_universe(r->host), with, e);
	if (taken && r->recorder && r->now.step % r->scene->record_every == 0)
		taken = ob_recorder_sense(r->recorder, ob_host_universe(r->host), e);
	ob_host_trace(r->host, OB_TRACE_SNAPSHOT, begin, 0);
	return taken;
}

static bool measures_all(const run *r)
{
	return r->request.asked.measure == OB_MEASURE_STEPS && (!r->request.resume || r->saved.figures.each_step);
}

// Writes a checkpoint of the newest snapshot's step, where the universe stands.
static void keep_checkpoint(run *r)
{
	const ob_run_request *q = &r->request;
	ob_error e;
	ob_saved_run now = {
		.scene = q->scene,
		.text = r->scene->text,
		.text_size = r->scene->text_size,
		.options = q->scene_options,
		.duration = q->duration,
		.settings = q->run,
	};
	now.settings.timed = now.settings.freezes = now.settings.budget = now.settings.verify = 0;
	now.settings.fault = (ob_fault_plan){ 0 };
	ob_observer_save(&r->observer, &now.figures);
	now.figures.each_step = measures_all(r);
	if (ob_saved_run_make(&now, ob_checkpoint_writer_file(r->checkpoints), r->host, ob_version_words, &e))
		ob_checkpoint_writer_write(r->checkpoints, r->now.time);
	else
		ob_log_warn("--checkpoint %s: no checkpoint of %g s: %s", q->checkpoint, r->now.time, e.text);
	r->kept = r->now.step;
}

// True if a checkpoint is due. Each of several ranks writes one from its first step on, for any may survive the others.
static bool is_checkpoint_due(const run *r)
{
	return r->checkpoints && r->now.step != r->kept && r->now.step % r->every == 0 &&
	       (r->now.step > r->first || r->ranks.ranks > 1);
}

// Returns how far the clock lets the run go towards the next boundary
static uint64_t keep_pace(run *r, uint64_t next)
{
	uint64_t due = next;
	if (isinf(r->request.pace) || r->request.is_free) // free simulators follow the clock themselves
		return next;
	do
		due = ob_pace_wait(&r->pace, r->now.step, r->request.run.step_length, UINT64_MAX, .05);
	while (due <= r->now.step && !ob_host_interrupted(r->host));
	return earlier(due, next);
}

// Stepping and measuring overlap: the snapshot of one boundary is used while the universe runs to the next.
static bool step_through(run *r, ob_error *e)
{
	r->own_cpu = ob_clock_thread_cpu();
	if (!take_snapshot(r, e))
		return false;
	for (;;) {
		uint64_t next = next_boundary(r);
		if (is_checkpoint_due(r) && next != UINT64_MAX)
			keep_checkpoint(r);
		if (r->checkpoints)
			ob_host_want_contacts(r->host, next_checkpoint(r));
		if (next != UINT64_MAX)
			ob_host_go(r->host, keep_pace(r, next));
		if (!use_snapshot(r, e))
			return false;
		if (next == UINT64_MAX)
			return true;
		if (!ob_host_wait(r->host, e)) {
			// Ctrl-C leaves it at a boundary, which the report uses; several ranks stop at different ones
			if (ob_host_interrupted(r->host) && r->ranks.ranks < 2)
				take_snapshot(r, NULL);
			return false;
		}
		if (!take_snapshot(r, e))
			return false;
	}
}

// Opens all outputs of the run. After the host's start, which forks.
static bool open_outputs(run *r, ob_error *e)
{
	const ob_run_request *q = &r->request;
	if (q->frames.wanted) { // first: it makes directories
		r->capture = ob_capture_open(&q->frames, r->scene, q->duration, q->run.step_length, r->first,
					     ob_host_universe(r->host), e);
		if (!r->capture)
			return false;
		ob_capture_trace(r->capture, r->host);
	}
	if (!ob_observer_open(&r->observer, r->scene, q->series, e))
		return false;
	if (q->resume)
		ob_observer_resume(&r->observer, &r->saved.figures);
	if (q->checkpoint && !(r->checkpoints = ob_checkpoint_writer_create(q->checkpoint, &q->fault)))
		return ob_fail(e, "no memory for checkpoints");
	if (q->record && !(r->recorder = ob_request_record(q, r->scene, ob_host_universe(r->host), e)))
		return false;
	return true;
}

// Closes all, even after failures; e holds the first failure.
static bool close_outputs(run *r, ob_error *e)
{
	bool fine = true;
	r->frames = r->capture ? ob_capture_frames(r->capture) : 0;
	fine &= ob_capture_close(r->capture, e);
	if (r->recorder)
		fine &= ob_recorder_close(r->recorder, fine ? e : NULL);
	fine &= ob_observer_close(&r->observer, fine ? e : NULL);
	fine &= ob_host_end_trace(r->host, &r->trace, fine ? e : NULL);
	fine &= ob_checkpoint_writer_close(r->checkpoints, &r->checkpoint_sums, fine ? e : NULL);
	r->capture = NULL;
	r->recorder = NULL;
	r->checkpoints = NULL;
	return fine;
}

static void count_objects(const ob_snapshot *s, ob_report *p)
{
	for (uint32_t i = 0; i < s->count; i++) {
		bool present = s->passport[i].flags & OB_OBJECT_PRESENT;
		p->objects += present;
		p->bodies += present && !(s->passport[i].flags & OB_OBJECT_PRESCRIBED);
	}
}

// Steps times bodies since a time (s); counts temporary bodies only while they exist. whole: of the seconds begun, as errors
// of motion are bounded by seconds.
static double body_steps(const run *r, double since, bool whole)
{
	double sum = 0;
	for (uint32_t i = 0; i < r->scene->objects; i++) {
		const ob_object_def *d = &r->scene->object[i];
		double begin = fmax(d->born, since), end = fmin(d->dies, r->now.time);
		if (whole)
			begin = floor(begin + 1e-9), end = ceil(end - 1e-9);
		if (!(d->passport.flags & OB_OBJECT_PRESCRIBED) && end > begin)
			sum += (end - begin) / r->request.run.step_length;
	}
	return sum;
}

// Simulated time (s) when this process began
static double first_time(const run *r)
{
	return (double)r->first * r->request.run.step_length;
}

static void name_report(const run *r, const char *outcome, ob_report *p)
{
	const ob_run_request *q = &r->request;
	ob_universe_info info;
	ob_universe_get_info(ob_host_universe(r->host), &info);
	*p = (ob_report){
		.workers = info.workers,
		.steps = r->now.step,
		.simulated_s = r->now.time,
		.resumed_s = q->resume ? first_time(r) : NAN,
		.step = q->run.step_length,
		.substeps = q->run.tolerance > 0 ? 0 : q->run.substeps,
		.iterations = q->run.iterations,
		.tolerance = q->run.tolerance > 0 ? q->run.tolerance : NAN,
		.lag = q->run.lag,
		.load = q->run.load,
		.seed = q->scene_options.has_seed ? q->scene_options.seed : r->scene->seed,
		.frames = r->frames,
		.frame_rate = q->frames.wanted && !q->frames.stills ? q->frames.fps : NAN,
		.total_s = ob_clock_wall() - r->begun,
		.trace_events = r->trace.events,
		.trace_lost = r->trace.lost,
		.checkpoints = r->checkpoint_sums.written,
		.checkpoint_bytes = r->checkpoint_sums.bytes,
		.checkpoint_s = q->checkpoint ? r->checkpoint_sums.held_s : NAN,
	};
	p->expected = r->scene->expected;
	snprintf(p->scene, sizeof p->scene, "%s", q->scene);
	snprintf(p->outcome, sizeof p->outcome, "%s", outcome);
	snprintf(p->arch, sizeof p->arch, "%.15s", ob_setting_print(&q->run, OB_SETTING_ARCHITECTURE).text);
	snprintf(p->isolation, sizeof p->isolation, "%s", info.isolation);
	snprintf(p->solver, sizeof p->solver, "%.15s", ob_setting_print(&q->run, OB_SETTING_SOLVER).text);
	snprintf(p->integrator, sizeof p->integrator, "%.15s", ob_setting_print(&q->run, OB_SETTING_INTEGRATOR).text);
	snprintf(p->narrow, sizeof p->narrow, "%.15s", ob_setting_print(&q->run, OB_SETTING_NARROW_PHASE).text);
	snprintf(p->commit, sizeof p->commit, "%s", ob_version_commit);
	p->fps = r->frames > 0 ? (double)r->frames / p->total_s : NAN;
}

static void report_time(const run *r, const ob_host_times *times, ob_report *p)
{
	ob_counters counters;
	bool timed = ob_universe_settings(ob_host_universe(r->host))->timed;
	ob_universe_count(ob_host_universe(r->host), &counters);
	ob_report_count(p, &counters, timed);
	uint64_t faults[OB_FAULT_KINDS];
	const uint32_t overwritten = ob_universe_faults(ob_host_universe(r->host), faults);
	faults[OB_FAULT_NOSPACE] += r->checkpoint_sums.faults;
	ob_report_faults(p, faults, overwritten);
	p->wall_s = times->wall_s;
	p->cpu_s = times->cpu_s;
	p->startup_s = times->startup_s;
	p->step_p50_s = times->step_p50_s;
	p->step_p90_s = times->step_p90_s;
	p->step_p99_s = times->step_p99_s;
	p->step_max_s = times->step_max_s;
	p->elapsed_s = times->elapsed_s;
	// workers wait at the gate while the host examines the state
	p->idle_s = timed ? (times->elapsed_s - times->wall_s) * (double)p->workers : NAN;
	p->gate_s = timed ? times->gate_s - p->idle_s : NAN;
	p->critical_s = timed ? times->critical_s : NAN;
	p->critical_16_s = timed ? times->simulated_s : NAN;
	// the renderer and the encoders have threads of their own
	double beside = ob_clock_thread_cpu() - r->own_cpu - r->drawing_cpu;
	p->renderer_cpu_s = r->frames > 0 ? fmax(0, times->host_cpu_s - beside) : 0;
	p->host_cpu_s = times->host_cpu_s - p->renderer_cpu_s;
}

static bool is_interrupted(void *host)
{
	return ob_host_interrupted(host);
}

static void report_separation(const run *r, ob_report *p)
{
	ob_snapshot s = { 0 };
	ob_separation apart = { NAN, NAN, 0 };
	ob_universe_info info;
	ob_universe_get_info(ob_host_universe(r->host), &info);
	const bool whole = r->ranks.ranks < 2 || r->now.step == info.step; // else others' data is missing
	if (whole && ob_snapshot_take(&s, ob_host_universe(r->host), OB_SNAPSHOT_CONTACTS, NULL))
		ob_measure_separation(&s, &apart, is_interrupted, r->host);
	p->separation_max_m = apart.max_m;
	p->separation_mean_m = apart.mean_m;
	ob_snapshot_finish(&s);
}

// Settings and counters of a free run.
static void report_free(const run *r, ob_report *p)
{
	const ob_free_settings *free = &r->request.free;
	p->update_rate = p->max_lag = p->jitter = p->delay = p->updates = p->waits = p->wait_s = NAN;
	p->lag_mean_s = p->lag_max_s = NAN;
	snprintf(p->sync, sizeof p->sync, "%s", r->request.is_free ? "free" : "lockstep");
	if (!r->request.is_free)
		return;
	ob_free_sums sums;
	ob_free_sum(ob_host_universe(r->host), &sums);
	const bool grouped = free->coupling == OB_COUPLING_GROUP;
	snprintf(p->coupling, sizeof p->coupling, "%s", grouped ? "group" : "own");
	p->update_rate = free->update_rate;
	p->updates = (double)sums.counts.updates;
	p->waits = (double)sums.counts.waits;
	if (grouped)
		return;
	p->max_lag = isinf(free->max_lag) ? NAN : free->max_lag;
	p->jitter = free->jitter;
	p->delay = free->delay;
	p->wait_s = 1e-9 * (double)sums.counts.wait_ns;
	p->lag_mean_s = 1e-9 * (double)sums.counts.lag_ns / (double)(sums.counts.readings + !sums.counts.readings);
	p->lag_max_s = 1e-9 * (double)sums.counts.lag_most_ns;
}

static void make_report(run *r, const char *outcome, ob_report *p)
{
	ob_host_times times;
	ob_host_get_times(r->host, &times);
	ob_observer_measure(&r->observer, &r->now, r->host, NULL);
	name_report(r, outcome, p);
	count_objects(&r->now, p);
	ob_observer_report(&r->observer, measures_all(r), p);
	report_separation(r, p);
	snprintf(p->state_hash, sizeof p->state_hash, "%016" PRIx64, ob_measure_hash(&r->now));
	report_time(r, &times, p);
	p->memory_bytes = times.memory_bytes;
	p->worker_memory_bytes = times.worker_memory_bytes;
	p->switches = times.switches;
	p->deaths = times.deaths;
	p->frozen = times.frozen;
	ob_script_count(ob_host_universe(r->host), &p->scripts_stopped, &p->scripts_warned);
	p->deaths_told = ob_host_get_deaths(r->host, p->death);
	p->script_errors_told = ob_host_get_script_errors(r->host, p->script_error);
	report_free(r, p);
	const double steps = body_steps(r, first_time(r), false);
	const double all = body_steps(r, 0, true);
	p->bounded_share = p->tolerance > 0 && all > 0 ? fmax(0, 1 - (double)p->unbounded_steps / all) : NAN;
	p->body_step_cpu_us = steps > 0 ? 1e6 * times.cpu_s / steps : NAN;
}

static bool write_json(const char *path, const ob_report *p, ob_error *e)
{
	bool out = strcmp(path, "-") == 0;
	FILE *f = out ? stdout : fopen(path, "we");
	if (!f)
		return ob_fail(e, "--json %s: %s", path, strerror(errno));
	ob_report_write_json(p, f);
	bool broken = fflush(f) != 0 || ferror(f);
	if (!out)
		broken |= fclose(f) != 0;
	return broken ? ob_fail(e, "--json %s: %s", path, strerror(errno)) : true;
}

static void warn_of_missed_tolerance(const ob_report *p)
{
	ob_quantity allowed, error;
	ob_log_warn("the tolerance of %s was missed in %" PRIu64 " island step%s; the largest error was %s",
		    ob_quantity_text(&allowed, p->tolerance, "m"), p->islands_over, p->islands_over == 1 ? "" : "s",
		    ob_quantity_text(&error, p->error_reached, "m"));
}

// Warns of a tolerance that is a length, and no small part of the thinnest object.
static void warn_of_coarse_tolerance(const run *r)
{
	enum { COARSE = 10 }; // thickness by tolerance
	const double tolerance = r->request.run.tolerance, thin = ob_scene_thinnest(r->scene);
	ob_quantity allowed, size;
	if (r->ranks.rank == 0 && !(r->request.asked.tolerance_share > 0) && COARSE * tolerance > thin)
		ob_log_warn("the tolerance of %s is coarse for the thinnest object, of %s: --tolerance .1%% follows "
			    "the size",
			    ob_quantity_text(&allowed, tolerance, "m"), ob_quantity_text(&size, thin, "m"));
}

static void warn_of_unbounded_motion(const ob_report *p)
{
	ob_quantity allowed, error;
	ob_quantity_text(&allowed, p->tolerance, "m");
	if (p->unbounded_steps > 0)
		ob_log_warn(
			"motion may be off by more than %s a second for %.3g %% of the time of objects, by up to %s",
			allowed.text, 100 * (1 - p->bounded_share),
			ob_quantity_text(&error, p->deviation_reached, "m"));
	else
		ob_log_warn("verifying found errors of motion above %s a second in %.3g %% of the steps that it solved "
			    "again; the largest was %s",
			    allowed.text, 100 * (1 - p->verified_share),
			    ob_quantity_text(&error, p->verified_second_max_m, "m"));
}

static void explain(const run *r, const ob_report *p, FILE *f)
{
	const ob_universe *u = ob_host_universe(r->host);
	ob_explained x = { &r->request, r->scene, ob_universe_settings(u), { 0 }, body_steps(r, 0, false), p->cpu_s };
	ob_universe_count(u, &x.counters);
	ob_explain_print(&x, f);
}

static bool write_report(const run *r, const ob_report *p, ob_error *e)
{
	const ob_run_request *q = &r->request;
	bool json_out = q->json && strcmp(q->json, "-") == 0,
	     raw_out = q->frames.raw && strcmp(q->frames.raw, "-") == 0;
	FILE *people = json_out || raw_out ? stderr : stdout;
	ob_report_print(p, q->full_report, people);
	if (q->explain && p->steps > 0)
		explain(r, p, people);
	return !q->json || write_json(q->json, p, e);
}

// True if the end gets a checkpoint. After an interrupt, several ranks stop within different steps: the last step that
// all completed counts.
static bool is_end_kept(const run *r, bool done, bool interrupted)
{
	return r->checkpoints && r->kept != r->now.step && (done || (interrupted && r->ranks.ranks < 2));
}

// Prints the command to resume. Each rank prints it, because none can tell which ranks survive.
static void tell_of_checkpoint(const run *r)
{
	if (r->checkpoint_sums.written > 0)
		ob_log_warn("rank %u: the run goes on from %g s with: obsim run --resume %s", r->ranks.rank,
			    (double)r->kept * r->request.run.step_length, r->request.checkpoint);
}

// Carries out the run, from the running host to its report. Returns an ob_exit.
static int carry_out(run *r)
{
	ob_error e = { "" }, e_close, e_report;
	ob_progress *progress = progress_begin(ob_host_universe(r->host), r->steps);
	ob_pace_begin(&r->pace, r->request.pace, false);
	bool ready = open_outputs(r, &e);
	bool done = ready && step_through(r, &e);
	bool interrupted = !done && ob_host_interrupted(r->host);
	if (is_end_kept(r, done, interrupted))
		keep_checkpoint(r);
	bool closed = close_outputs(r, &e_close);
	progress_end(progress);
	ob_pace_end(&r->pace);

	int code = OB_EXIT_OK;
	warn_of_coarse_tolerance(r);
	if (interrupted)
		code = ob_command_fail(OB_EXIT_FAILED, "interrupted: the files hold what was done so far");
	else if (!done && r->misjudged)
		code = ob_command_fail(OB_EXIT_USAGE, e.text);
	else if (!done)
		code = ob_command_fail(ob_host_broke_invariant(r->host) ? OB_EXIT_BROKEN : OB_EXIT_FAILED, e.text);
	r->whole = done && closed;
	// a sink that broke the run reports its error again when it is closed
	if (!closed && (done || interrupted))
		code = ob_command_fail(OB_EXIT_FAILED, e_close.text);
	if (!done && closed && r->ranks.ranks > 1)
		tell_of_checkpoint(r);
	if (!r->observer.started)
		return code;
	ob_report *report = &(ob_report){ 0 };
	make_report(r, done ? "finished" : interrupted ? "interrupted" : "failed", report);
	if (r->ranks.rank == 0 && !write_report(r, report, &e_report))
		code = ob_command_fail(OB_EXIT_FAILED, e_report.text);
	if (ob_report_missed_tolerance(report)) {
		warn_of_missed_tolerance(report);
		code = r->request.strict ? OB_EXIT_FAILED : code;
	} else if (r->request.strict && !ob_report_motion_is_bounded(report)) {
		warn_of_unbounded_motion(report);
		code = OB_EXIT_FAILED;
	}
	const bool wrong = report->scripts_stopped > 0 || ob_report_missed_expectation(report);
	return r->request.strict && wrong && code == OB_EXIT_OK ? OB_EXIT_FAILED : code;
}

// Reads the scene of the run, and merges it with the request. NULL and e on failure.
static ob_scene *read_scene(run *r, const ob_arguments *a, ob_error *e)
{
	ob_run_request *q = &r->request;
	if (!ob_request_read(q, a, e))
		return NULL;
	if (!q->resume) {
		r->scene = ob_scene_load(q->scene, &q->scene_options, e);
		return r->scene && ob_request_resolve(q, r->scene, e) ? r->scene : NULL;
	}
	ob_saved_run *saved = &r->saved;
	r->scene = ob_saved_run_open_with_scene(saved, &r->saved_file, q->resume, e);
	if (!r->scene || !ob_request_resume(q, saved, r->scene, e))
		return NULL;
	if (strcmp(r->saved_file.program, ob_version_words) != 0)
		ob_log_warn("%s was written by obsim %s; this is %s, and may end in other bits", q->resume,
			    r->saved_file.program, ob_version_words);
	r->first = saved->host.universe.step;
	return r->scene;
}

// Sets up a rank of a universe on several machines. Simulators are processes with outboxes, so that they cannot damage
// shared state: most of a rank's data is compared with no other's. The run ends when one dies. Ranks other than 0 write
// only checkpoints: all other output is rank 0's.
static bool share(run *r, ob_ranks ranks, ob_error *e)
{
	ob_run_request *q = &r->request;
	if (q->is_free)
		return ob_fail(e, "--sync free: expected a single rank, for ranks run in lockstep");
	if (q->run.monolith || q->workers == 0)
		return ob_fail(e,
			       "on several ranks a universe has object simulators in a pool: leave --arch monolith and "
			       "--workers objects away");
	if (q->harden >> OB_HARDEN_PRIVILEGES)
		return ob_fail(e, "--harden: several ranks always take outbox,checksum,pages, and no more, as they "
				  "communicate over the network");
	q->isolation = OB_ISOLATION_PROCESS;
	q->harden |= 1 << OB_HARDEN_OUTBOX | 1 << OB_HARDEN_CHECKSUM | 1 << OB_HARDEN_PAGES;
	q->on_death = OB_ON_DEATH_ABORT;
	q->patience = 1e9; // another rank may be slow
	if (ranks.rank == 0)
		return true;
	q->name = NULL; // rank 0 may be on this machine
	q->frames.wanted = q->explain = false;
	q->record = q->json = q->series = q->trace = NULL;
	if (q->checkpoint) { // its own file, for the same reason
		const int n = snprintf(r->own_checkpoint, sizeof r->own_checkpoint, "%s.%u", q->checkpoint, ranks.rank);
		if (n < 0 || (size_t)n >= sizeof r->own_checkpoint)
			return ob_fail(e, "--checkpoint: the name is too long");
		q->checkpoint = r->own_checkpoint;
	}
	q->asked.measure = OB_MEASURE_ENDS;
	q->pace = INFINITY;
	return true;
}

static void prepare(run *r, ob_host_config *config)
{
	const ob_run_request *q = &r->request;
	r->steps = ob_request_steps(q->duration, q->run.step_length);
	r->every = ob_request_steps(q->asked.every, q->run.step_length);
	r->kept = UINT64_MAX;
	*config = ob_request_host(q);
	config->ranks = r->ranks;
	config->saved = q->checkpoint && r->ranks.ranks <= 1; // another rank may never end the step
	config->shares_contacts = q->frames.contacts;
	config->from = q->resume ? &r->saved.host : NULL;
}

static void finish(run *r)
{
	ob_snapshot_finish(&r->now);
	ob_snapshot_finish(&r->prev);
	ob_scene_free(r->scene);
	ob_saved_run_close(&r->saved, &r->saved_file);
}

int ob_command_run(const ob_arguments *a)
{
	if (a->value[OB_OPTION_REPLAY])
		return ob_command_draw_replay(a);
	if (a->value[OB_OPTION_REPLAY_REQUESTS])
		return ob_command_rerun(a);
	run r = { .begun = ob_clock_wall() };
	ob_error e;
	ob_host_config config = { 0 };
	r.ranks = ob_ranks_started();
	if (!read_scene(&r, a, &e) || (r.ranks.ranks > 1 && !share(&r, r.ranks, &e))) {
		finish(&r);
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	}
	prepare(&r, &config);

	signal(SIGPIPE, SIG_IGN); // a reader that leaves is an error of the sink, with a message
	ob_interrupt_watch(); // before there is anything to clean up after Ctrl-C
	const char *schedule = r.request.asked.record_schedule;
	const bool begun =
		!schedule || ob_free_schedule_create(schedule, &r.request.free, r.request.schedule_digest, &e);
	r.host = begun ? ob_host_start(r.scene, &config, &e) : NULL;
	int code = r.host ? carry_out(&r) : ob_command_fail(OB_EXIT_FAILED, e.text);
	ob_host_stop(r.host);
	if (schedule && r.whole && !ob_free_schedule_end(schedule, &e))
		code = ob_command_fail(OB_EXIT_FAILED, e.text);
	ob_interrupt_release();
	finish(&r);
	return code;
}

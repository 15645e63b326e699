// The trials of an experiment, one after the other, each in a process of its own.
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "experiment/experiment.h"
#include "experiment/folder.h"
#include "experiment/process.h"
#include "experiment/progress.h"
#include "experiment/result_line.h"

static const double wall_for_cpu = 4; // a busy machine is not the trial's fault
static const double worth_telling_s = 5; // shorter runs are over before their estimate is read

// ---- schedule

bool ob_trials_add(ob_trials *s, const ob_trial *t)
{
	if (s->count == s->max) {
		size_t max = s->max ? 2 * s->max : 64;
		ob_trial *more = reallocarray(s->trial, max, sizeof *more);
		if (!more)
			return false;
		s->trial = more;
		s->max = max;
	}
	s->trial[s->count++] = *t;
	return true;
}

bool ob_trials_repeat(ob_trials *s, size_t from, uint32_t repeats, ob_order order, bool seeds)
{
	size_t n = s->count - from;
	for (uint32_t r = 1; r < repeats; r++) {
		for (size_t i = 0; i < n; i++) {
			size_t at = order == OB_ORDER_ROTATED               ? (i + r) % n
				    : order == OB_ORDER_TO_AND_FRO && r % 2 ? n - 1 - i
									    : i;
			ob_trial t = s->trial[from + at];
			t.repeat += r;
			t.seed += seeds ? r : 0;
			if (!ob_trials_add(s, &t))
				return false;
		}
	}
	return true;
}

void ob_trials_finish(ob_trials *s)
{
	free(s->trial);
	*s = (ob_trials){ 0 };
}

// ---- the folder

// Results of another program or machine are not mixed with these: their file gets a number.
static bool set_aside(const char *folder, const char *file, ob_error *e)
{
	for (int i = 1;; i++) {
		char name[32];
		snprintf(name, sizeof name, "results-%d.csv", i);
		char *path = ob_folder_path(folder, name);
		bool taken = access(path, F_OK) == 0, fine = taken || rename(file, path) == 0;
		if (!fine)
			ob_fail(e, "%s cannot be renamed: %s", file, strerror(errno));
		else if (!taken)
			fprintf(stderr, "obsim: results of another program or machine are kept in %s\n", path);
		free(path);
		if (!taken)
			return fine;
	}
}

bool ob_experiment_open(const ob_experiment *x, const char *folder, ob_records *r, ob_error *e)
{
	*r = (ob_records){ 0 };
	ob_provenance_machine(r->machine, sizeof r->machine);
	ob_provenance_commit(x->commit, r->commit, sizeof r->commit);
	if (!folder)
		return true;
	if (!ob_folder_make(folder, e))
		return false;
	char *file = ob_folder_path(folder, "results.csv");
	bool same = ob_records_read(r, x, file, NULL);
	for (size_t i = 0; same && i < r->count; i++)
		same = !strcmp(r->record[i].commit, r->commit) && !strcmp(r->record[i].machine, r->machine);
	bool fine = same || set_aside(folder, file, e);
	if (!same)
		ob_records_finish(r);
	free(file);
	return fine;
}

// ---- what is left to do, and how long it takes

// Trials of one case: what is known of the time that they take
typedef struct timing {
	const char *of;
	double took, guessed; // s, of those that have run
	double ahead; // s, as guessed
} timing;

typedef struct session {
	const ob_experiment *experiment;
	const ob_trials *trials;
	ob_records *records;
	FILE *file; // NULL: nothing is kept
	const char *path;
	size_t *timing_of; // [trial]
	timing *timing;
	size_t timings;
	size_t done, all;
	double begun; // of the trial under way, s
	char what[OB_CASE_KEY + OB_CONFIGURATION_KEY + 32];
	ob_progress_view view;
} session;

static double wall_limit(const ob_experiment *x)
{
	return wall_for_cpu * x->limit_s;
}

// A record that came of less time than a trial has now
static bool had_less(const ob_experiment *x, const ob_record *r)
{
	return r->failure == OB_FAILURE_TIME &&
	       (x->limit_s <= 0 || (r->took_cpu_s < x->limit_s && r->took_s < wall_limit(x)));
}

// Does the trial have its record, or is a failure of an earlier repeat with the same seed known?
static bool is_done(const ob_experiment *x, const ob_records *records, const ob_trial *t)
{
	for (size_t i = 0; i < records->count; i++) {
		const ob_record *r = &records->record[i];
		if (r->seed != t->seed || strcmp(r->configuration, t->configuration) || strcmp(r->of, t->of))
			continue;
		if ((r->repeat == t->repeat || r->failure) && !had_less(x, r))
			return true;
	}
	return false;
}

static size_t find_timing(session *s, const char *of)
{
	for (size_t i = s->timings; i > 0; i--) // a case's trials mostly stand together
		if (!strcmp(s->timing[i - 1].of, of))
			return i - 1;
	s->timing[s->timings].of = of;
	return s->timings++;
}

static bool prepare(session *s, ob_error *e)
{
	size_t n = s->trials->count;
	s->timing_of = calloc(n + 1, sizeof *s->timing_of);
	s->timing = calloc(n + 1, sizeof *s->timing);
	if (!s->timing_of || !s->timing)
		return ob_fail(e, "out of memory");
	for (size_t i = 0; i < n; i++) {
		const ob_trial *t = &s->trials->trial[i];
		s->timing_of[i] = find_timing(s, t->of);
		if (is_done(s->experiment, s->records, t))
			continue;
		s->timing[s->timing_of[i]].ahead += t->guess_s;
		s->all++;
	}
	return true;
}

// What remains, by how fast each case was so far; one of which nothing is known goes as all others do.
static double guess_left(const session *s)
{
	timing all = { 0 };
	double left = 0;
	for (size_t i = 0; i < s->timings; i++) {
		all.took += s->timing[i].took;
		all.guessed += s->timing[i].guessed;
	}
	for (size_t i = 0; i < s->timings; i++) {
		const timing *p = s->timing[i].guessed > 0 ? &s->timing[i] : &all;
		left += s->timing[i].ahead * (p->guessed > 0 ? p->took / p->guessed : 1);
	}
	return fmax(left - (ob_clock_wall() - s->begun), 0);
}

static void tick(void *of)
{
	session *s = of;
	ob_progress_show(&s->view, (double)s->done, (double)s->all, guess_left(s), s->what);
}

static void announce(const session *s)
{
	char time[48];
	double left = guess_left(s);
	ob_progress_print_time(time, sizeof time, left);
	if (!s->experiment->quiet && left >= worth_telling_s)
		fprintf(stderr, "obsim: %zu runs, about %s\n", s->all, time);
}

// ---- one trial

typedef struct job {
	const ob_experiment *experiment;
	const ob_trial *trial;
} job;

static bool work(const void *with, void *answer, ob_error *e)
{
	const job *j = with;
	return j->experiment->run(j->trial, answer, e);
}

static ob_record begin_record(const session *s, const ob_trial *t)
{
	ob_record r = { .repeat = t->repeat, .seed = t->seed };
	memcpy(r.of, t->of, sizeof r.of);
	memcpy(r.configuration, t->configuration, sizeof r.configuration);
	memcpy(r.machine, s->records->machine, sizeof r.machine);
	memcpy(r.commit, s->records->commit, sizeof r.commit);
	for (int i = 0; i < OB_METRICS; i++)
		r.metric[i] = NAN;
	return r;
}

// The record of one so coarse that the trial takes at least as long, and that ran out of the time there is. NULL: none
static const ob_record *coarser_out_of_time(const session *s, const ob_trial *t)
{
	const ob_experiment *x = s->experiment;
	for (size_t i = 0; x->is_finer && i < s->records->count; i++) {
		const ob_record *r = &s->records->record[i];
		if (r->failure == OB_FAILURE_TIME && !strcmp(r->of, t->of) && !had_less(x, r) && x->is_finer(t, r))
			return r;
	}
	return NULL;
}

// false and e: it is not the trial that failed.
static bool try(session *s, const ob_trial *t, ob_record *r, ob_error *e)
{
	static const ob_failure failures[] = { [OB_PROCESS_GAVE_UP] = OB_FAILURE_ERROR,
					       [OB_PROCESS_CRASHED] = OB_FAILURE_CRASH,
					       [OB_PROCESS_OUT_OF_TIME] = OB_FAILURE_TIME };
	const ob_experiment *x = s->experiment;
	const ob_record *coarser = coarser_out_of_time(s, t);
	if (coarser) {
		r->failure = coarser->failure;
		memcpy(r->reason, coarser->reason, sizeof r->reason);
		r->took_s = coarser->took_s;
		r->took_cpu_s = coarser->took_cpu_s;
		return true;
	}
	job j = { x, t };
	ob_process p = { .work = work,
			 .with = &j,
			 .size = sizeof *r,
			 .cpu_limit_s = x->limit_s,
			 .wall_limit_s = wall_limit(x),
			 .tick = x->quiet ? NULL : tick,
			 .tick_of = s };
	ob_process_cost cost;
	ob_error why = { "" };
	if (!x->quiet)
		tick(s);
	ob_process_end end = ob_process_run(&p, r, &cost, &why);
	r->took_s = cost.wall_s;
	r->took_cpu_s = cost.cpu_s;
	if (end == OB_PROCESS_INTERRUPTED || end == OB_PROCESS_NOT_STARTED)
		return ob_fail(e, "%s", why.text);
	if (end == OB_PROCESS_ANSWERED) {
		r->failure = *r->reason ? OB_FAILURE_OUTCOME : OB_FAILURE_NONE;
	} else {
		r->failure = failures[end];
		snprintf(r->reason, sizeof r->reason, "%.159s", *why.text ? why.text : "it failed without a word");
	}
	for (char *at = r->reason; (at = strpbrk(at, "\r\n"));)
		*at = ' '; // a record is a line of the file
	return true;
}

// What a trial with less time had left is no longer true.
static void forget(ob_records *records, const ob_trial *t)
{
	size_t kept = 0;
	for (size_t i = 0; i < records->count; i++) {
		const ob_record *r = &records->record[i];
		if (r->seed != t->seed || strcmp(r->configuration, t->configuration) || strcmp(r->of, t->of) ||
		    r->failure != OB_FAILURE_TIME)
			records->record[kept++] = *r;
	}
	records->count = kept;
}

static bool keep(session *s, const ob_trial *t, const ob_record *r, ob_error *e)
{
	forget(s->records, t);
	if (!ob_records_add(s->records, r))
		return ob_fail(e, "no memory for results");
	if (!s->file)
		return true;
	ob_result_line_write(s->file, s->experiment, r);
	return (fflush(s->file) == 0 && !ferror(s->file)) ||
	       ob_fail(e, "%s cannot be written: %s", s->path, strerror(errno));
}

static bool run_trial(session *s, size_t i, ob_error *e)
{
	const ob_trial *t = &s->trials->trial[i];
	if (is_done(s->experiment, s->records, t))
		return true;
	snprintf(s->what, sizeof s->what, "%s, %s", t->of, t->configuration);
	s->begun = ob_clock_wall();
	ob_record r = begin_record(s, t);
	if (!try(s, t, &r, e) || !keep(s, t, &r, e))
		return false;
	timing *p = &s->timing[s->timing_of[i]];
	p->took += ob_clock_wall() - s->begun;
	p->guessed += t->guess_s;
	p->ahead -= t->guess_s;
	s->done++;
	// a failure makes the repeats that follow needless
	for (size_t j = i + 1; r.failure && j < s->trials->count; j++) {
		const ob_trial *later = &s->trials->trial[j];
		if (later->seed != t->seed || strcmp(later->configuration, t->configuration) ||
		    strcmp(later->of, t->of))
			continue;
		s->timing[s->timing_of[j]].ahead -= later->guess_s;
		s->done++;
	}
	return true;
}

static bool run_all(session *s, ob_error *e)
{
	bool fine = true;
	announce(s);
	ob_processes_begin();
	for (size_t i = 0; fine && i < s->trials->count; i++)
		fine = run_trial(s, i, e);
	bool interrupted = ob_processes_interrupted();
	ob_processes_end();
	if (!s->experiment->quiet)
		ob_progress_clear(&s->view);
	if (!fine && interrupted)
		ob_fail(e, "interrupted: %zu of %zu runs are done%s", s->done, s->all,
			s->path ? ", and the same command goes on from there" : "");
	return fine;
}

bool ob_experiment_run(const ob_experiment *x, const ob_trials *trials, ob_records *r, const char *folder, ob_error *e)
{
	session s = { .experiment = x, .trials = trials, .records = r, .begun = ob_clock_wall() };
	char *path = folder ? ob_folder_path(folder, "results.csv") : NULL;
	s.path = path;
	// the file as it is now, without what was dropped; then a line for each trial
	bool fine = prepare(&s, e) && (!path || ob_records_write(r, x, path, e));
	if (fine && path && !(s.file = fopen(path, "ae")))
		fine = ob_fail(e, "%s cannot be written: %s", path, strerror(errno));
	fine = fine && run_all(&s, e);
	if (s.file)
		fclose(s.file);
	if (path && s.file && !ob_records_write(r, x, path, fine ? e : NULL))
		fine = false;
	free(path);
	free(s.timing);
	free(s.timing_of);
	return fine;
}

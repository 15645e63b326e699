// Runs the trials of an experiment, one after the other on each rank, each in a process of its own (process.h).
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/allocate.h"
#include "base/clock.h"
#include "base/hash.h"
#include "experiment/experiment.h"
#include "experiment/folder.h"
#include "experiment/process.h"
#include "experiment/progress.h"
#include "ranks/courier.h"

static const double tick_s = .2;
static const double worth_telling_s = 5; // shorter runs are over before their estimate is read

// ---- schedule

bool ob_trials_add(ob_trials *s, const ob_trial *t)
{
	if (!OB_MAKE_ROOM(s->trial, s->count, s->max))
		return false;
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

// Results of another program or machine are not mixed with these: renames their file with a number.
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
	if (!folder || ob_ranks_started().rank > 0) // the first rank has the records
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

// ---- several ranks: the first has the records and the file, and hands out one trial after the
// other, to itself as well; the others run them.
//
//      rank 0                                        each other (run_as_helper)
//          <-------- JOIN, a digest of its schedule --------
//          --------- RUN trial 17 ------------------------->  in a process of its own
//          <-------- RAN trial 17, its record --------------
//          --------- LEAVE: all is done ------------------->
//
// Ranks wait for the slowest only at the end. A rank that fails sends FAILED instead, or is interrupted, or dies. The
// first rank then ends with an error, and the launcher ends the others; the file has all results received by then.

typedef enum message_kind { JOIN, RUN, RAN, LEAVE, FAILED } message_kind;

typedef struct message {
	message_kind kind;
	uint64_t trial; // its number in the schedule; JOIN: the digest
	ob_record record; // RAN: of the trial; JOIN: machine and commit alone; FAILED: the reason alone
} message;
_Static_assert(sizeof(message) <= OB_COURIER_BYTES, "it fits");

static const double look_s = 1; // between polls while no message comes
static const double grace_s = 60; // after which it leaves by itself

// Digest of a schedule: two ranks with the same one agree on the numbers of trials.
static uint64_t digest_of(const ob_experiment *x, const ob_trials *s)
{
	uint64_t hash = ob_hash_on(OB_HASH_BEGIN, x->name, strlen(x->name));
	hash = ob_hash_on(hash, &x->limit_s, sizeof x->limit_s);
	for (size_t i = 0; i < s->count; i++) {
		const ob_trial *t = &s->trial[i];
		hash = ob_hash_on(hash, t->of, strlen(t->of) + 1);
		hash = ob_hash_on(hash, t->configuration, strlen(t->configuration) + 1);
		hash = ob_hash_on(hash, &t->repeat, sizeof t->repeat);
		hash = ob_hash_on(hash, &t->seed, sizeof t->seed);
	}
	return hash;
}

typedef struct helper {
	ob_courier *courier;
	message last; // from the first rank
	ob_courier_news news; // kind of the last message
	ob_error why; // reason for which the first has gone
} helper;

static bool attend_first(void *of)
{
	helper *h = of;
	uint32_t from;
	h->news = ob_courier_receive(h->courier, &h->last, &from, &h->why);
	return h->news == OB_COURIER_NOTHING; // the first sends nothing while a trial runs
}

// Returns false if interrupted.
static bool await_order(helper *h, ob_error *e)
{
	while (attend_first(h) && !ob_processes_interrupted())
		ob_processes_wait(ob_courier_socket(h->courier), look_s);
	if (h->news == OB_COURIER_GONE)
		return ob_fail(e, "%s", h->why.text);
	return h->news == OB_COURIER_MESSAGE || ob_fail(e, "interrupted");
}

static bool help(helper *h, const ob_experiment *x, const ob_trials *s, const ob_records *own, ob_error *e)
{
	const ob_meanwhile meanwhile = { .attend = attend_first, .ear = ob_courier_socket(h->courier), .of = h };
	message said = { .kind = JOIN,
			 .trial = digest_of(x, s),
			 .record = ob_trial_record(own, &(ob_trial){ .repeat = 0 }) };
	for (;;) {
		if (!ob_courier_send(h->courier, 0, &said, e) || !await_order(h, e))
			return false;
		if (h->last.kind == LEAVE)
			return true;
		const ob_trial *t = &s->trial[h->last.trial];
		said = (message){ RAN, h->last.trial, ob_trial_record(own, t) };
		if (!ob_trial_run(x, t, &meanwhile, &said.record, e))
			return h->news == OB_COURIER_GONE ? ob_fail(e, "%s", h->why.text) : false;
	}
}

// The launcher may have interrupted all ranks, and kills the rest as soon as one leaves. The first must leave first, as
// it has results to store and to report.
static void fail(helper *h, const ob_error *why)
{
	message said = { .kind = FAILED };
	snprintf(said.record.reason, sizeof said.record.reason, "%.150s", why->text);
	ob_courier_send(h->courier, 0, &said, NULL);
	for (double end = ob_clock_wall() + grace_s; ob_clock_wall() < end && h->news != OB_COURIER_GONE;
	     attend_first(h))
		ob_processes_wait(ob_courier_socket(h->courier), look_s);
}

// Work of a rank other than the first. Returns false and e if interrupted, or if the others cannot be reached.
static bool run_as_helper(const ob_experiment *x, const ob_trials *s, const ob_records *own, const ob_ranks *ranks,
			  ob_error *e)
{
	ob_error why;
	helper h = { .courier = ob_courier_start(ranks, sizeof(message), &why) };
	ob_processes_begin();
	bool fine = h.courier && help(&h, x, s, own, &why);
	if (h.courier && !fine)
		fail(&h, &why);
	ob_processes_end();
	if (fine)
		fine = ob_courier_end(h.courier, &why);
	else
		ob_courier_abandon(h.courier);
	return fine || ob_fail(e, "rank %u: %s", ranks->rank, why.text);
}

// ---- the first rank: remaining trials, and their time

// Known times of the trials of one case.
typedef struct timing {
	const char *of;
	double took, guessed; // s, of completed ones
	double ahead; // s, guessed
} timing;

typedef enum trial_state { AHEAD, UNDER_WAY, DONE } trial_state;

// A rank, and its current trial.
typedef struct seat {
	bool joined, busy;
	size_t trial;
	double begun; // s
} seat;

typedef struct session {
	const ob_experiment *experiment;
	const ob_trials *trials;
	ob_records *records;
	FILE *file; // NULL: no file
	const char *path;
	trial_state *state; // [trial]
	size_t first; // all trials before it are done
	size_t *timing_of; // [trial]
	timing *timing;
	size_t timings;
	size_t done, all;
	uint32_t seats;
	seat *seat; // [seats]: one per rank, this one first
	ob_courier *courier; // to the others; NULL: there are none
	bool failed; // while a trial of this rank ran, and why
	ob_error why;
	ob_progress_view view;
} session;

// True if the record came from less time than a trial has now.
static bool had_less(const ob_experiment *x, const ob_record *r)
{
	return r->failure == OB_FAILURE_TIME &&
	       (x->limit_s <= 0 || (r->took_cpu_s < x->limit_s && r->took_s < ob_trial_wall_limit(x)));
}

// True if the trial has its record, or a failure of an earlier repeat with the same seed is known.
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
	for (size_t i = s->timings; i > 0; i--) // a case's trials are mostly adjacent
		if (!strcmp(s->timing[i - 1].of, of))
			return i - 1;
	s->timing[s->timings].of = of;
	return s->timings++;
}

static bool prepare(session *s, ob_error *e)
{
	size_t n = s->trials->count;
	s->state = calloc(n + 1, sizeof *s->state);
	s->timing_of = calloc(n + 1, sizeof *s->timing_of);
	s->timing = calloc(n + 1, sizeof *s->timing);
	s->seat = calloc(s->seats, sizeof *s->seat);
	if (!s->state || !s->timing_of || !s->timing || !s->seat)
		return ob_fail(e, "out of memory");
	s->seat[0].joined = true;
	for (size_t i = 0; i < n; i++) {
		const ob_trial *t = &s->trials->trial[i];
		s->timing_of[i] = find_timing(s, t->of);
		s->state[i] = is_done(s->experiment, s->records, t) ? DONE : AHEAD;
		if (s->state[i] == DONE)
			continue;
		s->timing[s->timing_of[i]].ahead += t->guess_s;
		s->all++;
	}
	return true;
}

// Estimates the remaining time from the speed of each case so far; a case without data is as fast as all others.
static double guess_left(const session *s)
{
	timing all = { 0 };
	double left = 0, now = ob_clock_wall();
	for (size_t i = 0; i < s->timings; i++) {
		all.took += s->timing[i].took;
		all.guessed += s->timing[i].guessed;
	}
	for (size_t i = 0; i < s->timings; i++) {
		const timing *p = s->timing[i].guessed > 0 ? &s->timing[i] : &all;
		left += s->timing[i].ahead * (p->guessed > 0 ? p->took / p->guessed : 1);
	}
	for (uint32_t i = 0; i < s->seats; i++)
		left -= s->seat[i].busy ? now - s->seat[i].begun : 0;
	return fmax(left, 0) / s->seats;
}

static void tick(void *of)
{
	session *s = of;
	char what[OB_CASE_KEY + OB_CONFIGURATION_KEY + 32] = "the other ranks";
	for (uint32_t i = s->seats; i-- > 0;)
		if (s->seat[i].busy)
			snprintf(what, sizeof what, "%s, %s", s->trials->trial[s->seat[i].trial].of,
				 s->trials->trial[s->seat[i].trial].configuration);
	ob_progress_show(&s->view, (double)s->done, (double)s->all, guess_left(s), what);
}

static void announce(const session *s)
{
	char time[48];
	double left = guess_left(s);
	ob_progress_print_time(time, sizeof time, left);
	if (!s->experiment->quiet && left >= worth_telling_s)
		fprintf(stderr, "obsim: %zu runs, about %s\n", s->all, time);
}

// ---- the next trial

// Record of a trial so coarse that this one takes at least as long, and that ran out of the available time. NULL: none
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

static bool is_repeat(const ob_trial *a, const ob_trial *b)
{
	return a->seed == b->seed && !strcmp(a->configuration, b->configuration) && !strcmp(a->of, b->of);
}

// True if the result of an earlier trial may make this one unnecessary. The earlier one must then come first, as it
// does if one rank runs all.
static bool depends_on(const session *s, const ob_trial *t, const ob_trial *earlier)
{
	const ob_experiment *x = s->experiment;
	if (strcmp(t->of, earlier->of) != 0)
		return false;
	const ob_record r = ob_trial_record(s->records, earlier);
	return is_repeat(t, earlier) || (x->is_finer && x->is_finer(t, &r));
}

// Returns the count if none can start: those left, if any, wait for running ones.
static size_t find_next(session *s)
{
	const ob_trial *t = s->trials->trial;
	while (s->first < s->trials->count && s->state[s->first] == DONE)
		s->first++;
	for (size_t i = s->first; i < s->trials->count; i++) {
		bool free = s->state[i] == AHEAD;
		for (size_t j = s->first; j < i && free; j++)
			free = s->state[j] == DONE || !depends_on(s, &t[i], &t[j]);
		if (free)
			return i;
	}
	return s->trials->count;
}

// ---- results

// Drops outdated records of trials that had less time.
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

static bool complete(session *s, size_t i, const ob_record *r, double took, ob_error *e)
{
	const ob_trial *t = &s->trials->trial[i];
	if (!keep(s, t, r, e))
		return false;
	timing *p = &s->timing[s->timing_of[i]];
	p->took += took;
	p->guessed += t->guess_s;
	p->ahead -= t->guess_s;
	s->state[i] = DONE;
	s->done++;
	// a failure makes the following repeats unnecessary
	for (size_t j = i + 1; r->failure && j < s->trials->count; j++) {
		const ob_trial *later = &s->trials->trial[j];
		if (s->state[j] == DONE || !is_repeat(later, t))
			continue;
		s->timing[s->timing_of[j]].ahead -= later->guess_s;
		s->state[j] = DONE;
		s->done++;
	}
	return true;
}

static bool end_trial(session *s, uint32_t rank, const ob_record *r, ob_error *e)
{
	seat *at = &s->seat[rank];
	at->busy = false;
	return complete(s, at->trial, r, ob_clock_wall() - at->begun, e);
}

// ---- execution

// Gives a rank the next trial, if there is one.
static bool hand_out(session *s, uint32_t rank, ob_error *e)
{
	for (;;) {
		size_t i = find_next(s);
		if (i == s->trials->count)
			return true;
		const ob_trial *t = &s->trials->trial[i];
		const ob_record *coarser = coarser_out_of_time(s, t);
		if (!coarser) {
			s->state[i] = UNDER_WAY;
			s->seat[rank] = (seat){ true, true, i, ob_clock_wall() };
			return rank == 0 || ob_courier_send(s->courier, rank, &(message){ .kind = RUN, .trial = i }, e);
		}
		ob_record r = ob_trial_record(s->records, t);
		r.failure = coarser->failure;
		memcpy(r.reason, coarser->reason, sizeof r.reason);
		r.took_s = coarser->took_s;
		r.took_cpu_s = coarser->took_cpu_s;
		if (!complete(s, i, &r, 0, e))
			return false;
	}
}

static bool admit(session *s, uint32_t rank, const message *m, ob_error *e)
{
	const ob_records *own = s->records;
	if (strcmp(m->record.commit, own->commit) != 0)
		return ob_fail(e, "rank %u is obsim %s, not %s: what is measured with different ones is not mixed",
			       rank, m->record.commit, own->commit);
	if (m->trial != digest_of(s->experiment, s->trials))
		return ob_fail(e, "rank %u has other trials: give all ranks the same command", rank);
	if (strcmp(m->record.machine, own->machine) != 0)
		return ob_fail(
			e, "rank %u has another machine (%s; %s), and what is measured on different ones is not mixed",
			rank, m->record.machine, own->machine);
	s->seat[rank].joined = true;
	return true;
}

// Handles messages from other ranks, then gives work to idle ones, from that rank on.
static bool attend(session *s, uint32_t from, ob_error *e)
{
	bool fine = true;
	for (bool more = s->courier; fine && more;) {
		message m;
		uint32_t rank;
		ob_courier_news news = ob_courier_receive(s->courier, &m, &rank, e);
		more = news == OB_COURIER_MESSAGE;
		if (more && m.kind == FAILED)
			fine = ob_fail(e, "rank %u: %s", rank, m.record.reason);
		else if (more)
			fine = m.kind == JOIN ? admit(s, rank, &m, e) : end_trial(s, rank, &m.record, e);
		else
			fine = news == OB_COURIER_NOTHING;
	}
	for (uint32_t rank = from; fine && rank < s->seats; rank++)
		fine = !s->seat[rank].joined || s->seat[rank].busy || hand_out(s, rank, e);
	return fine;
}

// Called while this rank's own trial runs.
static bool attend_to_others(void *of)
{
	session *s = of;
	s->failed = !attend(s, 1, &s->why);
	return !s->failed;
}

static bool run_own(session *s, ob_error *e)
{
	const ob_trial *t = &s->trials->trial[s->seat[0].trial];
	const ob_meanwhile meanwhile = { .tick = s->experiment->quiet ? NULL : tick,
					 .attend = s->courier ? attend_to_others : NULL,
					 .ear = s->courier ? ob_courier_socket(s->courier) : -1,
					 .of = s };
	ob_record r = ob_trial_record(s->records, t);
	if (!s->experiment->quiet)
		tick(s);
	if (ob_trial_run(s->experiment, t, &meanwhile, &r, e))
		return end_trial(s, 0, &r, e);
	return s->failed ? ob_fail(e, "%s", s->why.text) : false;
}

static bool have_joined(const session *s)
{
	uint32_t n = 0;
	while (n < s->seats && s->seat[n].joined)
		n++;
	return n == s->seats;
}

static bool run_trials(session *s, ob_error *e)
{
	while (s->done < s->all || !have_joined(s)) {
		if (!attend(s, 0, e))
			return false;
		if (s->seat[0].busy) {
			if (!run_own(s, e))
				return false;
		} else if (s->done < s->all || !have_joined(s)) {
			if (!s->experiment->quiet)
				tick(s);
			ob_processes_wait(ob_courier_socket(s->courier), tick_s);
			if (ob_processes_interrupted())
				return ob_fail(e, "interrupted");
		}
	}
	for (uint32_t rank = 1; rank < s->seats; rank++)
		if (!ob_courier_send(s->courier, rank, &(message){ .kind = LEAVE }, e))
			return false;
	return true;
}

static bool run_all(session *s, ob_error *e)
{
	announce(s);
	ob_processes_begin();
	bool fine = run_trials(s, e), interrupted = ob_processes_interrupted();
	ob_processes_end();
	if (!s->experiment->quiet)
		ob_progress_clear(&s->view);
	if (fine || (!interrupted && !s->courier))
		return fine;
	const ob_error why = *e;
	return ob_fail(e, "%s: %zu of %zu runs are done%s", interrupted ? "interrupted" : why.text, s->done, s->all,
		       s->path ? ", and the same command goes on from there" : "");
}

bool ob_experiment_run(const ob_experiment *x, const ob_trials *trials, ob_records *r, const char *folder, ob_error *e)
{
	const ob_ranks ranks = ob_ranks_started();
	if (ranks.rank > 0)
		return run_as_helper(x, trials, r, &ranks, e);
	session s = { .experiment = x, .trials = trials, .records = r, .seats = ranks.ranks };
	char *path = folder ? ob_folder_path(folder, "results.csv") : NULL;
	s.path = path;
	// the current file without dropped records; then a line for each trial
	bool fine = prepare(&s, e) && (!path || ob_records_write(r, x, path, e));
	if (fine && path && !(s.file = fopen(path, "ae")))
		fine = ob_fail(e, "%s cannot be written: %s", path, strerror(errno));
	if (fine && ranks.ranks > 1)
		fine = (s.courier = ob_courier_start(&ranks, sizeof(message), e));
	fine = fine && run_all(&s, e);
	if (s.file)
		fclose(s.file);
	if (path && s.file && !ob_records_write(r, x, path, fine ? e : NULL))
		fine = false;
	if (!fine)
		ob_courier_abandon(s.courier);
	else if (s.courier)
		fine = ob_courier_end(s.courier, e);
	free(path);
	free(s.state);
	free(s.seat);
	free(s.timing);
	free(s.timing_of);
	return fine;
}

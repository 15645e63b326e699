#include "host/timeline.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/allocate.h"
#include "base/clock.h"
#include "base/interrupt.h"
#include "base/utf8.h"
#include "table/free.h"
#include "table/table.h"
#include "table/trace.h"

// ---- trace file

// A trace as JSON in the Trace Event Format, which ui.perfetto.dev and chrome://tracing open.
//
// Importers have rules: spans of one track nest or stand apart, and of two that begin together the outer one comes
// first. They read times as doubles in microseconds, and convert them to whole nanoseconds, each in its own way. So all
// times are rounded down to eighths of a microsecond, which every conversion keeps.
//
// The file is whole at any time: each write ends with the end of the JSON, which the next write overwrites with its
// events. So a host may be killed. Only a signal between two pages of one write could tear the file. So a write is
// about as large as a page, and writes are few. A pipe gets the end once.
//
// Not thread-safe. Write errors are reported by close.

typedef struct ob_trace_file ob_trace_file;

enum {
	BUFFER = 1 << 12,
	LONGEST = 1 << 10, // bytes of one event, or of the file's end
	HOST_PID = 1,
	WORKERS_PID = 2,
	OBJECTS_PID = 3,
	SUPERVISOR_TID = 5,
	FIRST_TID = 10 // of the workers, then of the objects: thread ids are the file's own
};

struct ob_trace_file {
	const ob_universe *u;
	const char *path;
	int fd, error; // errno of the first failed write
	bool streamed; // a pipe: written text cannot be overwritten
	off_t end; // end of the events in the file
	uint32_t workers;
	bool monolith, free_run;
	uint64_t zero; // ns
	size_t used;
	char text[BUFFER];
};

// ---- text; printf takes ten times as long, for a million events

// Writes the text. Its events stay; the next events overwrite the rest.
static void write_text(ob_trace_file *f, size_t events)
{
	for (size_t done = 0; done < f->used && !f->error;) {
		const char *from = f->text + done;
		ssize_t n = f->streamed ? write(f->fd, from, f->used - done)
					: pwrite(f->fd, from, f->used - done, f->end + (off_t)done);
		if (n > 0)
			done += (size_t)n;
		else if (errno != EINTR)
			f->error = n < 0 ? errno : EIO;
	}
	f->end += (off_t)events;
	f->used = 0;
}

static void add(ob_trace_file *f, const char *s)
{
	size_t n = strlen(s);
	memcpy(f->text + f->used, s, n);
	f->used += n;
}

// Writes out all events so far.
static void trace_file_flush(ob_trace_file *f)
{
	const size_t events = f->used;
	if (events == 0)
		return;
	if (!f->streamed)
		add(f, "\n],\"otherData\":{\"unfinished\":true}}\n");
	write_text(f, events);
}

static void add_number(ob_trace_file *f, uint64_t n)
{
	char digits[20];
	int i = sizeof digits;
	do
		digits[--i] = (char)('0' + n % 10);
	while (n /= 10);
	memcpy(f->text + f->used, digits + i, sizeof digits - (size_t)i);
	f->used += sizeof digits - (size_t)i;
}

static void add_eighths(ob_trace_file *f, uint64_t n)
{
	static const char *const parts[8] = { "", ".125", ".25", ".375", ".5", ".625", ".75", ".875" };
	add_number(f, n / 8);
	add(f, parts[n % 8]);
}

// Adds a string in quotes. Bytes that are no UTF-8 count as Latin-1.
static void add_string(ob_trace_file *f, const char *text)
{
	static const char hex[] = "0123456789abcdef";
	add(f, "\"");
	for (const unsigned char *s = (const unsigned char *)text; *s;) {
		size_t n = ob_utf8_length((const char *)s);
		if (n == 0 || *s < 0x20 || *s == '"' || *s == '\\') {
			const char escape[] = { '\\', 'u', '0', '0', hex[*s >> 4], hex[*s & 15], 0 };
			add(f, escape);
			n = 1;
		} else {
			memcpy(f->text + f->used, s, n);
			f->used += n;
		}
		s += n;
	}
	add(f, "\"");
}

static void add_member(ob_trace_file *f, const char *key, uint64_t value)
{
	add(f, key);
	add_number(f, value);
}

// ---- events

typedef struct track {
	uint32_t pid;
	uint64_t tid;
} track;

static track of_object(const ob_trace_file *f, uint32_t id)
{
	return (track){ OBJECTS_PID, FIRST_TID + (uint64_t)f->workers + id };
}

static track of_ring(const ob_trace_file *f, uint32_t ring)
{
	if (ring < f->workers)
		return (track){ WORKERS_PID, FIRST_TID + (uint64_t)ring };
	return (track){ HOST_PID, ring == f->workers ? HOST_PID : SUPERVISOR_TID };
}

static void begin(ob_trace_file *f, const char *phase, track t)
{
	if (f->used > BUFFER - LONGEST)
		trace_file_flush(f);
	add(f, ",\n{\"ph\":\"");
	add(f, phase);
	add_member(f, "\",\"pid\":", t.pid);
	add_member(f, ",\"tid\":", t.tid);
}

static uint64_t eighths(const ob_trace_file *f, uint64_t ns)
{
	return ns > f->zero ? (ns - f->zero) / 125 : 0;
}

// Leaves the event open for more members.
static void begin_span(ob_trace_file *f, track t, const char *name, const ob_trace_event *e)
{
	uint64_t from = eighths(f, e->begin), to = eighths(f, e->end);
	begin(f, "X", t);
	add(f, ",\"ts\":");
	add_eighths(f, from);
	add(f, ",\"dur\":");
	add_eighths(f, to > from ? to - from : 0);
	add(f, ",\"name\":\"");
	add(f, name);
	add(f, "\"");
}

static void begin_instant(ob_trace_file *f, track t, const char *name, uint64_t when)
{
	begin(f, "i", t);
	add(f, ",\"s\":\"t\",\"ts\":");
	add_eighths(f, eighths(f, when));
	add(f, ",\"name\":\"");
	add(f, name);
	add(f, "\"");
}

static void end(ob_trace_file *f)
{
	add(f, "}");
}

static void put_state(ob_trace_file *f, const ob_trace_event *e)
{
	static const char *const names[OB_TRACE_MOTIONS] = {
		[OB_TRACE_ABSENT] = "absent",
		[OB_TRACE_FLYING] = "flies",
		[OB_TRACE_TOUCHING] = "touches",
		[OB_TRACE_ASLEEP] = "asleep",
	};
	uint32_t before = e->b & 255, after = e->b >> 8;
	track t = of_object(f, e->a);
	if (before >= OB_TRACE_MOTIONS)
		return;
	// the monolith does not report contacts
	begin_span(f, t, f->monolith && before != OB_TRACE_ASLEEP ? "awake" : names[before], e);
	end(f);
	if (after == OB_TRACE_ASLEEP || (before == OB_TRACE_ASLEEP && after != OB_TRACE_ABSENT)) {
		begin_instant(f, t, after == OB_TRACE_ASLEEP ? "falls asleep" : "wakes", e->end);
		end(f);
	}
}

static void put_killed(ob_trace_file *f, const ob_trace_event *e)
{
	const char *signal = e->b ? sigabbrev_np((int)e->b) : NULL;
	begin_instant(f, of_ring(f, e->a), "dies", e->end);
	add(f, ",\"args\":{\"signal\":");
	add_string(f, signal ? signal : e->b ? "unknown" : "none");
	add(f, "}");
	end(f);
}

static const char *name_of(const ob_trace_file *f, const ob_trace_event *e)
{
	static const char *const names[OB_TRACE_KINDS] = {
		[OB_TRACE_WAIT] = "gate",         [OB_TRACE_SOLVE] = "solve",     [OB_TRACE_OBJECTS] = "objects",
		[OB_TRACE_SCHEDULE] = "schedule", [OB_TRACE_CHUNK] = "chunk",     [OB_TRACE_ISLAND] = "island",
		[OB_TRACE_STEPS] = "steps",       [OB_TRACE_CLOCK] = "clock",     [OB_TRACE_LAG] = "lag",
		[OB_TRACE_SNAPSHOT] = "snapshot", [OB_TRACE_MEASURE] = "measure", [OB_TRACE_RECORD] = "record",
		[OB_TRACE_DRAW] = "draw",         [OB_TRACE_ENCODE] = "encode",
	};
	if (e->kind == OB_TRACE_PROFILE)
		return ob_profile_name(e->a);
	if (e->kind == OB_TRACE_WAIT && f->free_run)
		return "host"; // there is no gate
	return e->kind == OB_TRACE_SOLVE && f->monolith ? "world" : names[e->kind];
}

// Adds the numbers of an event under the names of its kind.
static void add_arguments(ob_trace_file *f, const ob_trace_event *e, bool unfinished)
{
	size_t start = f->used;
	add(f, ",\"args\":{");
	size_t empty = f->used;
	if (unfinished)
		add(f, "\"unfinished\":true");
	else if (e->kind == OB_TRACE_SOLVE || e->kind == OB_TRACE_OBJECTS)
		add_member(f, "\"step\":", e->step);
	if (!unfinished && ((e->kind == OB_TRACE_SOLVE && !f->monolith) || e->kind == OB_TRACE_CHUNK)) {
		add_member(f, e->kind == OB_TRACE_SOLVE ? ",\"islands\":" : "\"islands\":", e->a);
		add_member(f, ",\"bodies\":", e->b);
	}
	if (e->kind == OB_TRACE_ISLAND) {
		add_member(f, "\"first\":", e->a);
		add_member(f, ",\"bodies\":", e->b);
	}
	if (e->kind == OB_TRACE_STEPS)
		add_member(f, "\"steps\":", e->a);
	if (e->kind == OB_TRACE_LAG) {
		add_member(f, "\"object\":", e->a);
		add_member(f, ",\"waits_for\":", e->b);
	}
	if (e->kind == OB_TRACE_DRAW || e->kind == OB_TRACE_ENCODE)
		add_member(f, "\"frame\":", e->a);
	if (f->used == empty)
		f->used = start;
	else
		add(f, "}");
}

// Adds an event of a ring, of any kind. unfinished: it has not ended.
static void trace_file_put(ob_trace_file *f, uint32_t ring, const ob_trace_event *e, bool unfinished)
{
	if (e->kind == OB_TRACE_STATE) {
		put_state(f, e);
	} else if (e->kind == OB_TRACE_BIRTH || e->kind == OB_TRACE_DEATH) {
		begin_instant(f, of_object(f, e->a), e->kind == OB_TRACE_BIRTH ? "birth" : "death", e->end);
		end(f);
	} else if (e->kind == OB_TRACE_KILLED) {
		put_killed(f, e);
	} else if (e->kind > OB_TRACE_NONE && e->kind < OB_TRACE_KINDS) {
		begin_span(f, of_ring(f, ring), name_of(f, e), e);
		add_arguments(f, e, unfinished);
		end(f);
	}
}

// Adds an instant to the ring's track: the death of its simulator at this time (ns), in this step.
static void trace_file_put_death(ob_trace_file *f, uint32_t ring, const char *what, uint64_t step, uint64_t when)
{
	char cut[500]; // the longest event: the buffer is empty, and holds it even if all of it must be escaped
	snprintf(cut, sizeof cut, "%.*s", (int)sizeof cut - 1, what);
	trace_file_flush(f);
	begin_instant(f, of_ring(f, ring), "why it died", when);
	add(f, ",\"args\":{\"what\":");
	add_string(f, cut);
	add_member(f, ",\"step\":", step);
	add(f, "}");
	end(f);
}

// Adds an instant to the ring's track: that number of events is missing before this time (ns).
static void trace_file_put_lost(ob_trace_file *f, uint32_t ring, uint64_t lost, uint64_t when)
{
	begin_instant(f, of_ring(f, ring), "events lost", when);
	add_member(f, ",\"args\":{\"events\":", lost);
	add(f, "}");
	end(f);
}

// ---- names

static void name(ob_trace_file *f, const char *what, track t, const char *text, uint64_t rank)
{
	begin(f, "M", t);
	add(f, ",\"name\":\"");
	add(f, what);
	add(f, "_name\",\"args\":{\"name\":");
	add_string(f, text);
	add(f, "}");
	end(f);
	begin(f, "M", t);
	add(f, ",\"name\":\"");
	add(f, what);
	add_member(f, "_sort_index\",\"args\":{\"sort_index\":", rank);
	add(f, "}");
	end(f);
}

// Names object id's track after its passport. Call it again when the slot has another object.
static void trace_file_name_object(ob_trace_file *f, uint32_t id)
{
	char text[OB_NAME_MAX + 24], known[OB_NAME_MAX] = "";
	ob_trace_name(f->u, id, known);
	snprintf(text, sizeof text, "%u %s", id, known);
	name(f, "thread", of_object(f, id), text, of_object(f, id).tid);
}

static void name_tracks(ob_trace_file *f)
{
	bool own = ob_universe_settings(f->u)->one_per_object;
	char text[40];
	name(f, "process", (track){ HOST_PID, HOST_PID }, "host", HOST_PID);
	name(f, "process", (track){ WORKERS_PID, FIRST_TID }, own ? "workers, one per object" : "workers", WORKERS_PID);
	name(f, "process", (track){ OBJECTS_PID, FIRST_TID + (uint64_t)f->workers }, "simulators", OBJECTS_PID);
	name(f, "thread", of_ring(f, f->workers), "main thread", 0);
	name(f, "thread", of_ring(f, f->workers + 1), "supervisor", 1);
	for (uint32_t w = 0; w < f->workers; w++) {
		snprintf(text, sizeof text, "worker %u", w);
		name(f, "thread", of_ring(f, w), text, of_ring(f, w).tid);
	}
}

// Opens the file, and names its tracks after the universe's workers. NULL and e on failure.
static ob_trace_file *trace_file_open(const char *path, const ob_universe *u, ob_error *e)
{
	ob_trace_file *f = calloc(1, sizeof *f);
	if (!f) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	f->u = u;
	f->path = path;
	f->workers = ob_universe_workers(u);
	f->monolith = ob_universe_settings(u)->monolith;
	f->free_run = ob_free_settings_of(u);
	f->zero = ob_clock_ns();
	f->fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
	if (f->fd < 0) {
		ob_fail(e, "%s: %s", path, strerror(errno));
		free(f);
		return NULL;
	}
	f->streamed = lseek(f->fd, 0, SEEK_CUR) < 0;
	// an event must stand before the first comma; importers show it nowhere
	add(f, "{\"displayTimeUnit\":\"ns\",\"traceEvents\":[\n");
	add(f, "{\"ph\":\"M\",\"pid\":1,\"name\":\"process_labels\",\"args\":{\"labels\":\"obsim\"}}");
	name_tracks(f);
	trace_file_flush(f);
	return f;
}

// Ends the file and frees f. false and e if any write failed.
static bool trace_file_close(ob_trace_file *f, uint64_t events, uint64_t lost, ob_error *e)
{
	add_member(f, "\n],\"otherData\":{\"events\":", events);
	add_member(f, ",\"lost\":", lost);
	add(f, "}}\n");
	write_text(f, 0);
	if (close(f->fd) != 0 && !f->error)
		f->error = errno;
	bool fine = !f->error || ob_fail(e, "%s: %s", f->path, strerror(f->error));
	free(f);
	return fine;
}

// ---- timeline

enum { PERIOD_MS = 50, TAKEN_AT_ONCE = 4096 };

// State of one ring. A span arrives when it ends, so inner spans arrive before the outer one. They wait for it, because
// the file must have the outer one first.
typedef struct ring_state {
	ob_trace_event *waiting;
	uint32_t count, room;
	uint64_t until; // ns: end of the last span of level 0
	uint64_t lost; // as of the last drain
	uint64_t died; // ns; 0 = alive
} ring_state;

struct ob_timeline {
	ob_universe *u;
	ob_trace_file *file;
	ring_state *ring; // [rings]
	uint64_t *state_until; // [capacity] ns: end of the last span of each object
	uint64_t events, lost;
	pthread_t thread;
	pthread_mutex_t lock; // guards ended
	pthread_cond_t end;
	bool ended;
	ob_trace_event taken[TAKEN_AT_ONCE];
};

static int level(uint32_t kind)
{
	return kind == OB_TRACE_CHUNK ? 1 : kind == OB_TRACE_ISLAND ? 2 : kind == OB_TRACE_PROFILE ? 3 : 0;
}

static int outer_first(const void *pa, const void *pb)
{
	const ob_trace_event *a = pa, *b = pb;
	if (a->begin != b->begin)
		return a->begin < b->begin ? -1 : 1;
	if (level(a->kind) != level(b->kind))
		return level(a->kind) - level(b->kind);
	return (a->end > b->end) - (a->end < b->end);
}

static void write_waiting(ob_timeline *t, uint32_t ring)
{
	ring_state *r = &t->ring[ring];
	if (r->count > 1)
		qsort(r->waiting, r->count, sizeof *r->waiting, outer_first);
	for (uint32_t i = 0; i < r->count; i++)
		trace_file_put(t->file, ring, &r->waiting[i], false);
	r->count = 0;
}

static void keep_waiting(ob_timeline *t, uint32_t ring, const ob_trace_event *e)
{
	ring_state *r = &t->ring[ring];
	if (OB_MAKE_ROOM(r->waiting, r->count, r->room))
		r->waiting[r->count++] = *e;
	else
		t->lost++;
}

static void put(ob_timeline *t, uint32_t ring, const ob_trace_event *e)
{
	uint32_t capacity = ob_universe_capacity(t->u);
	bool objects = e->kind == OB_TRACE_STATE || e->kind == OB_TRACE_BIRTH || e->kind == OB_TRACE_DEATH;
	if (objects ? e->a >= capacity : e->kind == OB_TRACE_KILLED && e->a >= ob_universe_workers(t->u))
		return; // a damaged event: this program writes none like it
	if (objects || e->kind == OB_TRACE_KILLED) {
		if (e->kind == OB_TRACE_BIRTH)
			trace_file_name_object(t->file, e->a);
		if (e->kind == OB_TRACE_KILLED)
			t->ring[e->a].died = e->end;
		if (objects && e->end > t->state_until[e->a])
			t->state_until[e->a] = e->end;
		trace_file_put(t->file, ring, e, false);
		return;
	}
	keep_waiting(t, ring, e);
	if (level(e->kind) == 0) {
		t->ring[ring].until = e->end;
		write_waiting(t, ring);
	}
}

// Takes all events now in a ring; later ones may stay for the next time.
static void drain(ob_timeline *t, uint32_t ring)
{
	uint32_t n;
	do {
		n = ob_trace_take(t->u, ring, t->taken, TAKEN_AT_ONCE);
		t->events += n;
		for (uint32_t i = 0; i < n; i++)
			put(t, ring, &t->taken[i]);
	} while (n == TAKEN_AT_ONCE);
	uint64_t lost = ob_trace_lost(t->u, ring);
	if (lost == t->ring[ring].lost)
		return;
	trace_file_put_lost(t->file, ring, lost - t->ring[ring].lost, ob_clock_ns());
	t->events += lost - t->ring[ring].lost;
	t->lost += lost - t->ring[ring].lost;
	t->ring[ring].lost = lost;
}

// Drains the host's ring first, so that an object is known as added before workers' events of its states.
static void drain_all(ob_timeline *t)
{
	for (uint32_t ring = ob_trace_rings(t->u); ring-- > 0;)
		drain(t, ring);
}

// true if the end came within the period
static bool wait_for_end(ob_timeline *t)
{
	struct timespec until;
	clock_gettime(CLOCK_MONOTONIC, &until);
	until.tv_nsec += PERIOD_MS * 1000000L;
	until.tv_sec += until.tv_nsec / 1000000000L;
	until.tv_nsec %= 1000000000L;
	pthread_mutex_lock(&t->lock);
	int late = 0;
	while (!t->ended && late == 0)
		late = pthread_cond_timedwait(&t->end, &t->lock, &until);
	bool ended = t->ended;
	pthread_mutex_unlock(&t->lock);
	return ended;
}

static void *run(void *argument)
{
	ob_timeline *t = argument;
	pthread_setname_np(pthread_self(), "timeline");
	do {
		drain_all(t);
		trace_file_flush(t->file);
	} while (!wait_for_end(t));
	return NULL;
}

static bool start_thread(ob_timeline *t, ob_error *e)
{
	sigset_t before;
	pthread_condattr_t monotonic;
	pthread_mutex_init(&t->lock, NULL);
	pthread_condattr_init(&monotonic);
	pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
	pthread_cond_init(&t->end, &monotonic);
	pthread_condattr_destroy(&monotonic);
	ob_interrupt_leave_to_main(&before);
	int error = pthread_create(&t->thread, NULL, run, t);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	if (!error)
		return true;
	pthread_cond_destroy(&t->end);
	pthread_mutex_destroy(&t->lock);
	return ob_fail(e, "cannot start the timeline's thread: %s", strerror(error));
}

static void discard(ob_timeline *t)
{
	for (uint32_t i = 0; t->ring && i < ob_trace_rings(t->u); i++)
		free(t->ring[i].waiting);
	free(t->ring);
	free(t->state_until);
	free(t);
}

ob_timeline *ob_timeline_start(ob_universe *u, const char *path, ob_error *e)
{
	ob_timeline *t = calloc(1, sizeof *t);
	if (t) {
		t->u = u;
		t->ring = calloc(ob_trace_rings(u), sizeof *t->ring);
		t->state_until = calloc(ob_universe_capacity(u), sizeof *t->state_until);
	}
	if (!t || !t->ring || !t->state_until)
		ob_fail(e, "out of memory");
	else
		t->file = trace_file_open(path, u, e);
	if (t && t->file && start_thread(t, e))
		return t;
	if (t && t->file)
		trace_file_close(t->file, 0, 0, NULL);
	if (t)
		discard(t);
	return NULL;
}

// Writes the unfinished spans: current activity of workers, and states of objects.
static void put_unfinished(ob_timeline *t, const ob_trace_event *doing, uint64_t now)
{
	for (uint32_t ring = 0; ring < ob_universe_workers(t->u); ring++) {
		ob_trace_event e = doing[ring];
		e.end = t->ring[ring].died ? t->ring[ring].died : now;
		write_waiting(t, ring);
		if (e.kind != OB_TRACE_NONE && e.begin >= t->ring[ring].until && e.begin <= e.end)
			trace_file_put(t->file, ring, &e, e.kind != OB_TRACE_WAIT);
	}
	for (uint32_t id = 0; id < ob_universe_ids(t->u); id++) {
		ob_passport p;
		ob_motion m;
		uint64_t since = ob_trace_since(t->u, id);
		if (!ob_universe_get_passport(t->u, id, &p) || p.flags & OB_OBJECT_PRESCRIBED ||
		    !ob_universe_get_motion(t->u, id, &m))
			continue;
		ob_trace_event e = { since > t->state_until[id] ? since : t->state_until[id],
				     now,
				     OB_TRACE_STATE,
				     id,
				     (uint32_t)ob_trace_motion_of(m.flags),
				     0 };
		trace_file_put(t->file, 0, &e, true);
	}
}

static void finish_file(ob_timeline *t)
{
	uint32_t workers = ob_universe_workers(t->u);
	ob_trace_event *doing = calloc(workers, sizeof *doing);
	// activity of workers before the complete spans: a span that ends in between counts as complete
	for (uint32_t w = 0; doing && w < workers; w++)
		doing[w] = ob_trace_unfinished(t->u, w);
	drain_all(t);
	if (doing)
		put_unfinished(t, doing, ob_clock_ns());
	free(doing);
}

bool ob_timeline_finish(ob_timeline *t, const ob_death *deaths, uint32_t n, ob_timeline_sums *sums, ob_error *e)
{
	*sums = (ob_timeline_sums){ 0 };
	if (!t)
		return true;
	pthread_mutex_lock(&t->lock);
	t->ended = true;
	pthread_cond_signal(&t->end);
	pthread_mutex_unlock(&t->lock);
	pthread_join(t->thread, NULL);
	finish_file(t);
	for (uint32_t i = 0; i < n; i++) {
		ob_error line;
		ob_death_print(&deaths[i], line.text, sizeof line.text);
		trace_file_put_death(t->file,
				     deaths[i].worker < ob_universe_workers(t->u) ? deaths[i].worker
										  : ob_trace_supervisor(t->u),
				     line.text, deaths[i].step, deaths[i].when);
	}
	*sums = (ob_timeline_sums){ t->events, t->lost };
	bool fine = trace_file_close(t->file, t->events, t->lost, e);
	pthread_cond_destroy(&t->end);
	pthread_mutex_destroy(&t->lock);
	discard(t);
	return fine;
}

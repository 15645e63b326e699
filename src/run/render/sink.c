#include "render/sink.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/interrupt.h"

enum { WAITING_MAX = 8, WORKERS_MAX = 4 };

typedef struct slot {
	ob_sink_frame frame;
	uint8_t *rgba;
} slot;

// Slots circulate from free to waiting to a worker and back; lock guards all lists.
struct ob_sink {
	const ob_sink_kind *kind;
	void *state;
	int width, height, workers;
	pthread_t worker[WORKERS_MAX];
	pthread_mutex_t lock;
	pthread_cond_t has_frame, has_room;
	slot slot[WAITING_MAX];
	int unused[WAITING_MAX], unused_count;
	int waiting[WAITING_MAX], waiting_first, waiting_count;
	bool closing, failed;
	ob_error error; // the first one, when failed
};

// Takes the oldest waiting frame; -1 when the sink closes and none is left. Called with the lock held.
static int take_frame(ob_sink *s)
{
	while (!s->waiting_count && !s->closing)
		pthread_cond_wait(&s->has_frame, &s->lock);
	if (!s->waiting_count)
		return -1;
	int which = s->waiting[s->waiting_first];
	s->waiting_first = (s->waiting_first + 1) % WAITING_MAX;
	s->waiting_count--;
	return which;
}

static void return_slot(ob_sink *s, int which, bool good, const ob_error *e)
{
	if (!good && !s->failed) {
		s->failed = true;
		s->error = *e;
	}
	s->unused[s->unused_count++] = which;
	pthread_cond_signal(&s->has_room);
}

// Drops frames after a failure; close reports it.
static void *run_worker(void *sink)
{
	ob_sink *s = sink;
	pthread_mutex_lock(&s->lock);
	for (int which; (which = take_frame(s)) >= 0;) {
		bool good = !s->failed;
		ob_error e = { "" };
		pthread_mutex_unlock(&s->lock);
		if (good)
			good = s->kind->write(s->state, s->width, s->height, &s->slot[which].frame, &e);
		pthread_mutex_lock(&s->lock);
		return_slot(s, which, good, &e);
	}
	pthread_mutex_unlock(&s->lock);
	return NULL;
}

static void stop_workers(ob_sink *s)
{
	pthread_mutex_lock(&s->lock);
	s->closing = true;
	pthread_cond_broadcast(&s->has_frame);
	pthread_mutex_unlock(&s->lock);
	for (int i = 0; i < s->workers; i++)
		pthread_join(s->worker[i], NULL);
}

static void free_sink(ob_sink *s)
{
	for (int i = 0; i < WAITING_MAX; i++)
		free(s->slot[i].rgba);
	pthread_cond_destroy(&s->has_room);
	pthread_cond_destroy(&s->has_frame);
	pthread_mutex_destroy(&s->lock);
	free(s);
}

// Workers block signals: these are for the main thread, and a closed pipe is an error, not a reason to die.
static bool start_workers(ob_sink *s, int workers)
{
	sigset_t before;
	ob_interrupt_leave_to_main(&before);
	while (s->workers < workers && pthread_create(&s->worker[s->workers], NULL, run_worker, s) == 0)
		s->workers++;
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	return s->workers > 0;
}

static ob_sink *allocate_sink(int w, int h)
{
	ob_sink *s = calloc(1, sizeof *s);
	if (!s)
		return NULL;
	pthread_mutex_init(&s->lock, NULL);
	pthread_cond_init(&s->has_frame, NULL);
	pthread_cond_init(&s->has_room, NULL);
	s->width = w;
	s->height = h;
	for (int i = 0; i < WAITING_MAX; i++) {
		s->slot[i].rgba = malloc(4 * (size_t)w * (size_t)h);
		s->unused[s->unused_count++] = i;
		if (!s->slot[i].rgba) {
			free_sink(s);
			return NULL;
		}
	}
	return s;
}

ob_sink *ob_sink_start(const ob_sink_kind *kind, void *state, int w, int h, int workers, ob_error *e)
{
	ob_sink *s = w > 0 && h > 0 ? allocate_sink(w, h) : NULL;
	if (!s) {
		kind->finish(state, false, NULL);
		ob_fail(e, "frames of %dx%d: no memory for the %d that may wait to be written", w, h, WAITING_MAX);
		return NULL;
	}
	s->kind = kind;
	s->state = state;
	if (!start_workers(s, workers < WORKERS_MAX ? workers : WORKERS_MAX)) {
		kind->finish(state, false, NULL);
		free_sink(s);
		ob_fail(e, "no thread could be started to write frames");
		return NULL;
	}
	return s;
}

bool ob_sink_put(ob_sink *s, uint64_t frame, double time, const uint8_t *rgba, ob_error *e)
{
	pthread_mutex_lock(&s->lock);
	while (!s->unused_count && !s->failed)
		pthread_cond_wait(&s->has_room, &s->lock);
	if (s->failed) {
		pthread_mutex_unlock(&s->lock);
		return ob_fail(e, "%s", s->error.text); // written once, before failed was set
	}
	int which = s->unused[--s->unused_count];
	pthread_mutex_unlock(&s->lock);
	memcpy(s->slot[which].rgba, rgba, 4 * (size_t)s->width * (size_t)s->height);
	s->slot[which].frame = (ob_sink_frame){ frame, time, s->slot[which].rgba };
	pthread_mutex_lock(&s->lock);
	s->waiting[(s->waiting_first + s->waiting_count++) % WAITING_MAX] = which;
	pthread_cond_signal(&s->has_frame);
	pthread_mutex_unlock(&s->lock);
	return true;
}

bool ob_sink_close(ob_sink *s, ob_error *e)
{
	stop_workers(s);
	ob_error last = { "" };
	bool good = s->kind->finish(s->state, !s->failed, &last) && !s->failed;
	if (!good)
		ob_fail(e, "%s", s->failed && !last.text[0] ? s->error.text : last.text);
	free_sink(s);
	return good;
}

// ---- raw frames to a file descriptor, for any program that reads rgb24

enum { BLOCK_PIXELS = 16384 };

typedef struct raw {
	int fd; // the caller's: not closed
	const char *name;
} raw;

static bool write_all(int fd, const uint8_t *data, size_t size)
{
	while (size > 0) {
		ssize_t n = write(fd, data, size);
		if (n > 0) {
			data += n;
			size -= (size_t)n;
		} else if (n < 0 && errno == EAGAIN) {
			struct pollfd room = { fd, POLLOUT, 0 };
			poll(&room, 1, -1);
		} else if (n < 0 && errno != EINTR) {
			return false;
		}
	}
	return true;
}

bool ob_pipe_write(int fd, int w, int h, const uint8_t *rgba, const char *what, ob_error *e)
{
	uint8_t rgb[3 * BLOCK_PIXELS];
	for (size_t left = (size_t)w * (size_t)h; left > 0;) {
		size_t n = left < BLOCK_PIXELS ? left : BLOCK_PIXELS;
		for (size_t i = 0; i < n; i++)
			memcpy(rgb + 3 * i, rgba + 4 * i, 3);
		if (!write_all(fd, rgb, 3 * n))
			return ob_fail(e, "%s: %s", what,
				       errno == EPIPE ? "the reader of the frames has gone" : strerror(errno));
		rgba += 4 * n;
		left -= n;
	}
	return true;
}

static bool write_raw(void *state, int w, int h, const ob_sink_frame *frame, ob_error *e)
{
	const raw *r = state;
	return ob_pipe_write(r->fd, w, h, frame->rgba, r->name, e);
}

static bool finish_raw(void *state, bool good, ob_error *e)
{
	free(state);
	return true;
}

ob_sink *ob_sink_raw(int fd, const char *name, int w, int h, ob_error *e)
{
	static const ob_sink_kind kind = { write_raw, finish_raw };
	raw *r = malloc(sizeof *r);
	if (!r) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	*r = (raw){ fd, name };
	return ob_sink_start(&kind, r, w, h, 1, e);
}

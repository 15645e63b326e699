#include "cli/capture.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "measure/colouring.h"
#include "render/caption.h"
#include "table/free.h"
#include "table/table.h"

// ---- strip

// Strip on frames (--overlay simulators): a row for each worker, and the own times of a free run. The page has the same
// (src/front/serve/page/workers.js). One thread.

typedef struct ob_worker_strip ob_worker_strip;

enum {
	ROWS = 8, // beyond that, the workers with the most CPU
	PLACES = 128 // of the ribbon: simulators at one place share a bar
};
static const double span = 1; // s over which a share of CPU is taken: the host refreshes CPU times twice a second

// A worker, and the instant from which its share of CPU is taken.
typedef struct seen {
	ob_worker_info info;
	uint32_t number;
	int32_t pid; // at that instant
	uint64_t cpu_ns, at_ns;
	double share; // of a core; NaN: not known yet
} seen;

struct ob_worker_strip {
	const ob_universe *u;
	uint32_t workers;
	seen *worker; // [workers]
	seen *order; // [workers], those shown first
	ob_strip strip;
	ob_strip_row row[ROWS];
	ob_strip_place place[PLACES];
};

// NULL is allowed
static void worker_strip_destroy(ob_worker_strip *s)
{
	if (!s)
		return;
	free(s->worker);
	free(s->order);
	free(s);
}

// the universe must outlive it
static ob_worker_strip *worker_strip_create(const ob_universe *u, ob_error *e)
{
	ob_worker_strip *s = calloc(1, sizeof *s);
	const uint32_t n = ob_universe_simulators(u);
	if (s) {
		s->u = u;
		s->workers = n;
		s->worker = calloc(n, sizeof *s->worker);
		s->order = calloc(n, sizeof *s->order);
	}
	if (!s || !s->worker || !s->order) {
		worker_strip_destroy(s);
		ob_fail(e, "out of memory");
		return NULL;
	}
	s->strip = (ob_strip){ .row = s->row, .place = s->place, .tick = { "0", "1 ms", "10 ms", ".1 s", "1 s" } };
	return s;
}

static void look_at_workers(ob_worker_strip *s)
{
	const uint64_t now = ob_clock_ns();
	for (uint32_t i = 0; i < s->workers; i++) {
		seen *w = &s->worker[i];
		w->number = i;
		if (!ob_universe_get_worker(s->u, i, &w->info))
			w->info = (ob_worker_info){ 0 };
		const double since = 1e-9 * (double)(now - w->at_ns);
		if (w->pid == w->info.pid && w->at_ns && since < span)
			continue;
		const bool same = w->pid == w->info.pid && w->at_ns && w->info.cpu_ns >= w->cpu_ns;
		w->share = same ? 1e-9 * (double)(w->info.cpu_ns - w->cpu_ns) / since : NAN;
		w->pid = w->info.pid;
		w->cpu_ns = w->info.cpu_ns;
		w->at_ns = now;
	}
}

static int by_share(const void *a, const void *b)
{
	const seen *x = a, *y = b;
	const double p = isnan(x->share) ? 0 : x->share, q = isnan(y->share) ? 0 : y->share;
	return p != q ? (p < q) - (p > q) : x->number < y->number ? -1 : 1;
}

// Objects that a worker ran in the last step; in a free run, those that it simulates.
static uint32_t objects_of(const ob_worker_strip *s, const seen *w, const ob_snapshot *now)
{
	uint32_t n = 0;
	if (!ob_free_settings_of(s->u))
		return w->info.objects;
	for (uint32_t id = 0; id < now->count; id++)
		n += now->home[id] == w->number;
	return n;
}

static void fill_rows(ob_worker_strip *s, const ob_snapshot *now)
{
	const bool ranks = s->workers > 0 && ob_universe_rank_of(s->u, s->workers - 1) > 0;
	memcpy(s->order, s->worker, s->workers * sizeof *s->order);
	if (s->workers > ROWS)
		qsort(s->order, s->workers, sizeof *s->order, by_share);
	s->strip.rows = s->workers < ROWS ? s->workers : ROWS;
	for (uint32_t i = 0; i < s->strip.rows; i++) {
		const seen *w = &s->order[i];
		ob_strip_row *r = &s->row[i];
		char rank[16] = "";
		if (ranks)
			snprintf(rank, sizeof rank, ", rank %u", ob_universe_rank_of(s->u, w->number));
		*r = (ob_strip_row){ .share = w->share };
		ob_colour_of_number(w->number, r->colour);
		snprintf(r->text, sizeof r->text, "worker %u, pid %d%s", w->number, w->info.pid, rank);
		snprintf(r->tail, sizeof r->tail, "ran %u", objects_of(s, w, now));
	}
	if (s->workers > ROWS)
		snprintf(s->strip.more, sizeof s->strip.more, "and %u more, with less CPU", s->workers - ROWS);
}

static void fill_places(ob_worker_strip *s, const ob_snapshot *now)
{
	uint32_t n = 0;
	for (int i = 0; i < PLACES; i++) {
		s->place[i].count = 0;
		ob_colour_of_share((double)i / (PLACES - 1), s->place[i].colour);
	}
	for (uint32_t id = 0; now->own_time && id < now->count; id++) {
		const double share = ob_share_of_lead(now->own_time[id] - now->time);
		if (!(now->passport[id].flags & OB_OBJECT_PRESENT) || isnan(share))
			continue;
		s->place[lround((PLACES - 1) * fmin(1, share))].count++;
		n++;
	}
	s->strip.places = n ? PLACES : 0;
	snprintf(s->strip.title, sizeof s->strip.title, "lead of %u own times", n);
}

// Paints workers as they are, and own times as the snapshot has them.
static bool worker_strip_paint(ob_worker_strip *s, const ob_snapshot *now, uint8_t *rgba, int width, int height,
			       ob_error *e)
{
	look_at_workers(s);
	fill_rows(s, now);
	fill_places(s, now);
	return ob_caption_strip(rgba, width, height, &s->strip, e);
}

// ---- capture

ob_frame_clock ob_frame_clock_make(double duration, double fps, double step, uint64_t first)
{
	// 1e-9 of a frame: products like .1 s * 30 / s may fall short of the intended whole number
	return (ob_frame_clock){
		.fps = fps,
		.step = step,
		.frames = (uint64_t)fmax(1, floor(duration * fps + 1e-9)),
		.next = (uint64_t)ceil((double)first * step * fps * (1 - 1e-12) - 1e-9),
	};
}

ob_frame_clock ob_frame_clock_of_stills(const double *still, uint32_t n, double step, uint64_t first)
{
	ob_frame_clock c = { .step = step, .frames = n, .still = still };
	while (c.next < n && still[c.next] < (double)first * step * (1 - 1e-12))
		c.next++;
	return c;
}

double ob_frame_clock_time(const ob_frame_clock *c)
{
	return c->still ? c->still[c->next] : (double)c->next / c->fps;
}

uint64_t ob_frame_clock_step(const ob_frame_clock *c, bool *between)
{
	*between = false;
	if (c->next >= c->frames)
		return UINT64_MAX;
	double steps = ob_frame_clock_time(c) / c->step, nearest = round(steps);
	// on the step, but for the rounding of the quotient
	if (fabs(steps - nearest) <= 1e-9 * fmax(1, steps * 1e-3))
		return (uint64_t)nearest;
	*between = true;
	return (uint64_t)ceil(steps);
}

uint64_t ob_frame_clock_need(const ob_frame_clock *c, uint64_t now)
{
	ob_frame_clock later = *c; // current frames are drawn while the universe runs on
	bool between;
	uint64_t step;
	while ((step = ob_frame_clock_step(&later, &between)) <= now)
		later.next++;
	if (step == UINT64_MAX)
		return UINT64_MAX;
	return between && step - 1 > now ? step - 1 : step;
}

enum { SINKS_MAX = 3 };

struct ob_capture {
	ob_frame_clock clock;
	ob_frames_request request;
	uint64_t first; // frame that is drawn
	ob_renderer *renderer;
	ob_camera_def camera;
	const char *title; // the scene's, for the caption; NULL = none
	int width, height;
	ob_sink *sink[SINKS_MAX];
	int sinks;
	int raw_fd; // -1 = none
	char raw_name[300]; // for errors
	uint8_t *rgba;
	ob_host *host; // NULL = none to trace
	const ob_universe *universe; // of the places; NULL = none
	ob_worker_place *place; // [workers]
	uint32_t workers;
	ob_worker_strip *strip; // NULL: none
};

static bool add(ob_capture *c, ob_sink *s)
{
	if (s)
		c->sink[c->sinks++] = s;
	return s != NULL;
}

static bool open_sinks(ob_capture *c, const ob_frames_request *f, ob_error *e)
{
	if (f->dir && !add(c, ob_sink_png(f->dir, f->width, f->height, c->first, e)))
		return false;
	if (f->video && !add(c, ob_sink_video(f->video, f->width, f->height, f->fps, e)))
		return false;
	if (!f->raw)
		return true;
	if (strcmp(f->raw, "-") == 0)
		c->raw_fd = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
	else
		c->raw_fd = open(f->raw, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
	if (c->raw_fd < 0)
		return ob_fail(e, "--out %s: %s", f->raw, strerror(errno));
	snprintf(c->raw_name, sizeof c->raw_name, "--out %s", f->raw);
	return add(c, ob_sink_raw(c->raw_fd, c->raw_name, f->width, f->height, e));
}

static const ob_camera_def *find_camera(const ob_scene *s, const char *name)
{
	for (uint32_t i = 0; name && i < s->cameras; i++) {
		if (strcmp(s->camera[i].name, name) == 0)
			return &s->camera[i];
	}
	return &s->camera[0];
}

static bool find_workers(ob_capture *c, const ob_universe *u, ob_error *e)
{
	c->universe = u;
	c->workers = ob_universe_simulators(u);
	c->place = calloc(c->workers, sizeof *c->place);
	return c->place || ob_fail(e, "out of memory");
}

ob_capture *ob_capture_open(const ob_frames_request *f, const ob_scene *scene, double duration, double step,
			    uint64_t first, const ob_universe *u, ob_error *e)
{
	ob_capture *c = calloc(1, sizeof *c);
	if (!c) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	c->request = *f;
	c->clock = f->stills ? ob_frame_clock_of_stills(c->request.still, f->stills, step, first)
			     : ob_frame_clock_make(duration, f->fps, step, first);
	c->first = c->clock.next;
	c->camera = *find_camera(scene, f->camera);
	c->title = f->caption ? scene->title : NULL;
	c->width = f->width;
	c->height = f->height;
	c->raw_fd = -1;
	bool fine = !u || f->colour_by == OB_COLOUR_OWN || find_workers(c, u, e);
	if (fine && f->simulators) {
		c->strip = worker_strip_create(u, e);
		fine = c->strip;
	}
	if (!fine) {
		ob_capture_close(c, NULL);
		return NULL;
	}
	ob_render_setup setup = {
		.colouring = { f->colour_by, c->place, c->workers },
		.width = f->width,
		.height = f->height,
		.quality = f->quality,
		.samples = f->samples,
		.device = f->gpu,
		.overlay_aabb = f->aabb,
		.overlay_joints = f->joints,
		.overlay_contacts = f->contacts,
		.overlay_reads = f->reads,
		.reader = f->reader,
		.mesh = scene->mesh,
		.meshes = scene->meshes,
	};
	c->rgba = malloc((size_t)f->width * (size_t)f->height * 4);
	if (!c->rgba)
		ob_fail(e, "out of memory for a frame of %d x %d", f->width, f->height);
	else
		c->renderer = ob_renderer_create(&setup, &scene->look, e);
	if (!c->renderer || !open_sinks(c, f, e)) {
		ob_capture_close(c, NULL);
		return NULL;
	}
	return c;
}

void ob_capture_trace(ob_capture *c, ob_host *host)
{
	c->host = host;
}

static void trace(const ob_capture *c, ob_trace_kind kind, uint64_t begin)
{
	if (c->host)
		ob_host_trace(c->host, kind, begin, (uint32_t)c->clock.next);
}

uint64_t ob_capture_need(const ob_capture *c, uint64_t now)
{
	return ob_frame_clock_need(&c->clock, now);
}
uint64_t ob_capture_frames(const ob_capture *c)
{
	return c->clock.next - c->first;
}

// Places of workers now: a restarted one has another process.
static void locate_workers(const ob_capture *c)
{
	ob_worker_info info;
	for (uint32_t i = 0; i < c->workers; i++)
		c->place[i] = (ob_worker_place){ .pid = ob_universe_get_worker(c->universe, i, &info) ? info.pid : 0,
						 .rank = ob_universe_rank_of(c->universe, i) };
}

bool ob_capture_show(ob_capture *c, const ob_snapshot *prev, const ob_snapshot *now, ob_error *e)
{
	bool between;
	while (ob_frame_clock_step(&c->clock, &between) <= now->step) {
		double t = ob_frame_clock_time(&c->clock);
		const ob_snapshot *from = between ? prev : NULL;
		uint64_t begin = ob_clock_ns();
		locate_workers(c);
		if (!ob_renderer_draw(c->renderer, from, now, between ? t : now->time, &c->camera, c->rgba, e))
			return false;
		if (c->title) {
			char time[32];
			snprintf(time, sizeof time, "%.2f s", t);
			if (!ob_caption(c->rgba, c->width, c->height, c->title, time, e))
				return false;
		}
		if (c->strip && !worker_strip_paint(c->strip, now, c->rgba, c->width, c->height, e))
			return false;
		trace(c, OB_TRACE_DRAW, begin);
		begin = ob_clock_ns();
		for (int i = 0; i < c->sinks; i++) {
			if (!ob_sink_put(c->sink[i], c->clock.next, t, c->rgba, e))
				return false;
		}
		trace(c, OB_TRACE_ENCODE, begin);
		c->clock.next++;
	}
	return true;
}

bool ob_capture_close(ob_capture *c, ob_error *e)
{
	bool fine = true;
	if (!c)
		return true;
	for (int i = 0; i < c->sinks; i++)
		fine &= ob_sink_close(c->sink[i], fine ? e : NULL);
	if (c->raw_fd >= 0 && close(c->raw_fd) != 0 && fine)
		fine = ob_fail(e, "%s: %s", c->raw_name, strerror(errno));
	ob_renderer_destroy(c->renderer);
	worker_strip_destroy(c->strip);
	free(c->place);
	free(c->rgba);
	free(c);
	return fine;
}

#include "cli/strip.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "render/caption.h"
#include "table/free.h"
#include "table/table.h"

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

ob_worker_strip *ob_worker_strip_create(const ob_universe *u, ob_error *e)
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
		ob_worker_strip_destroy(s);
		ob_fail(e, "out of memory");
		return NULL;
	}
	s->strip = (ob_strip){ .row = s->row, .place = s->place, .tick = { "0", "1 ms", "10 ms", ".1 s", "1 s" } };
	return s;
}

void ob_worker_strip_destroy(ob_worker_strip *s)
{
	if (!s)
		return;
	free(s->worker);
	free(s->order);
	free(s);
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

bool ob_worker_strip_paint(ob_worker_strip *s, const ob_snapshot *now, uint8_t *rgba, int width, int height,
			   ob_error *e)
{
	look_at_workers(s);
	fill_rows(s, now);
	fill_places(s, now);
	return ob_caption_strip(rgba, width, height, &s->strip, e);
}

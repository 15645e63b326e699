#include "base/allocate.h"
#include "cli/top.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <ob/motion.h>

#include "base/clock.h"
#include "table/free.h"

// Makes room for n records of the given size, the new ones zeroed.
static bool grow(void **records, uint32_t *room, uint32_t n, size_t size)
{
	if (n <= *room)
		return true;
	if (!ob_grow(records, *room, n, size))
		return false;
	*room = n;
	return true;
}

void ob_top_watch(ob_top_sample *s, const ob_universe *u)
{
	double at = ob_clock_wall();
	for (uint32_t i = 0; i < s->workers; i++) {
		ob_top_worker *w = &s->worker[i];
		uint64_t before = w->info.cpu_ns;
		if (!ob_universe_get_worker(u, i, &w->info) || w->info.cpu_ns == before)
			continue;
		if (w->seen_at == 0) {
			w->mark_ns = w->info.cpu_ns;
			w->mark_at = at;
		}
		w->seen_at = at;
	}
}

// The rates since the last marks, which then move up.
static void rate_workers(ob_top_sample *s)
{
	for (uint32_t i = 0; i < s->workers; i++) {
		ob_top_worker *w = &s->worker[i];
		double span = w->seen_at - w->mark_at;
		if (w->seen_at > 0 && span > 0) {
			w->share = 1e-9 * (double)(w->info.cpu_ns - w->mark_ns) / span;
			w->mark_ns = w->info.cpu_ns;
			w->mark_at = w->seen_at;
		} else if (s->at - w->seen_at > 1.5) {
			// no refresh for long: it stands still
			w->share = w->seen_at > 0 ? 0 : NAN;
		}
	}
}

static void look_at_object(ob_top_object *o, const ob_universe *u, uint32_t id, double now)
{
	o->id = id;
	o->housed = ob_universe_get_home(u, id, &o->home);
	o->waits = ob_free_settings_of(u) && ob_free_blocker(u, id, &o->blocker);
	o->moving = ob_universe_get_motion(u, id, &o->motion);
	if (!o->moving)
		return;
	const ob_motion *m = &o->motion;
	double t = fmax(m->t0, fmin(now, m->valid_until));
	ob_state state = ob_motion_at(m, o->passport.inertia, t);
	o->position = state.pose.p;
	o->speed = ob_norm(state.v);
	o->spin = ob_norm(state.w);
}

static bool look_at_objects(ob_top_sample *s, const ob_universe *u)
{
	s->objects = 0;
	for (uint32_t id = 0; id < s->info.capacity; id++) {
		ob_passport p;
		if (!ob_universe_get_passport(u, id, &p))
			continue;
		void *records = s->object;
		if (s->objects == s->object_room &&
		    !grow(&records, &s->object_room, 2 * s->object_room + 64, sizeof *s->object))
			return false;
		s->object = records;
		s->object[s->objects].passport = p;
		look_at_object(&s->object[s->objects++], u, id, s->info.time);
	}
	return true;
}

static bool look_at_workers(ob_top_sample *s, const ob_universe *u)
{
	void *records = s->worker;
	uint32_t known = s->workers;
	bool fine = grow(&records, &s->worker_room, s->info.workers, sizeof *s->worker);
	s->worker = records;
	if (!fine)
		return false;
	s->workers = s->info.workers;
	for (uint32_t i = known; i < s->workers; i++) {
		s->worker[i] = (ob_top_worker){ .share = NAN };
		// its CPU time until now is no refresh that was seen to come
		ob_universe_get_worker(u, i, &s->worker[i].info);
	}
	ob_top_watch(s, u);
	rate_workers(s);
	return true;
}

bool ob_top_look(ob_top_sample *s, const ob_universe *u)
{
	double at = ob_clock_wall(), span = at - s->at, time = s->info.time;
	uint64_t step = s->info.step;
	bool first = s->at == 0;
	ob_universe_get_info(u, &s->info);
	s->at = at;
	s->alive = ob_universe_is_hosted(u);
	s->steps_per_second = first ? NAN : (double)(s->info.step - step) / span;
	s->pace = first ? NAN : (s->info.time - time) / span;
	return look_at_workers(s, u) && look_at_objects(s, u);
}

void ob_top_finish(ob_top_sample *s)
{
	free(s->worker);
	free(s->object);
	*s = (ob_top_sample){ 0 };
}

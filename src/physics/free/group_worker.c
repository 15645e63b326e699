// A worker of a free run solved in groups: it steps its world (world.h) whenever no body outside could touch one of its own before
// the step's end (groups.h).
//
//   all groups of its bodies are its own, and at one step     step
//   a group has a body that is behind                         wait for the worker of that
//   a group has bodies of other workers, all at this step     all go to the worker that has the lowest id
//   a group has come apart                                    back to the worker of its lowest id, if that is as far
//
// The earliest of all bodies is behind none, and its group goes to one worker, so somebody always goes on.
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "free/group_worker.h"
#include "free/groups.h"
#include "free/world.h"

typedef struct group_worker {
	ob_universe *u;
	uint32_t worker, until, entered, word;
	uint32_t blocker; // worker that it says to wait for; OB_NO_WORKER: none
	uint32_t looked, clear; // no group was mixed at the step of the last look, until this one
	uint32_t span, shorts; // steps that the last look was for; looks for one step until it tries more
	ob_group_world world;
	ob_groups groups;
	uint32_t *listed, lists; // [capacity] the list that each body was in last; number of lists so far
	uint32_t *come, comes; // [capacity] bodies that come to the world, or go
} group_worker;

static bool is_mine(const group_worker *w, const ob_group_place *p)
{
	return p->worker == w->worker;
}

// Parks all bodies of the world, for this worker.
static void park_all(group_worker *w)
{
	w->comes = w->world.n;
	memcpy(w->come, w->world.held, w->world.n * sizeof *w->come);
	ob_group_world_park(&w->world, w->come, w->comes, w->worker);
}

// Lists the bodies that are parked for the worker at a step.
static void list_parked(group_worker *w, uint32_t step)
{
	w->comes = 0;
	for (uint32_t i = 0; i < w->groups.n; i++) {
		const ob_group_place p = ob_group_place_of(w->u, w->groups.body[i].id);
		if (is_mine(w, &p) && !p.held && p.step == step)
			w->come[w->comes++] = w->groups.body[i].id;
	}
}

// Takes over changes by the host, while all wait: with all bodies of the worker in its world, so that those that touched one that
// has gone are woken. A body that has come in the place of another is not taken in with it.
static bool adopt(group_worker *w, bool first)
{
	if (!first) {
		list_parked(w, w->until);
		uint32_t known = 0;
		for (uint32_t i = 0; i < w->comes; i++)
			if (ob_group_world_knows(&w->world, w->come[i]))
				w->come[known++] = w->come[i];
		ob_group_world_take(&w->world, w->come, known);
	}
	ob_group_world_adopt(&w->world);
	w->clear = 0;
	return ob_groups_list(&w->groups, w->u);
}

// A predecessor may have held bodies: they are parked where it left them.
static bool begin(group_worker *w, ob_universe *u, uint32_t number, ob_error *e)
{
	*w = (group_worker){ .u = u,
			     .worker = number,
			     .entered = ob_free_entered(u),
			     .until = ob_free_until(u),
			     .span = 1,
			     .blocker = OB_NO_WORKER };
	w->come = calloc(ob_universe_capacity(u), sizeof *w->come);
	w->listed = calloc(ob_universe_capacity(u), sizeof *w->listed);
	if (!w->come || !w->listed || !ob_group_world_begin(&w->world, u, number, e))
		return false;
	const uint32_t made = ob_group_made(u, number);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		const ob_group_place p = ob_group_place_of(u, id);
		if (is_mine(w, &p) && p.held)
			ob_group_park(u, id, p, number, made);
	}
	ob_group_make(u, number, OB_GROUP_EMPTY, 0);
	return adopt(w, true);
}

static void finish(group_worker *w)
{
	ob_group_world_finish(&w->world);
	ob_groups_finish(&w->groups);
	free(w->come);
	free(w->listed);
}

// Own time of the worker's earliest body, in steps; UINT32_MAX: it has none.
static uint32_t earliest(const group_worker *w)
{
	uint32_t least = w->world.n ? w->world.step : UINT32_MAX;
	for (uint32_t i = 0; i < w->groups.n; i++) {
		const ob_group_place p = ob_group_place_of(w->u, w->groups.body[i].id);
		if (is_mine(w, &p) && !p.held && p.step < least)
			least = p.step;
	}
	return least;
}

// Sleeps until the host lets it go beyond this step, or another worker gives it a body.
static void idle(group_worker *w, uint32_t step)
{
	const double next = step == UINT32_MAX ? INFINITY : step * ob_universe_settings(w->u)->step_length;
	ob_free_idle(w->u, w->worker, w->word, w->until, next, UINT64_MAX);
}

// Waits for another worker, unless something has come from it since it was said that this one waits.
static void wait_for(group_worker *w, uint32_t other)
{
	if (w->blocker != other) {
		w->blocker = other;
		ob_group_await(w->u, w->worker, other);
		if (!ob_groups_are_barred(&w->groups))
			return;
	}
	ob_group_wait(w->u, w->worker, w->word);
	w->blocker = OB_NO_WORKER;
}

static void list(group_worker *w, uint32_t id)
{
	if (w->listed[id] != w->lists) {
		w->listed[id] = w->lists;
		w->come[w->comes++] = id;
	}
}

// Lists the bodies of a group that the worker's world holds, then those that pairs link to them: a pair outlasts the overlap of its
// boxes for a while, and has to stay in one world. Returns the number of the former.
static uint32_t list_linked(group_worker *w, uint32_t root)
{
	w->comes = 0;
	w->lists++;
	for (uint32_t k = 0; k < w->groups.considered; k++) {
		const uint32_t i = w->groups.order[k], id = w->groups.body[i].id;
		if (ob_groups_root(&w->groups, i) == root && ob_group_world_has(&w->world, id))
			list(w, id);
	}
	const uint32_t own = w->comes;
	for (uint32_t i = 0, n; i < w->comes; i++) {
		const uint32_t *other = ob_group_world_neighbours(&w->world, w->come[i], &n);
		for (uint32_t k = 0; k < n; k++)
			list(w, other[k]);
	}
	return own;
}

// Gives the worker's bodies of a group to another worker, at this step, those of its own last: it takes them when it has all. They
// are those that it had when it looked: since then others may have come to it, at steps of their own.
static void give(group_worker *w, uint32_t root, uint32_t to, uint32_t step)
{
	list_linked(w, root);
	for (uint32_t i = 0; i < w->comes / 2; i++) {
		const uint32_t id = w->come[i];
		w->come[i] = w->come[w->comes - 1 - i];
		w->come[w->comes - 1 - i] = id;
	}
	ob_group_world_park(&w->world, w->come, w->comes, to);
	for (uint32_t k = 0; k < w->groups.considered; k++) {
		const uint32_t i = w->groups.order[k];
		const ob_group_body *b = &w->groups.body[i];
		if (ob_groups_root(&w->groups, i) != root || !is_mine(w, &b->place) || b->place.held)
			continue;
		ob_group_world_chance(&w->world);
		ob_group_park(w->u, b->id, b->place, to, step);
	}
	ob_group_notify(w->u, w->worker, to);
}

// Worker that is to have a group of this worker's bodies alone; itself: no other.
static uint32_t home_of(group_worker *w, uint32_t root, uint32_t step)
{
	const uint32_t home = ob_free_worker_of(w->u, w->groups.body[root].id), made = ob_group_made(w->u, home);
	return home != w->worker && (made == step || made == OB_GROUP_EMPTY) && list_linked(w, root) == w->comes
		       ? home
		       : w->worker;
}

// Worker that is to step a group whose bodies are all at this step.
static uint32_t worker_for(group_worker *w, uint32_t root, uint32_t step)
{
	const ob_group_body *b = &w->groups.body[root];
	return b->other == OB_NO_WORKER ? home_of(w, root, step) : b->place.worker;
}

// Looks at the groups of the worker's bodies until a step's end, as found, and gives some away. Returns OB_NO_WORKER if all may step;
// the worker itself if some have gone to another; else another worker to wait for.
static uint32_t look_at_groups(group_worker *w, uint32_t step)
{
	uint32_t blocker = OB_NO_WORKER;
	bool gave = false;
	ob_group_world_chance(&w->world);
	for (uint32_t i = 0; i < w->groups.n; i++) {
		const ob_group_body *b = &w->groups.body[i];
		if (b->step > step || w->groups.ball[i].parent != i || !b->mine)
			continue;
		const uint32_t to = worker_for(w, i, step); // none is behind, else the search would have ended there
		if (to != w->worker) {
			give(w, i, to, step);
			gave = true;
		} else if (b->other != OB_NO_WORKER) {
			blocker = b->other;
		}
	}
	return gave ? w->worker : blocker;
}

// Sleeps until a step is due by the clock. false: it is.
static bool wait_for_clock(group_worker *w, uint32_t step)
{
	const double most = .02;
	const uint64_t due = ob_free_due_ns(w->u, step * ob_universe_settings(w->u)->step_length), now = ob_clock_ns();
	if (now >= due)
		return false;
	nanosleep(&(struct timespec){ .tv_nsec = (long)(1e9 * ob_min(most, 1e-9 * (double)(due - now))) }, NULL);
	return true;
}

// Worker that the bodies have to wait for before they step; OB_NO_WORKER: none. One look serves for several steps if all groups are
// the worker's own until then and no body comes: for twice as many as the last, or, where that failed, for one, some times.
static uint32_t find_blocker(group_worker *w, uint32_t step)
{
	enum { MOST = 8, SHORT = 8 };
	const bool all = w->world.n + w->comes == w->groups.n;
	if (ob_universe_workers(w->u) == 1 || (w->comes == 0 && step >= w->looked && step < w->clear))
		return OB_NO_WORKER;
	uint32_t span = all ? MOST : w->shorts > 0 ? 1 : 2 * w->span < MOST ? 2 * w->span : MOST;
	ob_groups_find(&w->groups, w->worker, step, step + span);
	if (span > 1 && w->groups.barred) {
		w->shorts = SHORT;
		ob_groups_find(&w->groups, w->worker, step, step + (span = 1));
	}
	const uint32_t blocker = w->groups.barred ? w->groups.behind->place.worker : look_at_groups(w, step);
	if (blocker != OB_NO_WORKER)
		return blocker;
	w->shorts -= w->shorts > 0;
	w->looked = step, w->clear = step + span, w->span = span;
	return OB_NO_WORKER;
}

static bool work(group_worker *w)
{
	const uint32_t step = earliest(w);
	if (w->world.n && step < w->world.step)
		park_all(w);
	if (step >= w->until) {
		idle(w, step);
		return true;
	}
	if (wait_for_clock(w, step))
		return true;
	list_parked(w, step);
	const uint32_t parked = w->comes, blocker = find_blocker(w, step);
	if (blocker == w->worker)
		return true;
	if (blocker != OB_NO_WORKER) {
		wait_for(w, blocker);
		return true;
	}
	if (w->blocker != OB_NO_WORKER)
		ob_group_await(w->u, w->worker, w->blocker = OB_NO_WORKER);
	list_parked(w, step); // looking at groups has listed others
	if (w->comes != parked) // which came after the look
		w->clear = 0;
	ob_group_world_take(&w->world, w->come, w->comes);
	return ob_group_world_step(&w->world);
}

bool ob_free_work_in_groups(ob_universe *u, uint32_t number, ob_error *e)
{
	group_worker w;
	bool fine = begin(&w, u, number, e);
	const bool begun = fine;
	while (fine && !ob_gate_stopped(u)) {
		w.word = ob_free_word(u, number); // before all else that it may have moved for
		const uint32_t until = ob_free_until(u), entered = ob_free_entered(u);
		if (entered != w.entered)
			fine = adopt(&w, false);
		w.until = until, w.entered = entered;
		fine = fine && work(&w);
	}
	while (begun && !ob_gate_stopped(u)) // the run has failed
		ob_free_idle(u, number, ob_free_word(u, number), w.until, INFINITY, UINT64_MAX);
	finish(&w);
	return begun;
}

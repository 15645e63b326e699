#include "free/neighbours.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"

static const double cover_steps = 8, cover_least = .02; // steps, and s, for which a fat AABB is meant to last
static const double cover_most = 1; // s, of a flight, which is to go as far as its radius in this time
static const double margin_share = .1, margin_most = .05; // of the radius; m: margin of a fat AABB

// The motion from the simulator's time on.
static ob_motion motion_now(const ob_free_sim *s)
{
	ob_motion m = s->motion;
	if (s->time <= m.t0)
		return m;
	const ob_state now = ob_motion_at(&m, s->passport.inertia, s->time);
	m.p = now.pose.p, m.q = now.pose.q, m.v = now.v, m.w = now.w;
	m.t0 = s->time;
	return m;
}

// Box that holds the object from some seconds before its own time, as it flies now, until some seconds afterwards.
static void swept_box(const ob_free_sim *s, const ob_motion *m, double before, double after, double margin,
		      double box[6])
{
	const double back[3] = { -m->v.x * before, -m->v.y * before, -m->v.z * before };
	ob_motion_swept_bounds(m, (ob_shape)s->passport.shape, s->passport.size, after, box);
	for (int c = 0; c < 3; c++) {
		box[c] += ob_min(0, back[c]) - margin;
		box[3 + c] += ob_max(0, back[c]) + margin;
	}
}

// Publishes a new fat AABB if the coming step may leave the present one. true: it did.
static bool renew_bounds(ob_free_sim *s, ob_free_scratch *x, double h)
{
	if (s->flies && s->time + h <= s->covered)
		return false;
	const double radius = ob_shape_radius((ob_shape)s->passport.shape, s->passport.size),
		     margin = ob_min(margin_most, margin_share * radius), lead = ob_free_lead(x->free, x->boundary);
	double box[6];
	bool fits = s->bounded && !s->flies; // a flight is to have a box for long
	const ob_motion now = motion_now(s);
	swept_box(s, &now, lead, lead + h, margin / 2, box);
	for (int c = 0; c < 3; c++)
		fits &= box[c] >= (double)s->bounds[c] && box[3 + c] <= (double)s->bounds[3 + c];
	if (fits) {
		s->covered = s->time + h;
		return false;
	}
	double cover = ob_max(cover_steps * h, cover_least);
	if (s->flies) {
		const double speed = ob_norm(now.v), falls = 2 * radius * ob_norm(now.a);
		cover = ob_max(cover, ob_min(cover_most, 2 * radius / (speed + sqrt(speed * speed + falls) + 1e-9)));
	}
	swept_box(s, &now, lead, lead + cover, margin, box);
	for (int c = 0; c < 3; c++) {
		s->bounds[c] = nextafterf((float)box[c], -FLT_MAX);
		s->bounds[3 + c] = nextafterf((float)box[3 + c], FLT_MAX);
	}
	s->bounded = true;
	s->covered = s->time + cover;
	ob_free_publish_bounds(x->u, s->id, s->bounds);
	return true;
}

static uint32_t find(const ob_free_sim *s, uint32_t id)
{
	uint32_t i = 0;
	while (i < s->neighbours && s->neighbour[i].id != id)
		i++;
	return i;
}

static void read_passport(ob_free_neighbour *n, const ob_universe *u)
{
	const double friction = n->passport.friction;
	n->passport_version = ob_universe_get_passport_version(u, n->id);
	ob_universe_get_passport(u, n->id, &n->passport);
	n->hull = ob_hull_of(u, &n->passport);
	if (n->passport.friction != friction) // the contact's impulses would go on without it
		n->contact.kept = 0;
}

static void add(ob_free_sim *s, ob_free_scratch *x, uint32_t id, ob_free_kind kind, uint32_t generation)
{
	if (s->neighbours == s->neighbours_max) {
		s->neighbours_max = 2 * s->neighbours_max + 8;
		s->neighbour = ob_reallocate(s->neighbour, s->neighbours_max * sizeof *s->neighbour);
	}
	ob_free_neighbour *n = &s->neighbour[s->neighbours++];
	*n = (ob_free_neighbour){ .id = id, .generation = generation, .kind = kind };
	read_passport(n, x->u);
	s->neighbours -= !ob_passport_collides(&s->passport, &n->passport);
	s->relisted = true;
}

static bool is_there(const ob_free_neighbour *n, const ob_universe *u)
{
	uint32_t generation;
	return ob_free_kind_of(u, n->id, &generation) != OB_FREE_ABSENT && generation == n->generation;
}

// Reads body properties that the host has changed.
static void renew_passports(ob_free_sim *s, const ob_universe *u)
{
	for (uint32_t i = 0; i < s->neighbours; i++) {
		ob_free_neighbour *n = &s->neighbour[i];
		if (ob_universe_get_passport_version(u, n->id) != n->passport_version && is_there(n, u))
			read_passport(n, u);
	}
}

// Drops neighbours that are gone or far.
static void drop_far(ob_free_sim *s, const ob_free_scratch *x)
{
	for (uint32_t i = s->neighbours; i-- > 0;) {
		const ob_free_neighbour *n = &s->neighbour[i];
		if (is_there(n, x->u) && ob_free_overlaps(x->u, n->id, s->bounds))
			continue;
		s->neighbour[i] = s->neighbour[--s->neighbours];
		s->relisted = true;
	}
}

// Adds an object to the neighbours if it is near, and not there yet.
static void consider(ob_free_sim *s, ob_free_scratch *x, uint32_t id)
{
	uint32_t generation;
	if (id == s->id || !ob_free_overlaps(x->u, id, s->bounds) || find(s, id) < s->neighbours)
		return;
	const ob_free_kind kind = ob_free_kind_of(x->u, id, &generation);
	if (kind != OB_FREE_ABSENT)
		add(s, x, id, kind, generation);
}

// Looks at all boxes, or at those that the grid finds.
static void look_around(ob_free_sim *s, ob_free_scratch *x)
{
	const bool grid = x->boxes.box;
	const uint32_t n = grid ? ob_free_boxes_query(&x->boxes, s->bounds) : ob_universe_ids(x->u);
	for (uint32_t i = 0; i < n; i++)
		consider(s, x, grid ? x->boxes.found[i] : i);
}

static int sim_by_id(const void *id, const void *sim)
{
	const uint32_t a = *(const uint32_t *)id, b = ((const ob_free_sim *)sim)->id;
	return a < b ? -1 : a > b;
}

// Has those of the worker's simulators that an object is near consider it.
static void spread(ob_free_scratch *x, uint32_t id)
{
	const bool grid = x->boxes.box;
	const uint32_t n = grid ? ob_free_boxes_query(&x->boxes, x->boxes.box[id]) : x->sims;
	for (uint32_t i = 0; i < n; i++) {
		ob_free_sim *s = grid ? bsearch(&x->boxes.found[i], x->all, x->sims, sizeof *s, sim_by_id) : &x->all[i];
		if (s && s->present && s->bounded)
			consider(s, x, id);
	}
}

// Takes over changes of boxes for all simulators of the worker.
static void take_changes(ob_free_scratch *x)
{
	const uint32_t ids = ob_universe_ids(x->u);
	uint32_t changed[OB_FREE_GROUP];
	for (uint32_t g = 0; g * OB_FREE_GROUP < ids; g++) {
		if (ob_free_moved(x->u, g) == x->boxes.looked[g])
			continue;
		const uint32_t n = ob_free_boxes_look(&x->boxes, x->u, g, changed);
		for (uint32_t i = 0; i < n; i++)
			spread(x, changed[i]);
	}
}

static int by_id(const void *a, const void *b)
{
	const uint32_t x = ((const ob_free_neighbour *)a)->id, y = ((const ob_free_neighbour *)b)->id;
	return x < y ? -1 : x > y;
}

static void sort(ob_free_sim *s)
{
	if (s->neighbours)
		qsort(s->neighbour, s->neighbours, sizeof *s->neighbour, by_id);
}

// Takes the neighbours that the simulator found when the run was recorded.
static void replay(ob_free_sim *s, ob_free_scratch *x)
{
	const uint32_t *id;
	uint32_t n, generation;
	if (!ob_free_schedule_neighbours(x->schedule, &id, &n))
		return;
	for (uint32_t i = s->neighbours; i-- > 0;) {
		bool found = false;
		for (uint32_t k = 0; k < n; k++)
			found |= id[k] == s->neighbour[i].id;
		if (!found || !is_there(&s->neighbour[i], x->u))
			s->neighbour[i] = s->neighbour[--s->neighbours];
	}
	for (uint32_t k = 0; k < n; k++)
		if (find(s, id[k]) == s->neighbours) {
			const ob_free_kind kind = ob_free_kind_of(x->u, id[k], &generation);
			if (kind == OB_FREE_ABSENT)
				ob_free_schedule_refuse(x->schedule);
			else
				add(s, x, id[k], kind, generation);
		}
	sort(s);
}

void ob_free_neighbours_update(ob_free_sim *s, ob_free_scratch *x, double h)
{
	const bool renewed = renew_bounds(s, x, h);
	renew_passports(s, x->u);
	if (ob_free_schedule_replays(x->schedule)) {
		replay(s, x);
		return;
	}
	take_changes(x);
	if (renewed)
		look_around(s, x);
	drop_far(s, x);
	if (!s->relisted)
		return;
	s->relisted = false;
	sort(s);
	if (!x->schedule)
		return;
	ob_free_schedule_note_neighbour(x->schedule, OB_NO_OBJECT);
	for (uint32_t i = 0; i < s->neighbours; i++)
		ob_free_schedule_note_neighbour(x->schedule, s->neighbour[i].id);
}

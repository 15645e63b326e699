#include "free/groups.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "motion/flight.h"
#include "shape/shape.h"
#include "solver/solver.h"

static const double margin =
	.02; // of the radius: bodies that are pushed apart, and such as a forecast takes to be touching
static const double margin_least = 5e-4; // m, likewise, at the default tolerance

uint32_t ob_groups_root(ob_groups *g, uint32_t i)
{
	while (g->ball[i].parent != i) {
		g->ball[i].parent = g->ball[g->ball[i].parent].parent;
		i = g->ball[i].parent;
	}
	return i;
}

// Reads what a body has that does not change.
static void describe(ob_groups *g, ob_group_body *b, const ob_passport *p)
{
	const ob_run_settings *run = ob_universe_settings(g->u);
	b->mass = p->mass;
	b->radius = (1 + margin) * ob_shape_radius((ob_shape)p->shape, p->size) +
		    margin_least * ob_run_settings_units(run).length;
	b->pull2 = p->mass * ob_norm2(ob_external_acceleration(run, p));
}

bool ob_groups_list(ob_groups *g, ob_universe *u)
{
	const uint32_t capacity = ob_universe_capacity(u), ids = ob_universe_ids(u);
	g->u = u;
	if (!g->body) {
		for (g->buckets = 64; g->buckets < 2 * capacity;)
			g->buckets *= 2;
		g->body = calloc(capacity, sizeof *g->body);
		g->ball = calloc(capacity, sizeof *g->ball);
		g->order = calloc(capacity, sizeof *g->order);
		g->next = calloc(capacity, sizeof *g->next);
		g->head = calloc(g->buckets, sizeof *g->head);
	}
	if (!g->body || !g->ball || !g->order || !g->next || !g->head)
		return false;
	g->n = 0;
	g->one = false;
	for (uint32_t id = 0; id < ids; id++) {
		ob_passport p;
		const ob_free_kind kind = ob_free_kind_of(u, id, NULL);
		if (kind == OB_FREE_ABSENT || !ob_universe_get_passport(u, id, &p))
			continue;
		if (kind == OB_FREE_PRESCRIBED)
			g->one |= p.flags & OB_OBJECT_KINEMATIC || ob_norm2(p.surface_velocity) > 0;
		else
			describe(g, &g->body[g->n], &p), g->body[g->n].version = 0, g->order[g->n] = g->n,
							 g->body[g->n++].id = id;
	}
	return true;
}

void ob_groups_finish(ob_groups *g)
{
	free(g->body);
	free(g->ball);
	free(g->order);
	free(g->next);
	free(g->head);
}

// Reads a body's state at its own time. Its motion is read again if there is a newer one.
static void look(ob_groups *g, ob_group_body *b, ob_group_ball *ball)
{
	const double h = ob_universe_settings(g->u)->step_length;
	for (;;) {
		b->place = ob_group_place_of(g->u, b->id);
		b->step = ob_group_step(g->u, b->id);
		if (b->version && b->version == ob_free_version(g->u, b->id))
			break;
		b->version = ob_group_read(g->u, b->id, b->step, &b->motion, ball->bounds);
		if (b->version)
			break;
	}
	const ob_passport *p = ob_passport_of(g->u, b->id);
	const double t = b->step * h;
	const bool stands = ob_published_stands(&b->motion, p, t);
	const ob_vec3 v = stands ? b->motion.v : ob_velocity_at(&b->motion, t);
	const ob_vec3 centre = stands ? b->motion.p : ob_centre_at(&b->motion, t);
	ball->at[0] = centre.x, ball->at[1] = centre.y, ball->at[2] = centre.z;
	b->norm2 = b->mass * ob_norm2(v) +
		   ob_max(p->inertia.x, ob_max(p->inertia.y, p->inertia.z)) * ob_norm2(b->motion.w);
}

// True if a group of the worker's bodies cannot step until the horizon.
static bool is_barred(const ob_groups *g, const ob_group_body *of)
{
	return of->mine && (of->behind || (g->alone && (of->other != OB_NO_WORKER || !of->even)));
}

static void join(ob_groups *g, uint32_t a, uint32_t b)
{
	const uint32_t low = a < b ? a : b, high = a < b ? b : a;
	ob_group_body *to = &g->body[low], *from = &g->body[high];
	g->ball[high].parent = low;
	g->count--;
	g->joined = true;
	to->group_norm2 += from->group_norm2;
	to->group_pull2 += from->group_pull2;
	to->least = from->least < to->least ? from->least : to->least;
	to->mine |= from->mine;
	to->even &= from->even;
	to->other = to->other != OB_NO_WORKER ? to->other : from->other;
	to->behind = to->behind ? to->behind : from->behind;
	if (is_barred(g, to))
		g->barred = true, g->behind = to->behind;
}

// ---- the grid: cells of the size of most bodies' boxes; larger ones are tested with all

static void find_reach(ob_groups *g, uint32_t i, uint32_t horizon)
{
	const double h = ob_universe_settings(g->u)->step_length;
	ob_group_body *b = &g->body[i];
	ob_group_ball *ball = &g->ball[i];
	const ob_group_body *of = &g->body[ob_groups_root(g, i)];
	const double t = (horizon - of->least) * h,
		     reach = b->radius +
			     (sqrt(of->group_norm2) * t + .5 * sqrt(of->group_pull2) * t * t) / sqrt(b->mass);
	ball->grown = reach > ball->reach;
	ball->reach = reach;
	for (int c = 0; c < 3; c++)
		b->half[c] = ob_max(reach, ob_max(ball->at[c] - ball->bounds[c], ball->bounds[3 + c] - ball->at[c]));
}

// Cell coordinate; the same for all that is farther away than the grid reaches.
static int32_t coordinate(double x)
{
	const double most = 1e9;
	return (int32_t)floor(ob_max(-most, ob_min(most, x)));
}

static uint32_t bucket_of(const ob_groups *g, const int32_t cell[3])
{
	uint64_t h = (uint32_t)cell[0] * UINT64_C(0x9e3779b97f4a7c15);
	h = (h ^ (uint32_t)cell[1]) * UINT64_C(0xc2b2ae3d27d4eb4f);
	h = (h ^ (uint32_t)cell[2]) * UINT64_C(0x165667b19e3779f9);
	return (uint32_t)(h >> 40) & (g->buckets - 1);
}

static bool is_large(const ob_groups *g, const ob_group_body *b)
{
	return !(b->half[0] <= g->half[0] && b->half[1] <= g->half[1] && b->half[2] <= g->half[2]);
}

// Cells are as long along each axis as boxes are, but for a few large ones: those of flights are long downwards.
static void fill_grid(ob_groups *g)
{
	static const double most = 3; // over the mean
	memset(g->head, 0, g->buckets * sizeof *g->head);
	g->large = 0;
	for (int c = 0; c < 3; c++) {
		double mean = 0, largest = 0;
		for (uint32_t k = 0; k < g->considered; k++) {
			mean += g->body[g->order[k]].half[c] / g->considered;
			largest = ob_max(largest, g->body[g->order[k]].half[c]);
		}
		g->half[c] = ob_min(largest, most * mean);
	}
	for (uint32_t k = 0; k < g->considered; k++) {
		const uint32_t i = g->order[k];
		ob_group_body *b = &g->body[i];
		if (is_large(g, b)) {
			g->next[i] = g->large;
			g->large = i + 1;
			continue;
		}
		for (int c = 0; c < 3; c++)
			b->cell[c] = coordinate(g->ball[i].at[c] / (2 * g->half[c]));
		uint32_t *head = &g->head[bucket_of(g, b->cell)];
		g->next[i] = *head;
		*head = i + 1;
	}
}

static bool boxes_overlap(const float *a, const float *b)
{
	return a[0] <= b[3] && b[0] <= a[3] && a[1] <= b[4] && b[1] <= a[4] && a[2] <= b[5] && b[2] <= a[5];
}

// Joins the groups of two bodies if their balls or boxes overlap.
static void test(ob_groups *g, uint32_t i, uint32_t k)
{
	const ob_group_ball *a = &g->ball[i], *b = &g->ball[k];
	const double far = a->reach + b->reach;
	double apart2 = 0; // m^2
	if (a->parent == b->parent)
		return;
	for (int c = 0; c < 3; c++)
		apart2 += (b->at[c] - a->at[c]) * (b->at[c] - a->at[c]);
	if (apart2 > far * far && !boxes_overlap(a->bounds, b->bounds))
		return;
	const uint32_t of_a = ob_groups_root(g, i), of_b = ob_groups_root(g, k);
	if (of_a != of_b)
		join(g, of_a, of_b);
}

// Tests a body with those near it.
static void test_near(ob_groups *g, uint32_t i)
{
	const ob_group_body *b = &g->body[i];
	if (is_large(g, b)) {
		for (uint32_t k = 0; k < g->considered; k++)
			test(g, i, g->order[k]);
		return;
	}
	int32_t cell[3];
	for (cell[0] = b->cell[0] - 1; cell[0] <= b->cell[0] + 1; cell[0]++)
		for (cell[1] = b->cell[1] - 1; cell[1] <= b->cell[1] + 1; cell[1]++)
			for (cell[2] = b->cell[2] - 1; cell[2] <= b->cell[2] + 1; cell[2]++)
				for (uint32_t k = g->head[bucket_of(g, cell)]; k; k = g->next[k - 1])
					if (k - 1 < i || !g->ball[k - 1].grown)
						test(g, i, k - 1);
	for (uint32_t k = g->large; k; k = g->next[k - 1])
		test(g, i, k - 1);
}

// Joins groups whose balls overlap. Those of a larger group are larger, so what has grown is tested again.
static void join_overlapping(ob_groups *g, uint32_t horizon)
{
	do {
		g->joined = false;
		for (uint32_t k = 0; k < g->considered; k++)
			find_reach(g, g->order[k], horizon);
		fill_grid(g);
		for (uint32_t k = 0; k < g->considered && g->count > 1 && !g->barred; k++)
			if (g->ball[g->order[k]].grown)
				test_near(g, g->order[k]);
	} while (g->joined && g->count > 1 && !g->barred);
}

void ob_groups_find(ob_groups *g, uint32_t worker, uint32_t step, uint32_t horizon)
{
	uint32_t n = 0;
	for (uint32_t i = 0; i < g->n; i++) { // all are in order[], those considered first
		ob_group_body *b = &g->body[i];
		look(g, b, &g->ball[i]);
		g->ball[i].parent = i;
		g->ball[i].reach = 0;
		b->mine = b->place.worker == worker, b->even = b->step == step;
		b->other = b->mine ? OB_NO_WORKER : b->place.worker;
		b->behind = b->step < step ? b : NULL;
		b->group_norm2 = b->norm2, b->group_pull2 = b->pull2, b->least = b->step;
	}
	for (uint32_t k = 0; k < g->n; k++) {
		const uint32_t i = g->order[k];
		if (g->body[i].step >= horizon)
			continue;
		g->order[k] = g->order[n];
		g->order[n++] = i;
	}
	g->considered = g->count = n;
	g->alone = horizon > step + 1;
	g->barred = false, g->behind = NULL;
	for (uint32_t k = 1; g->one && k < n; k++)
		if (ob_groups_root(g, g->order[0]) != ob_groups_root(g, g->order[k]))
			join(g, ob_groups_root(g, g->order[0]), ob_groups_root(g, g->order[k]));
	join_overlapping(g, horizon);
}

bool ob_groups_are_barred(const ob_groups *g)
{
	const ob_group_body *b = g->behind;
	if (!g->barred || !b)
		return false;
	const ob_group_place now = ob_group_place_of(g->u, b->id);
	return now.worker == b->place.worker && now.held == b->place.held && ob_group_step(g->u, b->id) == b->step;
}

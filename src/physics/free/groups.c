#include "free/groups.h"

#include <math.h>
#include <stdlib.h>

#include "base/allocate.h"
#include "motion/flight.h"
#include "shape/shape.h"
#include "solver/solver.h"

static const double margin =
	.02; // of the radius: bodies that are pushed apart, and such as a forecast takes to be touching
static const double margin_least = 5e-4; // m, likewise, at the default tolerance

uint32_t ob_groups_root(ob_groups *g, uint32_t i)
{
	while (g->body[i].parent != i) {
		g->body[i].parent = g->body[g->body[i].parent].parent;
		i = g->body[i].parent;
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
		g->body = calloc(capacity, sizeof *g->body);
		g->order = calloc(capacity, sizeof *g->order);
	}
	if (!g->body || !g->order)
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
	free(g->order);
}

// Reads a body's state at its own time. Its motion is read again if there is a newer one.
static void look(ob_groups *g, ob_group_body *b)
{
	const double h = ob_universe_settings(g->u)->step_length;
	for (;;) {
		b->place = ob_group_place_of(g->u, b->id);
		b->step = ob_group_step(g->u, b->id);
		if (b->version && b->version == ob_free_version(g->u, b->id))
			break;
		b->version = ob_group_read(g->u, b->id, b->step, &b->motion, b->bounds);
		if (b->version)
			break;
	}
	const ob_passport *p = ob_passport_of(g->u, b->id);
	const double t = b->step * h;
	const bool stands = ob_published_stands(&b->motion, p, t);
	const ob_vec3 v = stands ? b->motion.v : ob_velocity_at(&b->motion, t);
	b->p = stands ? b->motion.p : ob_centre_at(&b->motion, t);
	b->norm2 = b->mass * ob_norm2(v) +
		   ob_max(p->inertia.x, ob_max(p->inertia.y, p->inertia.z)) * ob_norm2(b->motion.w);
}

static void join(ob_groups *g, uint32_t a, uint32_t b)
{
	const uint32_t low = a < b ? a : b, high = a < b ? b : a;
	ob_group_body *to = &g->body[low], *from = &g->body[high];
	from->parent = low;
	to->group_norm2 += from->group_norm2;
	to->group_pull2 += from->group_pull2;
	to->least = from->least < to->least ? from->least : to->least;
}

static void find_reaches(ob_groups *g, uint32_t horizon)
{
	const double h = ob_universe_settings(g->u)->step_length;
	for (uint32_t k = 0; k < g->considered; k++) {
		ob_group_body *b = &g->body[g->order[k]];
		const ob_group_body *of = &g->body[ob_groups_root(g, g->order[k])];
		const double t = (horizon - of->least) * h;
		b->reach = b->radius + (sqrt(of->group_norm2) * t + .5 * sqrt(of->group_pull2) * t * t) / sqrt(b->mass);
	}
}

static double low_end(const ob_group_body *b)
{
	return ob_min(b->p.x - b->reach, b->bounds[0]);
}

static double high_end(const ob_group_body *b)
{
	return ob_max(b->p.x + b->reach, b->bounds[3]);
}

static bool boxes_overlap(const float *a, const float *b)
{
	return a[0] <= b[3] && b[0] <= a[3] && a[1] <= b[4] && b[1] <= a[4] && a[2] <= b[5] && b[2] <= a[5];
}

// Sorts by the low ends of balls; they were in that order a moment ago.
static void sort(ob_groups *g)
{
	for (uint32_t i = 1; i < g->considered; i++) {
		const uint32_t moved = g->order[i];
		const double low = low_end(&g->body[moved]);
		uint32_t at = i;
		for (; at > 0 && low_end(&g->body[g->order[at - 1]]) > low; at--)
			g->order[at] = g->order[at - 1];
		g->order[at] = moved;
	}
}

// Joins groups whose balls overlap. true: there were any.
static bool join_overlapping(ob_groups *g)
{
	bool any = false;
	for (uint32_t i = 0; i < g->considered; i++) {
		const ob_group_body *a = &g->body[g->order[i]];
		for (uint32_t k = i + 1; k < g->considered; k++) {
			const ob_group_body *b = &g->body[g->order[k]];
			const double far = a->reach + b->reach;
			if (low_end(b) > high_end(a))
				break;
			if (!boxes_overlap(a->bounds, b->bounds) && ob_norm2(ob_sub(b->p, a->p)) > far * far)
				continue;
			const uint32_t of_a = ob_groups_root(g, g->order[i]), of_b = ob_groups_root(g, g->order[k]);
			if (of_a == of_b)
				continue;
			join(g, of_a, of_b);
			any = true;
		}
	}
	return any;
}

void ob_groups_find(ob_groups *g, uint32_t worker, uint32_t step, uint32_t horizon)
{
	uint32_t n = 0;
	for (uint32_t i = 0; i < g->n; i++) { // all are in order[], those considered first
		ob_group_body *b = &g->body[i];
		look(g, b);
		b->parent = i;
		b->mine = false;
		b->other = b->behind = OB_NO_WORKER;
		b->group_norm2 = b->norm2, b->group_pull2 = b->pull2, b->least = b->step;
	}
	for (uint32_t k = 0; k < g->n; k++) {
		const uint32_t i = g->order[k];
		if (g->body[i].step > step)
			continue;
		g->order[k] = g->order[n];
		g->order[n++] = i;
	}
	g->considered = n;
	for (uint32_t k = 1; g->one && k < n; k++)
		if (ob_groups_root(g, g->order[0]) != ob_groups_root(g, g->order[k]))
			join(g, ob_groups_root(g, g->order[0]), ob_groups_root(g, g->order[k]));
	do {
		find_reaches(g, horizon);
		sort(g);
	} while (join_overlapping(g));
	for (uint32_t k = 0; k < n; k++) {
		const ob_group_body *b = &g->body[g->order[k]];
		ob_group_body *of = &g->body[ob_groups_root(g, g->order[k])];
		of->mine |= b->place.worker == worker;
		if (b->place.worker != worker)
			of->other = b->place.worker;
		if (b->step < step)
			of->behind = b->place.worker;
	}
}

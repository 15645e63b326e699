#include "sim/lane.h"

#include <stdlib.h>
#include <string.h>

enum { FULL = (1 << OB_LANES) - 1, NONE = UINT32_MAX };

// Batches with a free lane form a stack per colour and kind.
static void open_batch(ob_island_work *w, uint32_t batch)
{
	uint32_t *top = &w->open[w->batch_colour[batch]][w->batch[batch].kind];
	w->batch_open[batch] = *top;
	*top = batch;
}

static uint32_t add_batch(ob_island_work *w, uint32_t colour, ob_batch_kind kind)
{
	if (w->batches == w->batches_max) {
		w->batches_max = w->batches_max * 2 + 16;
		ob_batch *grown = aligned_alloc(64, w->batches_max * ((sizeof *grown + 63) / 64 * 64));
		if (w->batches)
			memcpy(grown, w->batch, w->batches * sizeof *grown);
		free(w->batch);
		w->batch = grown;
		w->batch_colour = realloc(w->batch_colour, w->batches_max * sizeof *w->batch_colour);
		w->batch_due = realloc(w->batch_due, w->batches_max * sizeof *w->batch_due);
		w->batch_order = realloc(w->batch_order, w->batches_max * sizeof *w->batch_order);
		w->batch_open = realloc(w->batch_open, w->batches_max * sizeof *w->batch_open);
	}
	ob_batch_init(&w->batch[w->batches], kind);
	w->batch_colour[w->batches] = colour;
	w->batch_due[w->batches] = 0;
	w->order_stale = true;
	if (colour < OB_COLOURS)
		open_batch(w, w->batches);
	return w->batches++;
}

// The first colour that neither body uses. Past the last colour each pair gets a batch of its own: a body with so many
// partners takes them one after the other.
static uint32_t free_colour(const ob_island_work *w, const ob_contact *t, bool jacobi)
{
	uint64_t used = w->member[t->a].colours | w->member[t->b].colours;
	if (jacobi)
		return 0;
	return used == UINT64_MAX ? OB_COLOURS : (uint32_t)__builtin_ctzll(~used);
}

// What stays true of a pair wherever its bodies are.
static ob_batch_kind kind_of(const ob_sim *s, const ob_contact *t)
{
	const ob_island_work *w = &s->island;
	bool boxed = ob_universe_settings(s->u)->narrow_phase == OB_NARROW_AABB; // a sphere's box has four points
	ob_shape a = w->member[t->a].shape, b = w->member[t->b].shape;
	bool point = (a == OB_SHAPE_SPHERE && (b == OB_SHAPE_SPHERE || b == OB_SHAPE_BOX || b == OB_SHAPE_PLANE)) ||
		     (b == OB_SHAPE_SPHERE && (a == OB_SHAPE_BOX || a == OB_SHAPE_PLANE));
	return (point && !boxed ? OB_KIND_POINT : OB_KIND_FULL) | (t->mu > 0 ? OB_KIND_FULL : OB_KIND_FRICTIONLESS);
}

void ob_lane_take(ob_sim *s, ob_contact *t)
{
	ob_island_work *w = &s->island;
	const ob_batch_kind kind = kind_of(s, t);
	uint32_t colour = free_colour(w, t, ob_universe_settings(s->u)->solver == OB_SOLVER_JACOBI), batch = NONE;
	if (colour < OB_COLOURS)
		batch = w->open[colour][kind];
	if (batch == NONE)
		batch = add_batch(w, colour, kind);
	unsigned live = w->batch[batch].live;
	uint32_t lane = (uint32_t)__builtin_ctz(~live);
	if (colour < OB_COLOURS && (live | 1u << lane) == FULL)
		w->open[colour][kind] = w->batch_open[batch]; // it is the top, and full now
	t->colour = colour;
	t->lane = batch * OB_LANES + lane;
	for (int side = 0; side < 2; side++) {
		ob_body *m = &w->member[side ? t->b : t->a];
		if (m->inv_mass > 0 && colour < OB_COLOURS)
			m->colours |= UINT64_C(1) << colour;
		m->contacts++;
		m->moved_freely = false;
	}
	w->counts_stale = true;
}

void ob_lane_leave(ob_island_work *w, ob_contact *t)
{
	ob_batch *b = &w->batch[t->lane / OB_LANES];
	bool was_full = b->live == FULL;
	ob_batch_clear(b, t->lane % OB_LANES);
	if (was_full && t->colour < OB_COLOURS)
		open_batch(w, t->lane / OB_LANES);
	for (int side = 0; side < 2; side++) {
		ob_body *m = &w->member[side ? t->b : t->a];
		if (t->colour < OB_COLOURS)
			m->colours &= ~(UINT64_C(1) << t->colour);
		m->contacts--;
	}
	t->lane = OB_NO_LANE;
	t->points = 0;
	w->counts_stale = true;
}

void ob_lane_fill(ob_island_work *w, const ob_contact *t, ob_vec3 normal, const double *gap)
{
	const ob_body *a = &w->member[t->a], *b = &w->member[t->b];
	ob_batch_lane lane = { t->a,  t->b, normal,      (int)t->points, t->arm_a,       t->arm_b,      gap,
			 t->mu, t->e, a->inv_mass, b->inv_mass,    a->inv_inertia, b->inv_inertia };
	ob_batch_set(&w->batch[t->lane / OB_LANES], t->lane % OB_LANES, &lane);
}

void ob_lane_save_impulses(ob_island_work *w, const ob_contact *t, ob_saved_impulses *old)
{
	const ob_batch *b = &w->batch[t->lane / OB_LANES];
	int l = t->lane % OB_LANES;
	for (int i = 0; i < OB_PAIR_ROWS; i++)
		old->impulse[i] = b->impulse[i][l];
	old->points = t->points;
	memcpy(old->arm, t->arm_a, sizeof old->arm);
	old->normal = ob_v3(b->n[0][l], b->n[1][l], b->n[2][l]);
	ob_vec3 t1 = ob_v3(b->t1[0][l], b->t1[1][l], b->t1[2][l]), t2 = ob_v3(b->t2[0][l], b->t2[1][l], b->t2[2][l]);
	old->friction = ob_add(ob_scale(t1, old->impulse[4]), ob_scale(t2, old->impulse[5]));
}

void ob_lane_warm_start(ob_island_work *w, const ob_contact *t, ob_saved_impulses *old)
{
	ob_batch *b = &w->batch[t->lane / OB_LANES];
	int l = t->lane % OB_LANES;
	const ob_body *ma = &w->member[t->a], *mb = &w->member[t->b];
	double thin = fmin(ma->thickness, mb->thickness), near = .04 * thin * thin + 1e-6;
	ob_vec3 n = ob_v3(b->n[0][l], b->n[1][l], b->n[2][l]), t1, t2;
	bool same = old->points && ob_dot(n, old->normal) > .9;
	bool sphere = ma->shape == OB_SHAPE_SPHERE || mb->shape == OB_SHAPE_SPHERE;
	for (uint32_t j = 0; j < OB_PAIR_POINTS; j++) {
		double best = sphere ? INFINITY : near;
		int found = -1;
		for (uint32_t k = 0; same && j < t->points && k < old->points; k++) {
			double apart = ob_norm2(ob_sub(t->arm_a[j], old->arm[k]));
			if (apart < best && old->impulse[k] >= 0)
				best = apart, found = (int)k;
		}
		b->impulse[j][l] = found >= 0 ? old->impulse[found] : 0;
		if (found >= 0)
			old->impulse[found] = -1; // taken
	}
	ob_tangents(n, &t1, &t2);
	b->impulse[4][l] = same ? ob_dot(old->friction, t1) : 0;
	b->impulse[5][l] = same ? ob_dot(old->friction, t2) : 0;
	b->impulse[6][l] = same ? old->impulse[6] : 0;
	for (int i = 0; i < OB_PAIR_ROWS; i++)
		b->impulse_start[i][l] = b->impulse[i][l];
}

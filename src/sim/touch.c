#include "sim/touch.h"

#include <stdlib.h>
#include <string.h>

#include "sim/broadphase.h"
#include "sim/ghost.h"
#include "sim/lane.h"
#include "sim/look.h"
#include "sim/members.h"

static const double look_again_share = 3; // of the tolerance, at most
static const double look_again = .003; // m: path after which a resting pair's geometry is looked at again

// m; corners that were no points of the contact come down by a share of the way that the bodies have made. Where many
// substeps did not do, that may be why.
static double patience(const ob_sim *s)
{
	double tolerance = ob_universe_settings(s->u)->tolerance;
	double share = look_again_share * fmin(1, 16. / s->island.substeps);
	return tolerance > 0 ? fmin(look_again, share * tolerance) : look_again;
}

static void refresh(ob_sim *s, ob_contact *t)
{
	ob_island_work *w = &s->island;
	ob_manifold m;
	double when;
	ob_saved_impulses old = { .points = 0 };
	ob_body_update_pose(w, t->a);
	ob_body_update_pose(w, t->b);
	const ob_body *a = &w->member[t->a], *b = &w->member[t->b];
	double tolerance = patience(s) * fmin(1, 2 * fmin(a->thickness, b->thickness)), path = a->path + b->path;
	ob_narrowphase_find(s, t, tolerance, &m, &when);
	if (!m.points) {
		t->limit = path + fmax(tolerance, m.separation - tolerance);
		if (t->lane != OB_NO_LANE)
			ob_lane_leave(w, t);
		return;
	}
	t->limit = path + tolerance;
	if (t->lane == OB_NO_LANE)
		ob_lane_take(s, t);
	else
		ob_lane_save_impulses(w, t, &old);
	ob_vec3 va = ob_v3(w->v[t->a][0], w->v[t->a][1], w->v[t->a][2]);
	ob_vec3 vb = ob_v3(w->v[t->b][0], w->v[t->b][1], w->v[t->b][2]);
	t->points = (uint32_t)m.points;
	for (int j = 0; j < m.points; j++) {
		t->arm_a[j] = ob_sub(m.at[j], ob_madd(a->p, when, va));
		t->arm_b[j] = ob_sub(m.at[j], ob_madd(b->p, when, vb));
	}
	ob_lane_fill(w, t, m.normal, m.gap);
	ob_lane_warm_start(w, t, &old);
}

// m/s, what the two may gain within the substep, on average over it. What touches is expected to go on as it did: at
// rest it gains nothing.
static double gain(const ob_island_work *w, const ob_contact *t)
{
	double free = w->pull * w->h;
	const double *a = w->dv[t->a], *b = w->dv[t->b];
	if (t->lane == OB_NO_LANE)
		return free;
	return fmin(free, .5 * (ob_norm(ob_v3(a[0], a[1], a[2])) + ob_norm(ob_v3(b[0], b[1], b[2]))));
}

bool ob_contacts_update(ob_sim *s, double ahead)
{
	bool any = false;
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->touches; i++) {
		ob_contact *t = &w->touch[i];
		const ob_body *a = &w->member[t->a], *b = &w->member[t->b];
		if (a->path + b->path + (a->speed + b->speed + gain(w, t)) * ahead > t->limit) {
			s->counters.narrowphase_tests++;
			refresh(s, t);
			any = true;
		}
	}
	return any;
}

// By colour, and by age within a colour.
static void order_batches(ob_island_work *w)
{
	uint32_t next[OB_COLOURS + 2] = { 0 }, colours = 0;
	for (uint32_t i = 0; i < w->batches; i++) {
		uint32_t c = w->batch_colour[i];
		next[c + 1]++;
		colours = c > colours ? c : colours;
	}
	for (uint32_t c = 0; c < colours; c++)
		next[c + 1] += next[c];
	for (uint32_t i = 0; i < w->batches; i++)
		w->batch_order[next[w->batch_colour[i]]++] = i;
	w->order_stale = false;
}

// Each lane learns how many contacts its bodies have.
static void count_contacts(const ob_island_work *w, ob_batch *b, bool jacobi)
{
	b->isolated = 0;
	for (int l = 0; l < OB_LANES; l++) {
		const ob_body *m[2] = { &w->member[b->body_a[l]], &w->member[b->body_b[l]] };
		bool alone =
			(m[0]->inv_mass == 0 || m[0]->contacts == 1) && (m[1]->inv_mass == 0 || m[1]->contacts == 1);
		b->isolated |= (unsigned)alone << l & b->live;
		if (jacobi) {
			b->ka[l] = fmax(1, m[0]->contacts);
			b->kb[l] = fmax(1, m[1]->contacts);
		}
	}
}

void ob_contacts_prepare(ob_sim *s)
{
	ob_island_work *w = &s->island;
	bool jacobi = ob_universe_settings(s->u)->solver == OB_SOLVER_JACOBI;
	if (w->order_stale)
		order_batches(w);
	for (uint32_t i = 0; i < w->batches; i++) {
		ob_batch *b = &w->batch[i];
		if (w->counts_stale)
			count_contacts(w, b, jacobi);
		if (b->dirty || (jacobi && w->counts_stale))
			ob_batch_prepare(b);
	}
	w->counts_stale = false;
}

// ---- between the universe and the island

// The pair's state before the step; NULL if it did not touch. What is solved again has overwritten what its key says.
static const ob_pair_state *touched_before(const ob_sim *s, const ob_pair_key *k)
{
	const ob_step_data *ex = ob_universe_step_data(s->u);
	if (k->record == OB_NO_RECORD || (!k->active && !ex->count->merged))
		return NULL;
	const ob_pair_state *p = ob_pair_before(&ex->record[k->record], ob_step_count(s->u));
	return p && p->points ? p : NULL;
}

static void load_touch(ob_sim *s, const ob_contact *from, const ob_pair_key *k)
{
	ob_island_work *w = &s->island;
	ob_contact *t = &w->touch[w->touches++];
	*t = *from;
	const ob_body *a = &w->member[t->a], *b = &w->member[t->b];
	t->mu = sqrt(a->friction * b->friction);
	t->e = fmax(a->restitution, b->restitution);
	w->elastic |= t->e > 0;
	const ob_pair_state *p = touched_before(s, k);
	if (!p)
		return;
	t->points = p->points;
	t->creep = p->creep;
	double gap[OB_PAIR_POINTS];
	for (uint32_t j = 0; j < OB_PAIR_POINTS; j++) {
		t->arm_a[j] = ob_v3(p->arm_a[j][0], p->arm_a[j][1], p->arm_a[j][2]);
		t->arm_b[j] = ob_sub(t->arm_a[j], p->between);
		gap[j] = p->gap[j];
	}
	ob_lane_take(s, t);
	ob_lane_fill(w, t, p->normal, gap);
	ob_batch *batch = &w->batch[t->lane / OB_LANES];
	const ob_step_data *ex = ob_universe_step_data(s->u);
	const double *impulse = t->mirror ? ex->impulse_b[k->record][p - ex->record[k->record].version] : p->impulse;
	for (int i = 0; i < OB_PAIR_ROWS; i++)
		batch->impulse[i][t->lane % OB_LANES] = batch->impulse_start[i][t->lane % OB_LANES] =
			impulse[i] * (w->h / p->substep);
}

// Each side for itself, on a ghost of the other.
static void load_apart(ob_sim *s, const ob_contact *t, const ob_pair_key *k)
{
	ob_contact own = *t, mirror = *t;
	own.b = ob_ghost_make(s, t->b);
	mirror.a = ob_ghost_make(s, t->a);
	mirror.mirror = true;
	load_touch(s, &own, k);
	load_touch(s, &mirror, k);
}

static void link_adjacent(ob_island_work *w)
{
	uint32_t total = 0;
	for (uint32_t i = 0; i < w->touches; i++) {
		w->member[w->touch[i].a].adjacent++;
		w->member[w->touch[i].b].adjacent++;
	}
	for (uint32_t r = 0; r < w->rows; r++) {
		w->member[r].first_adjacent = total;
		total += w->member[r].adjacent;
		w->member[r].adjacent = 0;
	}
	for (uint32_t i = 0; i < w->touches; i++)
		for (int side = 0; side < 2; side++) {
			ob_body *m = &w->member[side ? w->touch[i].b : w->touch[i].a];
			w->adjacency[m->first_adjacent + m->adjacent++] = i;
		}
}

void ob_contacts_load(ob_sim *s, const ob_island *is)
{
	ob_step_data *ex = ob_universe_step_data(s->u);
	ob_island_work *w = &s->island;
	uint32_t most = ob_ghosts_used(s) ? 2 * is->pairs : is->pairs;
	if (most > w->touches_max) {
		w->touches_max = most + most / 2;
		w->touch = realloc(w->touch, w->touches_max * sizeof *w->touch);
		w->adjacency = realloc(w->adjacency, 2 * w->touches_max * sizeof *w->adjacency);
	}
	w->touches = 0;
	w->batches = 0;
	memset(w->open, 0xff, sizeof w->open);
	w->order_stale = w->counts_stale = true;
	w->elastic = false;
	for (uint32_t i = 0; i < is->pairs; i++) {
		uint32_t key = ex->island_pair[is->first_pair + i];
		const ob_pair_key *k = &ex->pair[key];
		ob_contact t = {
			.key = key, .a = w->row_of[k->a], .b = w->row_of[k->b], .lane = OB_NO_LANE, .limit = k->limit
		};
		if (ob_ghosts_used(s) && t.a <= w->members && t.b <= w->members)
			load_apart(s, &t, k);
		else
			load_touch(s, &t, k);
	}
	link_adjacent(w);
}

// The lane's impulses, or zeros if it has none.
static void store_impulses(const ob_island_work *w, const ob_contact *t, double *impulse)
{
	for (int j = 0; j < OB_PAIR_ROWS; j++)
		impulse[j] = t->lane == OB_NO_LANE ? 0 : w->batch[t->lane / OB_LANES].impulse[j][t->lane % OB_LANES];
}

static void store_touch(const ob_island_work *w, const ob_contact *t, ob_pair_state *p)
{
	*p = (ob_pair_state){ .points = t->points, .substep = w->h, .creep = (float)t->creep };
	for (int j = 0; j < OB_PAIR_POINTS; j++) {
		p->arm_a[j][0] = (float)t->arm_a[j].x;
		p->arm_a[j][1] = (float)t->arm_a[j].y;
		p->arm_a[j][2] = (float)t->arm_a[j].z;
	}
	p->between = ob_sub(t->arm_a[0], t->arm_b[0]);
	store_impulses(w, t, p->impulse);
	if (t->lane == OB_NO_LANE)
		return;
	const ob_batch *b = &w->batch[t->lane / OB_LANES];
	int l = t->lane % OB_LANES;
	for (uint32_t j = 0; j < OB_PAIR_POINTS; j++)
		p->gap[j] = (float)b->gap[j][l];
	p->normal = ob_v3(b->n[0][l], b->n[1][l], b->n[2][l]);
}

void ob_contacts_store(ob_sim *s)
{
	ob_step_data *ex = ob_universe_step_data(s->u);
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->touches; i++) {
		const ob_contact *t = &w->touch[i], *mirror = i + 1 < w->touches && t[1].mirror ? t + 1 : NULL;
		ob_pair_key *k = &ex->pair[t->key];
		bool was_active = k->active || touched_before(s, k);
		k->limit = t->limit;
		k->active = t->lane != OB_NO_LANE;
		if (k->active || was_active) {
			if (k->record == OB_NO_RECORD)
				k->record = ob_record_take(s->u);
			ob_pair_record *record = &ex->record[k->record];
			ob_pair_state *p = ob_pair_write(record, ob_step_count(s->u));
			store_touch(w, t, p);
			if (mirror)
				store_impulses(w, mirror, ex->impulse_b[k->record][p - record->version]);
		}
		i += mirror != NULL;
	}
}

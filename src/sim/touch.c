#include "sim/touch.h"

#include <stdlib.h>
#include <string.h>

#include "contact/swept.h"
#include "ode/ode_collide.h"
#include "sim/members.h"
#include "sim/pairs.h"

static const double look_again = .003; // m: path after which a resting pair's geometry is looked at again
static const double swept_step = .4; // of the smaller thickness: faster pairs are followed through the substep
static const double swept_gap = 1e-3; // m: so near counts as meeting

// The shapes that contact/ does not know go to ODE.
static bool find_by_ode(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_ode_point point[8];
	ob_quat qa, qb;
	// dCollide wants quaternions; the rotation matrices are what moves here.
	const ob_mat3 *r[2] = { &a->r, &b->r };
	ob_quat *q[2] = { &qa, &qb };
	for (int i = 0; i < 2; i++) {
		const double(*m)[3] = r[i]->m;
		double w2 = 1 + m[0][0] + m[1][1] + m[2][2], x2 = 1 + m[0][0] - m[1][1] - m[2][2];
		double y2 = 1 - m[0][0] + m[1][1] - m[2][2], z2 = 1 - m[0][0] - m[1][1] + m[2][2];
		if (w2 >= x2 && w2 >= y2 && w2 >= z2)
			*q[i] = (ob_quat){ w2, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1] };
		else if (x2 >= y2 && x2 >= z2)
			*q[i] = (ob_quat){ m[2][1] - m[1][2], x2, m[0][1] + m[1][0], m[0][2] + m[2][0] };
		else if (y2 >= z2)
			*q[i] = (ob_quat){ m[0][2] - m[2][0], m[0][1] + m[1][0], y2, m[1][2] + m[2][1] };
		else
			*q[i] = (ob_quat){ m[1][0] - m[0][1], m[0][2] + m[2][0], m[1][2] + m[2][1], z2 };
		*q[i] = ob_quat_normalize(*q[i]);
	}
	int n = ob_ode_collide(a->shape, a->size, (ob_pose){ a->p, qa }, b->shape, b->size, (ob_pose){ b->p, qb },
			       margin, point, OB_PAIR_POINTS);
	out->points = n;
	out->separation = margin;
	for (int k = 0; k < n; k++) {
		out->normal = point[0].normal;
		out->at[k] = point[k].position;
		out->gap[k] = point[k].gap;
		out->separation = fmin(out->separation, point[k].gap);
	}
	return true;
}

static bool find(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	return ob_manifold_find(a, b, margin, out) || find_by_ode(a, b, margin, out);
}

static ob_placed placed(const ob_island_work *w, uint32_t row)
{
	const ob_member *m = &w->member[row];
	const double *v = w->v[row];
	return (ob_placed){ m->shape, m->size, m->p, m->r, ob_v3(v[0], v[1], v[2]), ob_v3(v[3], v[4], v[5]) };
}

// ---- lanes: a colour's batches hold no moving body twice

static uint32_t add_batch(ob_island_work *w, uint32_t colour)
{
	if (w->batches == w->batches_max) {
		w->batches_max = w->batches_max * 2 + 16;
		ob_batch *grown = aligned_alloc(64, w->batches_max * ((sizeof *grown + 63) / 64 * 64));
		if (w->batches)
			memcpy(grown, w->batch, w->batches * sizeof *grown);
		free(w->batch);
		w->batch = grown;
		w->batch_colour = realloc(w->batch_colour, w->batches_max * sizeof *w->batch_colour);
		w->batch_order = realloc(w->batch_order, w->batches_max * sizeof *w->batch_order);
	}
	ob_batch_init(&w->batch[w->batches]);
	w->batch_colour[w->batches] = colour;
	w->order_stale = true;
	return w->batches++;
}

// The first colour that neither body uses. Past the last colour each pair gets a batch of its own: a body with so many
// partners takes them one after the other.
static uint32_t free_colour(const ob_island_work *w, const ob_touch *t, bool jacobi)
{
	uint64_t used = w->member[t->a].colours | w->member[t->b].colours;
	if (jacobi)
		return 0;
	return used == UINT64_MAX ? OB_COLOURS : (uint32_t)__builtin_ctzll(~used);
}

static void take_lane(ob_sim *s, ob_touch *t)
{
	ob_island_work *w = &s->island;
	uint32_t colour = free_colour(w, t, ob_universe_settings(s->u)->exchange == OB_EXCHANGE_JACOBI),
		 batch = UINT32_MAX;
	for (uint32_t i = 0; i < w->batches && colour < OB_COLOURS; i++)
		if (w->batch_colour[i] == colour && w->batch[i].live != (1u << OB_LANES) - 1) {
			batch = i;
			break;
		}
	if (batch == UINT32_MAX)
		batch = add_batch(w, colour);
	uint32_t lane = (uint32_t)__builtin_ctz(~w->batch[batch].live);
	t->colour = colour;
	t->lane = batch * OB_LANES + lane;
	for (int side = 0; side < 2; side++) {
		ob_member *m = &w->member[side ? t->b : t->a];
		if (m->inv_mass > 0 && colour < OB_COLOURS)
			m->colours |= UINT64_C(1) << colour;
		m->contacts++;
	}
	w->counts_stale = true;
}

static void leave_lane(ob_island_work *w, ob_touch *t)
{
	ob_batch *b = &w->batch[t->lane / OB_LANES];
	ob_batch_apply_lane(b, t->lane % OB_LANES, -1, w->dv);
	ob_batch_clear(b, t->lane % OB_LANES);
	for (int side = 0; side < 2; side++) {
		ob_member *m = &w->member[side ? t->b : t->a];
		if (t->colour < OB_COLOURS)
			m->colours &= ~(UINT64_C(1) << t->colour);
		m->contacts--;
	}
	t->lane = OB_NO_LANE;
	t->points = 0;
	w->counts_stale = true;
}

static void fill_lane(ob_island_work *w, const ob_touch *t, ob_vec3 normal, const double *gap)
{
	const ob_member *a = &w->member[t->a], *b = &w->member[t->b];
	ob_lane lane = { t->a,  t->b, normal,      (int)t->points, t->arm_a,       t->arm_b,      gap,
			 t->mu, t->e, a->inv_mass, b->inv_mass,    a->inv_inertia, b->inv_inertia };
	ob_batch_set(&w->batch[t->lane / OB_LANES], t->lane % OB_LANES, &lane);
}

// ---- carrying impulses over to a new manifold

typedef struct carried {
	double impulse[OB_PAIR_ROWS];
	ob_vec3 arm[OB_PAIR_POINTS], friction, normal;
	uint32_t points;
} carried;

static void take_out(ob_island_work *w, const ob_touch *t, carried *old)
{
	const ob_batch *b = &w->batch[t->lane / OB_LANES];
	int l = t->lane % OB_LANES;
	ob_batch_apply_lane(b, l, -1, w->dv);
	for (int i = 0; i < OB_PAIR_ROWS; i++)
		old->impulse[i] = b->impulse[i][l];
	old->points = t->points;
	memcpy(old->arm, t->arm_a, sizeof old->arm);
	old->normal = ob_v3(b->n[0][l], b->n[1][l], b->n[2][l]);
	ob_vec3 t1 = ob_v3(b->t1[0][l], b->t1[1][l], b->t1[2][l]), t2 = ob_v3(b->t2[0][l], b->t2[1][l], b->t2[2][l]);
	old->friction = ob_add(ob_scale(t1, old->impulse[4]), ob_scale(t2, old->impulse[5]));
}

// Points near an old one inherit its impulse; the friction force keeps its direction in the world.
static void put_back(ob_island_work *w, const ob_touch *t, carried *old)
{
	ob_batch *b = &w->batch[t->lane / OB_LANES];
	int l = t->lane % OB_LANES;
	const ob_member *ma = &w->member[t->a], *mb = &w->member[t->b];
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
	ob_batch_apply_lane(b, l, 1, w->dv);
}

// ---- looking

// Bound of the speed at which any two points of the pair may approach (m/s), with what gravity adds.
static double closing_speed(const ob_sim *s, const ob_touch *t)
{
	const ob_island_work *w = &s->island;
	const double *va = w->v[t->a], *vb = w->v[t->b];
	ob_vec3 rel = ob_v3(va[0] - vb[0], va[1] - vb[1], va[2] - vb[2]);
	double speed = ob_norm(rel);
	for (int side = 0; side < 2; side++) {
		const ob_member *m = &w->member[side ? t->b : t->a];
		const double *v = side ? vb : va;
		if (m->inv_mass > 0 && m->shape != OB_SHAPE_SPHERE)
			speed += m->radius * ob_norm(ob_v3(v[3], v[4], v[5]));
	}
	return speed + ob_norm(ob_universe_settings(s->u)->gravity) * w->h;
}

// Points as of the instant of meeting, with gaps wound back to now: what closes at that instant closes then.
static void wind_back(const ob_placed *a, const ob_placed *b, double t, ob_manifold *m)
{
	ob_vec3 rel = ob_sub(a->v, b->v);
	ob_vec3 pa = ob_madd(a->p, t, a->v), pb = ob_madd(b->p, t, b->v);
	for (int j = 0; j < m->points; j++) {
		ob_vec3 spin = ob_sub(ob_cross(a->w, ob_sub(m->at[j], pa)), ob_cross(b->w, ob_sub(m->at[j], pb)));
		m->gap[j] -= t * ob_dot(m->normal, ob_add(rel, spin));
	}
}

// Fills m with the pair's points; arms run from the centres at time *when (0 unless it was swept).
static void look(ob_sim *s, const ob_touch *t, double tolerance, ob_manifold *m, double *when)
{
	ob_island_work *w = &s->island;
	ob_placed a = placed(w, t->a), b = placed(w, t->b);
	double thin = fmin(w->member[t->a].thickness, w->member[t->b].thickness);
	double speed = closing_speed(s, t), travel = speed * w->h;
	*when = 0;
	if (travel < swept_step * thin) {
		find(&a, &b, fmin(tolerance + 1.5 * travel, fmax(.5 * thin, tolerance + travel)), m);
		return;
	}
	double reach = fmin(w->member[t->a].radius, w->member[t->b].radius);
	double met = ob_swept_find(&a, &b, speed, w->h, fmin(swept_gap, .25 * thin), reach, find, m);
	if (isinf(met))
		return;
	*when = met;
	wind_back(&a, &b, *when, m);
}

static void refresh(ob_sim *s, ob_touch *t)
{
	ob_island_work *w = &s->island;
	ob_manifold m;
	double when;
	carried old = { .points = 0 };
	ob_member_settle(w, t->a);
	ob_member_settle(w, t->b);
	const ob_member *a = &w->member[t->a], *b = &w->member[t->b];
	double tolerance = look_again * fmin(1, 2 * fmin(a->thickness, b->thickness)), path = a->path + b->path;
	look(s, t, tolerance, &m, &when);
	if (!m.points) {
		t->limit = path + fmax(tolerance, m.separation - tolerance);
		if (t->lane != OB_NO_LANE)
			leave_lane(w, t);
		return;
	}
	t->limit = path + tolerance;
	if (t->lane == OB_NO_LANE)
		take_lane(s, t);
	else
		take_out(w, t, &old);
	ob_vec3 va = ob_v3(w->v[t->a][0], w->v[t->a][1], w->v[t->a][2]);
	ob_vec3 vb = ob_v3(w->v[t->b][0], w->v[t->b][1], w->v[t->b][2]);
	t->points = (uint32_t)m.points;
	for (int j = 0; j < m.points; j++) {
		t->arm_a[j] = ob_sub(m.at[j], ob_madd(a->p, when, va));
		t->arm_b[j] = ob_sub(m.at[j], ob_madd(b->p, when, vb));
	}
	fill_lane(w, t, m.normal, m.gap);
	put_back(w, t, &old);
}

bool ob_touches_refresh(ob_sim *s)
{
	bool any = false;
	ob_island_work *w = &s->island;
	double gh = ob_norm(ob_universe_settings(s->u)->gravity) * w->h;
	for (uint32_t i = 0; i < w->touches; i++) {
		ob_touch *t = &w->touch[i];
		const ob_member *a = &w->member[t->a], *b = &w->member[t->b];
		if (a->path + b->path + (a->speed + b->speed + 2 * gh) * w->h > t->limit) {
			refresh(s, t);
			any = true;
		}
	}
	return any;
}

static int by_colour(const void *x, const void *y, void *colour)
{
	uint32_t a = *(const uint32_t *)x, b = *(const uint32_t *)y, ca = ((uint32_t *)colour)[a],
		 cb = ((uint32_t *)colour)[b];
	return ca != cb ? (ca < cb ? -1 : 1) : a < b ? -1 : 1;
}

// Each lane learns how many contacts its bodies have.
static void count_contacts(const ob_island_work *w, ob_batch *b, bool jacobi)
{
	b->alone = 0;
	for (int l = 0; l < OB_LANES; l++) {
		const ob_member *m[2] = { &w->member[b->body_a[l]], &w->member[b->body_b[l]] };
		bool alone =
			(m[0]->inv_mass == 0 || m[0]->contacts == 1) && (m[1]->inv_mass == 0 || m[1]->contacts == 1);
		b->alone |= (unsigned)alone << l & b->live;
		if (jacobi) {
			b->ka[l] = fmax(1, m[0]->contacts);
			b->kb[l] = fmax(1, m[1]->contacts);
		}
	}
}

void ob_touches_prepare(ob_sim *s)
{
	ob_island_work *w = &s->island;
	bool jacobi = ob_universe_settings(s->u)->exchange == OB_EXCHANGE_JACOBI;
	if (w->order_stale) {
		for (uint32_t i = 0; i < w->batches; i++)
			w->batch_order[i] = i;
		qsort_r(w->batch_order, w->batches, sizeof *w->batch_order, by_colour, w->batch_colour);
		w->order_stale = false;
	}
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

static void load_touch(ob_sim *s, ob_touch *t, const ob_pair_key *k)
{
	ob_island_work *w = &s->island;
	const ob_member *a = &w->member[t->a], *b = &w->member[t->b];
	t->mu = sqrt(a->friction * b->friction);
	t->e = fmax(a->restitution, b->restitution);
	w->elastic |= t->e > 0;
	if (!k->active)
		return;
	const ob_pair_state *p = ob_pair_newest(&ob_universe_exchange(s->u)->record[k->record]);
	t->points = p->points;
	memcpy(t->arm_a, p->arm_a, sizeof t->arm_a);
	memcpy(t->arm_b, p->arm_b, sizeof t->arm_b);
	take_lane(s, t);
	fill_lane(w, t, p->normal, p->gap);
	ob_batch *batch = &w->batch[t->lane / OB_LANES];
	for (int i = 0; i < OB_PAIR_ROWS; i++)
		batch->impulse[i][t->lane % OB_LANES] = batch->impulse_start[i][t->lane % OB_LANES] =
			p->impulse[i] * (w->h / p->substep);
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
			ob_member *m = &w->member[side ? w->touch[i].b : w->touch[i].a];
			w->adjacency[m->first_adjacent + m->adjacent++] = i;
		}
}

void ob_touches_load(ob_sim *s, const ob_island *is)
{
	ob_exchange *ex = ob_universe_exchange(s->u);
	ob_island_work *w = &s->island;
	if (is->pairs > w->touches_max) {
		w->touches_max = is->pairs + is->pairs / 2;
		w->touch = realloc(w->touch, w->touches_max * sizeof *w->touch);
		w->adjacency = realloc(w->adjacency, 2 * w->touches_max * sizeof *w->adjacency);
	}
	w->touches = is->pairs;
	w->batches = 0;
	w->order_stale = w->counts_stale = true;
	w->elastic = false;
	for (uint32_t i = 0; i < is->pairs; i++) {
		uint32_t key = ex->island_pair[is->first_pair + i];
		const ob_pair_key *k = &ex->pair[key];
		ob_touch *t = &w->touch[i];
		*t = (ob_touch){
			.key = key, .a = w->row_of[k->a], .b = w->row_of[k->b], .lane = OB_NO_LANE, .limit = k->limit
		};
		load_touch(s, t, k);
	}
	link_adjacent(w);
}

void ob_touches_store(ob_sim *s)
{
	ob_exchange *ex = ob_universe_exchange(s->u);
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->touches; i++) {
		const ob_touch *t = &w->touch[i];
		ob_pair_key *k = &ex->pair[t->key];
		bool was_active = k->active;
		k->limit = t->limit;
		k->active = t->lane != OB_NO_LANE;
		if (!k->active && !was_active)
			continue;
		ob_pair_record *record = &ex->record[k->record];
		ob_pair_state *p = ob_pair_writable(record);
		*p = (ob_pair_state){ .points = t->points, .path_limit = t->limit, .substep = w->h };
		memcpy(p->arm_a, t->arm_a, sizeof p->arm_a);
		memcpy(p->arm_b, t->arm_b, sizeof p->arm_b);
		const ob_batch *b = k->active ? &w->batch[t->lane / OB_LANES] : NULL;
		int l = t->lane % OB_LANES;
		for (uint32_t j = 0; b && j < OB_PAIR_POINTS; j++)
			p->gap[j] = b->gap[j][l];
		for (int j = 0; b && j < OB_PAIR_ROWS; j++)
			p->impulse[j] = b->impulse[j][l];
		if (b)
			p->normal = ob_v3(b->n[0][l], b->n[1][l], b->n[2][l]);
		ob_pair_written(record, ob_step_count(s->u) + 1);
	}
}

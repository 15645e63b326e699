#include "sim/contacts.h"

#include <stdlib.h>
#include <string.h>

#include "sim/bodies.h"
#include "sim/broadphase.h"
#include "sim/ghost.h"
#include "sim/narrowphase.h"

// ---- lanes and graph colouring

// Impulses that go over from an old manifold to a new one (warm starting).
typedef struct saved_impulses {
	double impulse[OB_PAIR_ROWS];
	ob_vec3 arm[OB_PAIR_POINTS], friction, normal;
	uint32_t points;
} saved_impulses;

enum { ALL_LANES = (1 << OB_LANES) - 1, NO_BATCH = UINT32_MAX };

// Batches with a free lane form a stack per colour and kind.
static void push_open_batch(ob_island_work *w, uint32_t batch)
{
	uint32_t *top = &w->open_batch[w->batch_colour[batch]][w->batch[batch].kind];
	w->next_open_batch[batch] = *top;
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
		w->next_open_batch = realloc(w->next_open_batch, w->batches_max * sizeof *w->next_open_batch);
	}
	ob_batch_init(&w->batch[w->batches], kind);
	w->batch_colour[w->batches] = colour;
	w->batch_due[w->batches] = 0;
	w->order_stale = true;
	if (colour < OB_COLOURS)
		push_open_batch(w, w->batches);
	return w->batches++;
}

// The first colour that neither body uses. Past the last colour each contact gets a batch of its own: those of a body
// with so many contacts are solved one after the other.
static uint32_t free_colour(const ob_island_work *w, const ob_contact *contact, bool jacobi)
{
	uint64_t used = w->body[contact->a].colours | w->body[contact->b].colours;
	if (jacobi)
		return 0;
	return used == UINT64_MAX ? OB_COLOURS : (uint32_t)__builtin_ctzll(~used);
}

// The kind of batch that holds the contact, wherever its bodies are.
static ob_batch_kind kind_of(const ob_sim *s, const ob_contact *contact)
{
	const ob_island_work *w = &s->island;
	bool aabb = s->settings->narrow_phase == OB_NARROW_AABB; // a sphere's box has four points
	ob_shape a = w->body[contact->a].shape, b = w->body[contact->b].shape;
	bool point = (a == OB_SHAPE_SPHERE && (b == OB_SHAPE_SPHERE || b == OB_SHAPE_BOX || b == OB_SHAPE_PLANE)) ||
		     (b == OB_SHAPE_SPHERE && (a == OB_SHAPE_BOX || a == OB_SHAPE_PLANE));
	return (point && !aabb ? OB_KIND_POINT : OB_KIND_FULL) |
	       (contact->mu > 0 ? OB_KIND_FULL : OB_KIND_FRICTIONLESS);
}

// Takes a lane of the first colour that neither body uses.
static void take_lane(ob_sim *s, ob_contact *contact)
{
	ob_island_work *w = &s->island;
	const ob_batch_kind kind = kind_of(s, contact);
	uint32_t colour = free_colour(w, contact, s->settings->solver == OB_SOLVER_JACOBI), batch = NO_BATCH;
	if (colour < OB_COLOURS)
		batch = w->open_batch[colour][kind];
	if (batch == NO_BATCH)
		batch = add_batch(w, colour, kind);
	unsigned live = w->batch[batch].live;
	uint32_t lane = (uint32_t)__builtin_ctz(~live);
	if (colour < OB_COLOURS && (live | 1u << lane) == ALL_LANES)
		w->open_batch[colour][kind] = w->next_open_batch[batch]; // it is the top, and full now
	contact->colour = colour;
	contact->lane = batch * OB_LANES + lane;
	for (int side = 0; side < 2; side++) {
		ob_body *body = &w->body[side ? contact->b : contact->a];
		if (body->inv_mass > 0 && colour < OB_COLOURS)
			body->colours |= UINT64_C(1) << colour;
		body->contacts++;
		body->moved_freely = false;
	}
	w->counts_stale = true;
}

// Gives the lane back, and its impulses with it.
static void leave_lane(ob_island_work *w, ob_contact *contact)
{
	ob_batch *b = &w->batch[contact->lane / OB_LANES];
	bool was_full = b->live == ALL_LANES;
	ob_batch_clear(b, contact->lane % OB_LANES);
	if (was_full && contact->colour < OB_COLOURS)
		push_open_batch(w, contact->lane / OB_LANES);
	for (int side = 0; side < 2; side++) {
		ob_body *body = &w->body[side ? contact->b : contact->a];
		if (contact->colour < OB_COLOURS)
			body->colours &= ~(UINT64_C(1) << contact->colour);
		body->contacts--;
	}
	contact->lane = OB_NO_LANE;
	contact->points = 0;
	w->counts_stale = true;
}

// Writes the contact's geometry into its lane. gap: m, of each point.
static void fill_lane(ob_island_work *w, const ob_contact *contact, ob_vec3 normal, const double *gap)
{
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	ob_batch_lane lane = { contact->a,     contact->b,     normal,      (int)contact->points,
			       contact->arm_a, contact->arm_b, gap,         contact->mu,
			       contact->e,     a->inv_mass,    b->inv_mass, a->inv_inertia,
			       b->inv_inertia };
	ob_batch_set(&w->batch[contact->lane / OB_LANES], contact->lane % OB_LANES, &lane);
}

// Before the geometry changes.
static void save_impulses(ob_island_work *w, const ob_contact *contact, saved_impulses *old)
{
	const ob_batch *b = &w->batch[contact->lane / OB_LANES];
	int l = contact->lane % OB_LANES;
	for (int i = 0; i < OB_PAIR_ROWS; i++)
		old->impulse[i] = b->impulse[i][l];
	old->points = contact->points;
	memcpy(old->arm, contact->arm_a, sizeof old->arm);
	old->normal = ob_v3(b->n[0][l], b->n[1][l], b->n[2][l]);
	ob_vec3 t1 = ob_v3(b->t1[0][l], b->t1[1][l], b->t1[2][l]), t2 = ob_v3(b->t2[0][l], b->t2[1][l], b->t2[2][l]);
	old->friction = ob_add(ob_scale(t1, old->impulse[4]), ob_scale(t2, old->impulse[5]));
}

// Into the new geometry: points near an old one inherit its impulse, the friction force keeps its direction in the
// world.
static void warm_start_lane(ob_island_work *w, const ob_contact *contact, saved_impulses *old)
{
	ob_batch *b = &w->batch[contact->lane / OB_LANES];
	int l = contact->lane % OB_LANES;
	const ob_body *ma = &w->body[contact->a], *mb = &w->body[contact->b];
	double thin = fmin(ma->thickness, mb->thickness), near = .04 * thin * thin + 1e-6;
	ob_vec3 n = ob_v3(b->n[0][l], b->n[1][l], b->n[2][l]), t1, t2;
	bool same = old->points && ob_dot(n, old->normal) > .9;
	bool sphere = ma->shape == OB_SHAPE_SPHERE || mb->shape == OB_SHAPE_SPHERE;
	for (uint32_t j = 0; j < OB_PAIR_POINTS; j++) {
		double best = sphere ? INFINITY : near;
		int found = -1;
		for (uint32_t k = 0; same && j < contact->points && k < old->points; k++) {
			double apart = ob_norm2(ob_sub(contact->arm_a[j], old->arm[k]));
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

// ---- geometry

static const double max_retest_share = 3; // of the tolerance
static const double retest_path = .003; // m: after which the geometry of a resting pair is tested again

// m: path after which a pair is tested again. Corners that were no points of the contact come down by a share of the
// path of the bodies; where many substeps did not reach the tolerance, that may be why.
static double retest_distance(const ob_sim *s)
{
	double tolerance = s->settings->tolerance;
	double share = max_retest_share * fmin(1, 16. / s->island.substeps);
	return tolerance > 0 ? fmin(retest_path, share * tolerance) : retest_path;
}

static void update_contact(ob_sim *s, ob_contact *contact)
{
	ob_island_work *w = &s->island;
	ob_manifold m;
	double when;
	saved_impulses old = { .points = 0 };
	ob_body_update_pose(w, contact->a);
	ob_body_update_pose(w, contact->b);
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	double tolerance = retest_distance(s) * fmin(1, 2 * fmin(a->thickness, b->thickness)), path = a->path + b->path;
	ob_narrowphase_find(s, contact, tolerance, &m, &when);
	if (!m.points) {
		contact->limit = path + fmax(tolerance, m.separation - tolerance);
		if (contact->lane != OB_NO_LANE)
			leave_lane(w, contact);
		return;
	}
	contact->limit = path + tolerance;
	if (contact->lane == OB_NO_LANE)
		take_lane(s, contact);
	else
		save_impulses(w, contact, &old);
	ob_vec3 va = ob_v3(w->v[contact->a][0], w->v[contact->a][1], w->v[contact->a][2]);
	ob_vec3 vb = ob_v3(w->v[contact->b][0], w->v[contact->b][1], w->v[contact->b][2]);
	contact->points = (uint32_t)m.points;
	for (int j = 0; j < m.points; j++) {
		contact->arm_a[j] = ob_sub(m.at[j], ob_madd(a->p, when, va));
		contact->arm_b[j] = ob_sub(m.at[j], ob_madd(b->p, when, vb));
	}
	fill_lane(w, contact, m.normal, m.gap);
	warm_start_lane(w, contact, &old);
}

// m/s, bound of the speed that the two may gain within the partial substep, on average over it. Bodies that touch are
// expected to go on as they did: at rest they gain nothing.
static double speed_gain(const ob_island_work *w, const ob_contact *contact)
{
	double free = w->max_acceleration * w->h;
	const double *a = w->dv[contact->a], *b = w->dv[contact->b];
	if (contact->lane == OB_NO_LANE)
		return free;
	return fmin(free, .5 * (ob_norm(ob_v3(a[0], a[1], a[2])) + ob_norm(ob_v3(b[0], b[1], b[2]))));
}

bool ob_contacts_update(ob_sim *s, double ahead)
{
	bool any = false;
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->contacts; i++) {
		ob_contact *contact = &w->contact[i];
		const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
		if (a->path + b->path + (a->speed + b->speed + speed_gain(w, contact)) * ahead > contact->limit) {
			s->counters.narrowphase_tests++;
			update_contact(s, contact);
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

// Writes into each lane how many contacts its bodies have.
static void count_contacts(const ob_island_work *w, ob_batch *b, bool jacobi)
{
	b->isolated = 0;
	for (int l = 0; l < OB_LANES; l++) {
		const ob_body *m[2] = { &w->body[b->body_a[l]], &w->body[b->body_b[l]] };
		bool isolated =
			(m[0]->inv_mass == 0 || m[0]->contacts == 1) && (m[1]->inv_mass == 0 || m[1]->contacts == 1);
		b->isolated |= (unsigned)isolated << l & b->live;
		if (jacobi) {
			b->ka[l] = fmax(1, m[0]->contacts);
			b->kb[l] = fmax(1, m[1]->contacts);
		}
	}
}

void ob_contacts_prepare(ob_sim *s)
{
	ob_island_work *w = &s->island;
	bool jacobi = s->settings->solver == OB_SOLVER_JACOBI;
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

// The pair's state before the step; NULL if it did not touch. A first solution has overwritten what its key says, so
// where islands are solved again the record alone is asked.
static const ob_pair_state *state_before(const ob_sim *s, const ob_pair_key *k)
{
	const ob_step_data *data = s->data;
	if (k->record == OB_NO_RECORD || (!k->active && !data->count->merged))
		return NULL;
	const ob_pair_state *p = ob_pair_before(&data->record[k->record], ob_step_count(s->u));
	return p && p->points ? p : NULL;
}

static void load_contact(ob_sim *s, const ob_contact *from, const ob_pair_key *k)
{
	ob_island_work *w = &s->island;
	ob_contact *contact = &w->contact[w->contacts++];
	*contact = *from;
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	contact->mu = sqrt(a->friction * b->friction);
	contact->e = fmax(a->restitution, b->restitution);
	w->elastic |= contact->e > 0;
	const ob_pair_state *p = state_before(s, k);
	if (!p)
		return;
	contact->points = p->points;
	contact->creep = p->creep;
	double gap[OB_PAIR_POINTS];
	for (uint32_t j = 0; j < OB_PAIR_POINTS; j++) {
		contact->arm_a[j] = ob_v3(p->arm_a[j][0], p->arm_a[j][1], p->arm_a[j][2]);
		contact->arm_b[j] = ob_sub(contact->arm_a[j], p->between);
		gap[j] = p->gap[j];
	}
	take_lane(s, contact);
	fill_lane(w, contact, p->normal, gap);
	ob_batch *batch = &w->batch[contact->lane / OB_LANES];
	const ob_step_data *data = s->data;
	const double *impulse =
		contact->mirror ? data->impulse_b[k->record][p - data->record[k->record].version] : p->impulse;
	for (int i = 0; i < OB_PAIR_ROWS; i++)
		batch->impulse[i][contact->lane % OB_LANES] = batch->impulse_start[i][contact->lane % OB_LANES] =
			impulse[i] * (w->h / p->substep);
}

// Each side is solved for itself, against a ghost of the other.
static void load_with_ghosts(ob_sim *s, const ob_contact *contact, const ob_pair_key *k)
{
	ob_contact own = *contact, mirror = *contact;
	own.b = ob_ghost_make(s, contact->b);
	mirror.a = ob_ghost_make(s, contact->a);
	mirror.mirror = true;
	load_contact(s, &own, k);
	load_contact(s, &mirror, k);
}

static void link_adjacent(ob_island_work *w)
{
	uint32_t total = 0;
	for (uint32_t i = 0; i < w->contacts; i++) {
		w->body[w->contact[i].a].adjacent++;
		w->body[w->contact[i].b].adjacent++;
	}
	for (uint32_t r = 0; r < w->rows; r++) {
		w->body[r].first_adjacent = total;
		total += w->body[r].adjacent;
		w->body[r].adjacent = 0;
	}
	for (uint32_t i = 0; i < w->contacts; i++)
		for (int side = 0; side < 2; side++) {
			ob_body *body = &w->body[side ? w->contact[i].b : w->contact[i].a];
			w->adjacency[body->first_adjacent + body->adjacent++] = i;
		}
}

void ob_contacts_load(ob_sim *s, const ob_island *is)
{
	ob_step_data *data = s->data;
	ob_island_work *w = &s->island;
	uint32_t most = ob_ghosts_used(s) ? 2 * is->pairs : is->pairs;
	if (most > w->contacts_max) {
		w->contacts_max = most + most / 2;
		w->contact = realloc(w->contact, w->contacts_max * sizeof *w->contact);
		w->adjacency = realloc(w->adjacency, 2 * w->contacts_max * sizeof *w->adjacency);
	}
	w->contacts = 0;
	w->batches = 0;
	memset(w->open_batch, 0xff, sizeof w->open_batch);
	w->order_stale = w->counts_stale = true;
	w->elastic = false;
	for (uint32_t i = 0; i < is->pairs; i++) {
		uint32_t key = data->island_pair[is->first_pair + i];
		const ob_pair_key *k = &data->pair[key];
		ob_contact t = {
			.key = key, .a = w->row_of[k->a], .b = w->row_of[k->b], .lane = OB_NO_LANE, .limit = k->limit
		};
		if (ob_ghosts_used(s) && t.a <= w->bodies && t.b <= w->bodies)
			load_with_ghosts(s, &t, k);
		else
			load_contact(s, &t, k);
	}
	link_adjacent(w);
}

// The lane's impulses, or zeros if it has none.
static void store_impulses(const ob_island_work *w, const ob_contact *contact, double *impulse)
{
	for (int j = 0; j < OB_PAIR_ROWS; j++)
		impulse[j] = contact->lane == OB_NO_LANE
				     ? 0
				     : w->batch[contact->lane / OB_LANES].impulse[j][contact->lane % OB_LANES];
}

static void store_contact(const ob_island_work *w, const ob_contact *contact, ob_pair_state *p)
{
	*p = (ob_pair_state){ .points = contact->points, .substep = w->h, .creep = (float)contact->creep };
	for (int j = 0; j < OB_PAIR_POINTS; j++) {
		p->arm_a[j][0] = (float)contact->arm_a[j].x;
		p->arm_a[j][1] = (float)contact->arm_a[j].y;
		p->arm_a[j][2] = (float)contact->arm_a[j].z;
	}
	p->between = ob_sub(contact->arm_a[0], contact->arm_b[0]);
	store_impulses(w, contact, p->impulse);
	if (contact->lane == OB_NO_LANE)
		return;
	const ob_batch *b = &w->batch[contact->lane / OB_LANES];
	int l = contact->lane % OB_LANES;
	for (uint32_t j = 0; j < OB_PAIR_POINTS; j++)
		p->gap[j] = (float)b->gap[j][l];
	p->normal = ob_v3(b->n[0][l], b->n[1][l], b->n[2][l]);
}

void ob_contacts_store(ob_sim *s)
{
	ob_step_data *data = s->data;
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->contacts; i++) {
		const ob_contact *contact = &w->contact[i],
				 *mirror = i + 1 < w->contacts && contact[1].mirror ? contact + 1 : NULL;
		ob_pair_key *k = &data->pair[contact->key];
		bool was_active = k->active || state_before(s, k);
		k->limit = contact->limit;
		k->active = contact->lane != OB_NO_LANE;
		if (k->active || was_active) {
			if (k->record == OB_NO_RECORD)
				k->record = ob_record_take(s->u);
			ob_pair_record *record = &data->record[k->record];
			ob_pair_state *p = ob_pair_write(record, ob_step_count(s->u));
			store_contact(w, contact, p);
			if (mirror)
				store_impulses(w, mirror, data->impulse_b[k->record][p - record->version]);
		}
		i += mirror != NULL;
	}
}

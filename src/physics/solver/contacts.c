#include "solver/contacts.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "shape/part.h"
#include "shape/shape.h"
#include "solver/bodies.h"
#include "solver/contact_order.h"
#include "solver/narrowphase.h"
#include "solver/relative_speed.h"
#include "solver/surfaces.h"

// ---- lanes and graph colouring

// Impulses that a new manifold inherits from an old one (warm start).
typedef struct saved_impulses {
	double impulse[OB_PAIR_ROWS];
	ob_vec3 arm[OB_PAIR_POINTS], arm_b[OB_PAIR_POINTS], friction, normal;
	uint32_t points;
} saved_impulses;

enum { ALL_LANES = (1 << OB_LANES) - 1, NO_BATCH = UINT32_MAX };

// Batches with a free lane form a stack for each colour and kind.
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
		ob_batch *grown = ob_allocate_aligned(64, w->batches_max * ((sizeof *grown + 63) / 64 * 64));
		if (w->batches)
			memcpy(grown, w->batch, w->batches * sizeof *grown);
		free(w->batch);
		w->batch = grown;
		w->batch_colour = ob_reallocate(w->batch_colour, w->batches_max * sizeof *w->batch_colour);
		w->batch_due = ob_reallocate(w->batch_due, w->batches_max * sizeof *w->batch_due);
		w->batch_order = ob_reallocate(w->batch_order, w->batches_max * sizeof *w->batch_order);
		w->next_open_batch = ob_reallocate(w->next_open_batch, w->batches_max * sizeof *w->next_open_batch);
	}
	ob_batch_init(&w->batch[w->batches], kind);
	w->batch_colour[w->batches] = colour;
	w->batch_due[w->batches] = 0;
	w->order_stale = true;
	if (colour < OB_COLOURS)
		push_open_batch(w, w->batches);
	return w->batches++;
}

// Returns the first colour that neither body uses, or OB_COLOURS if there is none. Then each contact gets a batch of
// its own: such contacts are solved one after the other.
static uint32_t free_colour(const ob_island_work *w, const ob_contact *contact, bool jacobi)
{
	uint64_t used = w->body[contact->a].colours | w->body[contact->b].colours;
	if (jacobi)
		return 0;
	return used == UINT64_MAX ? OB_COLOURS : (uint32_t)__builtin_ctzll(~used);
}

// Returns the kind of batch for the contact, whatever the poses of its bodies.
static ob_batch_kind kind_of(const ob_solver *s, const ob_contact *contact)
{
	const ob_island_work *w = &s->island;
	const ob_shape a = ob_part_shape(w->body[contact->a].shape, contact->part[0]),
		       b = ob_part_shape(w->body[contact->b].shape, contact->part[1]);
	bool point = ob_shape_is(a, OB_ISOTROPIC) || ob_shape_is(b, OB_ISOTROPIC); // their boxes have four
	return (point && !s->methods.boxes ? OB_KIND_POINT : OB_KIND_FULL) |
	       (contact->mu > 0 ? OB_KIND_FULL : OB_KIND_FRICTIONLESS);
}

static void set_lane(ob_island_work *w, ob_contact *contact, uint32_t lane)
{
	contact->lane = w->contact_lane[contact - w->contact] = lane;
}

// Takes a lane of the first colour that neither body uses.
static void take_lane(ob_solver *s, ob_contact *contact)
{
	ob_island_work *w = &s->island;
	const ob_batch_kind kind = kind_of(s, contact);
	uint32_t colour = free_colour(w, contact, s->methods.jacobi), batch = NO_BATCH;
	if (colour < OB_COLOURS)
		batch = w->open_batch[colour][kind];
	if (batch == NO_BATCH)
		batch = add_batch(w, colour, kind);
	unsigned live = w->batch[batch].live;
	uint32_t lane = (uint32_t)__builtin_ctz(~live);
	if (colour < OB_COLOURS && (live | 1u << lane) == ALL_LANES)
		w->open_batch[colour][kind] = w->next_open_batch[batch]; // the top of the stack, full now
	contact->colour = colour;
	set_lane(w, contact, batch * OB_LANES + lane);
	for (int side = 0; side < 2; side++) {
		ob_body *body = &w->body[side ? contact->b : contact->a];
		if (body->inv_mass > 0 && colour < OB_COLOURS)
			body->colours |= UINT64_C(1) << colour;
		body->contacts++;
		body->moved_freely = false;
	}
	w->counts_stale = true;
}

// Returns the lane with its impulses.
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
	set_lane(w, contact, OB_NO_LANE);
	contact->points = 0;
	contact->spin_lever_a = contact->spin_lever_b = 0;
	w->counts_stale = true;
}

// True if the area over which the two touch may be a polygon: one of them is a hull.
static bool may_have_area(const ob_contact *contact, const ob_body *a, const ob_body *b)
{
	const bool sides_a = ob_shape_is(a->shape, OB_SIDED), sides_b = ob_shape_is(b->shape, OB_SIDED);
	if (ob_part_is_round(contact->part[0]) || ob_part_is_round(contact->part[1]))
		return false;
	return (sides_a || a->hull || ob_shape_is(a->shape, OB_UNBOUNDED)) &&
	       (sides_b || b->hull || ob_shape_is(b->shape, OB_UNBOUNDED)) && (a->hull || b->hull);
}

// Writes the contact's geometry into its lane. gap: gap of each point (m).
static void fill_lane(ob_island_work *w, ob_contact *contact, ob_vec3 normal, const double *gap)
{
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	contact->spin_lever_a = ob_spin_lever(a, normal, contact->arm_a, contact->points);
	contact->spin_lever_b = ob_spin_lever(b, normal, contact->arm_b, contact->points);
	if (w->surfaces.count) {
		ob_surface_note_normal(w, contact->a, normal);
		ob_surface_note_normal(w, contact->b, normal);
	}
	ob_batch_lane lane = { .body_a = contact->a,
			       .body_b = contact->b,
			       .normal = normal,
			       .points = (int)contact->points,
			       .arm_a = contact->arm_a,
			       .arm_b = contact->arm_b,
			       .gap = gap,
			       .disc_radius = contact->disc_radius,
			       .mu = contact->mu,
			       .e = contact->e,
			       .inv_mass_a = a->inv_mass,
			       .inv_mass_b = b->inv_mass,
			       .inv_inertia_a = a->inv_inertia,
			       .inv_inertia_b = b->inv_inertia };
	ob_batch_set(&w->batch[contact->lane / OB_LANES], contact->lane % OB_LANES, &lane, &contact->friction_a,
		     &contact->friction_b);
	contact->area_due = contact->points > 2 && contact->mu > 0 && may_have_area(contact, a, b);
	w->areas_due |= contact->area_due;
}

// Saves the contact's impulses before its geometry changes.
static void save_impulses(ob_island_work *w, const ob_contact *contact, saved_impulses *old)
{
	const ob_batch *b = &w->batch[contact->lane / OB_LANES];
	int l = contact->lane % OB_LANES;
	for (int i = 0; i < OB_PAIR_ROWS; i++)
		old->impulse[i] = b->impulse[i][l];
	old->points = contact->points;
	memcpy(old->arm, contact->arm_a, sizeof old->arm);
	memcpy(old->arm_b, contact->arm_b, sizeof old->arm_b);
	old->normal = ob_batch_vector(b->n, l);
	ob_vec3 t1 = ob_batch_vector(b->t1, l), t2 = ob_batch_vector(b->t2, l);
	old->friction = ob_add(ob_scale(t1, old->impulse[4]), ob_scale(t2, old->impulse[5]));
}

static const double same_place = .2; // share of the smaller thickness: a point that has moved less is the same
static const double same_normal = .9; // cosine: no point is the same if the normal has turned farther
static const double same_rim = .5; // share of the radius: distance that a rim may roll on with the same geometry

// Returns the old point that carries load, or the lowest one if none does; -1 if several do, or there is no point.
static int the_loaded(const saved_impulses *old)
{
	int found = -1;
	for (uint32_t k = 0; k < old->points; k++)
		if (old->impulse[k] > 0) {
			if (found >= 0)
				return -1;
			found = (int)k;
		}
	return found < 0 && old->points > 0 ? 0 : found;
}

// True if the point, at "arm" now, is on the rim on which it was. moved: m.
static bool on_same_rim(const ob_body *body, const ob_hull *part, ob_vec3 arm, ob_vec3 moved)
{
	ob_vec3 centre = { 0, 0, 0 };
	ob_mat3 r = body->r;
	double radius = body->size.x;
	if (ob_part_is_round(part))
		radius = part->size.x, ob_part_enter(part, &centre, &r);
	const ob_vec3 axis = ob_column(&r, 2), from = ob_sub(arm, centre);
	return ob_shape_is(ob_part_shape(body->shape, part), OB_RIMMED) &&
	       ob_dot(axis, from) * ob_dot(axis, ob_sub(from, moved)) > 0 && ob_norm(moved) < same_rim * radius;
}

// Matches points with old ones, nearest pairs first, so that the order of neither matters. Points are near if they are
// on either body. limit: bound of the squared distance (m^2). Returns a bit for each old point that was matched.
static unsigned match_nearest(ob_contact *contact, const saved_impulses *old, double limit)
{
	double apart2[OB_PAIR_POINTS][OB_PAIR_POINTS];
	unsigned taken = 0;
	bool shared = false; // an old point is nearest to two points
	memset(contact->was, -1, sizeof contact->was);
	for (uint32_t j = 0; j < contact->points; j++) {
		double best = limit;
		for (uint32_t k = 0; k < old->points; k++) {
			const double a = ob_norm2(ob_sub(contact->arm_a[j], old->arm[k])),
				     b = ob_norm2(ob_sub(contact->arm_b[j], old->arm_b[k]));
			apart2[j][k] = a < b ? a : b;
			contact->was[j] = apart2[j][k] < best ? (int8_t)k : contact->was[j];
			best = apart2[j][k] < best ? apart2[j][k] : best;
		}
		const unsigned bit = contact->was[j] >= 0 ? 1u << contact->was[j] : 0;
		shared |= taken & bit;
		taken |= bit;
	}
	if (!shared)
		return taken;
	taken = 0;
	memset(contact->was, -1, sizeof contact->was);
	for (uint32_t n = 0; n < contact->points && n < old->points; n++) {
		double best = limit;
		uint32_t at = OB_PAIR_POINTS, to = 0;
		for (uint32_t j = 0; j < contact->points; j++)
			for (uint32_t k = 0; k < old->points && contact->was[j] < 0; k++)
				if (!(taken >> k & 1) && apart2[j][k] < best)
					best = apart2[j][k], at = j, to = k;
		if (at == OB_PAIR_POINTS)
			break;
		contact->was[at] = (int8_t)to;
		taken |= 1u << to;
	}
	return taken;
}

// Matches each point with a near old one. The loaded point of a body that rolls on its rim moves along the rim: it is
// matched as the lowest point, which comes first.
static void match_points(const ob_island_work *w, ob_contact *contact, const saved_impulses *old)
{
	const ob_body *ma = &w->body[contact->a], *mb = &w->body[contact->b];
	const ob_shape sa = ob_part_shape(ma->shape, contact->part[0]), sb = ob_part_shape(mb->shape, contact->part[1]);
	const bool sphere = ob_shape_is(sa, OB_ISOTROPIC) || ob_shape_is(sb, OB_ISOTROPIC);
	const double near = same_place * ob_min(ma->thickness, mb->thickness);
	const unsigned taken = match_nearest(contact, old, sphere ? INFINITY : near * near);
	if (contact->was[0] >= 0 || !(ob_shape_is(sa, OB_RIMMED) || ob_shape_is(sb, OB_RIMMED)))
		return;
	const int k = the_loaded(old);
	if (k < 0 || taken >> k & 1)
		return;
	const ob_vec3 moved = ob_sub(contact->arm_a[0], old->arm[k]);
	if (on_same_rim(ma, contact->part[0], contact->arm_a[0], moved) ||
	    on_same_rim(mb, contact->part[1], contact->arm_b[0], moved))
		contact->was[0] = (int8_t)k;
}

// Transfers impulses to the new geometry. Points inherit those of the points that they match; the friction force keeps
// its direction in the world.
static void warm_start_lane(ob_island_work *w, const ob_contact *contact, const saved_impulses *old)
{
	const bool same = old->points > 0;
	ob_batch *b = &w->batch[contact->lane / OB_LANES];
	int l = contact->lane % OB_LANES;
	const ob_vec3 t1 = ob_batch_vector(b->t1, l), t2 = ob_batch_vector(b->t2, l);
	for (uint32_t j = 0; j < OB_PAIR_POINTS; j++)
		lanes_put(&b->impulse[j], l, contact->was[j] >= 0 ? old->impulse[contact->was[j]] : 0);
	lanes_put(&b->impulse[4], l, same ? ob_dot(old->friction, t1) : 0);
	lanes_put(&b->impulse[5], l, same ? ob_dot(old->friction, t2) : 0);
	lanes_put(&b->impulse[6], l, same ? old->impulse[6] : 0);
	for (int i = 0; i < OB_PAIR_ROWS; i++)
		lanes_put(&b->impulse_start[i], l, b->impulse[i][l]);
}

// ---- geometry

static const double max_retest_share = 3; // of the tolerance
static const double retest_path = .0015; // m: path after which the geometry of a resting pair is tested again
static const double coarse_share = .2; // share of the tolerance by which a coarse run may miss a new corner
static const double coarse_thickness = .1; // its bound, as a share of the smaller thickness
static const double standing = 1e-5; // m/s: slower pairs count as at rest

// Returns the path (m) after which a pair is tested again. Corners that were no contact points approach by a share of
// the bodies' path. They may be the cause if many substeps did not reach the tolerance: then the path is shorter.
static double retest_distance(const ob_solver *s)
{
	double tolerance = s->settings->tolerance;
	double share = max_retest_share * ob_min(1, 16. / s->island.substeps);
	const double usual = retest_path * s->island.unit.length;
	return tolerance > 0 ? ob_min(usual, share * tolerance) : usual;
}

static const double same_distance = 1e-9; // share of the squared distance: smaller differences are due to rounding

// Sorts points by their distance from the bodies' centres, which does not depend on the frame: a sweep over the rows of
// a block takes them in turn. Planes without friction do not count: they are the same everywhere. Equally distant
// points, and those of a rim, which have roles, stay in the order in which they were found.
static void order_points(const ob_island_work *w, ob_contact *contact, double *gap)
{
	double far[OB_PAIR_POINTS];
	const ob_shape sa = ob_part_shape(w->body[contact->a].shape, contact->part[0]),
		       sb = ob_part_shape(w->body[contact->b].shape, contact->part[1]);
	const double of_a = ob_shape_is(sa, OB_UNBOUNDED) && contact->mu == 0 ? 0 : 1,
		     of_b = ob_shape_is(sb, OB_UNBOUNDED) && contact->mu == 0 ? 0 : 1;
	if (ob_shape_is(sa, OB_RIMMED) || ob_shape_is(sb, OB_RIMMED))
		return;
	for (uint32_t i = 0; i < contact->points; i++) {
		const ob_vec3 a = contact->arm_a[i], b = contact->arm_b[i];
		const double g = gap[i], f = of_a * ob_norm2(a) + of_b * ob_norm2(b);
		uint32_t at = i;
		for (; at > 0 && far[at - 1] > f * (1 + same_distance); at--) {
			far[at] = far[at - 1], gap[at] = gap[at - 1];
			contact->arm_a[at] = contact->arm_a[at - 1], contact->arm_b[at] = contact->arm_b[at - 1];
		}
		far[at] = f, gap[at] = g, contact->arm_a[at] = a, contact->arm_b[at] = b;
	}
}

static void put_points(ob_island_work *w, ob_contact *contact, const ob_manifold *m, ob_vec3 pa, ob_vec3 pb,
		       saved_impulses *old)
{
	double gap[OB_PAIR_POINTS];
	contact->points = (uint32_t)m->points;
	contact->disc_radius = m->disc_radius;
	for (int j = 0; j < m->points; j++) {
		contact->arm_a[j] = ob_sub(m->at[j], pa);
		contact->arm_b[j] = ob_sub(m->at[j], pb);
		gap[j] = m->gap[j];
	}
	order_points(w, contact, gap);
	fill_lane(w, contact, m->normal, gap);
	if (old->points && !(ob_dot(m->normal, old->normal) > same_normal))
		old->points = 0;
	match_points(w, contact, old);
	warm_start_lane(w, contact, old);
}

void ob_contact_set_geometry(ob_solver *s, ob_contact *contact, const ob_manifold *m, ob_vec3 pa, ob_vec3 pb)
{
	ob_island_work *w = &s->island;
	saved_impulses old;
	save_impulses(w, contact, &old);
	put_points(w, contact, m, pa, pb, &old);
	contact->as_of_instant = true;
	contact->limit = -INFINITY;
}

void ob_contact_find(ob_solver *s, ob_contact *contact)
{
	ob_island_work *w = &s->island;
	ob_manifold m;
	double when;
	saved_impulses old;
	ob_body_update_pose(w, contact->a);
	ob_body_update_pose(w, contact->b);
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	const double thin = ob_min(a->thickness, b->thickness);
	const double tolerance = ob_coarser(w, retest_distance(s) * ob_min(1, 2 * thin / w->unit.length),
					    ob_min(coarse_share * w->tolerance, coarse_thickness * thin));
	ob_narrowphase_find(s, contact, tolerance, &m, &when);
	if (!m.points) {
		contact->limit = contact->path + ob_min(ob_max(tolerance, m.separation - tolerance), m.valid_path);
		if (contact->lane != OB_NO_LANE)
			leave_lane(w, contact);
		return;
	}
	contact->limit = contact->path + ob_min(tolerance, m.valid_path);
	contact->since = when > 0 ? INFINITY : 0;
	contact->found_for = w->h;
	if (contact->lane == OB_NO_LANE)
		take_lane(s, contact), old.points = 0;
	else
		save_impulses(w, contact, &old);
	ob_vec3 va = ob_v3(w->v[contact->a][0], w->v[contact->a][1], w->v[contact->a][2]);
	ob_vec3 vb = ob_v3(w->v[contact->b][0], w->v[contact->b][1], w->v[contact->b][2]);
	put_points(w, contact, &m, ob_madd(a->p, when, va), ob_madd(b->p, when, vb), &old);
}

double ob_contact_gap(const ob_island_work *w, const ob_contact *contact)
{
	const ob_batch *b = &w->batch[contact->lane / OB_LANES];
	const uint32_t l = contact->lane % OB_LANES;
	const double *da = w->d[contact->a], *db = w->d[contact->b];
	double least = INFINITY;
	for (uint32_t j = 0; j < contact->points; j++) {
		double gap = b->gap[j][l];
		for (int c = 0; c < 3; c++)
			gap += b->n[c][l] * (da[c] - db[c]) + b->ja[j][c][l] * da[3 + c] - b->jb[j][c][l] * db[3 + c];
		least = ob_min(least, gap);
	}
	return least;
}

// Bounds the speed (m/s) that the two bodies may gain, on average over the partial substep. Touching bodies are
// expected to go on as before: at rest they gain nothing.
static double speed_gain(const ob_island_work *w, const ob_contact *contact)
{
	double free = w->max_acceleration * w->h;
	const double *a = w->dv[contact->a], *b = w->dv[contact->b];
	if (contact->lane == OB_NO_LANE)
		return free;
	return ob_min(free, .5 * ob_norm(ob_v3(a[0] - b[0], a[1] - b[1], a[2] - b[2])));
}

bool ob_contact_in_reach(const ob_island_work *w, const ob_contact *contact)
{
	if (contact->lane == OB_NO_LANE)
		return false;
	const ob_batch *b = &w->batch[contact->lane / OB_LANES];
	for (uint32_t j = 0; j < contact->points; j++)
		if (b->impulse[j][contact->lane % OB_LANES] > 0)
			return true;
	return ob_contact_gap(w, contact) <= (ob_contact_speed(w, contact) + w->max_acceleration * w->h) * w->h;
}

// True if the pair moves and touches nothing else that moves; then it is tested in every partial substep. Reason: a
// body that nearly balances on an edge is turned by the small offset of its centre, which each motion changes. Among
// other contacts, iterations are no finer than that offset; a coarse run's tolerance is wider than it.
static bool moves_alone(const ob_island_work *w, const ob_contact *contact, double speed)
{
	return w->coarseness == 1 && contact->lane != OB_NO_LANE && !w->body[contact->a].among_others &&
	       !w->body[contact->b].among_others && speed > standing * w->unit.speed;
}

// True if another test would find the same geometry: the bodies have not moved since, nor been hit, and points were
// sought as far ahead. Never true for restless bodies.
static bool is_of_now(const ob_solver *s, const ob_contact *contact)
{
	const ob_island_work *w = &s->island;
	return contact->since == 0 && !s->methods.restless && contact->found_for >= w->h &&
	       contact->lane != OB_NO_LANE && !ob_contact_was_hit(w, contact);
}

// Advances the contact's path, and tests its geometry if needed. Returns true if it was tested.
static bool update_contact(ob_solver *s, ob_contact *contact, double since, double ahead)
{
	const ob_island_work *w = &s->island;
	const double speed = ob_contact_speed(w, contact);
	contact->path += since * speed;
	if ((contact->as_of_instant || contact->turns || is_of_now(s, contact)) && ahead > 0)
		return false;
	if (!(ahead > 0 && moves_alone(w, contact, speed)) &&
	    !(contact->path + (speed + speed_gain(w, contact)) * ahead > contact->limit))
		return false;
	s->counters.narrowphase_tests++;
	ob_contact_find(s, contact);
	return true;
}

bool ob_contacts_update(ob_solver *s, double ahead)
{
	bool any = false;
	ob_island_work *w = &s->island;
	const double since = w->unpaced;
	w->unpaced = 0;
	for (uint32_t i = 0; i < w->contacts; i++)
		any |= update_contact(s, &w->contact[i], since, ahead);
	return any;
}

bool ob_contacts_update_hit(ob_solver *s, double ahead)
{
	bool any = false;
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->contacts; i++)
		if (ob_contact_was_hit(w, &w->contact[i]) || s->methods.restless)
			any |= update_contact(s, &w->contact[i], 0, ahead);
	return any;
}

// Sorts batches by colour, and by age within a colour.
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

// Marks the pairs that touch nothing else, and counts in each lane the contacts of its bodies.
static void count_contacts(const ob_island_work *w, ob_batch *b, bool jacobi)
{
	b->isolated = b->hit = 0;
	for (unsigned left = b->live; left; left &= left - 1) {
		const int l = __builtin_ctz(left);
		const ob_body *m[2] = { &w->body[b->body_a[l]], &w->body[b->body_b[l]] };
		bool isolated =
			(m[0]->inv_mass == 0 || m[0]->in_reach <= 1) && (m[1]->inv_mass == 0 || m[1]->in_reach <= 1);
		b->isolated |= (unsigned)isolated << l;
		b->hit |= (unsigned)(m[0]->hit > 0 || m[1]->hit > 0) << l;
		if (jacobi) {
			lanes_put(&b->ka, l, ob_max(1, m[0]->contacts));
			lanes_put(&b->kb, l, ob_max(1, m[1]->contacts));
		}
	}
}

// Counts the contacts of each body that may carry load in the partial substep: 0, 1 or more. Lanes do not show it: for
// other contacts they depend on when the narrow phase ran last.
static void count_in_reach(ob_island_work *w)
{
	for (uint32_t row = 0; row < w->rows; row++)
		w->body[row].in_reach = w->body[row].joints ? 2 : 0; // a joint brings load, too
	for (uint32_t i = 0; i < w->contacts; i++) {
		const ob_contact *contact = &w->contact[i];
		ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
		const bool known = (a->inv_mass == 0 || a->in_reach > 1) && (b->inv_mass == 0 || b->in_reach > 1);
		if (known || !ob_contact_in_reach(w, contact))
			continue;
		a->in_reach++;
		b->in_reach++;
	}
}

// Finds the areas of pairs that touch nothing else.
static void find_areas(ob_solver *s)
{
	ob_island_work *w = &s->island;
	w->areas_due = false;
	for (uint32_t i = 0; i < w->contacts; i++) {
		ob_contact *contact = &w->contact[i];
		if (!contact->area_due || contact->lane == OB_NO_LANE)
			continue;
		ob_batch *b = &w->batch[contact->lane / OB_LANES];
		const uint32_t l = contact->lane % OB_LANES;
		if (!(b->isolated >> l & 1)) {
			w->areas_due = true;
			continue;
		}
		contact->area_due = false;
		b->areas |= (unsigned)ob_narrowphase_area(s, contact, &b->area[l]) << l;
	}
}

void ob_contacts_prepare(ob_solver *s)
{
	ob_island_work *w = &s->island;
	bool jacobi = s->methods.jacobi;
	if (w->order_stale)
		order_batches(w);
	count_in_reach(w);
	for (uint32_t i = 0; i < w->batches; i++) {
		ob_batch *b = &w->batch[i];
		count_contacts(w, b, jacobi && w->counts_stale);
		if (jacobi && w->counts_stale)
			b->dirty = 1;
	}
	w->counts_stale = false;
	if (w->areas_due)
		find_areas(s);
}

// ---- input and results

void ob_contact_load(ob_solver *s, const ob_island_pair *pair)
{
	ob_island_work *w = &s->island;
	ob_contact *contact = &w->contact[w->contacts++];
	set_lane(w, contact, OB_NO_LANE);
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	contact->mu = ob_pair_friction(a->friction, b->friction);
	contact->e = ob_pair_restitution(a->restitution, b->restitution);
	w->elastic |= contact->e > 0;
	const ob_pair_state *p = pair->before;
	contact->began = !p;
	contact->next_point = INFINITY;
	if (!p)
		return;
	contact->points = p->points;
	if (p->of_now && contact->limit > -INFINITY && pair->newest)
		contact->since = 0, contact->found_for = p->substep;
	contact->creep = p->creep;
	contact->disc_radius = p->disc_radius;
	for (uint32_t j = 0; j < OB_PAIR_POINTS; j++) {
		contact->arm_a[j] = p->arm_a[j];
		contact->arm_b[j] = ob_sub(contact->arm_a[j], p->between);
	}
	take_lane(s, contact);
	fill_lane(w, contact, p->normal, p->gap);
	ob_batch *batch = &w->batch[contact->lane / OB_LANES];
	const double *impulse = contact->mirror ? pair->impulse_b : p->impulse;
	for (int i = 0; i < OB_PAIR_ROWS; i++)
		batch->impulse[i][contact->lane % OB_LANES] = batch->impulse_start[i][contact->lane % OB_LANES] =
			impulse[i] * (w->h / p->substep);
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

void ob_contacts_load(ob_solver *s, const ob_island_input *in)
{
	ob_island_work *w = &s->island;
	const uint32_t most = s->methods.sides * in->pairs;
	if (most > w->contacts_max) {
		w->contacts_max = most + most / 2;
		w->contact = ob_reallocate(w->contact, w->contacts_max * sizeof *w->contact);
		w->contact_lane = ob_reallocate(w->contact_lane, w->contacts_max * sizeof *w->contact_lane);
		w->adjacency = ob_reallocate(w->adjacency, 2 * w->contacts_max * sizeof *w->adjacency);
		w->contact_key = ob_reallocate(w->contact_key, w->contacts_max * sizeof *w->contact_key);
		w->contact_order = ob_reallocate(w->contact_order, w->contacts_max * sizeof *w->contact_order);
	}
	w->contacts = 0;
	w->batches = 0;
	memset(w->open_batch, 0xff, sizeof w->open_batch);
	w->order_stale = w->counts_stale = true;
	w->elastic = false;
	ob_contact_order(s, in, w->contact_order);
	for (uint32_t i = 0; i < in->pairs; i++) {
		const ob_island_pair *pair = &in->pair[w->contact_order[i]];
		ob_contact *t = &w->contact[w->contacts];
		*t = (ob_contact){ .key = w->contact_order[i],
				   .a = w->row_of[pair->a],
				   .b = w->row_of[pair->b],
				   .part = { pair->part[0], pair->part[1] },
				   .lane = OB_NO_LANE,
				   .since = INFINITY };
		const uint32_t own = w->surfaces.count ? ob_surface_row(w, w->contact_order[i]) : 0;
		if (own)
			*(pair->fixed == pair->a ? &t->a : &t->b) = own;
		t->limit = pair->limit - w->body[t->a].path - w->body[t->b].path;
		s->methods.load(s, pair);
	}
	link_adjacent(w);
	ob_surfaces_begin(s);
}

// Copies the lane's impulses, or zeros without a lane.
static void store_impulses(const ob_island_work *w, const ob_contact *contact, double *impulse)
{
	for (int j = 0; j < OB_PAIR_ROWS; j++)
		impulse[j] = contact->lane == OB_NO_LANE
				     ? 0
				     : w->batch[contact->lane / OB_LANES].impulse[j][contact->lane % OB_LANES];
}

static void store_contact(const ob_island_work *w, const ob_contact *contact, ob_pair_state *p)
{
	*p = (ob_pair_state){ .points = (uint16_t)contact->points,
			      .of_now = contact->since == 0,
			      .substep = w->h,
			      .creep = (float)contact->creep,
			      .disc_radius = contact->disc_radius };
	for (int j = 0; j < OB_PAIR_POINTS; j++)
		p->arm_a[j] = contact->arm_a[j];
	p->between = ob_sub(contact->arm_a[0], contact->arm_b[0]);
	store_impulses(w, contact, p->impulse);
	if (contact->lane == OB_NO_LANE)
		return;
	const ob_batch *b = &w->batch[contact->lane / OB_LANES];
	int l = contact->lane % OB_LANES;
	for (uint32_t j = 0; j < OB_PAIR_POINTS; j++)
		p->gap[j] = b->gap[j][l];
	p->normal = ob_batch_vector(b->n, l);
}

void ob_contacts_report(ob_solver *s)
{
	ob_island_work *w = &s->island;
	ob_found_contact found = { 0 };
	for (uint32_t i = 0; i < w->contacts; i++) {
		const ob_contact *contact = &w->contact[i],
				 *mirror = i + 1 < w->contacts && contact[1].mirror ? contact + 1 : NULL;
		const ob_island_pair *pair = &s->in->pair[contact->key];
		const double path = contact->path + w->unpaced * ob_contact_speed(w, contact);
		const bool active = contact->lane != OB_NO_LANE;
		found.pair = pair->pair;
		found.limit = contact->limit - path + w->body[contact->a].path + w->body[contact->b].path;
		found.active = active;
		found.kept = active || pair->kept; // the step may have been solved before
		found.two_sided = s->methods.sides > 1;
		if (found.kept)
			store_contact(w, contact, &found.state);
		memset(found.impulse_b, 0,
		       sizeof found.impulse_b); // zero with one side: not the impulses of an earlier pair
		if (found.kept && mirror)
			store_impulses(w, mirror, found.impulse_b);
		s->calls.contact(s->calls.with, &found);
		i += mirror != NULL;
	}
}

#include "measure/measure.h"

#include <stdlib.h>
#include <string.h>

#include "motion/depth.h"
#include "shape/shape.h"

// ---- energy and momentum

static bool is_dynamic(const ob_snapshot *s, uint32_t id)
{
	const ob_passport *p = &s->passport[id];
	return p->flags & OB_OBJECT_PRESENT && !(p->flags & OB_OBJECT_STATIC) && p->mass > 0;
}

// I w in the world frame (kg m^2/s), from the principal moments in the body frame.
static ob_vec3 angular_momentum(const ob_passport *p, const ob_state *s)
{
	ob_mat3 r = ob_quat_matrix(s->pose.q);
	ob_vec3 w = ob_rotate_back(&r, s->w);
	return ob_rotate(&r, ob_v3(p->inertia.x * w.x, p->inertia.y * w.y, p->inertia.z * w.z));
}

double ob_measure_energy(const ob_snapshot *s, ob_vec3 gravity)
{
	double sum = 0;
	for (uint32_t id = 0; id < s->count; id++) {
		if (!is_dynamic(s, id))
			continue;
		const ob_passport *p = &s->passport[id];
		ob_state state = ob_snapshot_state(s, id);
		sum += .5 * p->mass * ob_norm2(state.v) + .5 * ob_dot(state.w, angular_momentum(p, &state)) -
		       p->mass * ob_dot(gravity, state.pose.p) - ob_dot(p->force, state.pose.p);
	}
	return sum;
}

ob_vec3 ob_measure_momentum(const ob_snapshot *s)
{
	ob_vec3 sum = ob_v3(0, 0, 0);
	for (uint32_t id = 0; id < s->count; id++)
		if (is_dynamic(s, id))
			sum = ob_madd(sum, s->passport[id].mass, ob_snapshot_state(s, id).v);
	return sum;
}

ob_vec3 ob_measure_angular_momentum(const ob_snapshot *s)
{
	ob_vec3 sum = ob_v3(0, 0, 0);
	for (uint32_t id = 0; id < s->count; id++) {
		if (!is_dynamic(s, id))
			continue;
		const ob_passport *p = &s->passport[id];
		ob_state state = ob_snapshot_state(s, id);
		sum = ob_add(ob_madd(sum, p->mass, ob_cross(state.pose.p, state.v)), angular_momentum(p, &state));
	}
	return sum;
}

// ---- hash

// FNV-1a, 64 bits (Fowler, Noll and Vo), least significant byte first on every machine.
static uint64_t hash_word(uint64_t hash, uint64_t word)
{
	for (int i = 0; i < 8; i++) {
		hash ^= word >> (8 * i) & 0xff;
		hash *= 0x100000001b3u;
	}
	return hash;
}

uint64_t ob_measure_hash(const ob_snapshot *s)
{
	uint64_t hash = 0xcbf29ce484222325u;
	for (uint32_t id = 0; id < s->count; id++) {
		if (!(s->passport[id].flags & OB_OBJECT_PRESENT))
			continue;
		ob_state state = ob_snapshot_state(s, id);
		uint64_t word[sizeof state / 8];
		memcpy(word, &state, sizeof state);
		hash = hash_word(hash, id);
		for (size_t i = 0; i < sizeof state / 8; i++)
			hash = hash_word(hash, word[i]);
	}
	return hash;
}

// ---- penetration
//
// A tree finds overlapping boxes: a node holds the boxes of a range, its children the halves of the range along the
// axis with the largest spread of centres. Two nodes without overlap have no pair in common.

enum { LEAF = 8, ASKED_EVERY = 256 };

// Cost of the depth of a pair, in tests of two boxes, some 2 ns each; and the limit.
enum { WORK_OF_DEPTH = 32, WORK_OF_COLUMN = 256, WORK_OF_SEARCH = 8192 };
static const uint64_t most_work = UINT64_C(1) << 31;

struct box {
	double bounds[6];
	uint32_t item;
};

struct item {
	uint32_t id, overlaps; // overlaps: number of others with overlapping boxes
	bool fixed;
	ob_solid solid;
};

struct node {
	double bounds[6];
	uint32_t first, count; // of the boxes
	uint32_t children; // the first of two; 0: a leaf
};

struct effort {
	uint64_t work, asked; // asked: work at the last call of stop
	bool (*stop)(void *context);
	void *context;
	bool stopped;
};

// Pair of objects that a joint lets overlap.
struct joined {
	uint32_t low, high; // ids
};

struct search {
	const ob_passport *passport; // [ids]
	uint32_t items; // at most, of solids and planes
	struct item *item;
	struct box *box;
	struct node *node;
	uint32_t nodes;
	ob_penetration *out;
	double *each; // [ids], m; NULL: not wanted
	double total; // m
	struct effort effort;
	struct joined *joined; // [joined_count], sorted
	size_t joined_count;
};

static bool is_over(struct effort *x)
{
	if (x->work - x->asked >= ASKED_EVERY * WORK_OF_SEARCH && x->stop) {
		x->asked = x->work;
		x->stopped |= x->stop(x->context);
	}
	return x->stopped || x->work > most_work;
}

static uint64_t work_of(const ob_solid *a, const ob_solid *b)
{
	return ob_depth_needs_search(a->shape, b->shape) ? WORK_OF_SEARCH : WORK_OF_DEPTH;
}

static int by_ids(const void *x, const void *y)
{
	const struct joined *a = x, *b = y;
	return a->low != b->low ? (a->low < b->low ? -1 : 1) : a->high < b->high ? -1 : a->high > b->high;
}

static struct joined joined_of(uint32_t a, uint32_t b)
{
	return (struct joined){ a < b ? a : b, a < b ? b : a };
}

// Lists them. false: no memory.
static bool list_joined(struct search *s, const ob_snapshot *from)
{
	s->joined = malloc((from->joints + 1) * sizeof *s->joined);
	for (uint32_t i = 0; s->joined && i < from->joints; i++) {
		const ob_joint_passport *j = &from->joint[i];
		if (ob_snapshot_has_joint(from, i) && j->object[1] != OB_JOINT_WORLD &&
		    !(j->flags & (OB_JOINT_COLLIDES | OB_JOINT_BROKEN)))
			s->joined[s->joined_count++] = joined_of(j->object[0], j->object[1]);
	}
	if (s->joined_count)
		qsort(s->joined, s->joined_count, sizeof *s->joined, by_ids);
	return s->joined;
}

static bool may_overlap(const struct search *s, uint32_t a, uint32_t b)
{
	const struct joined key = joined_of(a, b);
	return s->joined_count && bsearch(&key, s->joined, s->joined_count, sizeof key, by_ids);
}

static double greater(double a, double b)
{
	return a > b ? a : b;
}

static void note_depth(struct search *s, uint32_t a, uint32_t b, double depth)
{
	if (!(depth > 0))
		return;
	s->total += depth;
	s->out->pairs++;
	if (s->each) {
		s->each[a] = greater(s->each[a], depth);
		s->each[b] = greater(s->each[b], depth);
	}
	if (depth > s->out->max_m) {
		s->out->max_m = depth;
		s->out->worst_a = a < b ? a : b;
		s->out->worst_b = a < b ? b : a;
	}
}

static void add_depth(struct search *s, struct item *a, struct item *b)
{
	if (a->id == b->id || (a->fixed && b->fixed) ||
	    !ob_passport_collides(&s->passport[a->id], &s->passport[b->id]) || may_overlap(s, a->id, b->id))
		return;
	a->overlaps++;
	b->overlaps++;
	s->effort.work += work_of(&a->solid, &b->solid);
	note_depth(s, a->id, b->id, ob_depth(&a->solid, &b->solid));
}

// Depth of a solid in the ground below a triangle (m).
static double depth_in_column(const ob_terrain *t, uint32_t triangle, ob_pose pose, const ob_solid *x)
{
	const ob_mat3 r = ob_quat_matrix(pose.q);
	const double radius = ob_shape_radius(x->shape, x->size);
	ob_hull column;
	ob_vec3 centre;
	ob_terrain_column(t, triangle, 2 * radius, &column, &centre);
	const ob_solid ground = { OB_SHAPE_HULL, ob_v3(column.radius, .5 * column.thickness, column.inner),
				  ob_add(pose.p, ob_rotate(&r, centre)), r, &column };
	return ob_depth(x, &ground);
}

// Adds the depth of a solid with this box in a terrain.
static void add_depth_in_terrain(struct search *s, const ob_terrain *t, uint32_t id, ob_pose pose, struct item *x,
				 const double *box)
{
	const ob_mat3 r = ob_quat_matrix(pose.q);
	const ob_vec3 half = ob_v3(.5 * (box[3] - box[0]), .5 * (box[4] - box[1]), .5 * (box[5] - box[2])),
		      at = ob_rotate_back(&r, ob_sub(ob_v3(box[0] + half.x, box[1] + half.y, box[2] + half.z), pose.p)),
		      centre = ob_rotate_back(&r, ob_sub(x->solid.p, pose.p));
	const double middle[3] = { at.x, at.y, at.z };
	double low[3], high[3], most = 0;
	if (x->fixed || !ob_passport_collides(&s->passport[id], &s->passport[x->id]) || may_overlap(s, id, x->id))
		return;
	for (int i = 0; i < 3; i++) {
		const double reach = fabs(r.m[0][i]) * half.x + fabs(r.m[1][i]) * half.y + fabs(r.m[2][i]) * half.z;
		low[i] = middle[i] - reach, high[i] = middle[i] + reach;
	}
	ob_terrain_search near;
	uint32_t triangle;
	ob_terrain_begin(t, low, high, &near);
	while (ob_terrain_next(&near, &triangle) && !is_over(&s->effort)) {
		const ob_terrain_region *region = &ob_terrain_regions(t)[ob_terrain_triangles(t)[triangle].region];
		s->effort.work += WORK_OF_COLUMN;
		if (t->solid || ob_dot(region->normal, centre) > region->offset)
			most = greater(most, depth_in_column(t, triangle, pose, &x->solid));
	}
	note_depth(s, id, x->id, most);
}

static void add_terrain(struct search *x, const ob_snapshot *s, uint32_t id, uint32_t solids)
{
	const ob_terrain *t = ob_terrain_at(s->terrains, s->passport[id].hull);
	for (uint32_t i = 0; t && i < solids && !is_over(&x->effort); i++)
		add_depth_in_terrain(x, t, id, ob_snapshot_state(s, id).pose, &x->item[i], x->box[i].bounds);
}

static bool is_terrain(const ob_passport *p)
{
	return p->flags & OB_OBJECT_PRESENT && ob_shape_is(p->shape, OB_SURFACED);
}

static bool boxes_overlap(const double *a, const double *b)
{
	for (int i = 0; i < 3; i++)
		if (a[i] > b[i + 3] || b[i] > a[i + 3])
			return false;
	return true;
}

// Number of solids that an object consists of: a compound's are its parts.
static uint32_t solids_of(const ob_snapshot *s, uint32_t id)
{
	const uint32_t parts = ob_snapshot_parts(s, id);
	return parts ? parts : 1;
}

// Returns solid k of so many. Not for absent objects.
static ob_solid solid_of(const ob_snapshot *s, uint32_t id, uint32_t k)
{
	const ob_passport *p = &s->passport[id];
	const ob_hull *hull = ob_snapshot_part(s, id, ob_snapshot_parts(s, id) ? k + 1 : 0);
	return ob_solid_of(p->shape, p->size, ob_snapshot_state(s, id).pose, hull);
}

static void find_box(const ob_solid *solid, ob_pose pose, double bounds[6])
{
	if (solid->hull)
		ob_hull_bounds(solid->hull, pose, bounds);
	else
		for (int i = 0; i < 3; i++) {
			const double *r = solid->r.m[i], at = i == 0 ? solid->p.x : i == 1 ? solid->p.y : solid->p.z;
			const double reach = ob_shape_extent(solid->shape, solid->size, ob_v3(r[0], r[1], r[2]));
			bounds[i] = at - reach, bounds[i + 3] = at + reach;
		}
}

// Fills item[] with solids: those of finite size, each with a box, from the front, and planes from the back.
static void collect_solids(const ob_snapshot *s, struct search *x, uint32_t *solids, uint32_t *planes)
{
	*solids = *planes = 0;
	for (uint32_t id = 0; id < s->count; id++) {
		const ob_passport *p = &s->passport[id];
		if (!(p->flags & OB_OBJECT_PRESENT) || p->shape == OB_SHAPE_NONE || is_terrain(p))
			continue;
		const bool plane = ob_shape_is(p->shape, OB_UNBOUNDED);
		for (uint32_t k = 0; k < solids_of(s, id); k++) {
			struct item *i = plane ? &x->item[x->items - ++*planes] : &x->item[(*solids)++];
			i->id = id;
			i->overlaps = 0;
			i->fixed = p->flags & OB_OBJECT_STATIC || !(p->mass > 0);
			i->solid = solid_of(s, id, k);
			if (plane)
				continue;
			x->box[*solids - 1].item = *solids - 1;
			find_box(&i->solid, ob_snapshot_state(s, id).pose, x->box[*solids - 1].bounds);
		}
	}
}

static double middle(const struct box *b, int axis)
{
	return b->bounds[axis] + b->bounds[axis + 3];
}

static bool is_before(const struct box *a, const struct box *b, int axis)
{
	double x = middle(a, axis), y = middle(b, axis);
	return x != y ? x < y : a->item < b->item;
}

static double lesser(double a, double b)
{
	return a < b ? a : b;
}

// Bounds all boxes of a node; returns the axis with the largest spread of centres.
static int bound_boxes(struct node *n, const struct box *box)
{
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	int widest = 0;
	for (int k = 0; k < 3; k++)
		n->bounds[k] = INFINITY, n->bounds[k + 3] = -INFINITY;
	for (uint32_t i = n->first; i < n->first + n->count; i++)
		for (int k = 0; k < 3; k++) {
			n->bounds[k] = lesser(n->bounds[k], box[i].bounds[k]);
			n->bounds[k + 3] = greater(n->bounds[k + 3], box[i].bounds[k + 3]);
			low[k] = lesser(low[k], middle(&box[i], k));
			high[k] = greater(high[k], middle(&box[i], k));
		}
	for (int k = 1; k < 3; k++)
		if (high[k] - low[k] > high[widest] - low[widest])
			widest = k;
	return widest;
}

// Quickselect (Hoare 1961): the first half of the boxes before all of the second, along the axis. No two compare equal.
static void split_boxes(struct box *box, uint32_t count, int axis)
{
	uint32_t low = 0, high = count - 1, half = count / 2;
	while (low < high) {
		struct box pivot = box[low + (high - low) / 2], swapped;
		uint32_t i = low, j = high;
		while (i <= j) {
			while (is_before(&box[i], &pivot, axis))
				i++;
			while (is_before(&pivot, &box[j], axis))
				j--;
			if (i > j)
				break;
			swapped = box[i], box[i] = box[j], box[j] = swapped;
			i++;
			if (j == 0)
				break;
			j--;
		}
		if (half <= j)
			high = j;
		else if (half >= i)
			low = i;
		else
			return;
	}
}

static void build_tree(struct search *s, uint32_t at)
{
	struct node *n = &s->node[at];
	int axis = bound_boxes(n, s->box);
	n->children = 0;
	if (n->count <= LEAF)
		return;
	split_boxes(s->box + n->first, n->count, axis);
	uint32_t half = n->count / 2, children = s->nodes;
	s->nodes += 2;
	n->children = children;
	s->node[children] = (struct node){ .first = n->first, .count = half };
	s->node[children + 1] = (struct node){ .first = n->first + half, .count = n->count - half };
	build_tree(s, children);
	build_tree(s, children + 1);
}

static void test_leaves(struct search *s, const struct node *a, const struct node *b)
{
	for (uint32_t i = a->first; i < a->first + a->count; i++) {
		const struct box *one = &s->box[i];
		if (!boxes_overlap(one->bounds, b->bounds))
			continue;
		for (uint32_t j = a == b ? i + 1 : b->first; j < b->first + b->count && !is_over(&s->effort); j++) {
			s->effort.work++;
			if (boxes_overlap(one->bounds, s->box[j].bounds))
				add_depth(s, &s->item[one->item], &s->item[s->box[j].item]);
		}
	}
}

static void find_pairs(struct search *s, uint32_t one, uint32_t other)
{
	const struct node *a = &s->node[one], *b = &s->node[other];
	s->effort.work++;
	if (is_over(&s->effort) || !boxes_overlap(a->bounds, b->bounds))
		return;
	if (!a->children && !b->children) {
		test_leaves(s, a, b);
	} else if (one == other) {
		find_pairs(s, a->children, a->children);
		find_pairs(s, a->children + 1, a->children + 1);
		find_pairs(s, a->children, a->children + 1);
	} else if (a->children && (!b->children || a->count >= b->count)) {
		find_pairs(s, a->children, other);
		find_pairs(s, a->children + 1, other);
	} else {
		find_pairs(s, one, b->children);
		find_pairs(s, one, b->children + 1);
	}
}

static bool give_up(const struct search *s, const ob_snapshot *of, ob_error *e)
{
	const struct item *most = s->item;
	s->out->max_m = s->out->mean_m = NAN;
	if (s->effort.stopped)
		return ob_fail(e, "interrupted");
	for (uint32_t i = 0; i < s->items; i++)
		most = s->item[i].overlaps > most->overlaps ? &s->item[i] : most;
	return ob_fail(
		e,
		"step %llu: the boxes of more objects overlap than a measure of their penetration can look at; object "
		"%u (%.*s) alone overlaps %u others: move them apart",
		(unsigned long long)of->step, most->id, OB_NAME_MAX, of->passport[most->id].name, most->overlaps);
}

bool ob_measure_depths(const ob_snapshot *s, double *each, ob_penetration *out, bool (*stop)(void *context),
		       void *context, ob_error *e)
{
	*out = (ob_penetration){ 0 };
	if (!s->count)
		return true;
	struct search x = {
		.passport = s->passport, .out = out, .each = each, .effort = { .stop = stop, .context = context }
	};
	for (uint32_t id = 0; id < s->count; id++)
		x.items += solids_of(s, id);
	x.item = calloc(x.items, sizeof *x.item);
	x.box = malloc(x.items * sizeof *x.box);
	x.node = malloc(2 * (size_t)x.items * sizeof *x.node);
	bool fine = x.item && x.box && x.node && list_joined(&x, s);
	if (!fine) {
		out->max_m = out->mean_m = NAN;
		ob_fail(e, "no memory to measure the penetration of %u objects", s->count);
	} else {
		uint32_t solids, planes;
		collect_solids(s, &x, &solids, &planes);
		for (uint32_t k = 0; k < planes; k++)
			for (uint32_t i = 0; i < solids && !is_over(&x.effort); i++)
				add_depth(&x, &x.item[x.items - 1 - k], &x.item[i]);
		for (uint32_t id = 0; id < s->count; id++)
			if (is_terrain(
				    &s->passport
					     [id])) // the boxes are in the order of the solids until the tree is built
				add_terrain(&x, s, id, solids);
		x.node[0] = (struct node){ .count = solids };
		x.nodes = 1;
		if (solids) {
			build_tree(&x, 0);
			find_pairs(&x, 0, 0);
		}
		if (out->pairs)
			out->mean_m = x.total / (double)out->pairs;
		fine = !is_over(&x.effort) || give_up(&x, s, e);
	}
	free(x.item);
	free(x.box);
	free(x.node);
	free(x.joined);
	return fine;
}

bool ob_measure_penetration_unless(const ob_snapshot *s, ob_penetration *out, bool (*stop)(void *context),
				   void *context, ob_error *e)
{
	return ob_measure_depths(s, NULL, out, stop, context, e);
}

void ob_measure_penetration(const ob_snapshot *s, ob_penetration *out)
{
	ob_measure_penetration_unless(s, out, NULL, NULL, NULL);
}

// ---- separation

// Distance (m) of two objects, and the work of finding it; 0 if they overlap.
static double gap_between(const ob_snapshot *s, uint32_t a, uint32_t b, uint64_t *work)
{
	double gap = is_terrain(&s->passport[a]) || is_terrain(&s->passport[b]) ? 0 : INFINITY; // not measured there
	for (uint32_t i = 0; gap > 0 && i < solids_of(s, a); i++)
		for (uint32_t j = 0; j < solids_of(s, b); j++) {
			const ob_solid one = solid_of(s, a, i), other = solid_of(s, b, j);
			*work += work_of(&one, &other);
			gap = fmin(gap, fmax(0, -ob_depth(&one, &other)));
		}
	return gap;
}

// Impulse (N s) of all points of the contact at *i, which are consecutive; moves *i behind them.
static double contact_impulse(const ob_snapshot *s, size_t *i)
{
	const ob_contact_point *first = &s->contact[*i];
	double impulse = 0;
	for (; *i < s->contacts && s->contact[*i].a == first->a && s->contact[*i].b == first->b; (*i)++)
		impulse += s->contact[*i].impulse;
	return impulse;
}

void ob_measure_separation(const ob_snapshot *s, ob_separation *out, bool (*stop)(void *context), void *context)
{
	double sum = 0;
	struct effort effort = { .stop = stop, .context = context };
	*out = (ob_separation){ 0 };
	for (size_t i = 0; i < s->contacts;) {
		const ob_contact_point *c = &s->contact[i];
		if (!(contact_impulse(s, &i) > 0) || c->a >= s->count || c->b >= s->count)
			continue;
		if (is_over(&effort)) {
			*out = (ob_separation){ NAN, NAN, 0 };
			return;
		}
		const double gap = gap_between(s, c->a, c->b, &effort.work);
		out->pairs++;
		sum += gap;
		out->max_m = fmax(out->max_m, gap);
	}
	if (out->pairs)
		out->mean_m = sum / (double)out->pairs;
}

// Place of a joint on its object at this side, in the world.
static ob_vec3 place_of_joint(const ob_snapshot *s, const ob_joint_passport *j, int side)
{
	if (j->object[side] == OB_JOINT_WORLD)
		return j->frame[side].p;
	const ob_pose body = ob_snapshot_state(s, j->object[side]).pose;
	const ob_mat3 r = ob_quat_matrix(body.q);
	return ob_add(body.p, ob_rotate(&r, j->frame[side].p));
}

double ob_measure_gap(const ob_snapshot *s)
{
	double most = 0;
	for (uint32_t i = 0; i < s->joints; i++) {
		const ob_joint_passport *j = &s->joint[i];
		const bool parts =
			j->kind == OB_JOINT_SLIDER || j->kind == OB_JOINT_DISTANCE || j->kind == OB_JOINT_APART;
		if (!parts && ob_snapshot_has_joint(s, i) && !(j->flags & OB_JOINT_BROKEN))
			most = fmax(most, ob_norm(ob_sub(place_of_joint(s, j, 0), place_of_joint(s, j, 1))));
	}
	return most;
}

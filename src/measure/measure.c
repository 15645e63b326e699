#include "measure/measure.h"

#include <stdlib.h>
#include <string.h>

#include "measure/depth.h"

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

struct item {
	double low, high; // of its box, along the axis of the sweep
	double bounds[6];
	uint32_t id;
	bool fixed;
	ob_solid solid;
};

struct sum {
	ob_penetration *out;
	double total; // m
};

static int by_low(const void *a, const void *b)
{
	const struct item *x = a, *y = b;
	return x->low != y->low ? (x->low > y->low) - (x->low < y->low) : (x->id > y->id) - (x->id < y->id);
}

static void add_depth(struct sum *s, const struct item *a, const struct item *b)
{
	if (a->fixed && b->fixed)
		return;
	double depth = ob_depth(&a->solid, &b->solid);
	if (!(depth > 0))
		return;
	s->total += depth;
	s->out->pairs++;
	if (depth > s->out->max_m) {
		s->out->max_m = depth;
		s->out->worst_a = a->id < b->id ? a->id : b->id;
		s->out->worst_b = a->id < b->id ? b->id : a->id;
	}
}

static bool boxes_overlap(const struct item *a, const struct item *b)
{
	for (int i = 0; i < 3; i++)
		if (a->bounds[i] > b->bounds[i + 3] || b->bounds[i] > a->bounds[i + 3])
			return false;
	return true;
}

// Fills item[] with the solids of finite size from the front and the planes from the back.
static void collect_solids(const ob_snapshot *s, struct item *item, uint32_t *solids, uint32_t *planes)
{
	*solids = *planes = 0;
	for (uint32_t id = 0; id < s->count; id++) {
		const ob_passport *p = &s->passport[id];
		if (!(p->flags & OB_OBJECT_PRESENT) || p->shape == OB_SHAPE_NONE)
			continue;
		ob_pose pose = ob_snapshot_state(s, id).pose;
		bool plane = p->shape == OB_SHAPE_PLANE;
		struct item *i = plane ? &item[s->count - ++*planes] : &item[(*solids)++];
		i->id = id;
		i->fixed = p->flags & OB_OBJECT_STATIC || !(p->mass > 0);
		i->solid = (ob_solid){ p->shape, p->size, pose.p, ob_quat_matrix(pose.q) };
		ob_shape_bounds(p->shape, p->size, pose, i->bounds);
	}
}

// The axis along which the centres are spread most: towers are swept upwards, fields sideways.
static int widest_axis(const struct item *item, uint32_t n)
{
	double sum[3] = { 0 }, sum2[3] = { 0 };
	for (uint32_t i = 0; i < n; i++) {
		for (int k = 0; k < 3; k++) {
			double x = .5 * (item[i].bounds[k] + item[i].bounds[k + 3]);
			sum[k] += x;
			sum2[k] += x * x;
		}
	}
	int widest = 0;
	double spread[3];
	for (int k = 0; k < 3; k++) {
		spread[k] = sum2[k] - sum[k] * sum[k] / n;
		if (spread[k] > spread[widest])
			widest = k;
	}
	return widest;
}

static void sweep_and_prune(struct item *item, uint32_t n, struct sum *s)
{
	int axis = widest_axis(item, n);
	for (uint32_t i = 0; i < n; i++) {
		item[i].low = item[i].bounds[axis];
		item[i].high = item[i].bounds[axis + 3];
	}
	qsort(item, n, sizeof *item, by_low);
	for (uint32_t i = 0; i < n; i++)
		for (uint32_t j = i + 1; j < n && item[j].low <= item[i].high; j++)
			if (boxes_overlap(&item[i], &item[j]))
				add_depth(s, &item[i], &item[j]);
}

void ob_measure_penetration(const ob_snapshot *s, ob_penetration *out)
{
	*out = (ob_penetration){ 0 };
	if (!s->count)
		return;
	struct item *item = malloc(s->count * sizeof *item);
	if (!item) {
		out->max_m = out->mean_m = NAN;
		return;
	}
	struct sum sum = { out, 0 };
	uint32_t solids, planes;
	collect_solids(s, item, &solids, &planes);
	for (uint32_t k = 0; k < planes; k++)
		for (uint32_t i = 0; i < solids; i++)
			add_depth(&sum, &item[s->count - 1 - k], &item[i]);
	if (solids)
		sweep_and_prune(item, solids, &sum);
	if (out->pairs)
		out->mean_m = sum.total / (double)out->pairs;
	free(item);
}

// ---- separation

static ob_solid solid_of(const ob_snapshot *s, uint32_t id)
{
	const ob_passport *p = &s->passport[id];
	ob_state state = ob_snapshot_state(s, id);
	return (ob_solid){ p->shape, p->size, state.pose.p, ob_quat_matrix(state.pose.q) };
}

// Impulse (N s) of all points of the contact at *i, which follow one another; *i is set behind them.
static double contact_impulse(const ob_snapshot *s, size_t *i)
{
	const ob_contact_point *first = &s->contact[*i];
	double impulse = 0;
	for (; *i < s->contacts && s->contact[*i].a == first->a && s->contact[*i].b == first->b; (*i)++)
		impulse += s->contact[*i].impulse;
	return impulse;
}

void ob_measure_separation(const ob_snapshot *s, ob_separation *out)
{
	double sum = 0;
	*out = (ob_separation){ 0 };
	for (size_t i = 0; i < s->contacts;) {
		const ob_contact_point *c = &s->contact[i];
		if (!(contact_impulse(s, &i) > 0) || c->a >= s->count || c->b >= s->count)
			continue;
		ob_solid a = solid_of(s, c->a), b = solid_of(s, c->b);
		double gap = fmax(0, -ob_depth(&a, &b));
		out->pairs++;
		sum += gap;
		out->max_m = fmax(out->max_m, gap);
	}
	if (out->pairs)
		out->mean_m = sum / (double)out->pairs;
}

#include "measure/measure.h"

#include <stdlib.h>

#include "measure/depth.h"

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

static void look(struct sum *s, const struct item *a, const struct item *b)
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
static void collect(const ob_snapshot *s, struct item *item, uint32_t *solids, uint32_t *planes)
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

static void sweep(struct item *item, uint32_t n, struct sum *s)
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
				look(s, &item[i], &item[j]);
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
	collect(s, item, &solids, &planes);
	for (uint32_t k = 0; k < planes; k++)
		for (uint32_t i = 0; i < solids; i++)
			look(&sum, &item[s->count - 1 - k], &item[i]);
	if (solids)
		sweep(item, solids, &sum);
	if (out->pairs)
		out->mean_m = sum.total / (double)out->pairs;
	free(item);
}

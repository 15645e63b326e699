#include "sim/pairs.h"

#include <stdlib.h>
#include <string.h>

#include <ob/motion.h>

#include "sim/now.h"
#include "sim/outcome.h"

// The newest version of after so many steps, or before; -1: none. What was written in a step that is done again is
// newer.
static int before(const ob_pair_record *r, uint64_t steps)
{
	int found = -1;
	for (int k = 0; k < 2; k++)
		if (r->stamp[k] && r->stamp[k] <= steps + 1 && (found < 0 || r->stamp[k] > r->stamp[found]))
			found = k;
	return found;
}

const ob_pair_state *ob_pair_before(const ob_pair_record *r, uint64_t steps)
{
	int k = before(r, steps);
	return k < 0 ? NULL : &r->version[k];
}

ob_pair_state *ob_pair_write(ob_pair_record *r, uint64_t steps)
{
	int k = before(r, steps) == 0;
	r->stamp[k] = (uint32_t)(steps + 2);
	return &r->version[k];
}

static int by_key(const void *x, const void *y)
{
	uint64_t a = *(const uint64_t *)x, b = *(const uint64_t *)y;
	return a < b ? -1 : a > b;
}

static uint64_t key_of(uint32_t a, uint32_t b)
{
	return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

static bool immobile(const ob_step_data *ex, uint32_t id)
{
	return ex->brief[id].state < OB_SCHEDULE_AWAKE;
}

// All pairs that the objects of the list have perceived, sorted, each once: of two that have both moved, which have
// both found their boxes to overlap, the lower one tells. The caller frees.
static uint64_t *perceived_keys(ob_universe *u, const uint32_t *list, uint32_t count, const uint32_t *moved, size_t *n)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	size_t total = 0, kept = 0;
	for (uint32_t k = 0; k < count; k++)
		total += ex->perceived[list[k]].count;
	uint64_t *keys = malloc((total + 1) * sizeof *keys);
	for (uint32_t k = 0; keys && k < count; k++) {
		const struct ob_neighbours *p = &ex->perceived[list[k]];
		for (uint32_t i = 0; i < p->count; i++) {
			uint32_t other = ex->perceived_id[p->offset + i];
			bool told = moved[other] && other < list[k];
			if (!told && (!immobile(ex, list[k]) || !immobile(ex, other)))
				keys[kept++] = key_of(list[k], other);
		}
	}
	if (keys)
		qsort(keys, kept, sizeof *keys, by_key);
	*n = kept;
	return keys;
}

static double apart_from_plane(const ob_universe *u, uint32_t plane, ob_vec3 at, double sphere)
{
	const ob_motion *m = ob_newest_motion(u, plane);
	ob_mat3 r = ob_quat_matrix(m->q);
	return ob_dot(ob_column(&r, 2), ob_sub(at, m->p)) - sphere;
}

double ob_pairs_apart(const ob_universe *u, uint32_t a, uint32_t b, uint64_t steps)
{
	const ob_passport *pa = ob_passport_of(u, a), *pb = ob_passport_of(u, b);
	const ob_motion *ma = ob_result_of(u, a), *mb = ob_result_of(u, b);
	bool boxed = ob_universe_settings(u)->narrow_phase == OB_NARROW_AABB; // reaches beyond the sphere round it
	double ra = ob_shape_radius(pa->shape, pa->size), rb = ob_shape_radius(pb->shape, pb->size);
	ob_vec3 at_a = ob_centre_now(u, a, ma, steps), at_b = ob_centre_now(u, b, mb, steps);
	if (pa->shape == OB_SHAPE_PLANE)
		return apart_from_plane(u, a, at_b, (boxed ? sqrt(3) : 1) * rb);
	if (pb->shape == OB_SHAPE_PLANE)
		return apart_from_plane(u, b, at_a, (boxed ? sqrt(3) : 1) * ra);
	double spheres = ob_norm(ob_sub(at_a, at_b)) - ra - rb;
	if (spheres > fmax(ra, rb) && !boxed) // attitudes would not add much, and cost more
		return spheres;
	double box_a[6], box_b[6], apart = 0;
	ob_shape_bounds(pa->shape, pa->size, ob_state_now(u, a, ma, steps).pose, box_a);
	ob_shape_bounds(pb->shape, pb->size, ob_state_now(u, b, mb, steps).pose, box_b);
	for (int c = 0; c < 3; c++)
		apart = fmax(apart, fmax(box_a[c] - box_b[3 + c], box_b[c] - box_a[3 + c]));
	return boxed ? apart : fmax(apart, spheres);
}

static ob_pair_key new_pair(const ob_universe *u, uint64_t key, uint64_t steps)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	uint32_t a = (uint32_t)(key >> 32), b = (uint32_t)key;
	double apart = ob_pairs_apart(u, a, b, steps);
	double paths = ob_schedule_path(&ex->brief[a], steps) + ob_schedule_path(&ex->brief[b], steps);
	double limit = apart > 0 ? paths + apart : -1;
	return (ob_pair_key){ .a = a, .b = b, .record = OB_NO_RECORD, .limit = limit };
}

static uint64_t key_of_pair(const ob_pair_key *k)
{
	return (uint64_t)k->a << 32 | k->b;
}

void ob_pair_let_go(ob_universe *u, ob_pair_key *k)
{
	if (k->record != OB_NO_RECORD)
		ob_record_give_back(u, k->record);
	k->record = OB_NO_RECORD;
}

// Drops the pairs of what has moved that are no longer perceived, and from the keys those that are there already.
// Returns how many keys are left.
static size_t keep_perceived(ob_universe *u, const uint32_t *moved, uint64_t *keys, size_t count)
{
	ob_step_data *ex = ob_universe_step_data(u);
	size_t k = 0, fresh = 0;
	uint32_t kept = 0;
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		const ob_pair_key *old = &ex->pair[i];
		while (k < count && keys[k] < key_of_pair(old))
			keys[fresh++] = keys[k++];
		bool still = k < count && keys[k] == key_of_pair(old);
		k += still;
		// What has touched in this step is let go when it is over: it may have to be solved again.
		if (still || old->record != OB_NO_RECORD || !(moved[old->a] | moved[old->b]))
			ex->pair[kept++] = *old;
	}
	while (k < count)
		keys[fresh++] = keys[k++];
	ex->count->pairs = kept;
	return fresh;
}

// From the back, where there is room.
static bool insert(ob_universe *u, const uint64_t *keys, size_t fresh, uint64_t steps)
{
	ob_step_data *ex = ob_universe_step_data(u);
	size_t old = ex->count->pairs, end = old + fresh;
	if (end > ex->pairs_max)
		return false;
	ex->count->pairs = (uint32_t)end;
	while (fresh > 0) {
		if (old > 0 && key_of_pair(&ex->pair[old - 1]) > keys[fresh - 1])
			ex->pair[--end] = ex->pair[--old];
		else
			ex->pair[--end] = new_pair(u, keys[--fresh], steps);
	}
	return true;
}

void ob_pairs_merge(ob_universe *u, uint64_t steps)
{
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t count, *moved = ex->scratch;
	const uint32_t *list = ob_requery_list(u, &count);
	size_t fresh;
	if (!count)
		return;
	memset(moved, 0, ob_universe_ids(u) * sizeof *moved);
	for (uint32_t i = 0; i < count; i++)
		moved[list[i]] = 1;
	uint64_t *keys = perceived_keys(u, list, count, moved, &fresh);
	if (!keys || !insert(u, keys, keep_perceived(u, moved, keys, fresh), steps))
		ex->count->failure = OB_STEP_PAIRS_FULL;
	free(keys);
	ob_requery_reset(u);
	ob_neighbours_reset(u);
}

void ob_pairs_drop(ob_universe *u, uint32_t id)
{
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t out = 0;
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		if (ex->pair[i].a == id || ex->pair[i].b == id)
			ob_pair_let_go(u, &ex->pair[i]);
		else
			ex->pair[out++] = ex->pair[i];
	}
	ex->count->pairs = out;
}

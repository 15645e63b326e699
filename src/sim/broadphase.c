#include "sim/broadphase.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <ob/motion.h>

#include "base/cpu.h"
#include "sim/publish.h"

// Size classes 1 .. 63: cells of 2^-32 m .. 2^30 m.
enum { LEVEL_ZERO = 33, LEVELS = 64 };

typedef struct cell {
	int32_t level, x, y, z;
} cell;

static uint32_t bucket_of(const ob_step_data *ex, cell c)
{
	uint64_t h = (uint64_t)(uint32_t)c.x * 0x9E3779B97F4A7C15u ^ (uint64_t)(uint32_t)c.y * 0xC2B2AE3D27D4EB4Fu ^
		     (uint64_t)(uint32_t)c.z * 0x165667B19E3779F9u ^ (uint64_t)(uint32_t)c.level << 58;
	h ^= h >> 29;
	h *= 0xBF58476D1CE4E5B9u;
	return (uint32_t)(h >> 32) & (ex->buckets - 1);
}

static bool is_plane(const ob_universe *u, uint32_t id)
{
	return ob_passport_of(u, id)->shape == OB_SHAPE_PLANE;
}

static int32_t coordinate(double x, double side)
{
	double c = floor(x / side);
	return c < -1e9 ? -1000000000 : c > 1e9 ? 1000000000 : (int32_t)c;
}

static double side_of(int level)
{
	return ldexp(1, level - LEVEL_ZERO);
}

static cell cell_of(const float *b)
{
	float e = fmaxf(b[3] - b[0], fmaxf(b[4] - b[1], b[5] - b[2]));
	int level;
	frexpf(e, &level); // e = f 2^level, f in [.5, 1): the cell's side 2^level is not below e
	level += LEVEL_ZERO;
	level = level < 1 ? 1 : level >= LEVELS ? LEVELS - 1 : level;
	double side = side_of(level);
	return (cell){ level, coordinate(.5 * ((double)b[0] + b[3]), side),
		       coordinate(.5 * ((double)b[1] + b[4]), side), coordinate(.5 * ((double)b[2] + b[5]), side) };
}

static bool indexed(const ob_index_cell *c)
{
	return c->level != 0;
}

// Until the last object of a class has left it, its cells stay between where any of them was.
static void widen(ob_step_data *ex, cell to)
{
	const int32_t at[3] = { to.x, to.y, to.z };
	int32_t *low = ex->count->level_low[to.level], *high = ex->count->level_high[to.level];
	const bool first = !ex->count->levels[to.level];
	for (int c = 0; c < 3; c++) {
		low[c] = first || at[c] < low[c] ? at[c] : low[c];
		high[c] = first || at[c] > high[c] ? at[c] : high[c];
	}
}

static void unlink_object(ob_step_data *ex, uint32_t id)
{
	ob_index_cell *c = &ex->cell[id];
	uint32_t *link = &ex->bucket[bucket_of(ex, (cell){ c->level, c->x, c->y, c->z })];
	while (*link != id + 1)
		link = &ex->cell[*link - 1].next;
	*link = c->next;
	ex->count->levels[c->level]--;
	if (c->after)
		ex->cell[c->after - 1].before = c->before;
	if (c->before)
		ex->cell[c->before - 1].after = c->after;
	else
		ex->count->level_first[c->level] = c->after;
	c->level = 0;
}

static uint32_t plane_at(const ob_step_data *ex, uint32_t id)
{
	uint32_t i = 0;
	while (i < ex->count->planes && ex->plane[i] != id)
		i++;
	return i;
}

void ob_index_put(ob_universe *u, uint32_t id)
{
	ob_step_data *ex = ob_universe_step_data(u);
	if (is_plane(u, id)) {
		if (plane_at(ex, id) == ex->count->planes)
			ex->plane[ex->count->planes++] = id;
		return;
	}
	ob_index_cell *c = &ex->cell[id];
	cell to = cell_of(ex->bounds[id]);
	if (indexed(c)) {
		if (c->level == to.level && c->x == to.x && c->y == to.y && c->z == to.z)
			return;
		unlink_object(ex, id);
	}
	uint32_t *head = &ex->bucket[bucket_of(ex, to)];
	uint32_t *first = &ex->count->level_first[to.level];
	*c = (ob_index_cell){ *head, to.level, to.x, to.y, to.z, 0, *first };
	*head = id + 1;
	if (*first)
		ex->cell[*first - 1].before = id + 1;
	*first = id + 1;
	widen(ex, to);
	ex->count->levels[to.level]++;
}

void ob_index_remove(ob_universe *u, uint32_t id)
{
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t plane = plane_at(ex, id);
	if (plane < ex->count->planes)
		ex->plane[plane] = ex->plane[--ex->count->planes];
	else if (indexed(&ex->cell[id]))
		unlink_object(ex, id);
}

static bool below_plane(const ob_universe *u, uint32_t plane, const float *b)
{
	const ob_motion *m = ob_newest_motion(u, plane);
	ob_mat3 r = ob_quat_matrix(m->q);
	ob_vec3 n = ob_column(&r, 2);
	ob_vec3 low = ob_v3(n.x > 0 ? b[0] : b[3], n.y > 0 ? b[1] : b[4], n.z > 0 ? b[2] : b[5]);
	return ob_dot(n, ob_sub(low, m->p)) <= 0;
}

// A growing answer that counts on when it is full.
typedef struct answer {
	uint32_t *id, n, max;
	uint32_t load; // of each test of two boxes
	uint64_t tests;
} answer;

static bool overlap(answer *to, const float *a, const float *b)
{
	to->tests++;
	ob_synthetic_load(to->load);
	return a[0] <= b[3] && b[0] <= a[3] && a[1] <= b[4] && b[1] <= a[4] && a[2] <= b[5] && b[2] <= a[5];
}

static void found(answer *a, uint32_t id)
{
	if (a->n < a->max)
		a->id[a->n] = id;
	a->n++;
}

static void scan_level(const ob_step_data *ex, uint32_t id, int level, answer *a)
{
	for (uint32_t j = ex->count->level_first[level]; j; j = ex->cell[j - 1].after)
		if (j - 1 != id && overlap(a, ex->bounds[id], ex->bounds[j - 1]))
			found(a, j - 1);
}

static void scan_cells(const ob_step_data *ex, uint32_t id, int level, const cell *lo, const cell *hi, answer *a)
{
	for (int32_t z = lo->z; z <= hi->z; z++)
		for (int32_t y = lo->y; y <= hi->y; y++)
			for (int32_t x = lo->x; x <= hi->x; x++)
				for (uint32_t next = ex->bucket[bucket_of(ex, (cell){ level, x, y, z })]; next;
				     next = ex->cell[next - 1].next) {
					uint32_t j = next - 1;
					const ob_index_cell *c = &ex->cell[j];
					if (j != id && c->level == level && c->x == x && c->y == y && c->z == z &&
					    overlap(a, ex->bounds[id], ex->bounds[j]))
						found(a, j);
				}
}

// The cells of a class in which the centre of a box may lie that overlaps b; false: there are none.
static bool cells_around(const ob_step_data *ex, const float *b, int level, cell *lo, cell *hi)
{
	const double side = side_of(level), h = .5 * side; // a centre lies at most half a side outside
	const int32_t *low = ex->count->level_low[level], *high = ex->count->level_high[level];
	int32_t from[3], to[3];
	for (int c = 0; c < 3; c++) {
		from[c] = coordinate(b[c] - h, side), to[c] = coordinate(b[3 + c] + h, side);
		from[c] = from[c] > low[c] ? from[c] : low[c];
		to[c] = to[c] < high[c] ? to[c] : high[c];
		if (from[c] > to[c])
			return false;
	}
	*lo = (cell){ level, from[0], from[1], from[2] };
	*hi = (cell){ level, to[0], to[1], to[2] };
	return true;
}

uint32_t ob_index_query(const ob_universe *u, uint32_t id, uint32_t *out, uint32_t max, uint64_t *tests)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	answer a = { out, 0, max, ob_universe_settings(u)->load, 0 };
	const float *b = ex->bounds[id];
	if (is_plane(u, id)) {
		for (uint32_t j = 0; j < ob_universe_ids(u); j++)
			if (indexed(&ex->cell[j]) && below_plane(u, id, ex->bounds[j]))
				found(&a, j);
		return a.n;
	}
	for (int level = 1; level < LEVELS; level++) {
		cell lo, hi;
		uint32_t there = ex->count->levels[level];
		if (!there || !cells_around(ex, b, level, &lo, &hi))
			continue;
		double cells = (hi.x - lo.x + 1.) * (hi.y - lo.y + 1.) * (hi.z - lo.z + 1.);
		if (cells > there)
			scan_level(ex, id, level, &a);
		else
			scan_cells(ex, id, level, &lo, &hi, &a);
	}
	for (uint32_t k = 0; k < ex->count->planes; k++)
		if (below_plane(u, ex->plane[k], b))
			found(&a, ex->plane[k]);
	*tests += a.tests;
	return a.n;
}

static const double lasting = 2; // claimed boxes last about so many steps
static const double base_margin = .04; // m: of an object at rest ..
static const double base_share = .2; // .. but no more than this share of its radius, for heaps of small things
static const double generous = 4; // times the margin that a new box would have: too large
static const double roomy = 2; // times as long as a flight's new box: what goes on being used for it, at most
static const uint64_t review_steps = 16;
static const double far_margin = 1.5; // m: fast ones claim only what one step needs beyond this

double ob_turning_speed(ob_vec3 w, ob_shape shape, ob_vec3 size)
{
	double rate = ob_norm(w);
	return shape == OB_SHAPE_SPHERE || rate == 0 ? 0 : rate * ob_shape_radius(shape, size);
}

double ob_surface_speed(ob_vec3 v, ob_vec3 w, ob_shape shape, ob_vec3 size)
{
	return ob_norm(v) + ob_turning_speed(w, shape, size);
}

double ob_step_reach(const ob_run_settings *run, const ob_passport *p, ob_vec3 v, ob_vec3 w)
{
	double speed = ob_surface_speed(v, w, p->shape, p->size);
	return (speed + ob_norm(ob_external_acceleration(run, p)) * run->step_length) * run->step_length;
}

static bool holds(const float *box, const double *tight, double margin)
{
	for (int c = 0; c < 3; c++)
		if (tight[c] - margin < box[c] || tight[3 + c] + margin > box[3 + c])
			return false;
	return true;
}

static void claim(ob_universe *u, uint32_t id, const double *tight, double margin)
{
	ob_step_data *ex = ob_universe_step_data(u);
	for (int c = 0; c < 3; c++) {
		// Rounded outwards; a plane's box stays infinite.
		ex->bounds[id][c] = nextafterf((float)(tight[c] - margin), -FLT_MAX);
		ex->bounds[id][3 + c] = nextafterf((float)(tight[3 + c] + margin), FLT_MAX);
	}
	if (!ob_broadphase_query_pending(u, id)) {
		ex->neighbours[id].count = UINT32_MAX;
		ob_requery_append(u, id);
	}
}

static double resting_margin(ob_shape shape, ob_vec3 size)
{
	return fmin(base_margin, base_share * ob_shape_radius(shape, size));
}

// What to claim for some steps: on all sides what the next one needs, in which it may be hit and thrown anywhere, and
// beyond that where it goes. Returns the margin on all sides (m); box: with the way that it goes, without the margin.
static double look_ahead(const ob_universe *u, const ob_passport *p, const ob_state *now, double reach, double *box)
{
	const double h = ob_universe_settings(u)->step_length, way[3] = { h * now->v.x, h * now->v.y, h * now->v.z };
	double once = resting_margin(p->shape, p->size) + reach;
	double more = reach > 0 ? fmax(0, fmin(lasting - 1, (far_margin - once) / reach)) : 0; // steps
	for (int c = 0; c < 3; c++) {
		box[c] += fmin(0, more * way[c]);
		box[3 + c] += fmax(0, more * way[c]);
	}
	return once + more * fmax(0, reach - h * ob_norm(now->v));
}

static bool much_larger(const float *box, const double *next, double margin)
{
	for (int c = 0; c < 3; c++)
		if ((double)box[3 + c] - box[c] > next[3 + c] - next[c] + 2 * generous * margin)
			return true;
	return false;
}

void ob_fat_aabb_update(ob_universe *u, uint32_t id, const ob_state *now, double reach)
{
	const ob_passport *p = ob_passport_of(u, id);
	const float *box = ob_universe_step_data(u)->bounds[id];
	double next[6];
	ob_shape_bounds(p->shape, p->size, now->pose, next);
	bool held = holds(box, next, reach);
	// A box claimed when the object was fast is given up when it is not; looked at now and then, not all at once.
	if (held && (ob_step_count(u) + id) % review_steps)
		return;
	double margin = look_ahead(u, p, now, reach, next);
	if (!held || much_larger(box, next, margin))
		claim(u, id, next, margin);
}

void ob_fat_aabb_renew(ob_universe *u, uint32_t id, const ob_state *now, double reach)
{
	const ob_passport *p = ob_passport_of(u, id);
	double next[6];
	ob_shape_bounds(p->shape, p->size, now->pose, next);
	double margin = look_ahead(u, p, now, reach, next);
	claim(u, id, next, margin);
}

void ob_fat_aabb_sweep(ob_universe *u, uint32_t id, const double *box, double margin)
{
	const float *old = ob_universe_step_data(u)->bounds[id];
	bool fits = holds(old, box, margin);
	for (int c = 0; c < 3; c++)
		fits &= old[3 + c] - old[c] <= roomy * (box[3 + c] - box[c] + 2 * margin);
	if (!fits)
		claim(u, id, box, margin);
}

bool ob_broadphase_query_pending(const ob_universe *u, uint32_t id)
{
	return ob_universe_step_data(u)->neighbours[id].count == UINT32_MAX;
}

void ob_broadphase_query(ob_universe *u, uint32_t id, uint64_t *box_tests)
{
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t near[256], n = ob_index_query(u, id, near, 256, box_tests);
	uint32_t offset = ob_neighbours_reserve(u, n);
	if (offset == UINT32_MAX) {
		ex->count->failure = OB_STEP_NEIGHBOURS_FULL;
		n = offset = 0;
	} else if (n <= 256) {
		for (uint32_t i = 0; i < n; i++)
			ex->neighbour_id[offset + i] = near[i];
	} else {
		ob_index_query(u, id, ex->neighbour_id + offset, n, box_tests);
	}
	ex->neighbours[id] = (struct ob_neighbours){ offset, n };
}

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
	return ex->schedule[id].state < OB_SCHEDULE_AWAKE;
}

// All pairs that the objects of the list have perceived, sorted, each once: of two that have both moved, which have
// both found their boxes to overlap, the lower one tells. The caller frees.
static uint64_t *perceived_keys(ob_universe *u, const uint32_t *list, uint32_t count, const uint32_t *moved, size_t *n)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	size_t total = 0, kept = 0;
	for (uint32_t k = 0; k < count; k++)
		total += ex->neighbours[list[k]].count;
	uint64_t *keys = malloc((total + 1) * sizeof *keys);
	for (uint32_t k = 0; keys && k < count; k++) {
		const struct ob_neighbours *p = &ex->neighbours[list[k]];
		for (uint32_t i = 0; i < p->count; i++) {
			uint32_t other = ex->neighbour_id[p->offset + i];
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
	double paths = ob_schedule_path(&ex->schedule[a], steps) + ob_schedule_path(&ex->schedule[b], steps);
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

#include "step/broadphase.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include <ob/motion.h>

#include "base/cpu.h"
#include "exchange/results.h"
#include "motion/drift.h"
#include "shape/shape.h"
#include "solver/relative_speed.h"
#include "step/publish.h"

// ---- spatial index

// Size classes 1 .. 63: cells of 2^-32 m .. 2^30 m. The last has all that is larger, too, so it is searched as a whole.
enum { LEVEL_ZERO = 33, LEVELS = 64 };
enum { CELLS_AT_ONCE = 32 }; // cells whose buckets, and then objects, are prefetched together

typedef struct cell {
	int32_t level, x, y, z;
} cell;

// Layout: each cell has a place; eight places share a bucket. Cells that differ in x alone have consecutive places. A
// query reads a row of cells at once, from one bit per place (ob_step_data.occupied): most cells are empty.
enum { PLACES_PER_BUCKET = 8 };

// Returns the place of the cell with x = 0 in a row of cells.
static uint32_t place_of_row(int32_t level, int32_t y, int32_t z)
{
	uint64_t h = (uint64_t)(uint32_t)y * 0xC2B2AE3D27D4EB4Fu ^ (uint64_t)(uint32_t)z * 0x165667B19E3779F9u ^
		     (uint64_t)(uint32_t)level << 58;
	h ^= h >> 29;
	h *= 0xBF58476D1CE4E5B9u;
	return (uint32_t)(h >> 32);
}

static uint32_t place_of(cell c)
{
	return place_of_row(c.level, c.y, c.z) + (uint32_t)c.x;
}

// Returns the bucket of a place: places that differ by a multiple of data->buckets share it.
static uint32_t bucket_of(const ob_step_data *data, uint32_t place)
{
	return place & (data->buckets - 1);
}

// Returns the number of words of the bitmap "occupied": a power of two.
static uint32_t occupied_words(const ob_step_data *data)
{
	return data->buckets / (64 / PLACES_PER_BUCKET);
}

static uint64_t *occupied_word(const ob_step_data *data, uint32_t place)
{
	return &data->occupied[place / 64 & (occupied_words(data) - 1)];
}

static bool is_plane(const ob_universe *u, uint32_t id)
{
	return ob_shape_is(ob_passport_of(u, id)->shape, OB_UNBOUNDED);
}

// Returns the cell coordinate of x (m). per_metre: cells per metre, a power of two.
static int32_t coordinate(double x, double per_metre)
{
	const double farthest = 1e9, there = x * per_metre,
		     c = fabs(there) < farthest ? there
			 : there < 0            ? -farthest
						: farthest;
	const int32_t towards_zero = (int32_t)c;
	return towards_zero - (c < towards_zero);
}

// Returns 2^n, written into the exponent: faster than ldexp, a library call.
static double power_of_two(int n)
{
	const uint64_t bits = (uint64_t)(1023 + n) << 52;
	double x;
	memcpy(&x, &bits, sizeof x);
	return x;
}

static cell cell_of(const float *b)
{
	float e = fmaxf(b[3] - b[0], fmaxf(b[4] - b[1], b[5] - b[2]));
	int level;
	frexpf(fminf(e, FLT_MAX), &level); // e = f 2^level, f in [.5, 1): the cell's side 2^level is at least e
	level += LEVEL_ZERO;
	level = level < 1 ? 1 : level >= LEVELS ? LEVELS - 1 : level;
	const double per_metre = power_of_two(LEVEL_ZERO - level);
	return (cell){ level, coordinate(.5 * ((double)b[0] + b[3]), per_metre),
		       coordinate(.5 * ((double)b[1] + b[4]), per_metre),
		       coordinate(.5 * ((double)b[2] + b[5]), per_metre) };
}

static bool indexed(const ob_index_cell *c)
{
	return c->level != 0;
}

// Extends the range of cells in use of a size class. It shrinks only when the last object leaves the class.
static void extend_level(ob_step_data *data, cell to)
{
	const int32_t at[3] = { to.x, to.y, to.z };
	int32_t *low = data->count->level_low[to.level], *high = data->count->level_high[to.level];
	const bool first = !data->count->levels[to.level];
	for (int c = 0; c < 3; c++) {
		low[c] = first || at[c] < low[c] ? at[c] : low[c];
		high[c] = first || at[c] > high[c] ? at[c] : high[c];
	}
}

// Returns a link of the index, as id + 1, or 0. A link out of range is damage: fails the step, returns 0.
static uint32_t checked_link(ob_step_data *data, uint32_t link)
{
	if (link <= data->objects_max)
		return link;
	data->count->failure = OB_STEP_DAMAGED;
	return 0;
}

static uint32_t place_of_object(const ob_step_data *data, uint32_t id)
{
	const ob_index_cell *c = &data->cell[id];
	return place_of((cell){ c->level, c->x, c->y, c->z });
}

// True if any object in the bucket has the same bit of the bitmap.
static bool is_occupied(ob_step_data *data, uint32_t place)
{
	const uint32_t bits = PLACES_PER_BUCKET * data->buckets;
	uint32_t link = data->bucket[bucket_of(data, place)];
	for (uint32_t i = 0; checked_link(data, link) && i < data->objects_max; i++, link = data->cell[link - 1].next)
		if (((place_of_object(data, link - 1) ^ place) & (bits - 1)) == 0)
			return true;
	return false;
}

// Removes the object from the index. The host calls it, too: follows no more links than there are objects.
static void unlink_object(ob_step_data *data, uint32_t id)
{
	ob_index_cell *c = &data->cell[id];
	const uint32_t place = place_of_object(data, id);
	uint32_t *link = &data->bucket[bucket_of(data, place)];
	for (uint32_t i = 0; *link && *link != id + 1 && i < data->objects_max && checked_link(data, *link); i++)
		link = &data->cell[*link - 1].next;
	if (*link != id + 1 || c->level < 1 || c->level >= LEVELS) {
		data->count->failure = OB_STEP_DAMAGED;
		return;
	}
	*link = c->next;
	if (!is_occupied(data, place))
		*occupied_word(data, place) &= ~(UINT64_C(1) << place % 64);
	if (!--data->count->levels[c->level])
		data->count->levels_used &= ~(UINT64_C(1) << c->level);
	if (checked_link(data, c->after))
		data->cell[c->after - 1].before = c->before;
	if (checked_link(data, c->before))
		data->cell[c->before - 1].after = c->after;
	else
		data->count->level_first[c->level] = c->after;
	c->level = 0;
}

static uint32_t plane_at(const ob_step_data *data, uint32_t id)
{
	uint32_t i = 0;
	while (i < data->count->planes && i < data->objects_max && data->plane[i] != id)
		i++;
	return i;
}

void ob_index_put(ob_universe *u, uint32_t id)
{
	ob_step_data *data = ob_universe_step_data(u);
	if (is_plane(u, id)) {
		if (plane_at(data, id) == data->count->planes && ob_object_in_range(data, data->count->planes))
			data->plane[data->count->planes++] = id;
		return;
	}
	ob_index_cell *c = &data->cell[id];
	cell to = cell_of(data->bounds[id]);
	if (indexed(c)) {
		if (c->level == to.level && c->x == to.x && c->y == to.y && c->z == to.z)
			return;
		unlink_object(data, id);
	}
	const uint32_t place = place_of(to);
	uint32_t *head = &data->bucket[bucket_of(data, place)];
	uint32_t *first = &data->count->level_first[to.level];
	*c = (ob_index_cell){ *head, to.level, to.x, to.y, to.z, 0, *first };
	*head = id + 1;
	*occupied_word(data, place) |= UINT64_C(1) << place % 64;
	if (checked_link(data, *first))
		data->cell[*first - 1].before = id + 1;
	*first = id + 1;
	extend_level(data, to);
	data->count->levels[to.level]++;
	data->count->levels_used |= UINT64_C(1) << to.level;
}

void ob_index_prefetch(const ob_universe *u, const uint32_t *ids, uint32_t i, uint32_t end)
{
	enum { CELL_AHEAD = 12, LINKS_AHEAD = 6 };
	const ob_step_data *data = ob_universe_step_data(u);
	if (i + CELL_AHEAD < end) {
		__builtin_prefetch(&data->cell[ids[i + CELL_AHEAD]], 1);
		__builtin_prefetch(data->bounds[ids[i + CELL_AHEAD]]);
	}
	if (i + LINKS_AHEAD >= end || ids[i + LINKS_AHEAD] >= data->objects_max)
		return;
	const ob_index_cell *c = &data->cell[ids[i + LINKS_AHEAD]];
	if (!indexed(c))
		return;
	__builtin_prefetch(&data->bucket[bucket_of(data, place_of((cell){ c->level, c->x, c->y, c->z }))], 1);
	if (c->before)
		__builtin_prefetch(&data->cell[c->before - 1], 1);
	if (c->after)
		__builtin_prefetch(&data->cell[c->after - 1], 1);
}

void ob_index_remove(ob_universe *u, uint32_t id)
{
	ob_step_data *data = ob_universe_step_data(u);
	uint32_t plane = plane_at(data, id);
	if (plane < data->count->planes && data->count->planes <= data->objects_max)
		data->plane[plane] = data->plane[--data->count->planes];
	else if (indexed(&data->cell[id]))
		unlink_object(data, id);
}

// True if the bucket holds the object exactly once, and all its links are valid.
static bool bucket_has(const ob_step_data *data, uint32_t bucket, uint32_t id)
{
	uint32_t times = 0, n = 0;
	for (uint32_t link = data->bucket[bucket]; link; link = data->cell[link - 1].next) {
		if (link > data->objects_max || !indexed(&data->cell[link - 1]) || n++ == data->objects_max)
			return false;
		times += link == id + 1;
	}
	return times == 1;
}

ob_index_place ob_index_find(const ob_universe *u, uint32_t id)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_index_cell *c = &data->cell[id];
	const bool plane = plane_at(data, id) < data->count->planes;
	if (!indexed(c))
		return plane ? OB_INDEX_PLANE : OB_INDEX_NOWHERE;
	if (plane || c->level < 0 || c->level >= LEVELS)
		return OB_INDEX_BROKEN;
	const cell to = cell_of(data->bounds[id]);
	const uint32_t place = place_of_object(data, id);
	const bool found =
		bucket_has(data, bucket_of(data, place), id) && *occupied_word(data, place) >> place % 64 & 1;
	const bool current = ob_broadphase_query_pending(u, id) ||
			     (c->level == to.level && c->x == to.x && c->y == to.y && c->z == to.z);
	return found && current ? OB_INDEX_CELL : OB_INDEX_BROKEN;
}

static bool below_plane(const ob_universe *u, uint32_t plane, const float *b)
{
	const ob_motion *m = ob_newest_motion(u, plane);
	ob_mat3 r = ob_quat_matrix(m->q);
	ob_vec3 n = ob_column(&r, 2);
	ob_vec3 low = ob_v3(n.x > 0 ? b[0] : b[3], n.y > 0 ? b[1] : b[4], n.z > 0 ? b[2] : b[5]);
	return ob_dot(n, ob_sub(low, m->p)) <= 0;
}

// Four lanes, and a test that all four are true.
typedef float quad __attribute__((vector_size(16)));
typedef int32_t truths __attribute__((vector_size(16)));
typedef int64_t halves __attribute__((vector_size(16)));

static bool are_all(truths a)
{
	const halves both = (halves)a;
	return (both[0] & both[1]) == -1;
}

// Ids of the objects whose boxes overlap the queried one. n goes on counting when the array is full.
typedef struct overlaps {
	uint32_t *id, n, max;
	uint32_t load; // synthetic load of each box test
	uint64_t tests;
	quad upper, lower; // corners of the queried box; the fourth component, INFINITY or -INFINITY, has no effect
} overlaps;

static bool test_overlap(overlaps *to, const float *b)
{
	quad low, high; // b[0 .. 3] and b[2 .. 5]
	memcpy(&low, b, sizeof low);
	memcpy(&high, b + 2, sizeof high);
	to->tests++;
	ob_synthetic_load(to->load);
	return are_all((low <= to->upper) & (high >= to->lower));
}

static void add_overlap(overlaps *a, uint32_t id)
{
	if (a->n < a->max)
		a->id[a->n] = id;
	a->n++;
}

static void scan_level(const ob_step_data *data, uint32_t id, int level, overlaps *a)
{
	for (uint32_t j = data->count->level_first[level]; j; j = data->cell[j - 1].after)
		if (j - 1 != id && test_overlap(a, data->bounds[j - 1]))
			add_overlap(a, j - 1);
}

static truths place_in_space(const ob_index_cell *c)
{
	truths at;
	_Static_assert(offsetof(ob_index_cell, z) == offsetof(ob_index_cell, level) + 3 * sizeof(int32_t),
		       "four together");
	memcpy(&at, &c->level, sizeof at);
	return at;
}

// Appends the objects of a cell that overlap, from the first link of its bucket on.
static void scan_cell(const ob_step_data *data, uint32_t id, truths at, uint32_t first, overlaps *a)
{
	for (uint32_t next = first; next; next = data->cell[next - 1].next) {
		const uint32_t j = next - 1;
		if (are_all(place_in_space(&data->cell[j]) == at) && j != id && test_overlap(a, data->bounds[j]))
			add_overlap(a, j);
	}
}

// Occupied cells to be scanned. Their buckets and objects are spread over memory: all are prefetched before the first
// is read.
typedef struct cells_ahead {
	uint32_t n, bucket[CELLS_AT_ONCE];
	truths at[CELLS_AT_ONCE];
} cells_ahead;

static void scan_ahead(const ob_step_data *data, uint32_t id, cells_ahead *c, overlaps *a)
{
	uint32_t first[CELLS_AT_ONCE];
	for (uint32_t i = 0; i < c->n; i++) {
		first[i] = data->bucket[c->bucket[i]];
		if (!first[i])
			continue;
		__builtin_prefetch(&data->cell[first[i] - 1]);
		__builtin_prefetch(data->bounds[first[i] - 1]);
	}
	for (uint32_t i = 0; i < c->n; i++)
		scan_cell(data, id, c->at[i], first[i], a);
	c->n = 0;
}

// Scans rows of at most 64 cells each.
static void scan_rows(const ob_step_data *data, uint32_t id, const cell *lo, const cell *hi, cells_ahead *ahead,
		      overlaps *a)
{
	const uint64_t *occupied = data->occupied, all = UINT64_MAX >> (63 - (hi->x - lo->x));
	const uint32_t words = occupied_words(data);
	const cell from = *lo;
	for (int32_t z = from.z; z <= hi->z; z++)
		for (int32_t y = from.y; y <= hi->y; y++) {
			const uint32_t place = place_of((cell){ from.level, from.x, y, z }), shift = place % 64;
			const uint64_t first = occupied[place / 64 & (words - 1)],
				       second = occupied[(place / 64 + 1) & (words - 1)];
			for (uint64_t bits = (first >> shift | second << 1 << (63 - shift)) & all; bits;
			     bits &= bits - 1) {
				const int i = __builtin_ctzll(bits);
				const uint32_t bucket = bucket_of(data, place + (uint32_t)i);
				__builtin_prefetch(&data->bucket[bucket]);
				ahead->at[ahead->n] = (truths){ from.level, from.x + i, y, z };
				ahead->bucket[ahead->n++] = bucket;
				if (ahead->n == CELLS_AT_ONCE)
					scan_ahead(data, id, ahead, a);
			}
		}
}

// Finds the cells of a size class that may hold the centre of a box that overlaps b. Returns false if there are none.
static bool cells_around(const ob_step_data *data, const float *b, int level, cell *lo, cell *hi)
{
	const double per_metre = power_of_two(LEVEL_ZERO - level),
		     h = power_of_two(level - LEVEL_ZERO - 1); // a centre lies at most half a side outside b
	const int32_t *low = data->count->level_low[level], *high = data->count->level_high[level];
	int32_t from[3], to[3];
	for (int c = 0; c < 3; c++) {
		from[c] = coordinate(b[c] - h, per_metre), to[c] = coordinate(b[3 + c] + h, per_metre);
		from[c] = from[c] > low[c] ? from[c] : low[c];
		to[c] = to[c] < high[c] ? to[c] : high[c];
		if (from[c] > to[c])
			return false;
	}
	*lo = (cell){ level, from[0], from[1], from[2] };
	*hi = (cell){ level, to[0], to[1], to[2] };
	return true;
}

static void scan_cells(const ob_step_data *data, uint32_t id, cell lo, const cell *hi, cells_ahead *ahead, overlaps *a)
{
	for (; hi->x - lo.x > 63; lo.x += 64)
		scan_rows(data, id, &lo, &(cell){ lo.level, lo.x + 63, hi->y, hi->z }, ahead, a);
	scan_rows(data, id, &lo, hi, ahead, a);
}

uint32_t ob_index_query(const ob_universe *u, uint32_t id, uint32_t *out, uint32_t max, uint64_t *tests)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const float *b = data->bounds[id];
	overlaps a = { out,
		       0,
		       max,
		       ob_universe_settings(u)->load,
		       0,
		       { b[3], b[4], b[5], INFINITY },
		       { -INFINITY, b[0], b[1], b[2] } };
	cells_ahead ahead;
	ahead.n = 0;
	if (is_plane(u, id)) {
		for (uint32_t j = 0; j < ob_universe_ids(u); j++)
			if (indexed(&data->cell[j]) && below_plane(u, id, data->bounds[j]))
				add_overlap(&a, j);
		return a.n;
	}
	for (uint64_t levels = data->count->levels_used; levels; levels &= levels - 1) {
		const int level = __builtin_ctzll(levels);
		cell lo, hi;
		uint32_t there = data->count->levels[level];
		if (level == LEVELS - 1) {
			scan_level(data, id, level, &a);
			continue;
		}
		if (!cells_around(data, b, level, &lo, &hi))
			continue;
		double cells = (hi.x - lo.x + 1.) * (hi.y - lo.y + 1.) * (hi.z - lo.z + 1.);
		if (cells > there)
			scan_level(data, id, level, &a);
		else
			scan_cells(data, id, lo, &hi, &ahead, &a);
	}
	scan_ahead(data, id, &ahead, &a);
	for (uint32_t k = 0; k < data->count->planes; k++)
		if (below_plane(u, data->plane[k], b))
			add_overlap(&a, data->plane[k]);
	*tests += a.tests;
	return a.n;
}

// ---- fat AABBs

static const double fat_aabb_steps = 2; // steps for which a new box is meant to last
static const double rest_margin = .04; // m: margin of an object at rest
static const double rest_margin_share = .2; // its bound, as a share of the object's radius: for heaps of small bodies
static const double margin_limit = 1.5; // m: above it, a fast object's box covers the next step alone
static const double oversize_margins = 4; // a box larger than a new one by so many of its margins is replaced
static const uint64_t oversize_check_steps = 16; // interval of the test for it
static const double sweep_oversize = 2; // a box so many times as long as that of a new flight is replaced

void ob_tight_aabb(const ob_universe *u, const ob_passport *p, ob_pose pose, double bounds[6])
{
	const ob_hull *hull = ob_hull_of(u, p);
	if (hull)
		ob_hull_bounds(hull, pose, bounds);
	else
		ob_shape_bounds(p->shape, p->size, pose, bounds);
}

double ob_step_reach(const ob_run_settings *run, const ob_passport *p, ob_quat q, ob_vec3 v, ob_vec3 w)
{
	ob_mat3 r = ob_quat_matrix(q);
	double speed =
		ob_norm(v) + ob_turning_speed(p->shape, p->size, p->inertia, ob_rotate_back(&r, w), run->step_length);
	return (speed + ob_norm(ob_external_acceleration(run, p)) * run->step_length) * run->step_length;
}

static bool box_contains(const float *box, const double *tight, double margin)
{
	for (int c = 0; c < 3; c++)
		if (tight[c] - margin < box[c] || tight[3 + c] + margin > box[3 + c])
			return false;
	return true;
}

void ob_fat_aabb_set(ob_universe *u, uint32_t id, const double *tight, double margin)
{
	float box[6];
	for (int c = 0; c < 3; c++) {
		// Rounded outwards; a plane's box stays infinite.
		box[c] = nextafterf((float)(tight[c] - margin), -FLT_MAX);
		box[3 + c] = nextafterf((float)(tight[3 + c] + margin), FLT_MAX);
	}
	ob_commit_bounds(u, id, box);
}

double ob_fat_aabb_margin(const ob_run_settings *run, ob_shape shape, ob_vec3 size)
{
	return ob_min(rest_margin * ob_run_settings_units(run).length,
		      rest_margin_share * ob_shape_radius(shape, size));
}

// Region swept in the last step: the segment from the old position to the present one, and all points within "bulge"
// (m) of it. path: bound of the distance (m) that any of the object's points moved in that step.
typedef struct wake {
	double back[3]; // m, from the present position to the old one
	double bulge;
} wake;

static wake wake_of(const ob_universe *u, uint32_t id, const ob_state *now, double path)
{
	const uint64_t step = ob_step_count(u);
	ob_vec3 back = ob_sub(ob_centre_now(u, id, ob_newest_motion(u, id), step), now->pose.p);
	double straight = ob_norm(back), more = ob_max(0, path - straight);
	return (wake){ { back.x, back.y, back.z }, more + .5 * sqrt(more * (path + straight)) };
}

// Extends the box by itself moved by times * by, and all positions between.
static void sweep_box(double *box, const double *by, double times)
{
	for (int c = 0; c < 3; c++) {
		box[c] += ob_min(0, times * by[c]);
		box[3 + c] += ob_max(0, times * by[c]);
	}
}

// Predicts the fat AABB for some steps. It covers the distance flown at the present velocity, and on all sides the
// motion by turning and falling. A body thrown off its path gets a new box in that step, which covers the path left
// behind. Returns the margin on all sides (m); box: swept, without the margin.
static double predict_fat_aabb(const ob_universe *u, const ob_passport *p, const ob_state *now, double reach,
			       double *box)
{
	const ob_run_settings *run = ob_universe_settings(u);
	const double h = run->step_length, margin = ob_fat_aabb_margin(run, p->shape, p->size),
		     limit = margin_limit * ob_run_settings_units(run).length,
		     way[3] = { h * now->v.x, h * now->v.y, h * now->v.z };
	const double once = margin + reach, aside = ob_max(0, reach - h * ob_norm(now->v));
	// Steps beyond the first.
	double more = reach > 0 ? ob_max(0, ob_min(fat_aabb_steps - 1, (limit - once) / reach)) : 0;
	sweep_box(box, way, 1 + more);
	return margin + (1 + more) * aside;
}

static bool is_oversized(const float *box, const double *next, double margin)
{
	for (int c = 0; c < 3; c++)
		if ((double)box[3 + c] - box[c] > next[3 + c] - next[c] + 2 * oversize_margins * margin)
			return true;
	return false;
}

void ob_fat_aabb_update(ob_universe *u, uint32_t id, const ob_state *now, double reach, double path)
{
	const ob_passport *p = ob_passport_of(u, id);
	const float *box = ob_universe_step_data(u)->bounds[id];
	const double h = ob_universe_settings(u)->step_length, way[3] = { h * now->v.x, h * now->v.y, h * now->v.z };
	const wake w = wake_of(u, id, now, path);
	double next[6], behind[6], ahead[6];
	ob_tight_aabb(u, p, now->pose, next);
	memcpy(behind, next, sizeof next);
	memcpy(ahead, next, sizeof next);
	sweep_box(behind, w.back, 1);
	sweep_box(ahead, way, 1);
	bool held =
		box_contains(box, behind, w.bulge) && box_contains(box, ahead, ob_max(0, reach - h * ob_norm(now->v)));
	// Replaces the box of an object that was fast and is slow now. Objects are checked in turn, not all in the same
	// step.
	if (held && (ob_step_count(u) + id) % oversize_check_steps)
		return;
	double margin = ob_max(predict_fat_aabb(u, p, now, reach, next), w.bulge);
	sweep_box(next, w.back, 1);
	if (!held || is_oversized(box, next, margin))
		ob_fat_aabb_set(u, id, next, margin);
}

void ob_fat_aabb_renew(ob_universe *u, uint32_t id, const ob_state *now, double reach)
{
	const ob_passport *p = ob_passport_of(u, id);
	double next[6];
	ob_tight_aabb(u, p, now->pose, next);
	double margin = predict_fat_aabb(u, p, now, reach, next);
	ob_fat_aabb_set(u, id, next, margin);
}

void ob_fat_aabb_sweep(ob_universe *u, uint32_t id, const double *box, double margin)
{
	const float *old = ob_universe_step_data(u)->bounds[id];
	bool fits = box_contains(old, box, margin);
	for (int c = 0; c < 3; c++)
		fits &= old[3 + c] - old[c] <= sweep_oversize * (box[3 + c] - box[c] + 2 * margin);
	if (!fits)
		ob_fat_aabb_set(u, id, box, margin);
}

bool ob_broadphase_query_pending(const ob_universe *u, uint32_t id)
{
	return ob_universe_step_data(u)->neighbours[id].count == UINT32_MAX;
}

void ob_broadphase_remove(ob_universe *u, uint32_t id)
{
	ob_index_remove(u, id);
	ob_requery_drop(u, id);
	ob_universe_step_data(u)->neighbours[id].count = 0; // no query is pending
}

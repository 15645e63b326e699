#include "sim/index.h"

#include <math.h>

#include "base/burden.h"

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
	ob_burden(to->load);
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

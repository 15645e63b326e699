// Terrains are built once, when a scene is read.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/budget.h"
#include "terrain/terrain.h"

// Triangles this near to one plane are one region: relative to the size of the terrain.
static const double same_plane = 1e-9;
static const double same_direction = 1 - 1e-6; // cosine
static const double flattest = 1e-9; // height of a triangle, relative to its longest edge

// Terrain in the making.
typedef struct draft {
	const ob_vec3 *vertex;
	uint32_t vertices, triangles, regions;
	ob_terrain_triangle *triangle;
	ob_terrain_region *region;
	uint32_t *by_region; // [triangles]
	uint32_t *first, *entry; // of columns
	uint32_t columns[2], entries;
	double low[3], high[3], per_metre[2];
} draft;

static double component(ob_vec3 v, int i)
{
	return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

static void widen(double low[3], double high[3], ob_vec3 v)
{
	for (int i = 0; i < 3; i++) {
		low[i] = fmin(low[i], component(v, i));
		high[i] = fmax(high[i], component(v, i));
	}
}

static ob_vec3 corner(const draft *d, uint32_t triangle, int k)
{
	return d->vertex[d->triangle[triangle].corner[k]];
}

// Normal of a triangle, as long as twice its area.
static ob_vec3 area_of(const draft *d, uint32_t i)
{
	const ob_vec3 a = corner(d, i, 0);
	return ob_cross(ob_sub(corner(d, i, 1), a), ob_sub(corner(d, i, 2), a));
}

// ---- input

static bool check_vertices(draft *d, ob_error *e)
{
	for (int i = 0; i < 3; i++)
		d->low[i] = INFINITY, d->high[i] = -INFINITY;
	for (uint32_t i = 0; i < d->vertices; i++) {
		const ob_vec3 v = d->vertex[i];
		if (!(fabs(v.x) <= OB_TERRAIN_FARTHEST && fabs(v.y) <= OB_TERRAIN_FARTHEST &&
		      fabs(v.z) <= OB_TERRAIN_FARTHEST))
			return ob_fail(e, "vertex %u: expected numbers from -1e6 to 1e6 m, got {%g, %g, %g}", i + 1,
				       v.x, v.y, v.z);
		widen(d->low, d->high, v);
	}
	return true;
}

static bool take_triangles(draft *d, const uint32_t (*from)[3], ob_error *e)
{
	for (uint32_t i = 0; i < d->triangles; i++) {
		double longest = 0;
		for (int k = 0; k < 3; k++) {
			if (from[i][k] >= d->vertices)
				return ob_fail(e, "triangle %u: it has a vertex that is not there", i + 1);
			d->triangle[i].corner[k] = from[i][k];
		}
		for (int k = 0; k < 3; k++)
			longest = fmax(longest, ob_norm(ob_sub(corner(d, i, k), corner(d, i, (k + 1) % 3))));
		if (!(ob_norm(area_of(d, i)) > flattest * longest * longest))
			return ob_fail(e, "triangle %u: expected an area: its corners are in a line", i + 1);
	}
	return true;
}

// ---- neighbours

// Edge from its lower vertex to its higher one. side: 3 times its triangle, plus its number there.
typedef struct edge {
	uint32_t low, high, side;
} edge;

static int by_vertices(const void *x, const void *y)
{
	const edge *a = x, *b = y;
	if (a->low != b->low)
		return a->low < b->low ? -1 : 1;
	if (a->high != b->high)
		return a->high < b->high ? -1 : 1;
	return a->side < b->side ? -1 : a->side > b->side;
}

static bool runs_up(const draft *d, uint32_t side)
{
	const ob_terrain_triangle *t = &d->triangle[side / 3];
	return t->corner[side % 3] < t->corner[(side % 3 + 1) % 3];
}

// Connects triangles at edges that just two have, in opposite directions.
static bool connect(draft *d)
{
	const uint32_t n = 3 * d->triangles;
	edge *all = malloc(n * sizeof *all);
	if (!all)
		return false;
	for (uint32_t side = 0; side < n; side++) {
		const uint32_t *c = d->triangle[side / 3].corner, from = c[side % 3], to = c[(side % 3 + 1) % 3];
		all[side] = (edge){ from < to ? from : to, from < to ? to : from, side };
	}
	qsort(all, n, sizeof *all, by_vertices);
	for (uint32_t i = 0, end; i < n; i = end) {
		for (end = i + 1; end < n && all[end].low == all[i].low && all[end].high == all[i].high;)
			end++;
		const uint32_t a = all[i].side, b = all[end - 1].side;
		if (end - i != 2 || runs_up(d, a) == runs_up(d, b))
			continue;
		d->triangle[a / 3].across[a % 3] = 1 + b / 3;
		d->triangle[b / 3].across[b % 3] = 1 + a / 3;
	}
	free(all);
	return true;
}

// ---- regions

static bool is_in_plane(const draft *d, const ob_terrain_region *r, uint32_t triangle, double near)
{
	const ob_vec3 area = area_of(d, triangle);
	bool in = ob_dot(area, r->normal) > same_direction * ob_norm(area);
	for (int k = 0; k < 3; k++)
		in = in && fabs(ob_dot(r->normal, corner(d, triangle, k)) - r->offset) <= near;
	return in;
}

static float below(double x)
{
	return nextafterf((float)x, -INFINITY);
}

static float above(double x)
{
	return nextafterf((float)x, INFINITY);
}

static void hold(const draft *d, ob_terrain_region *r, uint32_t triangle)
{
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++) {
			const double x = component(corner(d, triangle, k), i);
			r->low[i] = fminf(r->low[i], below(x));
			r->high[i] = fmaxf(r->high[i], above(x));
		}
}

// Begins a region with a triangle; list: its triangles, which grows while their neighbours are added. Returns their number.
static uint32_t grow_region(draft *d, uint32_t first, uint32_t *list)
{
	const double near =
		same_plane * ob_norm(ob_v3(d->high[0] - d->low[0], d->high[1] - d->low[1], d->high[2] - d->low[2]));
	ob_terrain_region *r = &d->region[d->regions];
	const ob_vec3 area = area_of(d, first);
	r->normal = ob_scale(area, 1 / ob_norm(area));
	r->offset = ob_dot(r->normal, corner(d, first, 0));
	for (int i = 0; i < 3; i++)
		r->low[i] = INFINITY, r->high[i] = -INFINITY;
	uint32_t n = 0;
	list[n++] = first;
	d->triangle[first].region = d->regions;
	for (uint32_t i = 0; i < n; i++) {
		hold(d, r, list[i]);
		for (int k = 0; k < 3; k++) {
			const uint32_t next = d->triangle[list[i]].across[k];
			if (!next || d->triangle[next - 1].region != UINT32_MAX || !is_in_plane(d, r, next - 1, near))
				continue;
			d->triangle[next - 1].region = d->regions;
			list[n++] = next - 1;
		}
	}
	d->regions++;
	return n;
}

static void find_regions(draft *d)
{
	uint32_t listed = 0;
	for (uint32_t i = 0; i < d->triangles; i++)
		d->triangle[i].region = UINT32_MAX;
	for (uint32_t i = 0; i < d->triangles; i++) {
		ob_terrain_region *r = &d->region[d->regions];
		if (d->triangle[i].region != UINT32_MAX)
			continue;
		r->first = listed;
		r->triangles = grow_region(d, i, d->by_region + listed);
		listed += r->triangles;
	}
}

// ---- columns

static uint32_t column_of(const draft *d, int axis, double x)
{
	const double c = (x - d->low[axis]) * d->per_metre[axis];
	return c > 0 ? (uint32_t)fmin(c, d->columns[axis] - 1) : 0;
}

// Range of columns of a triangle: begin[0] .. end[0] along x.
static void columns_of(const draft *d, uint32_t triangle, uint32_t begin[2], uint32_t end[2])
{
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (int k = 0; k < 3; k++)
		widen(low, high, corner(d, triangle, k));
	for (int i = 0; i < 2; i++)
		begin[i] = column_of(d, i, low[i]), end[i] = column_of(d, i, high[i]);
}

// Number of columns that triangles lie in, all together.
static uint64_t count_entries(const draft *d)
{
	uint64_t n = 0;
	for (uint32_t i = 0; i < d->triangles; i++) {
		uint32_t begin[2], end[2];
		columns_of(d, i, begin, end);
		n += (end[0] - begin[0] + 1ull) * (end[1] - begin[1] + 1ull);
	}
	return n;
}

// Enters a triangle into its columns. entry NULL: counts it there.
static void enter(draft *d, uint32_t triangle, uint32_t *at)
{
	uint32_t begin[2], end[2];
	columns_of(d, triangle, begin, end);
	for (uint32_t y = begin[1]; y <= end[1]; y++)
		for (uint32_t x = begin[0]; x <= end[0]; x++) {
			uint32_t *place = &at[y * d->columns[0] + x];
			if (d->entry)
				d->entry[*place] = triangle;
			++*place;
		}
}

static bool fill_columns(draft *d)
{
	const uint32_t columns = d->columns[0] * d->columns[1];
	uint32_t *at = calloc(columns + 1, sizeof *at);
	d->first = calloc(columns + 1, sizeof *d->first);
	if (!at || !d->first) {
		free(at);
		return false;
	}
	for (uint32_t i = 0; i < d->triangles; i++)
		enter(d, i, at);
	for (uint32_t c = 0; c < columns; c++) {
		d->first[c + 1] = d->first[c] + at[c];
		at[c] = d->first[c];
	}
	d->entry = malloc(d->entries * sizeof *d->entry);
	for (uint32_t i = 0; d->entry && i < d->triangles; i++)
		enter(d, i, at);
	free(at);
	return d->entry;
}

static void divide(draft *d, int axis, uint32_t columns)
{
	const double size = d->high[axis] - d->low[axis];
	d->columns[axis] = size > 0 ? columns : 1;
	d->per_metre[axis] = size > 0 ? d->columns[axis] / size : 0;
}

// Takes wider columns where triangles are larger than these, or lie above each other: so the size of the index is linear
// in the triangles, whatever they are. A search then finds few more than it would find in any case.
static void plan_columns(draft *d, const uint32_t cells[2])
{
	enum { MOST = 1024 };
	for (int i = 0; i < 2; i++)
		divide(d, i, cells[i] < 1 ? 1 : cells[i] < MOST ? cells[i] : MOST);
	uint64_t entries;
	while ((entries = count_entries(d)) > (uint64_t)OB_TERRAIN_ENTRIES_PER_TRIANGLE * d->triangles)
		for (int i = 0; i < 2; i++)
			divide(d, i, (d->columns[i] + 1) / 2);
	d->entries = (uint32_t)entries;
}

// ---- all together

// Size of the terrain as packed; before its regions are known, at most.
static uint64_t packed_bytes(const draft *d)
{
	const uint64_t regions = d->regions ? d->regions : d->triangles, columns = d->columns[0] * d->columns[1] + 1;
	return (sizeof(ob_terrain) + d->vertices * sizeof *d->vertex + regions * sizeof *d->region +
		d->triangles * (sizeof *d->triangle + sizeof *d->by_region) + columns * sizeof *d->first +
		d->entries * sizeof *d->entry + 63) /
	       64 * 64;
}

static ob_terrain *pack(const draft *d, bool solid)
{
	const size_t vertices = d->vertices * sizeof *d->vertex, regions = d->regions * sizeof *d->region,
		     triangles = d->triangles * sizeof *d->triangle, by_region = d->triangles * sizeof *d->by_region,
		     columns = (d->columns[0] * d->columns[1] + 1) * sizeof *d->first,
		     entries = d->entries * sizeof *d->entry, bytes = packed_bytes(d);
	ob_terrain *t = calloc(1, bytes);
	if (!t)
		return NULL;
	*t = (ob_terrain){ .bytes = bytes,
			   .vertices = d->vertices,
			   .triangles = d->triangles,
			   .regions = d->regions,
			   .columns = { d->columns[0], d->columns[1] },
			   .entries = d->entries,
			   .solid = solid };
	memcpy(t->low, d->low, sizeof t->low);
	memcpy(t->high, d->high, sizeof t->high);
	memcpy(t->per_metre, d->per_metre, sizeof t->per_metre);
	char *at = (char *)(t + 1);
	memcpy(at, d->vertex, vertices);
	memcpy(at += vertices, d->region, regions);
	memcpy(at += regions, d->triangle, triangles);
	memcpy(at += triangles, d->by_region, by_region);
	memcpy(at += by_region, d->first, columns);
	memcpy(at + columns, d->entry, entries);
	return t;
}

ob_terrain *ob_terrain_build(const ob_vec3 *vertex, uint32_t vertices, const uint32_t (*corner)[3], uint32_t triangles,
			     const uint32_t cells[2], bool solid, ob_error *e)
{
	draft d = { .vertex = vertex, .vertices = vertices, .triangles = triangles };
	ob_terrain *t = NULL;
	if (triangles < 1 || triangles > OB_TERRAIN_TRIANGLES_MAX) {
		ob_fail(e, "expected 1 to %d triangles, got %u", OB_TERRAIN_TRIANGLES_MAX, triangles);
		return NULL;
	}
	if (!ob_budget_allows(
		    triangles * (sizeof *d.triangle + sizeof *d.region + sizeof *d.by_region + 6 * sizeof(edge)), e))
		return NULL;
	d.triangle = calloc(triangles, sizeof *d.triangle);
	d.region = calloc(triangles, sizeof *d.region);
	d.by_region = malloc(triangles * sizeof *d.by_region);
	if (!d.triangle || !d.region || !d.by_region) {
		ob_fail(e, "no memory left on this machine");
	} else if (check_vertices(&d, e) && take_triangles(&d, corner, e)) {
		plan_columns(&d, cells);
		const bool allowed = ob_budget_allows(packed_bytes(&d) + d.entries * sizeof *d.entry, e);
		const bool fine = allowed && connect(&d) && fill_columns(&d);
		if (fine)
			find_regions(&d);
		t = fine ? pack(&d, solid) : NULL;
		if (allowed && !t)
			ob_fail(e, "no memory left on this machine");
	}
	free(d.triangle);
	free(d.region);
	free(d.by_region);
	free(d.first);
	free(d.entry);
	return t;
}

ob_terrain *ob_terrain_of_heights(const double *height, const uint32_t cells[2], const double size[2], ob_error *e)
{
	const uint32_t row = cells[0] + 1, vertices = row * (cells[1] + 1), triangles = 2 * cells[0] * cells[1];
	ob_vec3 *vertex = malloc(vertices * sizeof *vertex);
	uint32_t(*corner)[3] = malloc(triangles * sizeof *corner);
	ob_terrain *t = NULL;
	for (uint32_t i = 0; vertex && i < vertices; i++)
		vertex[i] = ob_v3(size[0] * ((double)(i % row) / cells[0] - .5),
				  size[1] * ((double)(i / row) / cells[1] - .5), height[i]);
	for (uint32_t i = 0; corner && i < triangles; i++) {
		const uint32_t cell = i / 2, at = cell / cells[0] * row + cell % cells[0], far = at + row + 1;
		const uint32_t half[2][3] = { { at, at + 1, far }, { at, far, at + row } };
		memcpy(corner[i], half[i % 2], sizeof corner[i]);
	}
	if (vertex && corner)
		t = ob_terrain_build(vertex, vertices, corner, triangles, cells, true, e);
	else
		ob_fail(e, "no memory left on this machine");
	free(vertex);
	free(corner);
	return t;
}

bool ob_terrain_set_add(ob_terrain_set **set, const ob_terrain *t, ob_error *e)
{
	const uint64_t bytes = *set ? (*set)->bytes : (sizeof **set + 63) / 64 * 64;
	if (*set && (*set)->count == OB_TERRAINS_MAX)
		return ob_fail(e, "expected at most %d heightfields and meshes", OB_TERRAINS_MAX);
	if (bytes + t->bytes > OB_TERRAIN_SET_BYTES)
		return ob_fail(e, "all heightfields and meshes together are larger than %u MiB",
			       (unsigned)(OB_TERRAIN_SET_BYTES >> 20));
	if (!ob_budget_allows(bytes + t->bytes, e))
		return false;
	ob_terrain_set *grown = realloc(*set, bytes + t->bytes);
	if (!grown)
		return ob_fail(e, "no memory left on this machine");
	if (!*set)
		memset(grown, 0, bytes);
	*set = grown;
	memcpy((char *)grown + bytes, t, t->bytes);
	grown->offset[grown->count++] = bytes;
	grown->bytes = bytes + t->bytes;
	return true;
}

// Bytes of the arrays of these counts, with the terrain's own; 0: there are too many.
static uint64_t bytes_of(const ob_terrain *t)
{
	const uint64_t columns = (uint64_t)t->columns[0] * t->columns[1] + 1, most = UINT64_C(1) << 28;
	if (!t->vertices || !t->triangles || !t->regions || columns < 2 || columns > most || t->vertices > most ||
	    t->triangles > most || t->regions > most || t->entries > most)
		return 0;
	return (sizeof *t + t->vertices * sizeof(ob_vec3) + t->regions * sizeof(ob_terrain_region) +
		t->triangles * sizeof(ob_terrain_triangle) + (t->triangles + columns + t->entries) * sizeof(uint32_t) +
		63) /
	       64 * 64;
}

static bool triangles_make_sense(const ob_terrain *t)
{
	const ob_terrain_triangle *x = ob_terrain_triangles(t);
	bool sense = true;
	for (uint32_t i = 0; i < t->triangles; i++)
		for (int k = 0; k < 3; k++)
			sense &= x[i].corner[k] < t->vertices && x[i].across[k] <= t->triangles &&
				 x[i].region < t->regions;
	for (uint32_t i = 0; i < t->regions; i++)
		sense &= ob_terrain_regions(t)[i].first <= t->triangles &&
			 ob_terrain_regions(t)[i].triangles <= t->triangles - ob_terrain_regions(t)[i].first;
	for (uint32_t i = 0; i < t->triangles; i++)
		sense &= ob_terrain_by_region(t)[i] < t->triangles;
	return sense;
}

static bool columns_make_sense(const ob_terrain *t)
{
	const uint32_t *first = ob_terrain_first(t), columns = t->columns[0] * t->columns[1];
	bool sense = first[0] == 0 && first[columns] == t->entries;
	for (uint32_t c = 0; c < columns; c++)
		sense &= first[c] <= first[c + 1];
	for (uint32_t i = 0; sense && i < t->entries; i++)
		sense = first[columns + 1 + i] < t->triangles;
	return sense;
}

bool ob_terrain_set_makes_sense(const ob_terrain_set *set, uint64_t bytes)
{
	if (bytes < sizeof *set || set->bytes != bytes || set->count > OB_TERRAINS_MAX)
		return false;
	for (uint64_t i = 0, at = (sizeof *set + 63) / 64 * 64; i < set->count; i++) {
		const ob_terrain *t = (const ob_terrain *)((const char *)set + at);
		if (set->offset[i] != at || bytes - at < sizeof *t || t->bytes > bytes - at ||
		    t->bytes != bytes_of(t) || !triangles_make_sense(t) || !columns_make_sense(t))
			return false;
		at += t->bytes;
	}
	return true;
}

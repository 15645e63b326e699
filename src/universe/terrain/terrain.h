// Terrain: static surfaces of triangles, such as heightfields. A terrain contains no pointers, so it lies in the universe
// as it is. Lengths are in m, in the frame of its object. Pure functions, thread-safe.
//
//   triangles ──(neighbours in one plane)──> regions        pairs and contacts are those of regions
//       └──────(columns of a grid over x, y)──> search
#ifndef OB_TERRAIN_TERRAIN_H
#define OB_TERRAIN_TERRAIN_H

#include <ob/error.h>
#include <ob/hull.h>

enum {
	OB_TERRAINS_MAX = 64, // of a universe
	OB_TERRAIN_TRIANGLES_MAX = 500000,
	OB_TERRAIN_ENTRIES_PER_TRIANGLE = 64, // in columns, on average
	OB_TERRAIN_REGIONS_MAX = (1 << 20) - 1, // as pairs count them, from 1
};

#define OB_TERRAIN_SET_BYTES ((uint64_t)256 << 20) // of all terrains of a universe
#define OB_TERRAIN_FARTHEST 1e6 // m, of a vertex along an axis

typedef struct ob_terrain_triangle {
	uint32_t corner[3]; // vertices, counterclockwise seen from outside
	uint32_t across[3]; // 1 + the triangle beyond the edge from corner k to the next; 0: none
	uint32_t region;
} ob_terrain_triangle;

// Connected triangles in one plane. Points inside are below it: normal . x < offset.
typedef struct ob_terrain_region {
	ob_vec3 normal; // unit
	double offset;
	float low[3], high[3]; // box
	uint32_t first, triangles; // in the list of triangles by region
} ob_terrain_region;

typedef struct ob_terrain {
	uint64_t bytes; // a multiple of 64; the arrays follow in the order of their counts
	uint32_t vertices, triangles, regions;
	uint32_t columns[2]; // along x and y
	uint32_t entries; // triangles of all columns; first[] has one more than the columns
	uint32_t solid; // 1: ground below it, however deep; 0: a skin, touched from outside alone
	uint32_t zero;
	double low[3], high[3]; // box
	double per_metre[2]; // columns per m
} ob_terrain;

static inline const ob_vec3 *ob_terrain_vertices(const ob_terrain *t)
{
	return (const ob_vec3 *)(t + 1);
}

static inline const ob_terrain_region *ob_terrain_regions(const ob_terrain *t)
{
	return (const ob_terrain_region *)(ob_terrain_vertices(t) + t->vertices);
}

static inline const ob_terrain_triangle *ob_terrain_triangles(const ob_terrain *t)
{
	return (const ob_terrain_triangle *)(ob_terrain_regions(t) + t->regions);
}

// Numbers of all triangles, region by region.
static inline const uint32_t *ob_terrain_by_region(const ob_terrain *t)
{
	return (const uint32_t *)(ob_terrain_triangles(t) + t->triangles);
}

static inline const uint32_t *ob_terrain_first(const ob_terrain *t)
{
	return ob_terrain_by_region(t) + t->triangles;
}

// Builds a terrain of these triangles. Each has an area; neighbours have an edge's two vertices in common. cells: about
// as many columns along x and y, or fewer: OB_TERRAIN_ENTRIES_PER_TRIANGLE. Returns NULL and e, without a place: *e names the first bad triangle or vertex, from 1.
// The caller frees it.
ob_terrain *ob_terrain_build(const ob_vec3 *vertex, uint32_t vertices, const uint32_t (*corner)[3], uint32_t triangles,
			     const uint32_t cells[2], bool solid, ob_error *e);

// Builds the terrain of heights: height[y][x] at the corners of cells[0] x cells[1] equal cells, which cover size (m)
// along x and y about the origin. Each cell is two triangles; the edge between them runs from its corner of least x and y.
ob_terrain *ob_terrain_of_heights(const double *height, const uint32_t cells[2], const double size[2], ob_error *e);

// Half extents of its object: a box about the origin that holds the terrain, and some of the ground below.
ob_vec3 ob_terrain_size(const ob_terrain *t);

// Search for triangles whose boxes overlap a box.
typedef struct ob_terrain_search {
	const ob_terrain *t;
	double low[3], high[3];
	uint32_t begin[2], end[2]; // columns
	uint32_t x, y, at, stop;
} ob_terrain_search;

void ob_terrain_begin(const ob_terrain *t, const double low[3], const double high[3], ob_terrain_search *s);
// Returns false at the end. Each triangle is found once, in an order that depends on the box.
bool ob_terrain_next(ob_terrain_search *s, uint32_t *triangle);

// True if a triangle's box overlaps a box.
bool ob_terrain_overlaps(const ob_terrain *t, uint32_t triangle, const double low[3], const double high[3]);

// True if a triangle itself has a point in a box.
bool ob_terrain_enters(const ob_terrain *t, uint32_t triangle, const double low[3], const double high[3]);

// Finds the regions with triangles whose boxes overlap a box, ascending. Writes up to max numbers; returns their number, which may exceed max.
uint32_t ob_terrain_find_regions(const ob_terrain *t, const double low[3], const double high[3], uint32_t *out,
				 uint32_t max);

// True if no vertex of the triangles around x, a point of the triangle, is seen from there more than "lean" (sine) above the
// plane across n: so n supports the surface there.
bool ob_terrain_supports(const ob_terrain *t, uint32_t triangle, ob_vec3 x, ob_vec3 n, double lean);
// True if x lies over the triangle, seen along its normal, or over its border; or beyond an edge where another region
// begins that rises from there or goes on nearly level, by at most slack (m): the triangle's plane goes on below it. From a
// distance "near" (m) on it does so only below the next triangle: the ground may fall behind it.
bool ob_terrain_is_over(const ob_terrain *t, uint32_t triangle, ob_vec3 x, double near, double slack);

// Returns the first distance t > 0, below length (m), at which the ray p + t d enters the surface from outside, and the
// normal there; infinity: it does not. d: a unit vector. tests: number of triangles that were tested.
double ob_terrain_enter(const ob_terrain *t, ob_vec3 p, ob_vec3 d, double length, ob_vec3 *n, uint32_t *tests);

// Makes the hull of the ground below a triangle, to this depth (m). Its origin is *centre.
void ob_terrain_column(const ob_terrain *t, uint32_t triangle, double depth, ob_hull *out, ob_vec3 *centre);

// Region of a terrain in place of a shape (contact/manifold.h). The hull, of corners alone, holds the region and ends at
// its plane.
typedef struct ob_terrain_part {
	ob_hull hull;
	const ob_terrain *terrain;
	uint32_t region;
} ob_terrain_part;

void ob_terrain_take(const ob_terrain *t, uint32_t region, ob_terrain_part *out);

// All terrains of a universe, one after another, by the number in body properties.
typedef struct ob_terrain_set {
	uint64_t bytes; // of all
	uint64_t count;
	uint64_t offset[OB_TERRAINS_MAX]; // from its beginning
} ob_terrain_set;

// Appends a terrain. *set: NULL, or as made before; it grows. false and e, without a place: there are too many, or they are
// too large.
bool ob_terrain_set_add(ob_terrain_set **set, const ob_terrain *t, ob_error *e);

// True if the set, of so many bytes, is plausible: counts, numbers of vertices, triangles and regions.
bool ob_terrain_set_makes_sense(const ob_terrain_set *set, uint64_t bytes);

static inline const ob_terrain *ob_terrain_at(const ob_terrain_set *set, uint32_t number)
{
	return set && number < set->count ? (const ob_terrain *)((const char *)set + set->offset[number]) : NULL;
}

#endif

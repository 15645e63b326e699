// Convex hulls of points: corners, faces and edges by qhull, mass properties by integrals over tetrahedra.
#ifndef OB_HULL_HULL_H
#define OB_HULL_HULL_H

#include <stddef.h>

#include <ob/error.h>
#include <ob/hull.h>

enum { OB_HULL_POINTS_MAX = 1 << 14 };

// The hull of points (m, in a frame of the caller's), in its own frame. The same hull, to the bit, for whatever order
// the points come in, however often, and with whatever lies inside; to rounding, for whatever frame. false and e,
// without a place: fewer than four points, all in one plane, too thin, too many corners, or not finite. Thread-safe.
bool ob_hull_build(const ob_vec3 *point, size_t points, ob_hull *out, ob_error *e);

// The points that are the corners of a hull, as whoever gave them has them.
typedef struct ob_hull_corners {
	uint32_t count, zero;
	ob_vec3 at[OB_HULL_CORNERS_MAX]; // m
} ob_hull_corners;

// Those of the points that h was built of. Of them alone the same hull is built, to the bit, unless rounding decides
// whether a point is a corner. Thread-safe.
void ob_hull_find_corners(const ob_hull *h, const ob_vec3 *point, size_t points, ob_hull_corners *out);

// What a passport says of it as its size (ob_shape).
static inline ob_vec3 ob_hull_size(const ob_hull *h)
{
	return ob_v3(h->radius, .5 * h->thickness, h->inner);
}

#endif

// Convex hulls of points: corners, faces and edges by qhull, mass properties by integrals over tetrahedra.
#ifndef OB_HULL_HULL_H
#define OB_HULL_HULL_H

#include <stddef.h>

#include <ob/error.h>
#include <ob/hull.h>

enum { OB_HULL_POINTS_MAX = 1 << 14 };

// Builds the hull of points (m, in a frame of the caller's), in its own frame. The order of the points, duplicates and
// interior points do not change a bit of it; the caller's frame changes its rounding alone. Returns false and e,
// without a place, on fewer than four points, all in one plane, too thin, too many corners, or not finite. Thread-safe.
bool ob_hull_build(const ob_vec3 *point, size_t points, ob_hull *out, ob_error *e);

// A convex part of a compound, in the frame of the compound's author: a hull of points, or a round shape.
typedef struct ob_hull_part {
	const ob_vec3 *point; // m
	size_t points; // 0: a round shape
	double density; // kg/m^3, or in any unit if the parts' ratios alone matter
	ob_shape round; // sphere, capsule or cylinder
	ob_vec3 size; // m, as of ob_shape
	ob_pose pose;
} ob_hull_part;

// Builds the hulls of a compound and of its parts, of which there are 1 to OB_HULL_PARTS_MAX: out[0], and out[1] ..
// out[parts]. inertia: m^2, principal moments per kilogram, about the origin of the points and the axes of their frame,
// which becomes the compound's; NAN: those of its parts. Returns false and e, without a place, if a part has no hull,
// or all together have none, or the centre of mass lies outside of it. *failed: the part, from 1; 0: all together.
// Thread-safe.
bool ob_hull_build_compound(const ob_hull_part *part, uint32_t parts, ob_vec3 inertia, ob_hull *out, uint32_t *failed,
			    ob_error *e);

// Points that are the corners of a hull, in the frame of their source.
typedef struct ob_hull_corners {
	uint32_t count, zero;
	ob_vec3 at[OB_HULL_CORNERS_MAX]; // m
} ob_hull_corners;

// Finds the corners among the points that h was built from. They alone give the same hull, to the bit, unless rounding
// decides that a point is a corner. Thread-safe.
void ob_hull_find_corners(const ob_hull *h, const ob_vec3 *point, size_t points, ob_hull_corners *out);

// Gives the hull other principal moments (m^2, per kilogram), about the origin of its points and the axes of their frame,
// which becomes its own. Returns false and e if the origin is not well inside the hull.
bool ob_hull_set_inertia(ob_hull *h, ob_vec3 inertia, ob_error *e);

// Size of the hull as body properties store it (ob_shape).
static inline ob_vec3 ob_hull_size(const ob_hull *h)
{
	return ob_v3(h->radius, .5 * h->thickness, h->inner);
}

#endif

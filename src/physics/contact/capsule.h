// Contacts of segments, for shapes that are grown about one. Pure functions, thread-safe.
#ifndef OB_CONTACT_CAPSULE_H
#define OB_CONTACT_CAPSULE_H

#include "contact/manifold.h"

// Finds the nearest points of two segments: directions u and v, w from the middle of the second to that of the first
// (m), half lengths la and lb (m). Results: s and t along them (m). Parallel segments: the middle of the part side by
// side.
void ob_nearest_on_lines(ob_vec3 u, ob_vec3 v, ob_vec3 w, double la, double lb, double *s, double *t);

// Contact point on a line: its place along the line (m), and its gap (m).
typedef struct ob_line_point {
	double s;
	double gap;
	ob_vec3 at;
	bool there;
} ob_line_point;

// Finds the ends of the part of a's axis that runs along b's, if any. The capsules are nearest along n, at "nearest" on
// a's axis.
void ob_side_by_side(const ob_placed *a, const ob_placed *b, ob_vec3 n, double nearest, ob_line_point end[2]);

// Sets the points and the separation of out, from the nearest point and the ends of the part side by side.
void ob_manifold_line(const ob_line_point *nearest, const ob_line_point end[2], double margin, ob_manifold *out);

#endif

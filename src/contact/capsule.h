// Capsules against what they can meet but cylinders (contact/cylinder.h): a capsule is a segment, grown by its radius.
// The nearest points of segment and segment (Ericson 2005, 5.1.9) and of segment and box (the zero of the squared
// distance's derivative, which is piecewise linear along the segment) in closed form. Pure functions, thread-safe.
//
// out as of ob_manifold_find: the normal points to a, the capsule; the separation is the distance itself while the
// segment is outside the other shape. One point where the two are nearest, and up to two more at the ends of what lies
// side by side with the other shape: along a face, an edge or another capsule.
#ifndef OB_CONTACT_CAPSULE_H
#define OB_CONTACT_CAPSULE_H

#include "contact/manifold.h"

void ob_manifold_capsule_plane(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_capsule_sphere(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_capsule_box(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_capsules(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

// Where two segments are nearest to each other: their directions u and v, w from the middle of the second to that of
// the first (m), their half lengths (m); s and t along them. Where they are parallel, in the middle of what lies side
// by side.
void ob_nearest_on_lines(ob_vec3 u, ob_vec3 v, ob_vec3 w, double la, double lb, double *s, double *t);

// A contact point on a line: where along it, with its gap (m).
typedef struct ob_line_point {
	double s;
	double gap;
	ob_vec3 at;
	bool there;
} ob_line_point;

// The ends of what of a's axis lies along b's, if it does, of two capsules that are nearest along n at "nearest" on a's
// axis.
void ob_side_by_side(const ob_placed *a, const ob_placed *b, ob_vec3 n, double nearest, ob_line_point end[2]);

// Points and separation of out, of the nearest point and the two ends of what lies side by side.
void ob_manifold_line(const ob_line_point *nearest, const ob_line_point end[2], double margin, ob_manifold *out);

#endif

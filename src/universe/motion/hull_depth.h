// Penetration depth with hulls (depth.h). Pure, thread-safe.
#ifndef OB_MOTION_HULL_DEPTH_H
#define OB_MOTION_HULL_DEPTH_H

#include "motion/depth.h"

// Depth of two polyhedra: hulls and boxes. The separating axes are the faces' normals, and the products of two edges
// that are extreme in both solids along them.
double ob_depth_of_polyhedra(const ob_solid *a, const ob_solid *b);
// Depth of a sphere or capsule in a hull.
double ob_depth_of_round_and_hull(const ob_solid *round, const ob_solid *hull);

#endif

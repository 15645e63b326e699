// Depth where a hull takes part (depth.h). Pure, thread-safe.
#ifndef OB_MEASURE_HULL_DEPTH_H
#define OB_MEASURE_HULL_DEPTH_H

#include "measure/depth.h"

// Two polyhedra: hulls and boxes. The separating axes are the faces' normals and the products of two edges that both
// solids have as their farthest part along them.
double ob_depth_of_polyhedra(const ob_solid *a, const ob_solid *b);
// A sphere or capsule.
double ob_depth_of_round_and_hull(const ob_solid *round, const ob_solid *hull);

#endif

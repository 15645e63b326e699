// Narrow phase of axis-aligned boxes, which grow and shrink as the shapes in them turn: an experiment. Objects touch if
// their boxes overlap.
#ifndef OB_SOLVER_BOXES_H
#define OB_SOLVER_BOXES_H

#include "solver/solver.h"

// As ob_manifold_find, for the boxes of the two shapes. A plane's box would be all of space: it stays a plane. Pure
// function.
void ob_manifold_aabb(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
// The same, counted, with the synthetic load of the run: ob_methods.find.
void ob_boxes_find(ob_solver *s, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

#endif

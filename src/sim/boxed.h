// The narrow phase that asks no more than whether boxes overlap: each shape counts as its axis-aligned box.
#ifndef OB_SIM_BOXED_H
#define OB_SIM_BOXED_H

#include "contact/manifold.h"

// ob_manifold_find for the boxes round the two shapes, which turn with nothing and grow and shrink as what is inside
// them turns. A plane's box would be all of space: it stays a plane. Pure function.
void ob_manifold_aabb(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

#endif

// What stands and what falls. Pure functions, thread-safe.
#ifndef OB_REFERENCE_STATICS_H
#define OB_REFERENCE_STATICS_H

// The farthest that a stack of n equal bricks, one on each level, reaches over the edge of a table, in lengths of a
// brick: sum of 1 / (2 k), k = 1 .. n (Johnson 1955, Am. J. Phys. 23, 240; Paterson and Zwick 2009, Am. Math.
// Monthly 116, 19). The k-th brick from the top is shifted by 1 / (2 k) against the one below.
double ob_reference_overhang(int n);
double ob_reference_overhang_shift(int k); // in lengths; k from 1, at the top

// Two equal boxes lean against each other at the top, their long sides at "angle" (rad) to the vertical. Each stands
// on its inner lower edge and touches the other with its inner upper edge, so with length l and thickness d its centre
// lies (l sin - d cos) / 2 inwards of its foot. The other pushes horizontally, by symmetry, at height l cos:
//	push l cos = weight (l sin - d cos) / 2,
// and the ground's friction must hold against the push: mu >= push / weight = (tan(angle) - d / l) / 2, which is
// tan(angle) / 2 for thin ones. The two boxes must be able to push horizontally where they touch: between themselves,
// rough enough for the normal that is found there. The least mu between each box and the ground:
double ob_reference_cards_grip(double angle, double length, double thickness);

#endif

// When two moving shapes first meet, so that nothing passes through anything between two looks.
#ifndef OB_CONTACT_SWEPT_H
#define OB_CONTACT_SWEPT_H

#include "contact/manifold.h"

// Finds points of two shapes; out->separation must be a lower bound of their distance where there are none.
typedef struct ob_manifold_finder {
	void (*find)(void *with, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
	void *with;
} ob_manifold_finder;

// Conservative advancement (Mirtich 1996): both shapes move at their constant v, w. Returns the first time in [0, h] at
// which they are within tolerance (m), and in out the points up to margin (m) as of that time: what turns about the
// first point to touch brings the next ones down within the same step. Infinity if they do not meet; then out has no
// points, and separation is as of now. speed: bound of the closing speed of any two points (m/s).
double ob_swept_find(const ob_placed *a, const ob_placed *b, double speed, double h, double tolerance, double margin,
		     ob_manifold_finder find, ob_manifold *out);

#endif

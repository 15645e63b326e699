// Area of a contact: a convex polygon that is no parallelogram, and the friction of a pressure over it. The law is that of
// contact/patch.h, of any polygon. Pure functions, thread-safe.
#ifndef OB_CONTACT_AREA_H
#define OB_CONTACT_AREA_H

#include "contact/manifold.h"

enum { OB_AREA_CORNERS = 12 };

// Corners counterclockwise, m, from the place where friction acts, along the tangents.
typedef struct ob_contact_area {
	int corners;
	double x[OB_AREA_CORNERS], y[OB_AREA_CORNERS];
} ob_contact_area;

// Linear pressure with a resultant of 1 on the part of an area where it is above 0. In units of "length", from "middle".
typedef struct ob_area_load {
	int corners;
	double x[OB_AREA_CORNERS + 4], y[OB_AREA_CORNERS + 4]; // the part
	double at, slope[2]; // pressure in the middle, and its gradient
	double length, middle[2]; // m
	double spread; // m^2: mean square distance of the part from its centroid
} ob_area_load;

// Finds the common area of two shapes that touch with a normal n, from b to a. from_a, from_b: m, world, where friction acts
// on each; t1, t2: tangents. Returns false if their faces do not face each other, or if the area is a parallelogram.
bool ob_area_find(const ob_placed *a, const ob_placed *b, ob_vec3 n, ob_vec3 from_a, ob_vec3 from_b, ob_vec3 t1,
		  ob_vec3 t2, ob_contact_area *out);

// Finds the linear pressure without tension that has this centre (m): by Newton's method, as the least of a convex
// function. A centre too near to the border is moved inwards.
void ob_area_load_set(const ob_contact_area *area, const double centre[2], ob_area_load *out);

// Computes the power D lost at a slip (m/s, rad/s) of the place where friction acts, and the matrix with grad D = bound
// slip about "about" (m): 11 12 13 22 23 33.
void ob_area_slip(const ob_area_load *load, const double slip[3], const double about[2], double *power,
		  double bound[6]);

#endif

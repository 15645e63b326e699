// Central impacts. Pure functions, thread-safe. SI units.
#ifndef OB_REFERENCE_IMPACT_H
#define OB_REFERENCE_IMPACT_H

typedef struct ob_reference_pair {
	double a, b; // m/s, along the line of centres
} ob_reference_pair;

// Velocities after a central impact of masses a and b (kg; INFINITY = fixed) with restitution e: momentum is kept, and
// b - a after = -e (b - a) before (Newton 1687, Principia, scholium to the laws and corollary 3).
ob_reference_pair ob_reference_impact(double mass_a, double mass_b, ob_reference_pair before, double e);

// Newton's cradle: n equal spheres in a row that touch, the first k come in together at speed v, e = 1. Pair after pair
// changes velocities until the last k go on at v and the rest stand still (Herrmann and Seitz 1982, Am. J. Phys. 50,
// 977). Fills velocity[n].
void ob_reference_cradle(int n, int k, double v, double *velocity);

#endif

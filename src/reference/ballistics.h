// Free fall and bouncing of a point mass. Pure functions, thread-safe. SI units.
#ifndef OB_REFERENCE_BALLISTICS_H
#define OB_REFERENCE_BALLISTICS_H

#include <ob/vec.h>

// p + v t + a t^2 / 2 (Galilei 1638, Discorsi, fourth day): the centre of mass of any body in free flight.
ob_vec3 ob_reference_parabola(ob_vec3 p, ob_vec3 v, ob_vec3 a, double t);

// A ball dropped from height (m, of its lowest point) onto a fixed ground, with Newton's restitution e: each impact
// leaves e times the speed (Newton 1687, Principia, scholium to the laws), so it rises to e^2 of the height.
double ob_reference_apex(double height, double e, int k); // m: height e^(2 k), after the k-th impact; k = 0: height
double ob_reference_apex_time(double height, double g, double e, int k); // s after the drop
double ob_reference_impact_time(double height, double g, double e, int k); // s after the drop, of the k-th, from 1
// Height at time t; 0 once infinitely many impacts have gone by, (1 + e) / (1 - e) sqrt(2 h / g) after the drop.
double ob_reference_bounce(double height, double g, double e, double t);

#endif

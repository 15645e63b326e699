// Bodies that turn about a point or an edge on the ground: rocking blocks, bricks that topple, a disk that rolls on its
// rim. Pure functions, thread-safe. SI units.
#ifndef OB_REFERENCE_PIVOT_H
#define OB_REFERENCE_PIVOT_H

// A body that rocks on two edges (a block) or on opposite points of its rim (a cylinder), without slip. "half" is the
// half width (radius), "height" that of the centre when it stands; moment: about the centre over the mass (m^2), for
// the axis that it rocks about. Housner (1963, Bull. Seism. Soc. Am. 53, 403).
typedef struct ob_reference_rocker {
	double half, height, moment, g;
} ob_reference_rocker;

// s from tilt "angle" (rad, below atan(half / height)) at rate "w" (rad/s, <= 0: coming back) until it stands:
//	angle'' = -g R / (moment + R^2) sin(alpha - angle), R and alpha: distance of the centre, and its angle to the
//	vertical, as seen from the pivot,
// by quadrature of the law of energy. w = 0: a quarter of the period.
double ob_reference_rocker_time(const ob_reference_rocker *r, double angle, double w);
// Rate of turn right after it hits with its other edge over that before, without bounce and slip: the moment of
// momentum about the new pivot is kept (Housner 1963). Of a block of homogeneous mass 1 - 3/2 sin^2 alpha.
double ob_reference_rocker_ratio(const ob_reference_rocker *r);

// A body with its centre "beyond" (m) outside the edge that it lies on and "height" above it topples over the edge
// without slip from rest: its tilt (rad) after t.
double ob_reference_topple(double beyond, double height, double moment, double g, double t);

// A disk of radius a and half thickness h that rolls on its rim with its centre at rest, its axis at angle "tilt" to
// the vertical. With i, j = moments of inertia over the mass, across and along the axis, the balance of moments about
// the centre gives the rate of precession
//	W^2 = g (a cos - h sin) / (sin (i cos - j h / a sin)),
// for a thin one 4 g / (a sin) (Moffatt 2000, Nature 404, 833). rad/s
double ob_reference_disk_precession(double a, double h, double tilt, double g);
// What turns about the disk's own axis, beyond the precession: the rim does not slip. rad/s
double ob_reference_disk_spin(double a, double h, double tilt, double g);

#endif

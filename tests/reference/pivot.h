// Bodies that turn about a point or an edge on the ground: rocking blocks, toppling bricks, a disk rolling on its rim.
// Pure functions, thread-safe. SI units.
#ifndef OB_REFERENCE_PIVOT_H
#define OB_REFERENCE_PIVOT_H

// Body that rocks on two edges (a block) or on opposite points of its rim (a cylinder), without slip. "half" is the
// half width (radius), "height" that of the centre at rest; moment: about the centre over the mass (m^2), for the axis
// of rocking. Housner (1963, Bull. Seism. Soc. Am. 53, 403).
typedef struct ob_reference_rocker {
	double half, height, moment, g;
} ob_reference_rocker;

// Time (s) from tilt "angle" (rad, below atan(half / height)) at rate "w" (rad/s, <= 0: coming back) until upright:
//      angle'' = -g R / (moment + R^2) sin(alpha - angle),
// R and alpha: distance of the centre from the pivot, and its angle to the vertical, by quadrature of the energy
// equation. w = 0: a quarter of the period.
double ob_reference_rocker_time(const ob_reference_rocker *r, double angle, double w);
// Ratio of the rates of turn after and before the impact of the other edge, without bounce and slip: angular momentum
// about the new pivot is conserved (Housner 1963). For a homogeneous block, 1 - 3/2 sin^2 alpha.
double ob_reference_rocker_ratio(const ob_reference_rocker *r);

// Tilt (rad) after t of a body that topples from rest over the edge that it lies on, without slip. Its centre is
// "beyond" (m) outside the edge and "height" above it.
double ob_reference_topple(double beyond, double height, double moment, double g, double t);

// Disk of radius a and half thickness h that rolls on its rim with its centre at rest, its axis at angle "tilt" to the
// vertical. With i, j = moments of inertia over the mass, across and along the axis, the balance of moments about the
// centre gives the rate of precession (rad/s)
//      W^2 = g (a cos - h sin) / (sin (i cos - j h / a sin)), for a thin one 4 g / (a sin)
// (Moffatt 2000, Nature 404, 833).
double ob_reference_disk_precession(double a, double h, double tilt, double g);
// Rate of turn (rad/s) about the disk's own axis, beyond the precession: the rim does not slip.
double ob_reference_disk_spin(double a, double h, double tilt, double g);

#endif

// Thin rigid plates that slide and spin on level ground under uniform pressure: each element of the surface has its own
// Coulomb friction, against its own velocity (Goyal, Ruina and Papadopoulos 1991, Wear 143, 307). Pure functions,
// thread-safe. SI units.
#ifndef OB_REFERENCE_PLATE_H
#define OB_REFERENCE_PLATE_H

#include <stdbool.h>

typedef struct ob_reference_plate {
	bool disc;
	double half_x, half_y; // m: half sides; for a disc, half_x = radius
	double mu, g;
} ob_reference_plate;

typedef struct ob_reference_plate_state {
	double x, y, angle; // m, rad: the centre; total turn
	double vx, vy, w; // m/s, rad/s
} ob_reference_plate_state;

// Acceleration of the centre (m/s^2) in the plate's frame, and of the turn (rad/s^2), at velocity (vx, vy) in the
// plate's frame and rate w. Integrates over the surface about the instantaneous centre of rotation. The rectangle has a
// closed form; the disc uses the trapezoid rule over the angle, which is periodic (as elliptic integrals in Farkas,
// Bartels, Unger and Wolf 2003, Phys. Rev. Lett. 90, 248302).
void ob_reference_plate_friction(const ob_reference_plate *p, double vx, double vy, double w, double *ax, double *ay,
				 double *turn);

// State after t, or at rest, integrated to 1e-9. angle is also the plate's attitude: 0 = sides along x and y.
ob_reference_plate_state ob_reference_plate_slide(const ob_reference_plate *p, ob_reference_plate_state start,
						  double t);

// Ratio v / (w radius) of every disc as it stops: sliding and spinning end at once, at .653 for any initial motion
// (Farkas et al. 2003).
#define OB_REFERENCE_DISC_END .653

#endif

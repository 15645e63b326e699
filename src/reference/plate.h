// Thin rigid plates that slide and spin on level ground under uniform pressure: each element of the surface has Coulomb
// friction of its own, against its own velocity (Goyal, Ruina and Papadopoulos 1991, Wear 143, 307). Pure functions,
// thread-safe. SI units.
#ifndef OB_REFERENCE_PLATE_H
#define OB_REFERENCE_PLATE_H

#include <stdbool.h>

typedef struct ob_reference_plate {
	bool disc;
	double half_x, half_y; // m: half sides; of a disc, half_x = radius
	double mu, g;
} ob_reference_plate;

typedef struct ob_reference_plate_state {
	double x, y, angle; // m, rad: of the centre; how far it has turned
	double vx, vy, w; // m/s, rad/s
} ob_reference_plate_state;

// Acceleration of the centre (m/s^2) in the plate's frame and of the turn (rad/s^2) at velocity (vx, vy) in the plate's
// frame and rate w. The integrals over the surface are taken about the instantaneous centre of rotation: in closed form
// for a rectangle, for a disc by the trapezoid rule over the angle, which is periodic (Farkas, Bartels, Unger and Wolf
// 2003, Phys. Rev. Lett. 90, 248302, have them as elliptic integrals).
void ob_reference_plate_friction(const ob_reference_plate *p, double vx, double vy, double w, double *ax, double *ay,
				 double *turn);

// The state after t, or once it has stopped, integrated to 1e-9. angle is also the plate's attitude: 0 = sides along
// x and y.
ob_reference_plate_state ob_reference_plate_slide(const ob_reference_plate *p, ob_reference_plate_state start,
						  double t);

// The ratio v / (w radius) with which every disc comes to its stop: sliding and spinning end at once, at .653 whatever
// they began with (Farkas et al. 2003).
#define OB_REFERENCE_DISC_END .653

#endif

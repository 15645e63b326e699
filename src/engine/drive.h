// Inside the module engine only: kinematic bodies, for engines that take them step by step. One thread per drive.
#ifndef OB_ENGINE_DRIVE_H
#define OB_ENGINE_DRIVE_H

#include "world/world.h"

typedef struct ob_drive {
	uint32_t count;
	struct ob_driven {
		uint32_t id;
		ob_state from; // at time 0
		double frequency; // rad/s; 0: it goes on as it began
		ob_vec3 a; // m/s^2, of what swings, at time 0
	} * body; // [count]
} ob_drive;

bool ob_drive_init(ob_drive *d, const ob_world *w); // of all its kinematic bodies; false: no memory
void ob_drive_finish(ob_drive *d);
// Body i of the drive at time t (s), with the constant velocities that bring it within h (s) to where it is to be then.
ob_state ob_drive_step(const ob_drive *d, uint32_t i, double t, double h);

#endif

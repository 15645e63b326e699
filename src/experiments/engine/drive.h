// Kinematic bodies, for engines that move them step by step. Internal to the module. One thread per drive.
#ifndef OB_ENGINE_DRIVE_H
#define OB_ENGINE_DRIVE_H

#include "engine/world.h"

typedef struct ob_drive {
	uint32_t count;
	struct ob_driven {
		uint32_t id;
		ob_state from; // at time 0
		double frequency; // rad/s; 0: constant motion
		ob_vec3 a; // m/s^2, if it swings, at time 0
	} * body; // [count]
} ob_drive;

bool ob_drive_init(ob_drive *d, const ob_world *w); // all kinematic bodies; false: out of memory
void ob_drive_finish(ob_drive *d);
// State of body i at time t (s), with constant velocities that bring it within h (s) to its place at that time.
ob_state ob_drive_step(const ob_drive *d, uint32_t i, double t, double h);

#endif

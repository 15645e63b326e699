// A mechanism for tests: an island of joined bodies, made by hand, that nothing else touches. A failure ends the test.
#ifndef OB_TESTS_SOLVER_MECHANISM_H
#define OB_TESTS_SOLVER_MECHANISM_H

#include "solver/solver.h"

enum { BODIES = 101, JOINTS = 101 };

static const double gravity = 9.81, step_length = 1. / 60; // m/s^2, s
static const ob_quat y_axis = { M_SQRT1_2, -M_SQRT1_2, 0, 0 }; // turns z to y

// Kept from step to step.
typedef struct mechanism {
	uint32_t bodies, joints;
	ob_passport passport[BODIES];
	ob_motion motion[BODIES];
	ob_joint_passport joint[JOINTS];
	ob_found_joint load[JOINTS];
	ob_solver solver;
	uint64_t steps;
	ob_run_settings run;
} mechanism;

mechanism *mechanism_create(double g); // gravity downwards, m/s^2
void mechanism_destroy(mechanism *m);
uint32_t mechanism_add(mechanism *m, ob_shape shape, ob_vec3 size, double mass, ob_vec3 at);
// Joins two bodies, or one and the world, in a frame of the world.
ob_joint_passport *mechanism_join(mechanism *m, ob_joint_kind kind, uint32_t a, uint32_t b, ob_vec3 at, ob_quat q);
// Lets something act along the axis of the last joint.
ob_joint_axis *mechanism_drive(mechanism *m);
// A ball of 1 kg, 1 m from a hinge along y, at this angle from straight down.
mechanism *mechanism_pendulum(double angle);
void mechanism_step(mechanism *m);
void mechanism_steps(mechanism *m, int n);

ob_vec3 mechanism_spin(const mechanism *m, uint32_t id); // angular momentum about the body's centre
double mechanism_energy(const mechanism *m); // J
// Largest distance by which joints have parted, m, and sine of an angle by which their z axes lean.
double mechanism_parted(const mechanism *m);

#endif

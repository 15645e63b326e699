// Samples of sensors, taken by their objects' simulators at the end of a step, for all instants within it.
//
//   step n                       step n + 1
//   |-----x----x----x----x-------|      x: instants k / rate; all of them are taken in the phase SENSE, when the motions of
//                                       the step are published and the step is not yet complete
//
// A body that flies, rests or follows a path has a closed form. One that contacts or joints move has states at the ends of
// this step and of some before: polynomials lie between (moment.c).
//
// A kind has a file and a function, which reads the universe alone. The gate orders them with all writers. Noise is a
// function of the sample's number (noise.c), so nothing is kept from sample to sample.
#ifndef OB_SENSOR_SENSOR_H
#define OB_SENSOR_SENSOR_H

#include <ob/sensor.h>

#include "table/table.h"

// Takes the samples that are due in the running step, whose motions are all published. One caller at a time a sensor.
void ob_sensor_sample(ob_universe *u, uint32_t sensor);

// ---- kinds

// A body at an instant of the running step.
typedef struct ob_moment {
	ob_state state;
	ob_vec3 a, turn; // m/s^2; rad/s^2, world frame
} ob_moment;

// past: holds `known` steps in a row, OB_PAST_STEPS + 1 at most; t (s): after the step's begin, up to its end.
ob_moment ob_moment_at(const ob_universe *u, uint32_t id, const ob_past *past, uint64_t known, double t);
// Moves on to the next step.
void ob_moment_pass(const ob_universe *u, uint32_t id, ob_past *past);

// A sample to be taken.
typedef struct ob_sampled {
	const ob_universe *u;
	const ob_sensor_passport *sensor;
	const ob_joint_passport *joint; // NULL: it has none, or that has gone
	const ob_past *past; // [2], of its object, or of both ends of its joint
	uint64_t known;
	double t; // s
} ob_sampled;

// Write the sensor's values without noise. Return false if there are none, as its joint has gone.
bool ob_sample_imu(const ob_sampled *x, double *value);
bool ob_sample_encoder(const ob_sampled *x, double *value);
bool ob_sample_force_torque(const ob_sampled *x, double *value);
bool ob_sample_touch(const ob_sampled *x, double *value);
bool ob_sample_lidar(const ob_sampled *x, double *value);

// Adds the noise of sample k to all values.
void ob_sensor_add_noise(const ob_sensor_passport *s, uint64_t k, double *value);

#endif

// Sensors of robots: measurements on an object of a universe, at instants of their own.
//
// A sensor belongs to an object, whose simulator takes its samples. The instants are multiples of 1 / rate, and lie
// between steps, too: sample k is of time k / rate, from k = 1 on. Noise follows from the scene's seed, the sensor's
// number and the sample's number alone, so samples have the same bits in every run. A delay hides a sample for so long.
//
//   kind          frame                              values of a sample
//   imu           its pose in the object             3 of acceleration without gravity (m/s^2), 3 of turn rate (rad/s)
//   encoder       -                                  value and rate of a joint's first free axis (m, rad; m/s, rad/s)
//   force_torque  the joint's in its first object    3 of force (N), 3 of torque (N m) on that, mean over the step
//   touch         -                                  sum of the normal forces of all contacts (N), in the last substep
//   lidar         its pose in the object             range of each beam (m); infinite: nothing within reach
//   camera        its pose in the object             pixels: colour, depth, object (ob_picture_of)
//
// Beams of a lidar are rows about its x axis, towards y, from the lowest row on. A camera looks along its x axis, z is up. Its
// pictures are the renderer's, which the host's process draws at the step boundary at or after their instants: they show the
// universe at these, and may differ in a few bits from one graphics driver to the next. Objects with which nothing collides (OB_OBJECT_SENSOR)
// are something else: they list who is in them.
//
// Units: SI, radians. Thread-safety: as <ob/universe.h>.
#ifndef OB_SENSOR_H
#define OB_SENSOR_H

#include <ob/motion.h>

#pragma GCC visibility push(default)

typedef enum ob_sensor_kind {
	OB_SENSOR_IMU,
	OB_SENSOR_ENCODER,
	OB_SENSOR_FORCE_TORQUE,
	OB_SENSOR_TOUCH,
	OB_SENSOR_LIDAR,
	OB_SENSOR_CAMERA,
	OB_SENSOR_KINDS,
} ob_sensor_kind;

enum { OB_SENSORS_MAX = 1 << 14, OB_SENSOR_VALUES_MAX = 1 << 12 }; // in a universe; in a sample, unless it is a picture
enum { OB_PIXELS_MAX = 1 << 22 }; // in a picture

// Errors of each value, in its unit: deviation of white noise, deviation of a constant offset, and deviation of a random
// walk after a second.
typedef struct ob_sensor_noise {
	double white, bias, walk;
} ob_sensor_noise;

// Properties of a sensor; constant. 280 bytes.
typedef struct ob_sensor_passport {
	uint32_t kind; // ob_sensor_kind
	uint32_t object, generation; // it takes samples while that object is present
	uint32_t joint; // number, of an encoder or a force_torque
	uint32_t width; // values of a sample
	uint32_t kept; // samples that the universe keeps, some of which may be written while they are read
	uint64_t first; // place of these
	uint64_t seed;
	ob_pose pose; // in the object's frame
	double rate; // Hz
	double delay; // s
	ob_sensor_noise
		noise[2]; // for the first and the second half of the values; touch and lidar have the first alone
	uint32_t beams, rows; // beams of a lidar, or pixels of a camera, in each row; rows
	// rad: from the first beam to the last, or 2 pi; from the lowest row to the highest. A camera has its angles of view here
	double fan, rise;
	double reach; // m
	char name[OB_NAME_MAX]; // as the scene has it, or of its kind and number: "imu#3"; ends with 0
} ob_sensor_passport;

// A pixel of a camera. 12 bytes.
typedef struct ob_pixel {
	float depth; // m, along the camera's x axis; infinite: nothing is there
	uint32_t id; // of the object; UINT32_MAX: none
	uint8_t rgba[4]; // sRGB; alpha is 255
} ob_pixel;

// Values that a sample needs for a picture, 8 bytes each.
static inline uint32_t ob_picture_values(uint32_t width, uint32_t height)
{
	return (uint32_t)(((uint64_t)width * height * sizeof(ob_pixel) + 7) / 8);
}

// Pixels of a camera's sample: rows * beams of them, from the upper left.
static inline const ob_pixel *ob_picture_of(const double *value)
{
	return (const ob_pixel *)value;
}

// Name of a kind, as scenes have it ("imu"). NULL: no such kind.
const char *ob_sensor_kind_name(uint32_t kind);
// Number of sensors; and one of them. false: none has this number.
uint32_t ob_universe_sensors(const ob_universe *u);
bool ob_universe_get_sensor(const ob_universe *u, uint32_t sensor, ob_sensor_passport *out);
// Copies the newest samples that are kept and no delay hides, of those with a number above `after`: at most max, the
// oldest first. number[i], time[i] (s) and value[i * width] are those of sample i; value NULL: without. Returns how many.
size_t ob_universe_get_samples(const ob_universe *u, uint32_t sensor, uint64_t after, uint64_t *number, double *time,
			       double *value, size_t max);

#pragma GCC visibility pop

#endif

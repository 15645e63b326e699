// Joints: what holds two objects of a universe, or one and the world, together.
//
// A joint has a frame in each of its two objects. Its kind says which of their relative motions it leaves free:
//
//   kind        free                                              frame
//   ball        all turns about its origin                        any
//   hinge       the turn about its z axis                         z: axis of the hinge
//   slider      the shift along its z axis                        z: direction of the slide
//   fixed       nothing                                           any
//   universal   the turns about x of the first, y of the second   x and y: arms of the cross
//   distance    all but the distance of the two origins           any; the origins lie apart
//   apart       everything: its two objects pass through each     any
//               other, and that is all
//
// Along the free axis of a hinge (rad), a slider (m) and a distance (m), and each of the two of a universal (rad), limits, a
// spring with a damper, dry friction and a motor may act. The value of an axis is the first object's turn, or shift,
// relative to the second since the scene began; of a distance the length itself. All turns of a ball have one spring to the
// attitude at the scene's start, one damper, and a rotor that turns with the first object; its value is the angle of its
// turn since then, which may have an upper limit.
//
// A joint pulls and turns its objects with the forces that it needs. With breaks_force or breaks_torque it breaks when the
// mean over a substep is greater: it ends, and a new contact of its objects may begin in the next step.
//
// Units: m, rad, N along sliders and distances, N m about hinges. Thread-safety: as <ob/universe.h>.
#ifndef OB_JOINT_H
#define OB_JOINT_H

#include <ob/motion.h>

#pragma GCC visibility push(default)

typedef enum ob_joint_kind {
	OB_JOINT_BALL,
	OB_JOINT_HINGE,
	OB_JOINT_SLIDER,
	OB_JOINT_FIXED,
	OB_JOINT_UNIVERSAL,
	OB_JOINT_DISTANCE,
	OB_JOINT_APART,
	OB_JOINT_KINDS,
} ob_joint_kind;

#define OB_JOINT_WORLD UINT32_MAX // in place of an object: the world itself

enum { // ob_joint_passport.flags
	OB_JOINT_COLLIDES = 1 << 0, // its two objects may touch each other
	OB_JOINT_DRIVEN = 1 << 1, // something acts along its free axes; a distance with this flag is free to change
	OB_JOINT_BROKEN = 1 << 2, // it has broken, so it holds nothing any more; set for readers
};

typedef enum ob_joint_motor {
	OB_MOTOR_NONE,
	OB_MOTOR_RATE, // holds the rate "target" with at most the force "most"
	OB_MOTOR_VALUE, // pulls to the value "target" with stiffness and damping, at most with the force "most"
	OB_MOTORS,
} ob_joint_motor;

// Forces along the free axis of a joint. They are torques of a hinge.
typedef struct ob_joint_axis {
	double low, high; // limits of the value; infinite: none
	double restitution; // of hits on a limit, 0..1
	double stiffness, rest, damping; // N/m, m, N s/m: a spring, its natural value, a damper
	double friction; // N, dry
	uint32_t motor, reserved; // ob_joint_motor
	double target, most; // m/s or m; N, may be infinite
	double motor_stiffness, motor_damping; // N/m, N s/m
	double armature; // kg, kg m^2: inertia of a rotor that moves at the axis' rate, beside that of the objects
} ob_joint_axis;

// Properties of a joint. It holds while both objects are present with these generations, and until it breaks. 416 bytes.
typedef struct ob_joint_passport {
	uint32_t object[2]; // ids; the second may be OB_JOINT_WORLD
	uint32_t generation[2]; // of the objects
	uint32_t kind; // ob_joint_kind
	uint32_t flags; // OB_JOINT_*
	ob_pose frame[2]; // frame of the joint in the frame of each object, as of a body; in the world's
	double length; // m, of a distance; else 0
	ob_joint_axis axis; // if the joint is OB_JOINT_DRIVEN; of a universal x of the first object
	ob_joint_axis second; // of a universal: y of the second object
	double breaks_force, breaks_torque; // N, N m: it breaks if it needs more; infinite: never
	char name[OB_NAME_MAX]; // as the scene has it, or of its kind and number: "hinge#3"; ends with 0
} ob_joint_passport;

// False of a passport between two objects that are the same: no joint has this number.
static inline bool ob_joint_exists(const ob_joint_passport *j)
{
	return j->object[0] != j->object[1];
}

// Action of a joint on its first object, world frame, mean over the last step; on its second object the same acts the other
// way round. A joint that has broken keeps what it broke by: the mean over that substep.
typedef struct ob_joint_load {
	ob_vec3 force; // N
	ob_vec3 torque; // N m, about the joint's origin in the first object
	double along; // N, N m: share along its first free axis: of limits, spring, damper, friction, motor; 0 of a ball
	uint64_t broke; // number of complete steps when it had broken; 0: it holds
} ob_joint_load;

// Name of a kind, as scenes have it ("hinge"). NULL: no such kind.
const char *ob_joint_kind_name(uint32_t kind);
// One past the highest number of a joint; and one joint. false: none has this number, or its numbers are implausible, or one of
// its objects does not exist any more. A joint that is added takes the number of one that has been removed.
uint32_t ob_universe_joints(const ob_universe *u);
bool ob_universe_get_joint(const ob_universe *u, uint32_t joint, ob_joint_passport *out);
// Value and rate of its first free axis (m, rad; m/s, rad/s), at the present time of the universe. false: it has no such joint
// now, or this kind has no such axis.
bool ob_universe_get_joint_value(const ob_universe *u, uint32_t joint, double *value, double *rate);
// The same for n joints: values[2 * i] and values[2 * i + 1]. false: one of them has none; the rest is not written.
bool ob_universe_get_joint_values(const ob_universe *u, const uint32_t *joint, size_t n, double *values);
// Action of the joint; 0 in a universe that has not stepped. false: it has no such joint now.
bool ob_universe_get_joint_load(const ob_universe *u, uint32_t joint, ob_joint_load *out);

#pragma GCC visibility pop

#endif

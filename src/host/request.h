// Requests of viewers, other programs and the host's own threads to a running universe.
#ifndef OB_HOST_REQUEST_H
#define OB_HOST_REQUEST_H

#include <ob/control.h>

#include "scene/scene.h"

typedef enum ob_request_kind {
	OB_REQUEST_ADD,
	OB_REQUEST_REMOVE,
	OB_REQUEST_COLOUR,
	OB_REQUEST_MESSAGE, // to the object's script
	OB_REQUEST_FORCE, // from now on, until another is set: by a request, a script, or the scene's timetable
	OB_REQUEST_KICK, // at once: by an impulse and an angular impulse
	OB_REQUEST_STATE, // the object goes on from another place, with other velocities
	OB_REQUEST_FRICTION, // its coefficient; its contacts begin anew
	OB_REQUEST_SURFACE, // velocity of the surface of a static or kinematic object; likewise
	OB_REQUEST_PATH, // a kinematic object follows points from now on
	OB_REQUEST_MOTOR, // target of the motor of a joint whose first object it is
	OB_REQUEST_TORQUE, // from now on, until another is set by the same origin; likewise below (pull.h)
	OB_REQUEST_PUSH, // a force at a point of its body
	OB_REQUEST_DRAG, // a spring from a point of its body to a target
	OB_REQUEST_RELEASE, // ends what the same origin does by these three to the object; id UINT32_MAX: to all objects
	OB_REQUEST_AVATAR, // adds an object of the scene's template for the origin, at state's place
	OB_REQUEST_JOIN, // adds the joint in values (ob_joint_passport); its first object is the request's
	OB_REQUEST_UNJOIN, // removes a joint whose first object it is
	OB_REQUEST_AT_ONCE, // the first that is no change of the universe's course, so that no log has it
	OB_REQUEST_MOVE = OB_REQUEST_AT_ONCE, // its simulator moves to a worker: with several ranks, too (table/home.h)
	OB_REQUEST_KILL, // the worker that simulates it is killed
	OB_REQUEST_KEEP, // a snapshot of the whole universe replaces the one kept before
	OB_REQUEST_RETURN, // the universe goes back to that snapshot, or to its start if there is none
	OB_REQUEST_RESTART, // the universe goes back to its start
	OB_REQUEST_SET, // wish: the scene starts anew with another parameter, "name=value" in values
	OB_REQUEST_SEED, // wish: with another seed
	OB_REQUEST_SAVE, // wish: a checkpoint file at the path in values; "": where the run keeps its checkpoint
	OB_REQUEST_PAUSE, // time stands; likewise below, of a run with a pace (pace.h)
	OB_REQUEST_RESUME,
	OB_REQUEST_STEP, // so many steps, while time stands
	OB_REQUEST_UNTIL, // time goes on until a simulated time, and stands
	OB_REQUEST_RATE, // the pace
	OB_REQUEST_KINDS
} ob_request_kind;

// Requests that change nothing, which the host does not take: obsim send reads the universe, the server changes what it sends to
// a viewer.
typedef enum ob_look_kind {
	OB_LOOK_WAIT = OB_REQUEST_KINDS, // until so many steps are complete
	OB_LOOK_POINTS, // contact points of the last step
	OB_LOOK_CONTACTS, // those of each step: on or off; likewise the next
	OB_LOOK_JOINTS,
	OB_LOOK_SIMULATORS,
	OB_LOOK_ENERGY,
	OB_LOOK_ANEW, // the whole state once more, as at the start of a connection
	OB_LOOK_INSPECT, // details of an object; id UINT32_MAX: none
} ob_look_kind;

// Origins of requests: connections of viewers count from 1; from this number on they are of the program that leads the run.
#define OB_ORIGIN_PROGRAM (UINT32_C(1) << 31)

enum { OB_REQUEST_POINTS = OB_CONTROL_POINTS, OB_REQUEST_STEPS = 1000000, OB_REQUEST_RATE_MOST = 1000000 };

// Path from where the object then stands, which is its first point, through others.
typedef struct ob_request_path {
	uint32_t points; // beside the first
	uint32_t loop, turns; // 0 or 1, as in ob_path
	uint32_t zero;
	ob_path_point point[OB_REQUEST_POINTS]; // times: s after the first
} ob_request_path;

typedef struct ob_request {
	uint32_t kind; // ob_request_kind
	uint32_t id, generation; // of the object; unused for an object to add
	uint32_t origin; // of an object to add, or a pull: number of the connection; 0: none
	ob_object_def def; // to add
	union {
		ob_hull_corners corners; // of a hull to add
		ob_request_path path;
	};
	float colour[4]; // linear
	uint32_t worker; // target of the move
	uint32_t on; // 0 or 1, of a look
	ob_state state; // to go on from; a part whose first number is NaN stays as it is
	ob_vec3 force, twist; // N, or N s; N m, or N m s; world frame
	ob_vec3 point, target; // m: from the centre of mass, body frame; world frame
	double frequency; // Hz, of a drag
	double friction; // coefficient
	ob_vec3 surface_velocity; // m/s, body frame
	uint32_t joint; // number of a joint
	double motor; // target: m/s, rad/s, or m, rad
	uint64_t steps; // 1 to OB_REQUEST_STEPS
	double until; // s, simulated
	uint64_t seed;
	double rate; // simulated s in a second, 0 to OB_REQUEST_RATE_MOST; 0: as fast as possible
	uint32_t bytes; // of the message, or the joint
	unsigned char values[512]; // flat (scene/flat.h)
} ob_request;

#endif

// Kinds of requests: of viewers, other programs, the host's own threads, and scripts. host/request_table.h has their words and
// fields. Their numbers stand in logs of requests and in checkpoints: new ones go before OB_REQUEST_AT_ONCE or OB_REQUEST_KINDS.
#ifndef OB_TABLE_REQUEST_KIND_H
#define OB_TABLE_REQUEST_KIND_H

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
	OB_LOOK_SENSED, // newest samples of sensors
	OB_LOOK_CONTACTS, // those of each step: on or off; likewise the next
	OB_LOOK_JOINTS,
	OB_LOOK_SIMULATORS,
	OB_LOOK_ENERGY,
	OB_LOOK_ANEW, // the whole state once more, as at the start of a connection
	OB_LOOK_INSPECT, // details of an object; id UINT32_MAX: none
} ob_look_kind;

#endif

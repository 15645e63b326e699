// Requests of viewers: a JSON object each, as {"do": "create", "shape": "box", "size": [.5, .5, .5], "at": [0, 0, 3]}.
//
//      create    shape (box, sphere, capsule, cylinder), size (m, as ob_shape says), at (m), mass (kg); optionally
//                attitude (w x y z), velocity (m/s), spin (rad/s), colour (linear RGB), friction, restitution,
//                roughness, metal, name
//      remove    id, generation
//      drag      id, generation, target (m); optionally point (m, body frame, from the centre of mass), frequency (Hz):
//                a spring holds the point until the visitor sends release, or leaves
//      push      id, generation, force (N); optionally point. Likewise
//      turn      id, generation, torque (N m). Likewise
//      release   optionally id: of one object, else of all that this visitor holds
//      message   id, generation, text: its words to the object's script, numbers as such
//      edit      id, generation, and some of at, attitude, velocity, spin, colour, friction, force (N, from now on), surface
//                (velocity of a belt, m/s, body frame)
//      kick      id, generation, impulse (N s); optionally twist (N m s)
//      path      id, generation, points (lists of s from now on, x, y, z in one list: 64 at most); optionally loop
//      motor     name, value: target of a joint's motor;  unjoin: name
//      kill      id, generation: the worker process that simulates the object
//      keep      a snapshot of the universe;  return: to that, or to the start;  restart: at the start
//      pause, resume
//      step      steps (1), while it is paused
//      until     value (s): goes on to this simulated time, and pauses
//      rate      rate (s a s); 0: as fast as possible
//      set       name, value: the scene starts anew with this value of a parameter;  seed: value, likewise
//      save      a checkpoint, where the server keeps one
//      contacts  on;  joints, energy: likewise
//      anew      the whole state once more, as at the start of a connection
//      inspect   id
//
// Other members are errors, and no byte is trusted. Pure; any thread.
#ifndef OB_SERVE_COMMAND_H
#define OB_SERVE_COMMAND_H

#include "host/request.h"

typedef enum ob_command_kind {
	OB_DO_NOTHING,
	OB_DO_CREATE,
	OB_DO_REMOVE,
	OB_DO_DRAG,
	OB_DO_PUSH,
	OB_DO_TURN,
	OB_DO_RELEASE,
	OB_DO_MESSAGE,
	OB_DO_EDIT,
	OB_DO_KICK,
	OB_DO_PATH,
	OB_DO_MOTOR,
	OB_DO_UNJOIN,
	OB_DO_KILL,
	OB_DO_KEEP,
	OB_DO_RETURN,
	OB_DO_RESTART,
	OB_DO_SET,
	OB_DO_SEED,
	OB_DO_SAVE,
	OB_DO_PAUSE,
	OB_DO_RESUME,
	OB_DO_STEP,
	OB_DO_UNTIL,
	OB_DO_RATE, // the last that is requests to the host
	OB_DO_CONTACTS,
	OB_DO_JOINTS,
	OB_DO_INSPECT,
	OB_DO_SIMULATORS,
	OB_DO_ENERGY,
	OB_DO_ANEW,
	OB_DO_KINDS,
} ob_command_kind;

enum { OB_COMMAND_REQUESTS = 5 };

typedef struct ob_command {
	ob_command_kind kind;
	uint32_t requests;
	ob_request request[OB_COMMAND_REQUESTS]; // [requests] to the host, in this order; origin 0
	uint32_t id; // inspect
	bool on; // contacts, joints, simulators, energy
	char name[OB_NAME_MAX]; // motor and unjoin: the joint, which the requests lack
} ob_command;

enum { OB_COMMAND_BYTES_MAX = 2048 };

// false and e, for the viewer, if it is invalid.
bool ob_command_read(ob_command *c, const char *json, size_t size, ob_error *e);

#endif

// Requests of viewers, other programs and the host's own threads to a running universe.
#ifndef OB_HOST_REQUEST_H
#define OB_HOST_REQUEST_H

#include "scene/scene.h"

typedef enum ob_request_kind {
	OB_REQUEST_ADD,
	OB_REQUEST_REMOVE,
	OB_REQUEST_COLOUR,
	OB_REQUEST_MESSAGE, // to the object's script
	OB_REQUEST_FORCE, // from now on, until another is set: by a request, a script, or the scene's timetable
	OB_REQUEST_KICK, // at once: by an impulse and an angular impulse
	OB_REQUEST_STATE, // the object goes on from another place, with other velocities
	OB_REQUEST_MOVE, // its simulator moves to a worker: done at once, with several ranks, too (table/home.h)
} ob_request_kind;

typedef struct ob_request {
	uint32_t kind; // ob_request_kind
	uint32_t id, generation; // of the object; unused for an object to add
	uint32_t origin; // of an object to add: number of the viewer's connection; 0: none
	ob_object_def def; // to add
	ob_hull_corners corners; // of a hull
	float colour[4]; // linear
	uint32_t worker; // target of the move
	ob_state state; // to go on from
	ob_vec3 force, twist; // N, or N s; N m s; world frame
	uint32_t bytes; // of the message
	unsigned char values[512]; // flat (scene/flat.h)
} ob_request;

#endif

// Requests of viewers, other programs and the host's own threads to a running universe.
#ifndef OB_HOST_REQUEST_H
#define OB_HOST_REQUEST_H

#include <ob/control.h>

#include "scene/scene.h"
#include "table/request_kind.h"

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

// ---- request queue

// Queue of requests that wait for the next step boundary: a wait-free queue of liburcu. Any number of threads push, one takes.

typedef struct ob_requests ob_requests;

ob_requests *ob_requests_create(void); // NULL: out of memory
void ob_requests_destroy(ob_requests *q);
bool ob_requests_push(ob_requests *q, const ob_request *r); // false: out of memory
bool ob_requests_take(ob_requests *q, ob_request *out); // oldest first; false: none
bool ob_requests_waiting(ob_requests *q);

#endif

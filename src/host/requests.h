// Requests to add or remove objects, from any thread, kept until the next step boundary. A wait-free queue of liburcu;
// any number of threads push, one takes.
#ifndef OB_HOST_REQUESTS_H
#define OB_HOST_REQUESTS_H

#include "scene/scene.h"

typedef struct ob_requests ob_requests;

typedef struct ob_request {
	bool add;
	uint32_t id; // to remove
	ob_object_def def; // to add
} ob_request;

ob_requests *ob_requests_create(void); // NULL: out of memory
void ob_requests_destroy(ob_requests *q);
bool ob_requests_push(ob_requests *q, const ob_request *r); // false: out of memory
bool ob_requests_take(ob_requests *q, ob_request *out); // oldest first; false: none
bool ob_requests_waiting(ob_requests *q);

#endif

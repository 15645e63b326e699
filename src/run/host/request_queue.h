// Queue of requests that wait for the next step boundary: a wait-free queue of liburcu. Any number of threads push, one takes.
#ifndef OB_HOST_REQUEST_QUEUE_H
#define OB_HOST_REQUEST_QUEUE_H

#include "host/request.h"

typedef struct ob_requests ob_requests;

ob_requests *ob_requests_create(void); // NULL: out of memory
void ob_requests_destroy(ob_requests *q);
bool ob_requests_push(ob_requests *q, const ob_request *r); // false: out of memory
bool ob_requests_take(ob_requests *q, ob_request *out); // oldest first; false: none
bool ob_requests_waiting(ob_requests *q);

#endif

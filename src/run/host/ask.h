// Requests of other programs of the same user to a running universe: create, remove or colour an object, send its
// script a message, or move its simulator to another worker. The host listens on a socket in the abstract namespace,
// named after the universe. A request is one packet, and so is its answer.
//
// A request is carried out at the next step boundary (host/population.h); the answer says that it is valid and queued.
// With several ranks, rank 0 takes requests. No byte of a request is trusted.
#ifndef OB_HOST_ASK_H
#define OB_HOST_ASK_H

#include "host/host.h"

enum { OB_ASKED_CALLERS = 64 }; // callers that have not sent a request

// The universe's end. The supervisor's thread only.
typedef struct ob_asked {
	int events; // readable when there is something to do; < 0: the universe takes no requests
	int socket;
	int caller[OB_ASKED_CALLERS]; // oldest first
	uint32_t count;
} ob_asked;

// Listens at the address of the universe of this name. false and e: the universe takes no requests.
bool ob_asked_listen(ob_asked *a, const char *universe, ob_error *e);
// Checks and answers all requests that have arrived, and accepts callers. Waits for none of them.
void ob_asked_answer(ob_host *h, ob_asked *a);
void ob_asked_close(ob_asked *a); // a socket that does not listen is allowed

// The caller's end: sends a request once it has verified that the universe's host listens. false and e: refused, or not
// reachable.
bool ob_ask(const ob_universe *u, const ob_request *r, ob_error *e);

#endif

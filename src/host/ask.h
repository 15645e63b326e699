// How another program of the same user asks a running universe for something: to create, remove or colour an object, to
// send its script a message, or to move its simulator to another worker. A socket of the host, by the name of the universe, in the abstract namespace; a request
// is one packet, and so is its answer.
//
// A request is carried out at the next step boundary (host/population.h); the answer says that it makes sense, and is
// waiting. Of several ranks, rank 0 is asked. No byte of it is trusted.
#ifndef OB_HOST_ASK_H
#define OB_HOST_ASK_H

#include "host/host.h"

enum { OB_ASKED_CALLERS = 64 }; // that have said nothing yet

// The universe's side. The supervisor's thread only.
typedef struct ob_asked {
	int events; // readable when there is something to do; < 0: the universe cannot be asked
	int socket;
	int caller[OB_ASKED_CALLERS]; // the oldest first
	uint32_t count;
} ob_asked;

// Listens at the address of the universe of this name. false and e: it cannot be asked.
bool ob_asked_listen(ob_asked *a, const char *universe, ob_error *e);
// Checks and answers every request that has come, and lets callers in. Waits for none of them.
void ob_asked_answer(ob_host *h, ob_asked *a);
void ob_asked_close(ob_asked *a); // one that does not listen is allowed

// The other side: asks a universe, once it is sure that its host listens. false and e: it refuses, or cannot be asked.
bool ob_ask(const ob_universe *u, const ob_request *r, ob_error *e);

#endif

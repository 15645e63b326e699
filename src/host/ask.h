// How another program of the same user asks a running universe for something: to create, remove or colour an object, to
// send its script a message, or to move its simulator to another worker. A socket of the host, by the name of the universe, in the abstract namespace; a request
// is one packet, and so is its answer.
//
// A request is carried out at the next step boundary (host/population.h); the answer says that it makes sense, and is
// waiting. Of several ranks, rank 0 is asked. No byte of it is trusted.
#ifndef OB_HOST_ASK_H
#define OB_HOST_ASK_H

#include "host/host.h"

// The socket on which the universe of this name is asked; < 0: there cannot be one, and nobody can ask.
int ob_ask_listen(const char *universe);
// Takes one request from the socket, checks it, and answers.
void ob_ask_answer(ob_host *h, int socket);

// The other side: asks the universe of this name. false and e: it refuses, or cannot be asked.
bool ob_ask(const char *universe, const ob_request *r, ob_error *e);

#endif

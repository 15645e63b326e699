// The content server and the universe's window: one thread that hands out the viewer's page over HTTP, and over
// WebSockets tells viewers what exists and how it moves (feed.h), and takes what they ask for (command.h).
//
//      the host's thread        pace, requests         this thread                    viewers
//      lets the universe run  <----------------+  +--------------------+  <-----  commands, JSON
//                                              +--|  ob_server         |
//      universe, roster (RCU) --------------------|> ob_feed           |  ----->  messages, shared by all
//                                                 +--------------------+  ----->  pages, scripts, shaders
//
// A viewer that takes too little loses what waits for it and is told all anew; one that takes nothing at all for
// OB_SERVER_STUCK is dropped. Neither the universe nor other viewers wait for it.
//
// Who may come: on a loopback address, pages of this server alone, and programs of this machine; on any other address,
// who has the token. A page of another origin is refused, also where it has a name of its own for this address.
//
// Where a film is shown there is no universe: pages alone are handed out, and the film to who has the token.
//
// Thread-safety: start and stop are one thread's.
#ifndef OB_SERVE_SERVE_H
#define OB_SERVE_SERVE_H

#include "host/host.h"
#include "host/pace.h"
#include "serve/message.h"

typedef struct ob_listen {
	char address[64]; // in numbers
	int port; // 0: one that is free
	bool six; // IPv6
	bool loopback; // nobody comes from elsewhere
} ob_listen;

// ADDRESS:PORT, as 127.0.0.1:8080, localhost:8080 or [::1]:8080. false and e where it is not.
bool ob_listen_read(ob_listen *l, const char *text, ob_error *e);

typedef struct ob_server_config {
	ob_listen listen;
	bool look_only; // viewers may look, and change nothing
	uint32_t viewers; // at most
	const ob_scene *scene;
	const char *version;
	const ob_message *film; // what is shown instead of a universe (film.h), each viewer at a time of their own; NULL: none
} ob_server_config;

enum { OB_SERVER_STUCK = 20 }; // s

typedef struct ob_server ob_server;

// True if libwebsockets can be loaded; false and e with the package that is missing. Maps nothing.
bool ob_serve_check(ob_error *e);

// The host and the pace must outlive it; of a film there are none. NULL and e on failure.
ob_server *ob_server_start(const ob_server_config *c, ob_host *h, ob_pace *pace, ob_error *e);
// Where the page is, with its token, if there is one.
const char *ob_server_url(const ob_server *s);
void ob_server_stop(ob_server *s); // NULL is allowed

#endif

// The content server and the universe's window: one thread that serves the viewer's page over HTTP. Over WebSockets it
// sends viewers the objects and their motions (feed.h), and receives their requests (command.h).
//
//      the host's thread        pace, requests         this thread                    viewers
//      lets the universe run  <----------------+  +--------------------+  <-----  commands, JSON
//                                              +--|  ob_server         |
//      universe, roster (RCU) --------------------|> ob_feed           |  ----->  messages, shared by all
//                                                 +--------------------+  ----->  pages, scripts, shaders
//
// A viewer that reads too slowly loses its queue and gets the whole state again; one that reads nothing for
// OB_SERVER_STUCK is dropped. Neither the universe nor other viewers wait for it.
//
// Access: on a loopback address, pages of this server alone, and programs of this machine; on any other address,
// holders of a token. A page of another origin is refused, even with a name of its own for this address.
//
// Roles (host/request_table.h): on a loopback, programs of the same user operate, and others take part (peer.h); elsewhere each
// role has a token. If look_only is set, all visitors watch.
//
// For a film there is no universe: the server serves only pages, and the film to holders of the token.
//
// Thread-safety: start and stop are one thread's.
#ifndef OB_SERVE_SERVE_H
#define OB_SERVE_SERVE_H

#include "host/host.h"
#include "host/pace.h"
#include "host/request_table.h"
#include "serve/message.h"

typedef struct ob_listen {
	char address[64]; // in numbers
	int port; // 0: any free one
	bool six; // IPv6
	bool loopback; // only this machine can connect
} ob_listen;

// Reads ADDRESS:PORT, as 127.0.0.1:8080, localhost:8080 or [::1]:8080. false and e for other text.
bool ob_listen_read(ob_listen *l, const char *text, ob_error *e);

typedef struct ob_server_config {
	ob_listen listen;
	bool look_only; // all visitors watch
	bool foxglove; // viewers of Foxglove may connect, also from pages of other origins, which watch
	uint32_t viewers; // at most
	const ob_scene *scene;
	const char *version;
	bool fixed; // the scene cannot start anew with other parameters
	bool saves; // the run has a place for a checkpoint
	const ob_message *film; // shown instead of a universe (film.h), to each viewer at a time of its own; NULL: none
} ob_server_config;

enum { OB_SERVER_STUCK = 20 }; // s
enum { OB_SERVER_WORLDS = 3 }; // at most

typedef struct ob_server ob_server;

// True if libwebsockets can be loaded; false and e with the package that is missing. Maps nothing.
bool ob_serve_check(ob_error *e);

// Serves worlds of one scene, each with a host; for a film none, and no pace. With several, the page shows them side by side,
// and a viewer's connection names its world (/universe?world=1). Hosts and the pace must outlive it. NULL and e on failure.
ob_server *ob_server_start(const ob_server_config *c, ob_host *const *h, uint32_t hosts, ob_pace *pace, ob_error *e);
// Address of the page for visitors of a role, with its token, if there is one. The first is for all that is allowed;
// "" for another: the server gives out no address of its own for that role.
const char *ob_server_url(const ob_server *s, ob_role role);
// Sends all viewers a message, and releases it; one that is not sent yet is dropped for the next. Any thread.
void ob_server_tell(ob_server *s, ob_message *m);
// Holds the server, whose viewers stay connected, and lets it go on with another run of the scene; before the host is stopped,
// and after the next one is started, with as many worlds. go_on: false and e if it cannot.
void ob_server_hold(ob_server *s);
bool ob_server_go_on(ob_server *s, const ob_scene *scene, ob_host *const *h, ob_error *e);
void ob_server_stop(ob_server *s); // NULL is allowed

#endif

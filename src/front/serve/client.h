// Connection of one viewer: its queue of messages, and its allowance of requests. The server's thread only.
#ifndef OB_SERVE_CLIENT_H
#define OB_SERVE_CLIENT_H

#include <libwebsockets.h>

#include "host/host.h"
#include "host/request_table.h"
#include "serve/command.h"
#include "serve/message.h"

enum {
	OB_CLIENT_QUEUE = 256, // messages
	OB_CLIENT_BYTES = 4 << 20, // in the queue
};

typedef struct ob_client_queue {
	ob_message *waiting[OB_CLIENT_QUEUE]; // a ring
	unsigned head, count;
	size_t bytes; // in the queue
	size_t sent; // bytes sent of the first
} ob_client_queue;

// Tokens of a bucket (a rate per second, and as many at once), against floods.
typedef struct ob_allowance {
	double left, at; // at: s
} ob_allowance;

typedef struct ob_client {
	struct lws *wsi;
	struct ob_client *next; // that looks at the same world
	uint32_t world; // number
	ob_client_queue queue;
	bool behind; // its queue was cleared; it gets the whole state once the rest has been sent
	double taken_at; // s: time of its last progress, or of an empty queue
	bool simulators; // is sent who simulates each object
	bool contacts, joints; // it shows them
	bool energy; // likewise, in its plots
	uint32_t avatar, generation; // its avatar's id and generation; UINT32_MAX: it has none
	bool missing; // the roster does not have its avatar
	uint32_t inspected; // id; UINT32_MAX: none
	uint32_t number; // origin of its requests: from 1, of this connection only
	ob_role role;
	bool pulls; // it may hold on to objects
	uint32_t frozen, first_frozen; // its objects that were frozen, of which it was not notified; id of the first
	ob_allowance commands, creations;
	uint64_t roster; // its number when creations were last counted
	uint32_t awaited; // creations since then
	struct ob_foxglove *foxglove; // NULL: a page of ours
	char command[OB_COMMAND_BYTES_MAX + 1];
	size_t command_size;
} ob_client;

// Queues m and holds it. false: the queue is full, and was cleared except for a message in progress.
bool ob_client_queue_put(ob_client_queue *q, ob_message *m);
void ob_client_queue_clear(ob_client_queue *q);
// Writes some of the queue; call it when the connection is writable. false: the connection is broken.
bool ob_client_write(ob_client *v);
// Takes one of "rate" tokens a second; false: too many.
bool ob_allowance_take(ob_allowance *a, double now, double rate);

// ---- avatar

// Avatars: objects that the scene's template (avatar = true) makes for viewers, one for each that may take part. The server's
// thread.

// Requests an avatar for a new viewer, at a free place near the template's. Scenes without avatars: nothing.
void ob_avatar_ask(ob_host *h, const ob_scene *scene, const ob_client *c);
// Finds each viewer's avatar, requests those that are missing, and removes those whose viewer has gone. Calls found for
// viewers whose avatar is another than before.
void ob_avatars_update(ob_host *h, const ob_scene *scene, ob_client *clients, void (*found)(ob_client *c));

#endif

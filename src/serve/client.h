// One viewer's connection: the messages that wait for it, and what it may still ask for. The server's thread only.
#ifndef OB_SERVE_CLIENT_H
#define OB_SERVE_CLIENT_H

#include <libwebsockets.h>

#include "serve/command.h"
#include "serve/message.h"

enum {
	OB_CLIENT_QUEUE = 256, // messages
	OB_CLIENT_BYTES = 4 << 20, // that wait
};

typedef struct ob_client_queue {
	ob_message *waiting[OB_CLIENT_QUEUE]; // a ring
	unsigned head, count;
	size_t bytes; // that wait
	size_t sent; // of the first
} ob_client_queue;

// Tokens of a bucket (so many a second, and as many again at once), against floods.
typedef struct ob_allowance {
	double left, at; // at: s
} ob_allowance;

typedef struct ob_client {
	struct lws *wsi;
	struct ob_client *next;
	ob_client_queue queue;
	bool behind; // it lost what waited, and is told all when the rest has been taken
	double taken_at; // s: when it last took anything, or nothing waited
	bool contacts; // it wants to see them
	uint32_t inspected; // id; UINT32_MAX: none
	ob_allowance commands, creations;
	char command[OB_COMMAND_BYTES_MAX + 1];
	size_t command_size;
} ob_client;

// Lets m wait; it is held. false: it is too much, and all but what is under way was let go.
bool ob_client_queue_put(ob_client_queue *q, ob_message *m);
void ob_client_queue_clear(ob_client_queue *q);
// Writes some of what waits; to be called when the connection can take it. false: the connection is broken.
bool ob_client_write(ob_client *v);
// One of so many a second; false: too many.
bool ob_allowance_take(ob_allowance *a, double now, double rate);

#endif

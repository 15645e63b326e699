// The door: all connections other than viewers, from their acceptance on. A connection is in one state at a time, and
// each state but a viewer's has a deadline, so no slow client keeps a place:
//
//      accepted ──> request ──> answer ──> idle        request: its head must be whole in OB_DOOR_REQUEST
//                   ^   |                   |          answer:  the client takes some of it every OB_DOOR_ANSWER
//                   |   +──> viewer         |          idle:    another request's head is whole in OB_DOOR_IDLE
//                   +───────────────────────+
//
// Places are limited, in total and per address. A new connection is always accepted: beyond a limit it replaces the
// connection that has been in its state for longest, of its own address or of the address with the most. So an address
// with many places loses them first, and a client that completes its request is served.
//
// The server's thread only.
#ifndef OB_SERVE_DOOR_H
#define OB_SERVE_DOOR_H

#include <libwebsockets.h>
#include <stdbool.h>
#include <stdint.h>

enum { // s
	OB_DOOR_REQUEST = 5,
	OB_DOOR_ANSWER = 20,
	OB_DOOR_IDLE = 20,
};

typedef enum ob_door_state {
	OB_AT_REQUEST,
	OB_AT_ANSWER,
	OB_AT_IDLE,
	OB_AT_VIEWER, // takes no place
	OB_AT_END, // is being closed
} ob_door_state;

typedef struct ob_visit ob_visit;

typedef struct ob_door {
	uint32_t places, share; // limits: in total, and per address
	ob_visit *visits;
} ob_door;

// Enters a connection that was just accepted, and closes another beyond a limit. now: s. false: no memory.
bool ob_door_enter(ob_door *d, struct lws *wsi, double now);
// Moves a connection to another state, or, in an answer, notes the client's progress.
void ob_door_move(struct lws *wsi, ob_door_state state, double now);
// Forgets a connection that has ended. One that never entered is allowed.
void ob_door_leave(ob_door *d, struct lws *wsi);
// Closes the connections whose deadline has passed.
void ob_door_look(ob_door *d, double now);

#endif

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
#include <stdio.h>

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

// ---- peer

// User of the program at the other end of a connection on a loopback, by the kernel's tables of connections.

// One end of a connection: an IPv6 address, or IPv4 as ::ffff:a.b.c.d, in words as they lie in memory; and its port.
typedef struct ob_peer_end {
	uint32_t word[4];
	unsigned port;
} ob_peer_end;

// True if the peer of a TCP socket is a program of the same user, or of root. Not across machines. Any thread.
bool ob_peer_is_ours(int fd);
// Finds the user of a socket that is bound to `own` and connected to `other` in a table as /proc/net/tcp or tcp6. A socket
// that its program has closed stands there with inode 0, and as root's: it is nobody's. false: there is none.
bool ob_peer_find_user(FILE *table, const ob_peer_end *own, const ob_peer_end *other, unsigned *user);

#endif

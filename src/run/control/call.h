// Calls to the host of a running universe, by programs of the same user on the same machine: a socket in the abstract
// namespace, named after the universe. Each message is one packet.
#ifndef OB_CONTROL_CALL_H
#define OB_CONTROL_CALL_H

#include <stdbool.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <ob/universe.h>

enum { OB_CALL_PATIENCE_MS = 10000 }; // to connect, to send, and for an answer that needs no step

// Fills in the address of a universe's host; returns its length.
socklen_t ob_call_address(const char *universe, struct sockaddr_un *a);
// Connects to the universe's host, and verifies that nobody else listens there. < 0 and e: not reachable. The caller
// closes the socket.
int ob_call_host(const ob_universe *u, ob_error *e);

#endif

// User of the program at the other end of a connection on a loopback, by the kernel's tables of connections.
#ifndef OB_SERVE_PEER_H
#define OB_SERVE_PEER_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

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

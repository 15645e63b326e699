// User of the program at the other end of a connection on a loopback, by the kernel's table of connections.
#ifndef OB_SERVE_PEER_H
#define OB_SERVE_PEER_H

#include <stdbool.h>

// True if the peer of a TCP socket is a program of the same user, or of root. Not across machines. Any thread.
bool ob_peer_is_ours(int fd);

#endif

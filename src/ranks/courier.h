// The wire for a process that forks. Who has loaded MPI has its threads and its sockets, which no child should inherit:
// so a process beside this one, forked first, has the wire, and carries what is said between a socket and the others.
//
//   rank 0                                      rank 1
//   this process  <- socket ->  courier  -- wire --  courier  <- socket ->  that process
//
// The courier ends with its process, however that ends, and by no signal to both: who wants to say why still can.
// Thread-safety: a courier belongs to one thread.
#ifndef OB_RANKS_COURIER_H
#define OB_RANKS_COURIER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>

#include "ranks/ranks.h"

enum { OB_COURIER_BYTES = 8192 }; // of a message, at most

typedef struct ob_courier ob_courier;

// Forks it; it joins the others by itself. All messages have n bytes, on all ranks. From a process without other
// threads. NULL and e: it cannot be started.
ob_courier *ob_courier_start(const ob_ranks *ranks, size_t n, ob_error *e);
// Becomes readable when there is something to receive, an error or the courier's end among it.
int ob_courier_socket(const ob_courier *c);
// false and e: it has gone.
bool ob_courier_send(ob_courier *c, uint32_t to, const void *message, ob_error *e);

typedef enum ob_courier_news {
	OB_COURIER_NOTHING,
	OB_COURIER_MESSAGE, // in "message", of "from"
	OB_COURIER_GONE // and e
} ob_courier_news;
// Does not wait.
ob_courier_news ob_courier_receive(ob_courier *c, void *message, uint32_t *from, ob_error *e);

// Waits until all ranks have come here. false and e: the courier died instead.
bool ob_courier_end(ob_courier *c, ob_error *e);
// Ends it without the others, which the launcher ends when this process fails. NULL is allowed.
void ob_courier_abandon(ob_courier *c);

#endif

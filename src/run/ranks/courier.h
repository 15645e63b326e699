// The wire for a process that forks. A process that has loaded MPI has MPI's threads and sockets, which no child should
// inherit. So a separate process, forked first, has the wire, and forwards messages between a socket and the other
// ranks.
//
//   rank 0                                      rank 1
//   this process  <- socket ->  courier  -- wire --  courier  <- socket ->  that process
//
// The courier ends with its process, however that ends, and not by a signal sent to both: a failing process can still
// report its reason. Thread-safety: a courier belongs to one thread.
#ifndef OB_RANKS_COURIER_H
#define OB_RANKS_COURIER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>

#include "ranks/ranks.h"

enum { OB_COURIER_BYTES = 8192 }; // message size limit

typedef struct ob_courier ob_courier;

// Forks the courier, which joins the others by itself. All messages have n bytes, on all ranks. Call it from a process
// without other threads. Returns NULL and e if it cannot be started.
ob_courier *ob_courier_start(const ob_ranks *ranks, size_t n, ob_error *e);
// Becomes readable when a message, an error or the courier's end arrives.
int ob_courier_socket(const ob_courier *c);
// Returns false and e if the courier has ended.
bool ob_courier_send(ob_courier *c, uint32_t to, const void *message, ob_error *e);

typedef enum ob_courier_news {
	OB_COURIER_NOTHING,
	OB_COURIER_MESSAGE, // in "message", sent by "from"
	OB_COURIER_GONE // and e
} ob_courier_news;
// Receives without waiting.
ob_courier_news ob_courier_receive(ob_courier *c, void *message, uint32_t *from, ob_error *e);

// Waits until all ranks call it. Returns false and e if the courier died instead.
bool ob_courier_end(ob_courier *c, ob_error *e);
// Ends it without the others, which the launcher ends when this process fails. NULL is allowed.
void ob_courier_abandon(ob_courier *c);

#endif

// The part of obsim that calls MPI (base/part.h): obsim-mpi.so.
#ifndef OB_RANKS_MODULE_H
#define OB_RANKS_MODULE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/part.h"

// Of each rank's share of an exchange: how long it is, and its first bytes. So what is short needs one message, not
// two; as long as Open MPI sends at once, without asking the receiver.
enum { OB_WIRE_FIRST = 4000 };
typedef struct ob_wire_first {
	uint64_t bytes; // of all that it has to say
	uint64_t more; // 1 = it has more than the first bytes to say to some rank
	char text[OB_WIRE_FIRST]; // the first of them
} ob_wire_first;

typedef struct ob_wire_module {
	ob_part_head head;
	bool (*open)(uint32_t *rank, uint32_t *ranks);
	// all[r] := what rank r has in "mine"
	void (*first)(const ob_wire_first *mine, ob_wire_first *all);
	// From all into "all": "bytes[r]" of rank r, a multiple of 8, to at[r], likewise. mine: this one's
	void (*rest)(const void *mine, char *all, const size_t *at, const size_t *bytes);
	// Likewise where each rank has something else to say to each: mine[r] to rank r
	void (*deal_first)(const ob_wire_first *mine, ob_wire_first *all);
	// mine: "mine_bytes[r]" to rank r, from mine_at[r] on
	void (*deal_rest)(const char *mine, const size_t *mine_at, const size_t *mine_bytes, char *all,
			  const size_t *at, const size_t *bytes);
	// Returns when the wire has taken it.
	void (*send)(uint32_t to, const void *bytes, size_t n);
	// Has a rank said something to this one? Who, and how many bytes
	bool (*probe)(uint32_t *from, size_t *n);
	// That, into as much room
	void (*receive)(uint32_t from, void *to, size_t n);
	void (*close)(void);
} ob_wire_module;

#endif

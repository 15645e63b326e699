// The part of obsim that calls MPI (base/part.h): obsim-mpi.so.
#ifndef OB_RANKS_MODULE_H
#define OB_RANKS_MODULE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/part.h"

// Header of each rank's share of an exchange: its length and first bytes. So short shares need one message, not two, as
// long as Open MPI sends eagerly.
enum { OB_WIRE_FIRST = 4000 };
typedef struct ob_wire_first {
	uint64_t bytes; // total length of its share
	uint64_t more; // 1 = more than the first bytes for at least one rank
	char text[OB_WIRE_FIRST]; // the first bytes
} ob_wire_first;

typedef struct ob_wire_module {
	ob_part_head head;
	bool (*open)(uint32_t *rank, uint32_t *ranks);
	// all[r] := "mine" of rank r
	void (*first)(const ob_wire_first *mine, ob_wire_first *all);
	// Gathers into "all": "bytes[r]" of rank r, a multiple of 8, at at[r], which is also a multiple of 8. mine:
	// this rank's
	void (*rest)(const void *mine, char *all, const size_t *at, const size_t *bytes);
	// Same with a separate header for each destination: mine[r] to rank r.
	void (*deal_first)(const ob_wire_first *mine, ob_wire_first *all);
	// mine: "mine_bytes[r]" to rank r, from mine_at[r] on
	void (*deal_rest)(const char *mine, const size_t *mine_at, const size_t *mine_bytes, char *all,
			  const size_t *at, const size_t *bytes);
	// Returns when the message is buffered or sent.
	void (*send)(uint32_t to, const void *bytes, size_t n);
	// True if a message for this rank is waiting; sets its source and length.
	bool (*probe)(uint32_t *from, size_t *n);
	// Receives that message into n bytes.
	void (*receive)(uint32_t from, void *to, size_t n);
	void (*close)(void);
} ob_wire_module;

#endif

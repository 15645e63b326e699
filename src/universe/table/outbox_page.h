// An outbox in the universe (outbox.h), as its simulator writes it and the arranger reads it: the page's head, its records,
// and their checksum; and the simulator's own memory of it.
#ifndef OB_TABLE_OUTBOX_PAGE_H
#define OB_TABLE_OUTBOX_PAGE_H

#include <string.h>

#include "table/layout.h"
#include "table/outbox.h"

enum { OB_CHECKSUM_LANES = 4, OB_OUTBOX_LOOK_AGAIN_MS = 100 };

typedef struct ob_outbox_page {
	_Alignas(64) uint32_t signal; // completed outboxes so far
	uint32_t last; // 1 = this one is the arrival
	uint32_t turn; // of the gate
	uint32_t bytes; // of records
	uint64_t sum;
	uint64_t faults[OB_FAULT_KINDS]; // injected into its simulator
	uint32_t working_on; // as ob_worker_cell
	_Alignas(64) char record[];
} ob_outbox_page;

typedef struct ob_record_head {
	uint32_t kind, bytes;
} ob_record_head;

static inline ob_outbox_page *ob_outbox_page_of(const ob_universe *u, uint32_t worker)
{
	return (ob_outbox_page *)(u->outbox_area + (size_t)worker * u->header.sizes.outbox_bytes);
}

// Bytes of records that an outbox has room for.
static inline size_t ob_outbox_room(const ob_universe *u)
{
	return u->header.sizes.outbox_bytes - sizeof(ob_outbox_page);
}

// FNV's operations (xor, multiply) on words, in independent lanes. Any single differing word changes the sum; several
// do with all but one chance in 2^64.
typedef struct ob_checksum {
	uint64_t lane[OB_CHECKSUM_LANES];
	size_t words;
} ob_checksum;

#define OB_CHECKSUM_PRIME UINT64_C(0x9E3779B97F4A7C15)

static inline ob_checksum ob_checksum_start(uint32_t worker, uint32_t turn)
{
	ob_checksum c = { .words = 0 };
	for (uint64_t i = 0; i < OB_CHECKSUM_LANES; i++)
		c.lane[i] = OB_CHECKSUM_PRIME * (i + 1) ^ (uint64_t)worker << 32 ^ turn;
	return c;
}

static inline void ob_checksum_add(ob_checksum *c, const void *words, size_t bytes)
{
	for (size_t i = 0; i < bytes / 8; i++, c->words++) {
		uint64_t word;
		memcpy(&word, (const char *)words + 8 * i, sizeof word);
		uint64_t *lane = &c->lane[c->words % OB_CHECKSUM_LANES];
		*lane = (*lane ^ word) * OB_CHECKSUM_PRIME;
	}
}

static inline uint64_t ob_checksum_end(const ob_checksum *c)
{
	uint64_t sum = c->words;
	for (int i = 0; i < OB_CHECKSUM_LANES; i++)
		sum = (sum ^ c->lane[i] ^ c->lane[i] >> 29) * OB_CHECKSUM_PRIME;
	return sum;
}

// State of this process between two phases; it is not in the universe.
typedef struct ob_outbox {
	ob_outbox_page *page;
	uint32_t worker, signal, done; // done: the last turn at which it arrived
	uint32_t next_task;
	bool stopped; // the arranger has stopped
	bool summed; // the checksum covers the records, not the turn alone
	size_t used;
	ob_checksum sum;
	ob_outbox_end end; // sums that it submits when it arrives
} ob_outbox;

#endif

// One universe on several ranks. Each rank has the same number of simulators and solves its share of each phase. It
// commits the results of all ranks' simulators that concern it, in the order of ranks. So each computes the same
// universe, of which it holds a part (halo.h), and the same as one rank with as many simulators.
//
//   arranger, at the end of a phase:  outboxes of its own simulators -> mail -> all ranks' mail -> commit
//
// A body is owned by one rank, which schedules its work:
//
//   known to all ranks                       known to one rank
//   each object's fat AABB, and its home     when it is due, its island (rank_islands.h), its motion, which its
//   (table/home.h)                             neighbours' ranks have, too (halo.h)
//   pairs that exist, and those that touch   when a pair is to be checked (pair_rank.h, late_contacts.c), its contents
//                                              between steps while it touches (holdings.h)
//   pairs of two ranks' bodies that are expected to touch, or have touched late
//
// The result of a check of a pair of two ranks' bodies is sent to the other rank, if it changes its state, and to all
// ranks, if it links the two bodies.
//
// With its mail each rank sends its position: step, phase, and a digest of the state before the phase and all earlier
// ones. If two ranks differ, all find out at which object, and the run ends. An arranger whose run is over, for any
// reason, sends that in place of a mail, so no rank waits for it.
#ifndef OB_CLUSTER_PEERS_H
#define OB_CLUSTER_PEERS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "table/outbox.h"

// Connection of a rank's arranger to the others (drawing above). gather: exchanges n bytes of each rank; returns
// those of all in the order of ranks; at: offset of each, and the end. NULL: no memory.
typedef struct ob_peers {
	uint32_t rank, ranks;
	const char *(*gather)(void *wire, const void *mine, size_t n, const size_t **at);
	// The same with another message for each rank: bytes[r] at mine[r] are sent to rank r
	const char *(*deal)(void *wire, const void *const *mine, const size_t *bytes, const size_t **at);
	void *wire;
	bool parted; // a rank has left, and all know it
	uint64_t look; // first step at which some rank needs all motions (halo.h), as all ranks know it
	uint32_t islands; // number on all ranks, when those of a step are solved
	uint64_t move; // requested on rank 0, as table/home.h; made before the next step's islands are built
} ob_peers;

// Head of each message.
typedef struct ob_peers_head {
	uint64_t step; // set by ob_peers_exchange
	uint64_t phase; // an ob_phase, or one of the next
	uint64_t digest;
	// 1 + an object whose state does not fit its digest; 0: none is known; OB_PEERS_MOTION: its motion
	uint64_t damaged;
	uint64_t differs; // 1 = it received motions whose start differs from the one here
	uint64_t move; // of rank 0: move of a simulator, as table/home.h; set by ob_peers_exchange
	uint64_t next_due; // first step with an object to solve, or a pair to check, on the rank; likewise
	uint64_t look; // first step at which the rank needs all motions; likewise
	uint64_t islands; // of the rank; likewise
	int64_t woken; // change of the number of its awake bodies since its last message
} ob_peers_head;
#define OB_PEERS_MOVE (UINT64_MAX - 1)
#define OB_PEERS_GATHER (UINT64_MAX - 2)
#define OB_PEERS_MEET (UINT64_MAX - 3)
#define OB_PEERS_LOOK (UINT64_MAX - 4)
#define OB_PEERS_SHARE (UINT64_MAX - 5)
#define OB_PEERS_CUT (UINT64_MAX - 6)
#define OB_PEERS_MOTION (UINT64_C(1) << 63)

// Kinds of parcels that ranks exchange between phases; they follow the head of a message.
typedef enum ob_parcel_kind {
	OB_PARCEL_HOMES, // bodies that move from the sender's rank to another (rank_islands.h)
	OB_PARCEL_KEPT, // contents of a pair (holdings.h)
	OB_PARCEL_BODY, // this and the next: halo.h
	OB_PARCEL_PAIR,
	OB_PARCEL_COST, // of a body (regions.h)
} ob_parcel_kind;
typedef struct ob_parcel {
	uint32_t kind, bytes; // size with this head: a multiple of 8
} ob_parcel;

// Digest of the state before a phase, before any of it is committed, that all ranks share: the number of pairs, and the
// bodies that query for others.
uint64_t ob_peers_digest(const ob_universe *u);
// Empties the mail and leaves room for a head.
void ob_peers_begin(ob_mail *mail);
// Sends the mail with this head to all ranks; each: mail[rank] to each. Returns the mails of all ranks, with heads, in
// the order of ranks: rank r's from at[r] to at[r + 1], valid until the next call. NULL: the others are at another point
// of the run, or one has left, or there is no memory, and the step has failed. Then all know the move requested on rank
// 0 (ob_peers.move), and the next step with work, or with a reader of all motions (ob_peers.look). They also know the
// numbers of islands and of awake bodies.
const char *ob_peers_exchange(ob_peers *p, ob_universe *u, ob_peers_head head, ob_mail *mail, bool each,
			      const size_t **at);
// Takes a parcel from a rank. Returns false if it is malformed.
typedef bool (*ob_parcel_take)(void *with, ob_universe *u, const char *parcel, const ob_parcel *head, uint32_t from);
// Sends parcels to the other ranks, by one mail to all or (each) by mail[rank], and takes those that they have sent.
// false: the step has failed.
bool ob_parcels_exchange(ob_peers *p, ob_universe *u, uint64_t phase, ob_mail *mail, bool each, ob_parcel_take take,
			 void *with);
// Fails the step: the rank has sent malformed data.
void ob_peers_blame(const ob_peers *p, ob_universe *u, uint32_t rank);
bool ob_peers_join(ob_peers *p, const ob_universe *u, ob_error *e);
void ob_peers_leave(ob_peers *p);

// ---- digest

// Digests of whole words, which ranks compare (peers.h, holdings.h).

static inline uint64_t ob_digest_word(uint64_t sum, uint64_t word)
{
	sum = (sum ^ word) * 0x9e3779b97f4a7c15u;
	return sum ^ sum >> 29;
}

// Returns the digest of memory; bytes: a multiple of 8. It sums products of two words each: NH of Black, Halevi,
// Krawczyk, Krovetz and Rogaway (UMAC: fast and secure message authentication, 1999). Keys are multiples of a number
// here, so no product waits for another.
static inline uint64_t ob_digest_words(const void *words, size_t bytes)
{
	const uint64_t step = 0x9e3779b97f4a7c15u, other = 0xd1b54a32d192ed03u;
	uint64_t word[2], key = step, low = 0, high = 0;
	size_t at = 0;
	for (; at + sizeof word <= bytes; at += sizeof word, key += step) {
		memcpy(word, (const char *)words + at, sizeof word);
		const unsigned __int128 product = (unsigned __int128)(word[0] + key) * (word[1] + (key ^ other));
		low += (uint64_t)product;
		high += (uint64_t)(product >> 64);
	}
	for (; at < bytes; at += sizeof *word) {
		memcpy(word, (const char *)words + at, sizeof *word);
		low = ob_digest_word(low, *word);
	}
	return ob_digest_word(ob_digest_word(bytes, low), high);
}

#endif

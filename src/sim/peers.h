// One universe on several ranks: each has the same number of simulators, solves its share of each phase, and commits
// what the simulators of all ranks have handed over, as far as it concerns it, in the order of ranks. So each comes to
// the same universe, of which it has a part (halo.h), and to that of one rank with as many simulators.
//
//   arranger, at the end of a phase:  outboxes of its own simulators -> mail -> all ranks' mail -> commit
//
// A body is one rank's own, which arranges what concerns it:
//
//   what all ranks have alike                what is with one
//   each object's fat AABB, and its home     when it is due, in which island it is (rank_islands.h), its motion, which
//   (table/home.h)                             its neighbours have, too (halo.h)
//   which pairs there are, and which touch   when a pair is to be checked (pair_rank.h, late_contacts.c), what it keeps
//                                              between steps while it touches (holdings.h)
//   which pairs of two ranks' bodies are expected to touch, or have touched late
//
// What the check of a pair of two ranks' bodies has found goes to the other, where it changes something, and to all,
// where it says that the pair links them.
//
// With its mail each rank sends where it stands: step, phase, and a digest of what the phase began with, and those
// before it. Where two differ, all find out about which object, and the run ends. An arranger whose run is over, for
// whatever reason, says so in place of a mail, so nobody waits for it.
#ifndef OB_SIM_PEERS_H
#define OB_SIM_PEERS_H

#include "sim/sim.h"
#include "table/outbox.h"

// What each message begins with.
typedef struct ob_peers_head {
	uint64_t step; // set by ob_peers_exchange
	uint64_t phase; // an ob_phase, or one of the next
	uint64_t digest;
	uint64_t damaged; // 1 + an object, what is kept of which is not what it was; 0: none is known; OB_PEERS_MOTION: its motion
	uint64_t differs; // 1 = it has been told of motions that have begun otherwise than where it is
	uint64_t move; // of rank 0: where a simulator is to move, as table/home.h; set by ob_peers_exchange
	uint64_t next_due; // the first step for which the rank has an object to solve, or a pair to check; likewise
	uint64_t look; // the first step at which the rank is to have all motions; likewise
	uint64_t islands; // of the rank; likewise
	int64_t woken; // of its bodies, less those that have fallen asleep, since it has said so last
} ob_peers_head;
#define OB_PEERS_MOVE (UINT64_MAX - 1)
#define OB_PEERS_GATHER (UINT64_MAX - 2)
#define OB_PEERS_MEET (UINT64_MAX - 3)
#define OB_PEERS_LOOK (UINT64_MAX - 4)
#define OB_PEERS_SHARE (UINT64_MAX - 5)
#define OB_PEERS_CUT (UINT64_MAX - 6)
#define OB_PEERS_MOTION (UINT64_C(1) << 63)

// What ranks hand to each other between phases, parcel by parcel behind the head of a message.
typedef enum ob_parcel_kind {
	OB_PARCEL_HOMES, // bodies that go from the sender's rank to another (rank_islands.h)
	OB_PARCEL_KEPT, // what a pair keeps (holdings.h)
	OB_PARCEL_BODY, // and the next: halo.h
	OB_PARCEL_PAIR,
} ob_parcel_kind;
typedef struct ob_parcel {
	uint32_t kind, bytes; // with this, which it begins with: a multiple of 8
} ob_parcel;

// What the phase begins with, before any of it is committed, and all have alike: how many pairs there are, and who
// looks for others.
uint64_t ob_peers_digest(const ob_universe *u);
// Empties the mail but for a head. false: no memory.
bool ob_peers_begin(ob_mail *mail);
// Sends the mail, which begins with a head, this one. Gives those of all ranks, heads and all, in their order: that of
// rank r from at[r] to at[r + 1]; they hold until the next call. NULL: the others are elsewhere, or one has left, and
// the step has failed. Then all know the move that rank 0 was asked for (ob_peers.move), for which step somebody has
// something to do, or looks at all motions (ob_peers.look), how many islands there are, and how many are awake.
const char *ob_peers_exchange(ob_peers *p, ob_universe *u, ob_peers_head head, ob_mail *mail, const size_t **at);
// Likewise to each rank another, mail[rank].
const char *ob_peers_deal(ob_peers *p, ob_universe *u, ob_peers_head head, ob_mail *mail, const size_t **at);
// The next parcel from "from" on, of so many bytes, which then begin behind it. NULL: there is none; *sound becomes false
// where it makes no sense. p: its head.
const char *ob_parcel_next(const char **from, size_t *bytes, ob_parcel *p, bool *sound);
// The rank has sent what makes no sense: the step fails.
void ob_peers_blame(const ob_peers *p, ob_universe *u, uint32_t rank);
bool ob_peers_join(ob_peers *p, const ob_universe *u, ob_error *e);
void ob_peers_leave(ob_peers *p);

#endif

// Halo: motions that one of several ranks (peers.h) keeps. It has those of its own bodies, which it solved last, and of
// their neighbours in pairs, which it needs to check pairs. For all other bodies it knows the fat AABBs, which they
// cannot leave, and a motion that may be out of date.
//
//   rank 0's bodies    rank 1's bodies
//   o o o o o o o o  | n n . . . . . .     rank 0     o   its own
//   . . . . . . n n  | o o o o o o o o     rank 1     n   a neighbour: both are of one pair
//
// All ranks know all pairs, so a body's owner knows which ranks need its motion, and when:
//
//   - tell: a body was solved. Its owner sends the motion to ranks that own neighbours of it.
//   - meet: a pair of two ranks' bodies is new. Each rank sends the other its body's motion, unless it did before.
//   - give: another rank solves the body from now on (rank_islands.h). It gets the motions of the body and of its
//     neighbours, and the state of its pairs.
//   - gather: a reader needs the universe (ob_peers.look). All ranks get all motions.
//   - share: a checkpoint is written. All ranks get the state of all pairs.
//
// So the universe is whole on each rank where a host reads it, at a pause, and no earlier. With a reader after each
// step, all ranks get all motions as they are solved.
//
// A rank keeps a digest of each motion, in memory that simulators do not reach. It is compared when the body is solved
// next, and so is the digest that the sender of a motion had.
//
// Thread-safety: the arranger alone calls these functions.
#ifndef OB_CLUSTER_HALO_H
#define OB_CLUSTER_HALO_H

#include "cluster/peers.h"

typedef struct ob_halo ob_halo;

// Creates the halo; at the start all ranks have all motions. NULL: no memory.
ob_halo *ob_halo_create(const ob_universe *u);
void ob_halo_destroy(ob_halo *h); // NULL is allowed
// Gives each new body an owner, after a pause or scripts. These publish motions that no simulator has computed, the
// same on all ranks.
void ob_halo_settle(ob_halo *h, ob_universe *u);

// True if any rank may lack any motion.
bool ob_halo_is_partial(const ob_halo *h);
void ob_halo_part(ob_halo *h); // sets that, from now on

// Prefetches what ob_halo_note and the functions for the body's publication need.
void ob_halo_prefetch(const ob_halo *h, uint32_t id);

// True if the body is another rank's. Listing the pairs of a body to solve shows if a neighbour is elsewhere, and
// ob_halo_note_border notes it: without one, ob_halo_address need not search the pairs. NULL is allowed.
bool ob_halo_is_elsewhere(const ob_halo *h, uint32_t id);
void ob_halo_note_border(ob_halo *h, uint32_t id, bool is_at);
// A body of this rank's was solved: sets to[r] if rank r is sent its motion; all: every rank is. Returns true if a
// receiver may lack the motion before the step.
bool ob_halo_address(ob_halo *h, const ob_universe *u, uint32_t id, bool all, bool *to);
// Notes the motion of a solved body, from this rank or another, that is to be staged.
void ob_halo_note(ob_halo *h, uint32_t id, const ob_motion *staged);
// Takes the next of other ranks' bodies with a staged motion, each once. false: there is none left. NULL is allowed.
bool ob_halo_take_received(ob_halo *h, uint32_t *id);
// Notes that the body's staged motion is published. NULL is allowed.
void ob_halo_note_published(ob_halo *h, const ob_universe *u, uint32_t id);
// Gets the digest of the body's motion before the step. false: it differs from the one that was noted.
bool ob_halo_digest(const ob_halo *h, const ob_universe *u, uint32_t id, uint64_t *digest);

// Exchange motions, called by all ranks: meet when pairs have been added (ob_step_data.check), gather between two
// steps. false: the step has failed.
bool ob_halo_meet(ob_halo *h, ob_universe *u, ob_peers *p);
bool ob_halo_gather(ob_halo *h, ob_universe *u, ob_peers *p);
// Exchanges, between two steps, until when each pair is known to be separated. A run that goes on from there needs the
// same: a pair may begin to touch when it is checked again.
bool ob_halo_share_pairs(ob_halo *h, ob_universe *u, ob_peers *p);
// Moves the body to that simulator from now on; called by all ranks.
void ob_halo_rehome(ob_halo *h, ob_universe *u, uint32_t id, uint32_t simulator);
// Packs the motions and pairs that the new rank of the body needs; it was this rank's.
void ob_halo_give(const ob_halo *h, const ob_universe *u, uint32_t id, ob_mail *mail);
// Unpacks a parcel of it from another rank. false: it is malformed.
bool ob_halo_take(ob_halo *h, ob_universe *u, const char *parcel, const ob_parcel *head);

#endif

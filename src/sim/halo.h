// Whose motions a rank has, of several (peers.h): those of the bodies that it has solved last, its own, and of their
// neighbours, which it must know to check pairs: its halo. Of all others it knows where they cannot leave (their fat
// AABBs), and no more: what it has of their motions may be of long ago.
//
//   rank 0's bodies    rank 1's bodies
//   o o o o o o o o  | n n . . . . . .     rank 0     o   its own
//   . . . . . . n n  | o o o o o o o o     rank 1     n   a neighbour: both are of one pair
//
// All ranks know all pairs, so a body's owner knows who has to hear of it, and when:
//
//   - tell: a body was solved. Its owner tells those who have neighbours of it.
//   - meet: a pair is new, of two ranks' bodies. Each tells the other where its body is, if it has not before.
//   - give: another rank solves the body from now on (rank_islands.h). It gets its motion and its neighbours', and
//     what is known of its pairs.
//   - gather: somebody looks at the universe (ob_peers.look). All ranks get all motions.
//   - share: somebody writes a checkpoint. All ranks get what is known of all pairs.
//
// So it is whole on each rank where a host looks at it, at a pause, and no earlier. Where somebody looks after each
// step, all are told all as it is solved.
//
// Of what a rank has it knows a digest, in memory that simulators do not reach, which is compared when the body is
// solved next; and with it what who tells the motion has had.
//
// Thread-safety: the arranger's.
#ifndef OB_SIM_HALO_H
#define OB_SIM_HALO_H

#include "sim/peers.h"

typedef struct ob_halo ob_halo;

// At the start all ranks have all. NULL: no memory.
ob_halo *ob_halo_create(const ob_universe *u);
void ob_halo_destroy(ob_halo *h); // NULL is allowed
// After a pause, or scripts, by which motions were published that no simulator has found, the same on all ranks: what
// is new gets an owner, where it has none.
void ob_halo_settle(ob_halo *h, ob_universe *u);

// Whether any rank may lack any.
bool ob_halo_is_partial(const ob_halo *h);
void ob_halo_part(ob_halo *h); // from now on

// It will be noted soon.
void ob_halo_prefetch(const ob_halo *h, uint32_t id);

// Who lists the pairs of a body that this rank is to solve sees whether a neighbour is elsewhere, another rank's: then
// nobody need look for those when it is told. NULL is allowed.
bool ob_halo_is_elsewhere(const ob_halo *h, uint32_t id);
void ob_halo_note_border(ob_halo *h, uint32_t id, bool is_at);
// A body of this rank's was solved: to[r] := whether rank r is told its motion; all: everybody is. Returns whether
// somebody who is told may lack what it had before.
bool ob_halo_tell(ob_halo *h, const ob_universe *u, uint32_t id, bool all, bool *to);
// What another rank, or this one, says of a body that was solved: its motion, to be staged.
void ob_halo_note(ob_halo *h, uint32_t id, const ob_motion *staged);
// The next of other ranks' bodies of which a motion was staged, each once. false: that was all.
bool ob_halo_take_heard(ob_halo *h, uint32_t *id);
// What was staged of the body is published.
void ob_halo_note_published(ob_halo *h, const ob_universe *u, uint32_t id);
// The digest of its motion of before the step. false: it is not what it was.
bool ob_halo_digest(const ob_halo *h, const ob_universe *u, uint32_t id, uint64_t *digest);

// By all ranks, when pairs have been added, those of ob_step_data.check; and between two steps. false: the step has
// failed.
bool ob_halo_meet(ob_halo *h, ob_universe *u, ob_peers *p);
bool ob_halo_gather(ob_halo *h, ob_universe *u, ob_peers *p);
// Between two steps, too: until when each pair is known to be apart. A run that goes on from there must know as much,
// for when a pair is looked at again is when it may begin to touch.
bool ob_halo_share_pairs(ob_halo *h, ob_universe *u, ob_peers *p);
// The body lives with that simulator from now on: all ranks hear of it.
void ob_halo_rehome(ob_halo *h, ob_universe *u, uint32_t id, uint32_t simulator);
// It was this rank's: what goes to where it lives now. false: no memory.
bool ob_halo_give(const ob_halo *h, const ob_universe *u, uint32_t id, ob_mail *mail);
// Of that, a parcel from another rank. false: it makes no sense.
bool ob_halo_take(ob_halo *h, ob_universe *u, const char *parcel, const ob_parcel *head);

#endif

// Where what pairs keep between steps is, of several ranks (peers.h): a record's contents are with the rank that solved
// its island last, and nowhere else.
//
//                          rank 0     rank 1     rank 2
//   island A, solved last    x                              on all: that the record is there, and whether they touch
//   island B                            x
//   B is rank 2's now                   x  ------->  x      before it is solved (give)
//   all are wanted           x <------> x <------->  x      for a checkpoint, say (gather)
//
// All ranks know where each object lives (table/home.h), and there is what its pairs keep. Who holds contents keeps
// their digest beside them: in memory that simulators do not reach, so damage is found before it becomes a result.
//
// Thread-safety: the arranger's.
#ifndef OB_SIM_HOLDINGS_H
#define OB_SIM_HOLDINGS_H

#include "sim/peers.h"

typedef struct ob_holdings ob_holdings;

// At the start all ranks have all. NULL: no memory.
ob_holdings *ob_holdings_create(const ob_universe *u);
void ob_holdings_destroy(ob_holdings *h); // NULL is allowed

enum { OB_ALL_RANKS = UINT32_MAX };
// A record has new contents, of the rank whose simulator has found them, or of all. version: where they are here, and
// state: what was written there; -1: they are not.
void ob_holdings_note(ob_holdings *h, const ob_universe *u, uint32_t record, int version, const ob_pair_state *state,
		      uint32_t rank);
// They will be soon, or it will be asked whether they are here.
void ob_holdings_prefetch(const ob_holdings *h, uint32_t record);
// Whether it has them and no other rank does.
bool ob_holdings_here_alone(const ob_holdings *h, const ob_universe *u, uint32_t record);

// The object was this rank's, and lives with another now: what its pairs keep goes there, and this rank lists them no
// longer. false: no memory.
bool ob_holdings_give(ob_holdings *h, const ob_universe *u, uint32_t id, ob_mail *mail);
// Of that, a parcel from another rank: false: it makes no sense.
bool ob_holdings_take(ob_holdings *h, const ob_universe *u, const char *parcel, size_t bytes);
// Between two steps, by all ranks: all of them have all contents. false: the step has failed.
bool ob_holdings_gather(ob_holdings *h, ob_universe *u, ob_peers *p);
// One of the objects of a contact that a simulator of this rank is to solve, and whose contents are no longer what they
// were; OB_NO_OBJECT: none is.
uint32_t ob_holdings_damaged(const ob_holdings *h, const ob_universe *u);

#endif

// Ranks that hold the contents of pairs' records (ob_pair_state) between steps, of several ranks (peers.h): the rank
// that solved a pair's island last, and no other.
//
//                          rank 0     rank 1     rank 2
//   island A, solved last    x                              all know: the record exists, and if the pair touches
//   island B                            x
//   B is rank 2's now                   x  ------->  x      before it is solved (give)
//   all are wanted           x <------> x <------->  x      for a checkpoint, for example (gather)
//
// All ranks know where each object lives (table/home.h); its pairs' contents are there. The holder of contents keeps
// their digest beside them, in memory that simulators do not reach: so damage is found before it becomes a result.
//
// Thread-safety: the arranger alone calls these functions.
#ifndef OB_CLUSTER_HOLDINGS_H
#define OB_CLUSTER_HOLDINGS_H

#include "cluster/peers.h"

typedef struct ob_holdings ob_holdings;

// Creates the holdings; at the start all ranks hold all contents. NULL: no memory.
ob_holdings *ob_holdings_create(const ob_universe *u);
void ob_holdings_destroy(ob_holdings *h); // NULL is allowed

enum { OB_ALL_RANKS = UINT32_MAX };
// Notes new contents of a record, which `rank` holds, or all ranks. version: place of the contents here; state:
// contents written there; version -1: they are not here.
void ob_holdings_note(ob_holdings *h, const ob_universe *u, uint32_t record, int version, const ob_pair_state *state,
		      uint32_t rank);
// Prefetches what ob_holdings_note and ob_holdings_here_alone need.
void ob_holdings_prefetch(const ob_holdings *h, uint32_t record);
// True if this rank alone has the contents.
bool ob_holdings_here_alone(const ob_holdings *h, const ob_universe *u, uint32_t record);

// Packs the contents of the pairs of an object that moved from this rank to another; this rank lists the pairs no
// longer.
void ob_holdings_give(ob_holdings *h, const ob_universe *u, uint32_t id, ob_mail *mail);
// Unpacks a parcel of it from another rank. false: it is malformed.
bool ob_holdings_take(ob_holdings *h, const ob_universe *u, const char *parcel, size_t bytes);
// Exchanges contents, between two steps, by all ranks: then all have all. false: the step has failed.
bool ob_holdings_gather(ob_holdings *h, ob_universe *u, ob_peers *p);
// Returns an object of a contact that a simulator of this rank is to solve and whose contents do not fit their digest;
// OB_NO_OBJECT: there is none.
uint32_t ob_holdings_damaged(const ob_holdings *h, const ob_universe *u);

#endif

// Regions of bodies on several ranks (peers.h): each simulator solves the bodies of its region. So a body's neighbours
// are mostly its own rank's, and few ranks need its motion (halo.h).
//
//   +--------+-----+    recursive bisection (Berger and Bokhari, A partitioning strategy for nonuniform problems on
//   |   0    |  2  |    multiprocessors, 1987): ranks, then the simulators of each, are halved, and so are bodies by
//   |        |     |    position, along the axis of their largest extent, weighted by their recent cost. Bodies that
//   +--------+--+--+    touch, directly or through others, count as one, so no island is cut through.
//   |   1    |3 |      A body that moves on changes its region when it is well beyond the cut.
//   +--------+--+
//
// A region says where each of a rank's bodies is to be solved next. Islands are assigned to ranks accordingly
// (rank_islands.h), and a body's state goes with it then. A cut follows from data that all ranks have: fat AABBs, pairs
// that touch, and, after an exchange, the costs of bodies.
//
// A cut is made at the start. A new one needs two reasons: islands had to go to others than those of their region, for
// balance, and the cost of bodies since the last cut exceeds that of a new one many times.
//
// Thread-safety: the arranger alone calls these functions.
#ifndef OB_CLUSTER_REGIONS_H
#define OB_CLUSTER_REGIONS_H

#include "cluster/peers.h"

typedef struct ob_regions ob_regions;

ob_regions *ob_regions_create(const ob_universe *u); // NULL: no memory
void ob_regions_destroy(ob_regions *r); // NULL is allowed

// Gives new bodies a home, by position, after a pause or scripts that created or removed bodies. true: all have got
// one, the first time.
bool ob_regions_settle(ob_regions *r, ob_universe *u);
// Updates the regions of bodies on the requery list, whose fat AABBs have changed.
void ob_regions_follow(ob_regions *r, const ob_universe *u);
// Cost of this rank's bodies since the last cut; and the part of it that was solved outside the bodies' regions.
typedef struct ob_regions_work {
	uint64_t all, spilled;
} ob_regions_work;
ob_regions_work ob_regions_work_of(const ob_regions *r);
// Cuts anew, if that is worth it; all ranks call it alike, with the sums of all. false: the step has failed.
bool ob_regions_renew(ob_regions *r, ob_universe *u, ob_peers *p, const ob_regions_work *sum);
// Lists this rank's bodies that touch nothing, are in no island of the step, and lie in another rank's region, before
// islands are assigned to ranks.
const uint32_t *ob_regions_find_fliers(ob_regions *r, const ob_universe *u, uint32_t *count);
// Adds work that goes to another rank for balance alone.
void ob_regions_spill(ob_regions *r, uint64_t work);
// Notes that the body has come from another rank, and lives here now.
void ob_regions_take(ob_regions *r, uint32_t id, uint32_t simulator);

// Returns the simulator of the body's region.
uint32_t ob_regions_at(const ob_regions *r, uint32_t id);
// Notes that the simulator gets the body, until that moves on, at this work. spilled: it is not the simulator of the
// body's region. NULL is allowed.
void ob_regions_note(ob_regions *r, uint32_t id, uint32_t simulator, uint32_t work, bool spilled);

#endif

// Where bodies live, of several ranks (peers.h): each simulator has a region, and solves what is in it, so that what is
// near a body is mostly its own rank's, and few ranks need know where it is (halo.h).
//
//   +--------+-----+    recursive bisection (Berger and Bokhari, A partitioning strategy for nonuniform problems on
//   |   0    |  2  |    multiprocessors, 1987): ranks, then the simulators of each, are halved, and so are bodies,
//   where |        |     |    they lie, along the axis in which they lie farthest apart, by what they have cost lately.
//   +--------+--+--+    Bodies that touch, directly or through others, count as one, so no island is cut through.
//   |   1    |3 |      A body that moves on changes its region when it is well beyond the cut.
//   +--------+--+
//
// It says where each of a rank's bodies is to be solved next; islands are given to ranks accordingly (rank_islands.h),
// and what is known of a body goes with it then. A cut follows from what all ranks know: fat AABBs, which pairs touch,
// and, when they have told each other, what bodies have cost.
//
// A cut is made at the start; and again when what bodies have cost since makes up for it many times over, if
// islands have had to be given to others than those whose region they are in, for the one had too much to do.
//
// Thread-safety: the arranger's.
#ifndef OB_SIM_REGIONS_H
#define OB_SIM_REGIONS_H

#include "sim/peers.h"

typedef struct ob_regions ob_regions;

ob_regions *ob_regions_create(const ob_universe *u); // NULL: no memory
void ob_regions_destroy(ob_regions *r); // NULL is allowed

// After a pause, or scripts, by which bodies have come or gone: what is new gets a home, where it lives. true: all have
// got one, for it was the first time.
bool ob_regions_settle(ob_regions *r, ob_universe *u);
// Fat AABBs have changed: those on the requery list.
void ob_regions_follow(ob_regions *r, const ob_universe *u);
// What this rank's bodies have cost since the last cut; and of it, those that were given to others than those of the
// region.
typedef struct ob_regions_work {
	uint64_t all, spilled;
} ob_regions_work;
ob_regions_work ob_regions_work_of(const ob_regions *r);
// By all ranks alike, with the sums of all: cuts anew, if that is worth it. false: the step has failed.
bool ob_regions_renew(ob_regions *r, ob_universe *u, ob_peers *p, const ob_regions_work *sum);
// Before the islands of a step are given to ranks: bodies of this one's that touch nothing, and are in none of them,
// but in another rank's region.
const uint32_t *ob_regions_find_fliers(ob_regions *r, const ob_universe *u, uint32_t *count);
// So much work goes to another rank for balance alone.
void ob_regions_spill(ob_regions *r, uint64_t work);
// The body has come from another rank, and lives here now.
void ob_regions_take(ob_regions *r, uint32_t id, uint32_t simulator);

// The simulator whose region the body is in.
uint32_t ob_regions_at(const ob_regions *r, uint32_t id);
// The body was given to it, and will stay there until it moves on; at so much work. spilled: to another than was asked
// for.
void ob_regions_note(ob_regions *r, uint32_t id, uint32_t simulator, uint32_t work, bool spilled);

#endif

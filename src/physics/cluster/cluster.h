// The part of a step that concerns the other ranks, for the arranger of one of several (peers.h). NULL stands for a
// single rank: each function does what is right there, mostly nothing. So the step does not ask how many ranks there
// are.
//
//   settle ──> (queries) ──> follow ──> (merge pairs) ──> meet ──> begin ──> end_contacts ──> (find due bodies)
//     ──> involve_links ──> (link bodies) ──> share_islands ──> (list, deal, solve, commit) ──> gather
//
// Thread-safety: the arranger alone calls these functions. false, unless stated otherwise: the step has failed.
#ifndef OB_CLUSTER_CLUSTER_H
#define OB_CLUSTER_CLUSTER_H

#include "cluster/rank_islands.h"

typedef struct ob_cluster {
	ob_peers peers;
	ob_rank_parts parts;
	ob_rank_islands *islands;
	// Pairs, by their index. parted: reported separated by simulators of other ranks; checked: checked by them.
	// links_across: have linked two ranks' bodies since islands were built; linked: those of them that still do.
	// The last two are the same on all ranks.
	ob_mail parted, checked, links_across, linked;
	ob_mail links; // ob_rank_link: the linked ones, and joints of two ranks' bodies
} ob_cluster;

// Appends a pair to one of these lists. Without memory the step fails.
void ob_cluster_note(ob_universe *u, ob_mail *list, uint32_t pair);

// Creates what several ranks need. *c: NULL on a single rank. false: no memory.
bool ob_cluster_create(const ob_universe *u, ob_cluster **c);
void ob_cluster_destroy(ob_cluster *c);

static inline ob_halo *ob_cluster_halo(const ob_cluster *c)
{
	return c ? c->parts.halo : NULL;
}

static inline ob_regions *ob_cluster_regions(const ob_cluster *c)
{
	return c ? c->parts.regions : NULL;
}

// Gives new bodies regions and owners, after a pause or scripts.
void ob_cluster_settle(ob_cluster *c, ob_universe *u);
// Updates the regions of bodies whose fat AABBs have changed, before pairs are merged.
void ob_cluster_follow(ob_cluster *c, ob_universe *u);
// Exchanges motions of bodies that have become neighbours, when pairs have been merged.
bool ob_cluster_meet(ob_cluster *c, ob_universe *u);
// True if some rank has an object to solve in this step, or a pair to check before it.
bool ob_cluster_is_due(const ob_cluster *c, const ob_universe *u);
// True if this rank has the motions of all bodies.
bool ob_cluster_is_whole(const ob_cluster *c);
// Returns the requested move of an object, as table/home.h, before islands are built. Rank 0 receives requests and
// sends them to the others.
uint64_t ob_cluster_begin(ob_cluster *c, ob_universe *u);
// Ends contacts of other ranks' islands of the step before.
void ob_cluster_end_contacts(ob_cluster *c, ob_universe *u);
// Puts this rank's bodies that are linked to other ranks' into islands, before islands are linked.
void ob_cluster_involve_links(ob_cluster *c, ob_universe *u);
// Shares the islands among ranks before their members are listed; then each rank has those that it must solve.
// elsewhere: set to true if another rank may have any.
bool ob_cluster_share_islands(ob_cluster *c, ob_universe *u, bool *elsewhere);
// Takes the next pair that simulators of other ranks have checked; each report once. false: none left.
bool ob_cluster_take_checked(ob_cluster *c, uint32_t *pair);
// Number of islands on all ranks, when those of a step are solved.
uint32_t ob_cluster_islands(const ob_cluster *c, const ob_universe *u);
// Gathers the universe on all ranks, between two steps, as far as a reader or a checkpoint needs it.
bool ob_cluster_gather(ob_cluster *c, ob_universe *u);

#endif

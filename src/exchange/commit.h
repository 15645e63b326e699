// Commit of the results that contained simulators hand over (results.h). When all have arrived, the arranger checks each
// record, and writes it:
//
//   - it belongs to this phase, and to an object, island or pair that this simulator was given;
//   - no object's result comes twice, and none is missing;
//   - ids and indices are in their ranges, numbers are finite, what is counted is not more than there can be.
//
// A simulator that hands over anything else is to blame (ob_step_blame): nothing of the phase is used, and all
// simulators are restarted from the checkpoint. These checks cannot detect a miscalculated result that is within the
// bounds.
#ifndef OB_EXCHANGE_COMMIT_H
#define OB_EXCHANGE_COMMIT_H

#include "cluster/halo.h"
#include "cluster/peers.h"
#include "table/outbox.h"

typedef struct ob_committer ob_committer;
ob_committer *ob_committer_create(const ob_universe *u); // NULL: no memory
void ob_committer_destroy(ob_committer *c);
// Waits until all local simulators have arrived, and collects their records. Returns false on STOP.
bool ob_commit_collect(ob_committer *c, ob_universe *u, ob_phase phase);
// Checks the collected records of all ranks that take part in the phase, and writes them.
void ob_commit_mail(ob_committer *c, ob_universe *u, ob_phase phase);

// ---- by the arranger of one of several ranks. false: the step has failed, unless stated otherwise

// Take the next pair that simulators of other ranks reported separated, or have checked; each report once. false: none
// left.
bool ob_commit_take_parted(ob_committer *c, uint32_t *pair);
bool ob_commit_take_checked(ob_committer *c, uint32_t *pair);
// Finds pairs that are expected to touch and link two ranks' bodies, after bodies got their homes. All ranks know these
// pairs from a checkpoint.
void ob_commit_find_links_across(ob_committer *c, ob_universe *u);
// Puts this rank's bodies that are linked to other ranks' into islands, before islands are linked.
void ob_commit_involve_links_across(ob_committer *c, ob_universe *u);
// Shares the islands among ranks before their members are listed; then each rank has those that it must solve. islands:
// as in rank_islands.h.
bool ob_commit_share_islands(ob_committer *c, ob_universe *u, ob_peers *p, bool *islands);
// Adds the records of the other ranks' simulators to those collected here. digest: ob_peers_digest.
bool ob_commit_exchange(ob_committer *c, ob_universe *u, ob_peers *p, ob_phase phase, uint64_t digest);
// Returns the halo: the motions that this rank has. NULL with a single rank.
ob_halo *ob_commit_halo(const ob_committer *c);
// Returns the regions of the ranks, in which bodies lie. NULL with a single rank.
struct ob_regions *ob_commit_regions(const ob_committer *c);
// Gathers the kept states and the checks of all pairs on all ranks, between two steps, for a checkpoint.
bool ob_commit_share(ob_committer *c, ob_universe *u, ob_peers *p);

#endif

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

#include "cluster/cluster.h"
#include "table/outbox.h"

typedef struct ob_committer ob_committer;
// cluster: NULL on a single rank. Returns NULL if there is no memory.
ob_committer *ob_committer_create(const ob_universe *u, ob_cluster *cluster);
void ob_committer_destroy(ob_committer *c);
// Commits a phase: waits until all local simulators have arrived, collects their records, adds those of the other ranks'
// simulators, checks them all and writes them. false: STOP.
bool ob_commit(ob_committer *c, ob_universe *u, ob_phase phase);

#endif

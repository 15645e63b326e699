// One universe on several ranks: each has the whole of it and the same number of simulators, solves its share of each
// phase, and commits what the simulators of all ranks have handed over, in the order of ranks. So each comes to the
// same universe, and to that of one rank with as many simulators.
//
//   arranger, at the end of a phase:  outboxes of its own simulators -> mail -> all ranks' mail -> commit
//
// With its mail each rank sends where it stands: step, phase, and a digest of what the phase began with. Where two
// differ, all find out about which object, and the run ends. An arranger whose run is over, for whatever reason, says
// so in place of a mail, so nobody waits for it.
#ifndef OB_SIM_PEERS_H
#define OB_SIM_PEERS_H

#include "sim/sim.h"
#include "table/outbox.h"

// What the phase begins with, before any of it is committed: who is to be solved, from which motions and contacts, or
// asked.
uint64_t ob_peers_digest(const ob_universe *u, ob_phase phase);
// Replaces the mail of this rank's simulators by that of all. false: the others are elsewhere, or one has left, and the
// step has failed.
bool ob_peers_exchange(ob_peers *p, ob_universe *u, ob_phase phase, uint64_t digest, ob_mail *mail);
bool ob_peers_join(ob_peers *p, const ob_universe *u, ob_error *e);
void ob_peers_leave(ob_peers *p);

#endif

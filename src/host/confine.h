// What a hardened run takes from its simulators' processes, once each is ready for the gate:
//
//   - the universe: mapped read-only, but for its own outbox (table/outbox.h). Not from the arranger, who writes it;
//   - root: where the host is root, its simulators are nobody; all capabilities are dropped, and none can come back
//     (no_new_privs);
//   - resources: no core file, no process or thread, no file beside standard error, half of the machine's memory;
//   - system calls: all but those by which a simulator waits, asks for the time or for memory, and ends (seccomp).
//
// What does something else is ended by the kernel: SIGSEGV for a store, SIGSYS for a system call. All are then
// restarted from the checkpoint, as after any death (restart.h).
#ifndef OB_HOST_CONFINE_H
#define OB_HOST_CONFINE_H

#include "table/table.h"

// The calling process for good. read_only: the universe, too. false and e: something cannot be taken from it.
bool ob_confine(ob_universe *u, uint32_t worker, bool read_only, ob_error *e);

#endif

// What a hardened run takes from its simulators' processes, once each is ready for the gate, by its
// measures (ob_harden_measure):
//
//   outbox      the right to write results in place: they are handed over (table/outbox.h). Not from the arranger
//   checksum    .. with a checksum, so that stores to where they lie are noticed
//   pages       the universe: mapped read-only, but for its own outbox. Not from the arranger, who writes it
//   privileges  root: where the host is root, its simulators are nobody; all capabilities are dropped, and none can come
//               back (no_new_privs)
//   limits      resources: no core file, no process or thread, no file beside standard error, half of the machine's memory
//   calls       system calls: all but those by which a simulator waits, asks for the time or for memory, and ends (seccomp,
//               which takes no_new_privs with it)
//
// Checksum and pages need the outbox; the others stand alone.
// What does something else is ended by the kernel: SIGSEGV for a store, SIGSYS for a system call. All are then
// restarted from the checkpoint, as after any death (restart.h).
#ifndef OB_HOST_CONFINE_H
#define OB_HOST_CONFINE_H

#include "table/table.h"

// The calling process, for good. false and e: something cannot be taken from it.
bool ob_confine(ob_universe *u, uint32_t worker, ob_error *e);

#endif

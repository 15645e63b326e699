// Restrictions of a hardened run on its simulators' processes, by measure (ob_harden_measure). They apply once a
// process is ready for the gate:
//
//   outbox      no right to write results in place: they pass through an outbox (table/outbox.h); not for the arranger
//   checksum    a checksum with each result, so that stray stores to its memory are detected
//   pages       the universe is mapped read-only, except the process's own outbox; the arranger may write it all
//   privileges  root: under a root host, its simulators run as user nobody; all capabilities are dropped for good
//               (no_new_privs)
//   limits      resources: no core file, no process or thread, no file beside standard error, half of the machine's
//               memory
//   calls       system calls: only those for waiting, time, memory and the end of the process (seccomp, which sets
//               no_new_privs)
//
// Checksum and pages need the outbox; the others stand alone. The kernel ends a process that breaks a rule: SIGSEGV for
// a store, SIGSYS for a system call. All workers are then restarted from the checkpoint, as after any death
// (restart.h).
#ifndef OB_HOST_CONFINE_H
#define OB_HOST_CONFINE_H

#include "table/table.h"

// A process with foreign code, an FMU, is restricted in every run: it starts no process, sends signals to itself alone, and has
// half of the machine's memory. The measures of a hardened run come in addition: privileges before its library is loaded, the
// others after that.

enum { OB_CALL_FD = 3 }; // a worker calls for such a process by it (table/desk.h)

// Restricts the calling process for good. false and e: a restriction cannot be set. Likewise the others, of foreign code,
// before and after its library is loaded.
bool ob_confine_foreign(const ob_universe *u, ob_error *e);
bool ob_confine_loaded(const ob_universe *u, ob_error *e);
bool ob_confine(ob_universe *u, uint32_t worker, ob_error *e);

#endif

// Ctrl-C and its kin (SIGINT, SIGTERM, SIGHUP). The first requests a clean end and removes the handler, so a second one
// kills (a host's fork server then cleans up). A signal that the process ignores stays ignored (nohup, background).
// Called by the thread that starts and stops hosts; ob_interrupt_came alone is thread-safe.
#ifndef OB_BASE_INTERRUPT_H
#define OB_BASE_INTERRUPT_H

#include <signal.h>
#include <stdbool.h>

// Installs the handlers. Returns a file descriptor that becomes readable with the first signal and stays so; -1 on
// failure. May be nested.
int ob_interrupt_watch(void);
// Restores the handlers that were installed before the first watch.
void ob_interrupt_release(void);
// True if a signal has come since the first watch: long operations poll it to end early. Any thread.
bool ob_interrupt_came(void);
// Blocks all signals in the calling thread, and so in threads that it starts, except those raised by the thread's own
// faults. If these were blocked, they would end the process silently. before: the mask to restore. Any thread.
void ob_interrupt_leave_to_main(sigset_t *before);

#endif

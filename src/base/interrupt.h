// Ctrl-C and its kin (SIGINT, SIGTERM, SIGHUP): the first asks for a clean end, a second one kills, for the handler
// is removed by the first signal (a host's fork server then cleans up). A signal that the process ignores stays ignored
// (nohup, background). Not thread-safe, but for ob_interrupt_came: called by the thread that starts and stops hosts.
#ifndef OB_BASE_INTERRUPT_H
#define OB_BASE_INTERRUPT_H

#include <signal.h>
#include <stdbool.h>

// Installs the handlers; returns a file descriptor that becomes, and stays, readable with the first signal. -1 on
// failure. May be nested.
int ob_interrupt_watch(void);
// Puts back what stood before the first watch.
void ob_interrupt_release(void);
// Whether a signal has come since the first watch: for what may take long, so that it ends. Any thread.
bool ob_interrupt_came(void);
// Blocks, in the calling thread and so in those that it starts, all signals but those that a fault of the thread itself
// raises: blocked, these would end the process without a word. before: the mask to put back. Any thread.
void ob_interrupt_leave_to_main(sigset_t *before);

#endif

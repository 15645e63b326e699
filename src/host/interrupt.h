// Ctrl-C and its kin (SIGINT, SIGTERM, SIGHUP): the first asks for a clean end, a second one kills, for the handler
// is removed by the first signal (the fork server then cleans up). A signal that the process ignores stays ignored (nohup, background).
// Not thread-safe: called by the thread that starts and stops hosts.
#ifndef OB_HOST_INTERRUPT_H
#define OB_HOST_INTERRUPT_H

// Installs the handlers; returns a file descriptor that becomes, and stays, readable with the first signal. -1 on
// failure. May be nested.
int ob_interrupt_watch(void);
// Puts back what stood before the first watch.
void ob_interrupt_release(void);

#endif

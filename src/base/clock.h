// Clocks, in seconds as double and nanoseconds as uint64_t.
#ifndef OB_BASE_CLOCK_H
#define OB_BASE_CLOCK_H

#include <stdint.h>
#include <sys/types.h>

double ob_clock_wall(void); // s, monotonic
uint64_t ob_clock_ns(void); // the same clock, ns
double ob_clock_thread_cpu(void); // s, CPU of the calling thread
double ob_clock_process_cpu(void);
// ns of CPU used by thread tid / process pid of this machine; 0 when it is gone
uint64_t ob_clock_cpu_of_thread(pid_t tid);
uint64_t ob_clock_cpu_of_process(pid_t pid);

// The hang clock: how long a wait has lasted, of the time in which this process ran. Where it stood still between two
// calls of tick, because it was stopped (Ctrl-Z) or the machine was suspended, only as much counts as lies between
// calls at their usual pace, a fifth of a second. So tick must be called more often than that while one waits.
typedef struct ob_hang_clock {
	double seen, waited; // s
} ob_hang_clock;

ob_hang_clock ob_hang_clock_start(void);
// Seconds waited so far.
double ob_hang_clock_tick(ob_hang_clock *c);

#endif

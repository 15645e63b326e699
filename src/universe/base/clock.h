// Clocks, in seconds as double and nanoseconds as uint64_t.
#ifndef OB_BASE_CLOCK_H
#define OB_BASE_CLOCK_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

double ob_clock_wall(void); // s, monotonic
uint64_t ob_clock_ns(void); // the same clock, ns
double ob_clock_thread_cpu(void); // s, CPU of the calling thread
double ob_clock_process_cpu(void);
// CPU time (ns) of thread tid / process pid of this machine; 0 if it has ended
uint64_t ob_clock_cpu_of_thread(pid_t tid);
uint64_t ob_clock_cpu_of_process(pid_t pid);

// Hang clock: duration of a wait, in time in which this process ran. A pause between two calls of tick (Ctrl-Z, machine
// suspended) counts as a fifth of a second at most, the longest usual pace of calls. Call tick more often than that
// while waiting.
typedef struct ob_hang_clock {
	double seen, waited; // s
} ob_hang_clock;

ob_hang_clock ob_hang_clock_start(void);
// Returns the seconds waited so far.
double ob_hang_clock_tick(ob_hang_clock *c);

// Time that counts as a hang of code that makes no progress: its CPU time while it computes, and wall time while it neither
// computes nor waits for a core. On a tenth of a core it gets ten times the patience, but no more.
typedef struct ob_hang_count {
	ob_hang_clock clock;
	double looked, counted; // s: clock at the last look; counted so far
	uint64_t cpu_ns; // CPU time at the last look; 0 = unknown
} ob_hang_count;

ob_hang_count ob_hang_count_start(uint64_t cpu_ns);
// Call it about ten times a second. denied: the code waits for a core. true: patience (s) is over.
bool ob_hang_count_is_over(ob_hang_count *c, uint64_t cpu_ns, bool denied, double patience);

#endif

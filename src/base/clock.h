// Clocks, in seconds as double and nanoseconds as uint64_t.
#ifndef OB_BASE_CLOCK_H
#define OB_BASE_CLOCK_H

#include <stdint.h>
#include <sys/types.h>

double ob_clock_wall(void);       // s, monotonic
uint64_t ob_clock_ns(void);        // the same clock, ns
double ob_clock_thread_cpu(void); // s, CPU of the calling thread
double ob_clock_process_cpu(void);
// ns of CPU used by thread tid / process pid of this machine; 0 when it is gone
uint64_t ob_clock_cpu_of_thread(pid_t tid);
uint64_t ob_clock_cpu_of_process(pid_t pid);

#endif

// How often the kernel has taken a task off its core: of its own accord (it slept), and against its will.
#ifndef OB_HOST_SWITCHES_H
#define OB_HOST_SWITCHES_H

#include <stdint.h>
#include <sys/types.h>

// Both together, of thread tid of process pid; 0 when it is gone.
uint64_t ob_switches_of_task(pid_t pid, pid_t tid);

#endif

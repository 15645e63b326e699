// Memory that processes occupy, as the kernel counts it.
#ifndef OB_HOST_MEMORY_H
#define OB_HOST_MEMORY_H

#include <stddef.h>
#include <sys/types.h>

// Bytes: proportional share (PSS) of a process's private and file-backed pages, without shared memory segments.
// 0 when the process is gone.
size_t ob_memory_of_process(pid_t pid);
// Bytes of the universe's segment that have been touched by anyone.
size_t ob_memory_of_universe(const char *name);

#endif

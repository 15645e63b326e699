// Resource use of processes and threads, from the kernel's /proc: memory and context switches.
#ifndef OB_HOST_ACCOUNTING_H
#define OB_HOST_ACCOUNTING_H

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

// Bytes: proportional share (PSS) of a process's private and file-backed pages, without shared memory segments.
// 0 when the process is gone.
size_t ob_memory_of_process(pid_t pid);
// Bytes of the universe's segment that any process has touched.
size_t ob_memory_of_universe(const char *name);
// Context switches of thread tid of process pid, voluntary and involuntary ones together; 0 when it is gone.
uint64_t ob_switches_of_thread(pid_t pid, pid_t tid);
// The kernel's letter for the state of that thread (proc(5), stat); 0 when it is gone.
char ob_state_of_thread(pid_t pid, pid_t tid);
// Returns the meaning of such a letter: "stopped by a signal", say.
const char *ob_state_word(char state);

#endif

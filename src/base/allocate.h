// Memory that the caller cannot do without: these functions return only with it.
//
// A simulator needs memory in the middle of a step, at a point of no return. The code that runs the simulator chooses
// the reaction for its own thread (ob_allocate_or_else): a worker leaves its step and ends. By default, the program
// ends with a line on standard error and exit code 1.
//
// Thread-safety: any thread; ob_allocate_or_else concerns the calling one.
#ifndef OB_BASE_ALLOCATE_H
#define OB_BASE_ALLOCATE_H

#include <stddef.h>

void *ob_allocate(size_t bytes) __attribute__((malloc, warn_unused_result));
void *ob_allocate_zeroed(size_t bytes) __attribute__((malloc, warn_unused_result));
// alignment: a power of two.
void *ob_allocate_aligned(size_t alignment, size_t bytes) __attribute__((malloc, warn_unused_result));
// Like realloc; keeps old unchanged if memory runs out.
void *ob_reallocate(void *old, size_t bytes) __attribute__((warn_unused_result));

// Calls leave in this thread instead, from now on; leave must not return. NULL: back to the default.
void ob_allocate_or_else(void (*leave)(void));

#endif

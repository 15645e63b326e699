// Memory without which the caller cannot go on: these functions do not return without it.
//
// A simulator needs more memory in the middle of a step, where nothing can be taken back. What then happens is for
// whoever runs it to say (ob_allocate_or_else), for a thread of its own: a worker leaves its step and ends. Unless told
// otherwise, the program ends with a line on standard error and exit code 1.
//
// Thread-safety: any thread; ob_allocate_or_else is of the calling one.
#ifndef OB_BASE_ALLOCATE_H
#define OB_BASE_ALLOCATE_H

#include <stddef.h>

void *ob_allocate(size_t bytes) __attribute__((malloc, warn_unused_result));
void *ob_allocate_zeroed(size_t bytes) __attribute__((malloc, warn_unused_result));
// alignment: a power of two.
void *ob_allocate_aligned(size_t alignment, size_t bytes) __attribute__((malloc, warn_unused_result));
// As realloc; old stays as it was where there is no memory.
void *ob_reallocate(void *old, size_t bytes) __attribute__((warn_unused_result));

// From now on leave is called in this thread instead, and must not return. NULL: as at first.
void ob_allocate_or_else(void (*leave)(void));

#endif

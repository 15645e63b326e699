// Memory that the caller cannot do without: these functions return only with it.
//
// A simulator needs memory in the middle of a step, at a point of no return. The code that runs the simulator chooses
// the reaction for its own thread (ob_allocate_or_else): a worker leaves its step and ends. By default, the program
// ends with a line on standard error and exit code 1.
//
// Thread-safety: any thread; ob_allocate_or_else concerns the calling one.
#ifndef OB_BASE_ALLOCATE_H
#define OB_BASE_ALLOCATE_H

#include <stdbool.h>
#include <stddef.h>

void *ob_allocate(size_t bytes) __attribute__((malloc, warn_unused_result));
void *ob_allocate_zeroed(size_t bytes) __attribute__((malloc, warn_unused_result));
// alignment: a power of two.
void *ob_allocate_aligned(size_t alignment, size_t bytes) __attribute__((malloc, warn_unused_result));
// Like realloc; keeps old unchanged if memory runs out.
void *ob_reallocate(void *old, size_t bytes) __attribute__((warn_unused_result));

// Grows an array to so many elements; those from a number on are cleared. Memory may run out: then the array stays as it is,
// and false returns.
#define OB_GROW(array, count) ob_grow(&(array), count, count, sizeof *(array))
#define OB_GROW_CLEARED(array, from, count) ob_grow(&(array), from, count, sizeof *(array))
bool ob_grow(void *array, size_t from, size_t count, size_t size);
// Makes room for so many elements: beyond "max", of any integer type, the array grows to half as many again, 64 at least.
#define OB_RESERVE(array, needed, max) \
	__extension__({ \
		size_t most_ = (max); \
		const bool fine_ = ob_reserve(&(array), needed, &most_, sizeof *(array)); \
		(max) = (__typeof__(max))most_; \
		fine_; \
	})
bool ob_reserve(void *array, size_t needed, size_t *max, size_t size);
// Makes room for one more element than "count".
#define OB_MAKE_ROOM(array, count, max) OB_RESERVE(array, (count) + 1, max)

// Calls leave in this thread instead, from now on; leave must not return. NULL: back to the default.
void ob_allocate_or_else(void (*leave)(void));

#endif

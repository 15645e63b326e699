#include "base/allocate.h"

#include <stdlib.h>
#include <string.h>

#include "base/log.h"

static _Thread_local void (*on_failure)(void);

static void *check(void *p, size_t bytes)
{
	if (p || bytes == 0)
		return p;
	if (on_failure)
		on_failure();
	ob_log_error("out of memory: %zu bytes are not to be had", bytes);
	exit(EXIT_FAILURE);
}

void *ob_allocate(size_t bytes)
{
	return check(malloc(bytes), bytes);
}

void *ob_allocate_zeroed(size_t bytes)
{
	return check(calloc(1, bytes), bytes);
}

void *ob_allocate_aligned(size_t alignment, size_t bytes)
{
	return check(aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment), bytes);
}

void *ob_reallocate(void *old, size_t bytes)
{
	return check(realloc(old, bytes), bytes);
}

// array: the address of the pointer, of any type.
bool ob_grow(void *array, size_t from, size_t count, size_t size)
{
	char *at;
	memcpy(&at, array, sizeof at);
	at = reallocarray(at, count, size);
	if (!at)
		return false;
	memset(at + from * size, 0, (count - from) * size);
	memcpy(array, &at, sizeof at);
	return true;
}

bool ob_reserve(void *array, size_t needed, size_t *max, size_t size)
{
	const size_t least = 64, more = needed + needed / 2 > least ? needed + needed / 2 : least;
	if (needed <= *max)
		return true;
	if (!ob_grow(array, more, more, size))
		return false;
	*max = more;
	return true;
}

void ob_allocate_or_else(void (*leave)(void))
{
	on_failure = leave;
}

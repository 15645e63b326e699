// The gate in slow motion: before every read-modify-write of an atomic word and every system call a worker may be
// delayed, as if it were preempted just there, so that rare interleavings happen many times in a test.
#include <stdint.h>
#include <sys/syscall.h>
#include <unistd.h>

static void delay(void)
{
	static _Thread_local uint64_t random;
	random = (random ? random : (uint64_t)gettid()) * UINT64_C(6364136223846793005) + 1;
	if (random >> 62 == 0)
		usleep((useconds_t)(random >> 53 & 511));
}

#define __atomic_fetch_add(...) (delay(), __atomic_fetch_add(__VA_ARGS__))
#define __atomic_fetch_and(...) (delay(), __atomic_fetch_and(__VA_ARGS__))
#define __atomic_fetch_or(...) (delay(), __atomic_fetch_or(__VA_ARGS__))
#define syscall(...) (delay(), syscall(__VA_ARGS__))

#include "table/gate.c"

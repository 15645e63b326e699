// The gate in slow motion: before every exchange of an atomic word and every call of the kernel a worker may dawdle,
// as if it were preempted just there, so that what takes a rare moment happens many times in a test.
#include <stdint.h>
#include <sys/syscall.h>
#include <unistd.h>

static void dawdle(void)
{
	static _Thread_local uint64_t random;
	random = (random ? random : (uint64_t)gettid()) * UINT64_C(6364136223846793005) + 1;
	if (random >> 62 == 0)
		usleep((useconds_t)(random >> 53 & 511));
}

#define __atomic_fetch_add(...) (dawdle(), __atomic_fetch_add(__VA_ARGS__))
#define __atomic_fetch_and(...) (dawdle(), __atomic_fetch_and(__VA_ARGS__))
#define __atomic_fetch_or(...) (dawdle(), __atomic_fetch_or(__VA_ARGS__))
#define syscall(...) (dawdle(), syscall(__VA_ARGS__))

#include "table/gate.c"

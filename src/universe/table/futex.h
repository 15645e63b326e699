// Futexes on words in shared memory. Waiting and waking also work where the word is mapped read-only.
#ifndef OB_TABLE_FUTEX_H
#define OB_TABLE_FUTEX_H

#include <limits.h>
#include <linux/futex.h>
#include <stdint.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

// Never FUTEX_PRIVATE_FLAG: the words lie in shared memory. bits: selects waiters of the word.
static inline void ob_futex_wait(const uint32_t *word, uint32_t seen, uint32_t bits, const struct timespec *until)
{
	syscall(SYS_futex, word, FUTEX_WAIT_BITSET, seen, until, NULL, bits);
}

static inline void ob_futex_wait_for(const uint32_t *word, uint32_t seen, const struct timespec *t)
{
	syscall(SYS_futex, word, FUTEX_WAIT, seen, t, NULL, 0);
}

static inline void ob_futex_wait_ms(const uint32_t *word, uint32_t seen, int ms)
{
	const struct timespec t = { .tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000L };
	ob_futex_wait_for(word, seen, &t);
}

static inline void ob_futex_wake(const uint32_t *word, uint32_t bits)
{
	syscall(SYS_futex, word, FUTEX_WAKE_BITSET, INT_MAX, NULL, NULL, bits);
}

#endif

// Work that does nothing but take time: what a costlier test would add.
#ifndef OB_BASE_BURDEN_H
#define OB_BASE_BURDEN_H

#include <stdint.h>

// Adds up the whole numbers from 1 to n, one after the other, however clever the compiler is.
static inline void ob_burden(uint32_t n)
{
	uint64_t sum = 0;
	for (uint64_t i = 1; i <= n; i++) {
		sum += i;
		__asm__ volatile("" : "+r"(sum)); // "sum" has to stand in a register each time round
	}
}

#endif

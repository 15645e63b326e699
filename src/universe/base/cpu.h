// Cores: number that this process may use, pinning of the calling thread to one, and a synthetic load.
#ifndef OB_BASE_CPU_H
#define OB_BASE_CPU_H

#include <stdint.h>

int ob_cpu_count(void); // >= 1, by the affinity mask
// Pins the calling thread to the (index mod count)-th allowed core; returns the core, -1 on failure.
int ob_cpu_pin(unsigned index);

// Takes time and does nothing else, as a costlier test would: adds the whole numbers from 1 to n one by one.
static inline void ob_synthetic_load(uint32_t n)
{
	uint64_t sum = 0;
	for (uint64_t i = 1; i <= n; i++) {
		sum += i;
		__asm__ volatile("" : "+r"(sum)); // keeps the compiler from replacing the loop by the sum
	}
}

#endif

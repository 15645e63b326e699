// Cores: how many this process may use, and pinning the calling thread to one.
#ifndef OB_BASE_CPU_H
#define OB_BASE_CPU_H

int ob_cpu_count(void);          // >= 1, by the affinity mask
// Pins the calling thread to the (index mod count)-th allowed core; returns the core, -1 on failure.
int ob_cpu_pin(unsigned index);

#endif

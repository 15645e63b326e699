// When a step does not end: who keeps it from ending.
#ifndef OB_HOST_STALL_H
#define OB_HOST_STALL_H

#include <stddef.h>

#include "host/host.h"

// "simulator 3 (task 4242, stopped by a signal), simulator 5 (task 4244, computing)": those that the gate still waits
// for or, where it waits for none, who arranges; as far as they find room in text. Takes a tenth of a second, to see
// who computes.
void ob_stall_describe(const ob_host *h, char *text, size_t size);

#endif

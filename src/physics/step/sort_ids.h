// Sorts ids, as the scheduling worker lists them: a radix sort with as many digits as the ids have.
#ifndef OB_STEP_SORT_IDS_H
#define OB_STEP_SORT_IDS_H

#include <stdint.h>

// Sorts n ids, all below "end", ascending. other: scratch, n ids.
void ob_sort_ids(uint32_t *id, uint32_t n, uint32_t end, uint32_t *other);

#endif

// What is watched where bodies fall and come to rest: how deep they ever are in each other, and in the last second, and
// whether energy grows. It fails where something falls through the ground, or nothing falls. The figures of such cases
// stand in this order.
#ifndef OB_LAB_HEAP_H
#define OB_LAB_HEAP_H

#include "lab/case.h"

// mm, mm, mm; the last: largest rise of the energy from its lowest so far, over that at the start.
enum { OB_HEAP_RESTING_MEAN, OB_HEAP_RESTING_WORST, OB_HEAP_WORST, OB_HEAP_GROWTH, OB_HEAP_FIGURES };

void ob_heap_observe(ob_case_run_state *t); // at each frame
void ob_heap_judge(ob_case_run_state *t); // after the last

#endif

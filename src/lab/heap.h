// Figures of bodies that fall and come to rest: maximum penetration, penetration in the last second, and growth of
// energy. It fails if a body falls through the ground, or none falls. Figures of such cases have this order.
#ifndef OB_LAB_HEAP_H
#define OB_LAB_HEAP_H

#include "lab/case.h"

// mm, mm, mm; the last: largest rise of the energy from its lowest so far, over the initial energy.
enum { OB_HEAP_RESTING_MEAN, OB_HEAP_RESTING_WORST, OB_HEAP_WORST, OB_HEAP_GROWTH, OB_HEAP_FIGURES };

void ob_heap_observe(ob_case_run_state *t); // at each frame
void ob_heap_judge(ob_case_run_state *t); // after the last

#endif

// The experiment's environment: a ground, and boxes of different sizes that fall onto it in columns of four.
#ifndef OB_PAPER_BOXES_H
#define OB_PAPER_BOXES_H

#include "scene/scene.h"

// false: no memory. The same seed gives the same boxes. What is in it must not outlive it; finish it.
bool ob_paper_boxes(ob_scene *s, uint32_t boxes, uint64_t seed);
void ob_paper_boxes_finish(ob_scene *s);

#endif

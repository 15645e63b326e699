// Environment of the experiment: a ground, and boxes of different sizes that fall onto it in columns of four.
#ifndef OB_PAPER_BOXES_H
#define OB_PAPER_BOXES_H

#include "scene/scene.h"

// Builds the scene; finish it. The same seed gives the same boxes. Pointers into it are valid as long as it is. Returns
// false if memory runs out.
bool ob_paper_boxes(ob_scene *s, uint32_t boxes, uint64_t seed);
void ob_paper_boxes_finish(ob_scene *s);

#endif

// Scenes filled by hand, for the tests and the benchmark of the renderer.
#ifndef OB_TESTS_RENDER_SCENERY_H
#define OB_TESTS_RENDER_SCENERY_H

#include "render/render.h"

// Room for count objects; object 0 is the ground, z = 0.
void scenery_start(ob_snapshot *s, uint32_t count);
// A dynamic object at rest; returns its motion, to be changed.
ob_motion *scenery_add(ob_snapshot *s, ob_shape shape, ob_vec3 size, ob_vec3 p, ob_quat q, const float colour[3]);
void scenery_finish(ob_snapshot *s);
// count boxes of random sizes, scattered on the ground, stacked and falling; the same for the same seed.
void scenery_boxes(ob_snapshot *s, uint32_t count, double spread, unsigned seed);

ob_look_def scenery_look(void);
ob_camera_def scenery_camera(ob_vec3 eye, ob_vec3 target);

#endif

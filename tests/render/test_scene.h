// Handmade scenes, for the tests and the benchmark of the renderer.
#ifndef OB_TESTS_RENDER_TEST_SCENE_H
#define OB_TESTS_RENDER_TEST_SCENE_H

#include "render/render.h"

// Makes room for count objects; object 0 is the ground, z = 0.
void test_scene_start(ob_snapshot *s, uint32_t count);
// Adds a dynamic object at rest; returns its motion, to be changed.
ob_motion *test_scene_add(ob_snapshot *s, ob_shape shape, ob_vec3 size, ob_vec3 p, ob_quat q, const float colour[3]);
void test_scene_finish(ob_snapshot *s);
// Adds count boxes of random sizes, scattered on the ground, stacked and falling; the same for the same seed.
void test_scene_boxes(ob_snapshot *s, uint32_t count, double spread, unsigned seed);

ob_look_def test_scene_look(void);
ob_camera_def test_scene_camera(ob_vec3 eye, ob_vec3 target);

#endif

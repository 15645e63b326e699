// Camera sensors of a run: the host draws their pictures in its pauses, and publishes them as samples.
//
//   step n - 1        step n: pause                       x: instant of picture k, k / rate
//   |--------x--------|  ──> cameras: draw ──> universe   it shows the universe at x, by the motions of both steps
//
// A renderer draws the pictures of all cameras of its size. Thread-safety: one thread at a time, while the universe is paused.
#ifndef OB_HOST_CAMERAS_H
#define OB_HOST_CAMERAS_H

#include "scene/scene.h"
#include "table/table.h"

typedef struct ob_cameras ob_cameras;

// True if the scene has none, or there is a renderer; false and e with the packages that are missing. Maps nothing.
bool ob_cameras_check(const ob_scene *scene, ob_error *e);
// After all that forks. NULL and e if nothing can be drawn. The scene and u must outlive it.
ob_cameras *ob_cameras_create(const ob_scene *scene, ob_universe *u, ob_error *e);
// Draws the pictures of the last step. false and e: the driver cannot.
bool ob_cameras_draw(ob_cameras *c, ob_error *e);
// First step after the present one that has a picture; UINT64_MAX: none.
uint64_t ob_cameras_next_step(const ob_cameras *c);
void ob_cameras_destroy(ob_cameras *c); // NULL is allowed

#endif

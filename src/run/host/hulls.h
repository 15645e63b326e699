// The hulls of a universe: those of its scene, by their numbers there, followed by those of objects created while it
// ran. A hull is never changed or freed, for readers may read it at any time. Objects of the same hull share it.
//
// Thread-safety: the host's thread only, while the universe is starting or paused.
#ifndef OB_HOST_HULLS_H
#define OB_HOST_HULLS_H

#include "hull/hull.h"
#include "scene/scene.h"
#include "table/table.h"

typedef struct ob_hulls {
	ob_universe *u;
	uint32_t of_scene, count; // count: of all
	ob_hull_corners *corners; // [count - of_scene], of the added hulls
} ob_hulls;

// Copies the scene's hulls into the universe. false and e: the memory file system is full.
bool ob_hulls_init(ob_hulls *h, const ob_scene *scene, ob_universe *u, ob_error *e);
void ob_hulls_finish(ob_hulls *h);
// Builds the hull of these corners, which may come from outside, and sets the object's shape: number, size. false and
// e: the corners have no hull, or there is no room for it.
bool ob_hulls_give(ob_hulls *h, const ob_hull_corners *corners, ob_passport *p, ob_error *e);
// Adds these hulls in their order to a universe with only the scene's. false and e: as above.
bool ob_hulls_load(ob_hulls *h, const ob_hull_corners *corners, uint32_t count, ob_error *e);

#endif

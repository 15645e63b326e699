#include "host/hulls.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"

static const char full[] = "/dev/shm is full: no room for its hull";

bool ob_hulls_init(ob_hulls *h, const ob_scene *scene, ob_universe *u, ob_error *e)
{
	*h = (ob_hulls){ .u = u, .of_scene = scene->hulls };
	for (; h->count < scene->hulls; h->count++)
		if (!ob_write_hull(u, h->count, &scene->hull[h->count]))
			return ob_fail(e, "/dev/shm is full: no room for %u hulls", scene->hulls);
	return true;
}

void ob_hulls_finish(ob_hulls *h)
{
	free(h->corners);
}

// UINT32_MAX: not found.
static uint32_t find(const ob_hulls *h, const ob_hull *hull)
{
	for (uint32_t i = 0; i < h->count; i++)
		if (memcmp(ob_hull_at(h->u, i), hull, sizeof *hull) == 0)
			return i;
	return UINT32_MAX;
}

static bool append(ob_hulls *h, const ob_hull_corners *corners, const ob_hull *hull, ob_error *e)
{
	const uint32_t come = h->count - h->of_scene;
	if (ob_universe_hulls(h->u) == 0)
		return ob_fail(e, "the one ODE world has no hulls");
	if (h->count >= ob_universe_hulls(h->u))
		return ob_fail(e, "there is no room for more than %u different hulls", ob_universe_hulls(h->u));
	if (!OB_GROW(h->corners, come + 1))
		return ob_fail(e, "out of memory");
	h->corners[come] = *corners;
	if (!ob_write_hull(h->u, h->count, hull))
		return ob_fail(e, "%s", full);
	h->count++;
	return true;
}

bool ob_hulls_give(ob_hulls *h, const ob_hull_corners *corners, ob_passport *p, ob_error *e)
{
	ob_hull hull;
	if (corners->count > OB_HULL_CORNERS_MAX)
		return ob_fail(e, "its hull has more than %d corners", OB_HULL_CORNERS_MAX);
	if (!ob_hull_build(corners->at, corners->count, &hull, e))
		return false;
	uint32_t number = find(h, &hull);
	if (number == UINT32_MAX) {
		number = h->count;
		if (!append(h, corners, &hull, e))
			return false;
	}
	p->hull = (uint16_t)number;
	p->size = ob_hull_size(&hull);
	return true;
}

bool ob_hulls_load(ob_hulls *h, const ob_hull_corners *corners, uint32_t count, ob_error *e)
{
	ob_passport p;
	for (uint32_t i = 0; i < count; i++) {
		const uint32_t number = h->count;
		if (!ob_hulls_give(h, &corners[i], &p, e))
			return false;
		if (p.hull != number)
			return ob_fail(e, "it has a hull twice");
	}
	return true;
}

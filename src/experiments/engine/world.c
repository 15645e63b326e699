#include "engine/world.h"

#include <stdlib.h>

ob_world_drive ob_world_drives(const ob_world *w)
{
	ob_world_drive drives = OB_WORLD_DRIVES_NOTHING;
	for (uint32_t i = 0; i < w->objects; i++) {
		const ob_passport *p = &w->passport[i];
		if (p->flags & OB_OBJECT_PRESCRIBED && ob_norm2(p->surface_velocity) > 0)
			return OB_WORLD_DRIVES_SURFACES;
		if (p->flags & OB_OBJECT_KINEMATIC)
			drives = OB_WORLD_DRIVES_BODIES;
	}
	return drives;
}

const ob_path *ob_world_path(const ob_world *w, uint32_t id)
{
	for (uint32_t i = 0; i < w->paths; i++)
		if (w->path[i].id == id)
			return &w->path[i].path;
	return NULL;
}

void ob_world_finish(ob_world *w)
{
	free(w->passport);
	free(w->state);
	free(w->path);
	free(w->hull);
	free(w->joint);
	*w = (ob_world){ 0 };
}

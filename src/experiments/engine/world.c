#include "engine/world.h"

#include <math.h>
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

// ---- drive

bool ob_drive_init(ob_drive *d, const ob_world *w)
{
	*d = (ob_drive){ .body = calloc(w->objects + 1, sizeof *d->body) };
	for (uint32_t id = 0; id < w->objects && d->body; id++) {
		if (!(w->passport[id].flags & OB_OBJECT_KINEMATIC))
			continue;
		const ob_path *path = ob_world_path(w, id);
		d->body[d->count++] = (struct ob_driven){
			.id = id,
			.from = w->state[id],
			.frequency = path ? path->frequency : 0,
			.a = path ? path->a : ob_v3(0, 0, 0),
		};
	}
	return d->body;
}

void ob_drive_finish(ob_drive *d)
{
	free(d->body);
}

static ob_vec3 place(const struct ob_driven *b, double t)
{
	const double f = b->frequency;
	const double along = f > 0 ? sin(f * t) / f : t, off = f > 0 ? (1 - cos(f * t)) / (f * f) : 0;
	return ob_madd(ob_madd(b->from.pose.p, along, b->from.v), off, b->a);
}

ob_state ob_drive_step(const ob_drive *d, uint32_t i, double t, double h)
{
	const struct ob_driven *b = &d->body[i];
	ob_state s = b->from;
	s.pose.p = place(b, t);
	s.pose.q = ob_quat_turn(b->from.pose.q, ob_scale(b->from.w, t));
	s.v = ob_scale(ob_sub(place(b, t + h), s.pose.p), 1 / h);
	return s;
}

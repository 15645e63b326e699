#include "render/overlay.h"

#include <stdlib.h>

static const float awake[4] = { 1, .86f, .25f, 1 }, flying[4] = { .45f, .95f, 1, 1 };
static const float asleep[4] = { .62f, .66f, .74f, 1 }, fixed[4] = { .35f, .37f, .42f, 1 };
static const float rim[4] = { .08f, .02f, .05f, .85f }, dot_colour[4] = { 1, .30f, .20f, 1 };
static const float normal_colour[4] = { 1, .95f, .55f, 1 };
static const float edge_px = 1.5f, dot_px = 6, rim_px = 8.5f, normal_px = 2;
static const double normal_length_px = 26;

static bool reserve(ob_overlay *o, size_t count)
{
	o->count = 0;
	if (count <= o->capacity)
		return true;
	ob_segment *grown = realloc(o->segment, count * sizeof *grown);
	if (!grown)
		return false;
	o->segment = grown;
	o->capacity = count;
	return true;
}

static void add(ob_overlay *o, ob_vec3 from, ob_vec3 to, const float colour[4], float width)
{
	ob_segment *s = &o->segment[o->count++];
	*s = (ob_segment){ .from = { (float)from.x, (float)from.y, (float)from.z },
			   .to = { (float)to.x, (float)to.y, (float)to.z },
			   .width = width };
	for (int k = 0; k < 4; k++)
		s->colour[k] = colour[k];
}

static const float *colour_of(const ob_passport *p, const ob_motion *m)
{
	if (p->flags & OB_OBJECT_STATIC)
		return fixed;
	if (m->flags & OB_MOTION_ASLEEP)
		return asleep;
	return m->flags & OB_MOTION_FREE ? flying : awake;
}

static ob_vec3 corner(const double bounds[6], int which, ob_vec3 eye)
{
	return ob_v3(bounds[which & 1 ? 3 : 0] - eye.x, bounds[which & 2 ? 4 : 1] - eye.y,
		     bounds[which & 4 ? 5 : 2] - eye.z);
}

bool ob_overlay_boxes(ob_overlay *o, const ob_bodies *b, const ob_view *v)
{
	if (!reserve(o, 12 * (size_t)b->count))
		return false;
	for (uint32_t i = 0; i < b->count; i++) {
		const ob_render_body *body = &b->body[i];
		const ob_passport *p = &b->now->passport[body->id];
		if (!ob_view_sees(v, body->pose.p, 2 * body->radius))
			continue;
		double bounds[6];
		ob_shape_bounds(p->shape, p->size, body->pose, bounds);
		for (int from = 0; from < 8; from++)
			for (int axis = 1; axis <= 4; axis *= 2)
				if (!(from & axis))
					add(o, corner(bounds, from, v->eye), corner(bounds, from | axis, v->eye),
					    colour_of(p, &b->now->motion[body->id]), edge_px);
	}
	return true;
}

bool ob_overlay_contacts(ob_overlay *o, const ob_snapshot *s, const ob_view *v, int height)
{
	if (!reserve(o, 3 * s->contacts))
		return false;
	double metres_per_px = 2 * v->tan_y / height; // at a distance of 1 m
	for (size_t i = 0; i < s->contacts; i++) {
		ob_vec3 at = ob_sub(s->contact[i].position, v->eye);
		double length = normal_length_px * metres_per_px * ob_norm(at);
		ob_vec3 tip = ob_madd(at, length, s->contact[i].normal);
		add(o, at, tip, normal_colour, normal_px);
		add(o, at, at, rim, rim_px);
		add(o, at, at, dot_colour, dot_px);
	}
	return true;
}

void ob_overlay_finish(ob_overlay *o)
{
	free(o->segment);
	*o = (ob_overlay){ 0 };
}

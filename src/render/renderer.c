#include "render/render.h"

#include <stdlib.h>

#include "render/context.h"
#include "render/passes.h"

static const double contact_reach = .8; // m above the ground: so far a body darkens it

struct ob_renderer {
	ob_render_setup setup;
	ob_look_def look;
	ob_context context;
	ob_targets targets;
	ob_passes passes;
	ob_bodies bodies;
	ob_instances casters, low, seen;
	ob_overlay overlay;
};

bool ob_render_available(void)
{
	return true;
}

ob_renderer *ob_renderer_create(const ob_render_setup *setup, const ob_look_def *look, ob_error *e)
{
	if (setup->width < 1 || setup->height < 1 || setup->samples < 1) {
		ob_fail(e, "frames of %dx%d with %d samples: expected at least 1 of each", setup->width, setup->height,
			setup->samples);
		return NULL;
	}
	ob_renderer *r = calloc(1, sizeof *r);
	if (!r) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	r->setup = *setup;
	r->look = *look;
	if (!ob_context_create(&r->context, setup->device, e) ||
	    !ob_targets_create(&r->targets, setup->width, setup->height, setup->samples, e) ||
	    !ob_passes_create(&r->passes, e)) {
		ob_renderer_destroy(r);
		return NULL;
	}
	return r;
}

void ob_renderer_destroy(ob_renderer *r)
{
	if (!r)
		return;
	if (r->context.context && ob_context_make_current(&r->context, NULL)) {
		ob_passes_destroy(&r->passes);
		ob_targets_destroy(&r->targets);
	}
	ob_context_destroy(&r->context);
	ob_bodies_finish(&r->bodies);
	ob_instances_finish(&r->casters);
	ob_instances_finish(&r->low);
	ob_instances_finish(&r->seen);
	ob_overlay_finish(&r->overlay);
	free(r);
}

static bool casts(const ob_render_body *body, const void *map)
{
	return ob_map_holds(map, body);
}

static bool is_low(const ob_render_body *body, const void *frame)
{
	const ob_frame *f = frame;
	return ob_dot(body->pose.p, f->contact.z) - body->radius < f->level + contact_reach &&
	       ob_map_holds(&f->contact, body);
}

static bool is_seen(const ob_render_body *body, const void *view)
{
	return ob_view_sees(view, body->pose.p, body->radius);
}

static bool draw_overlays(ob_renderer *r, const ob_snapshot *now, const ob_view *v)
{
	if (r->setup.overlay_aabb) {
		if (!ob_overlay_boxes(&r->overlay, &r->bodies, v))
			return false;
		ob_passes_overlay(&r->passes, &r->overlay, true);
	}
	if (r->setup.overlay_contacts) {
		if (!ob_overlay_contacts(&r->overlay, now, v, r->setup.height))
			return false;
		ob_passes_overlay(&r->passes, &r->overlay, false);
	}
	return true;
}

bool ob_renderer_draw(ob_renderer *r, const ob_snapshot *prev, const ob_snapshot *now, double t, const ob_camera_def *c,
		      uint8_t *rgba, ob_error *e)
{
	ob_frame f = { 0 };
	if (!ob_context_make_current(&r->context, e))
		return false;
	if (!ob_bodies_evaluate(&r->bodies, prev, now, t))
		return ob_fail(e, "out of memory");
	ob_frame_set(&f, &r->bodies, &r->look, c, t, r->setup.width, r->setup.height);
	ob_bodies_sort(&r->bodies, f.view.eye);
	if (!ob_instances_fill(&r->casters, &r->bodies, &f.view, r->setup.height, casts, &f.sun) ||
	    (f.ground >= 0 && !ob_instances_fill(&r->low, &r->bodies, &f.view, r->setup.height, is_low, &f)) ||
	    !ob_instances_fill(&r->seen, &r->bodies, &f.view, r->setup.height, is_seen, &f.view))
		return ob_fail(e, "out of memory");
	ob_passes_begin(&r->passes, &f.block);
	ob_passes_sun_map(&r->passes, &r->targets, &r->casters);
	if (f.ground >= 0)
		ob_passes_contact_map(&r->passes, &r->targets, &r->low);
	ob_passes_picture(&r->passes, &r->targets, &r->seen, &r->bodies, &f, &r->look);
	if (!draw_overlays(r, now, &f.view))
		return ob_fail(e, "out of memory");
	ob_passes_read(&r->targets, rgba);
	GLenum error = glGetError();
	return error == GL_NO_ERROR ? true : ob_fail(e, "the OpenGL driver reported error 0x%x while drawing", error);
}

#include "render/render.h"

#include <stdlib.h>

#include "render/context.h"
#include "render/passes.h"

static const double occlusion_height = .8; // m above the ground, up to which a body occludes it

struct ob_renderer {
	ob_render_setup setup;
	ob_look_def look;
	ob_context context;
	ob_targets targets;
	ob_passes passes;
	ob_draw_list list;
	ob_instances casters, near_ground, visible;
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
	ob_draw_list_finish(&r->list);
	ob_instances_finish(&r->casters);
	ob_instances_finish(&r->near_ground);
	ob_instances_finish(&r->visible);
	ob_overlay_finish(&r->overlay);
	free(r);
}

static bool casts_shadow(const ob_draw_item *body, const void *ortho)
{
	return ob_ortho_contains(ortho, body);
}

static bool is_near_ground(const ob_draw_item *body, const void *frame)
{
	const ob_frame *f = frame;
	return ob_dot(body->pose.p, f->occlusion.z) - body->radius < f->level + occlusion_height &&
	       ob_ortho_contains(&f->occlusion, body);
}

static bool is_visible(const ob_draw_item *body, const void *view)
{
	return ob_view_in_frustum(view, body->pose.p, body->radius);
}

static bool draw_overlays(ob_renderer *r, const ob_snapshot *now, const ob_view *v)
{
	if (r->setup.overlay_aabb) {
		if (!ob_overlay_boxes(&r->overlay, &r->list, v))
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
	if (!ob_draw_list_fill(&r->list, prev, now, t))
		return ob_fail(e, "out of memory");
	ob_frame_set(&f, &r->list, &r->look, c, t, r->setup.width, r->setup.height);
	ob_draw_list_sort(&r->list, f.view.eye);
	if (!ob_instances_fill(&r->casters, &r->list, &f.view, r->setup.height, casts_shadow, &f.shadow) ||
	    (f.ground >= 0 &&
	     !ob_instances_fill(&r->near_ground, &r->list, &f.view, r->setup.height, is_near_ground, &f)) ||
	    !ob_instances_fill(&r->visible, &r->list, &f.view, r->setup.height, is_visible, &f.view))
		return ob_fail(e, "out of memory");
	ob_passes_begin(&r->passes, &f.block);
	ob_passes_shadow_map(&r->passes, &r->targets, &r->casters);
	if (f.ground >= 0)
		ob_passes_occlusion_map(&r->passes, &r->targets, &r->near_ground);
	ob_passes_colour(&r->passes, &r->targets, &r->visible, &r->list, &f, &r->look);
	if (!draw_overlays(r, now, &f.view))
		return ob_fail(e, "out of memory");
	ob_passes_read(&r->targets, rgba);
	GLenum error = glGetError();
	return error == GL_NO_ERROR ? true : ob_fail(e, "the OpenGL driver reported error 0x%x while drawing", error);
}

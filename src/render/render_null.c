// Stands in for the renderer where obsim was built without EGL: everything else of obsim works.
#include "render/render.h"

bool ob_render_available(void)
{
	return false;
}

ob_renderer *ob_renderer_create(const ob_render_setup *r, const ob_look_def *look, ob_error *e)
{
	ob_fail(e, "this obsim was built without EGL and draws no frames; install libegl-dev and libopengl-dev and "
		   "build again with -Drender=enabled");
	return NULL;
}

void ob_renderer_destroy(ob_renderer *r) {}

bool ob_renderer_draw(ob_renderer *r, const ob_snapshot *prev, const ob_snapshot *now, double t, const ob_camera_def *c,
		      uint8_t *rgba, ob_error *e)
{
	return ob_fail(e, "this obsim was built without EGL and draws no frames");
}

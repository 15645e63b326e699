// The part of obsim that draws by EGL and OpenGL (base/part.h): obsim-render.so. The functions are those of render.h.
#ifndef OB_RENDER_PART_H
#define OB_RENDER_PART_H

#include "base/part.h"
#include "render/render.h"

typedef struct ob_render_part {
	ob_part_head head;
	ob_renderer *(*create)(const ob_render_setup *r, const ob_look_def *look, ob_error *e);
	void (*destroy)(ob_renderer *r);
	bool (*draw)(ob_renderer *r, const ob_snapshot *prev, const ob_snapshot *now, double t, const ob_camera_def *c,
		     uint8_t *rgba, ob_error *e);
	bool (*sense)(ob_renderer *r, const ob_snapshot *prev, const ob_snapshot *now, double t,
		      const ob_sensor_passport *s, ob_pixel *pixel, ob_error *e);
} ob_render_part;

// First member of each renderer.
typedef struct ob_renderer_base {
	const ob_render_part *part;
} ob_renderer_base;

#endif

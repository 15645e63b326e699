// The renderer and captions as the program sees them: loads the parts that draw.
#include "render/caption.h"
#include "render/part.h"

#define PACKAGES "libegl1, libopengl0 and libgl1-mesa-dri"

static const ob_render_part *part_of(const ob_renderer *r)
{
	return ((const ob_renderer_base *)r)->part;
}

bool ob_render_check(ob_error *e)
{
	return ob_part_check("render", PACKAGES, e);
}

ob_renderer *ob_renderer_create(const ob_render_setup *r, const ob_look_def *look, ob_error *e)
{
	const ob_render_part *part = ob_part_load("render", sizeof *part, OB_PART_PROGRAM, PACKAGES, e);
	ob_renderer *created = part ? part->create(r, look, e) : NULL;
	if (created)
		((ob_renderer_base *)created)->part = part;
	return created;
}

void ob_renderer_destroy(ob_renderer *r)
{
	if (r)
		part_of(r)->destroy(r);
}

bool ob_renderer_draw(ob_renderer *r, const ob_snapshot *prev, const ob_snapshot *now, double t, const ob_camera_def *c,
		      uint8_t *rgba, ob_error *e)
{
	return part_of(r)->draw(r, prev, now, t, c, rgba, e);
}

bool ob_renderer_sense(ob_renderer *r, const ob_snapshot *prev, const ob_snapshot *now, double t,
		       const ob_sensor_passport *s, ob_pixel *pixel, ob_error *e)
{
	return part_of(r)->sense(r, prev, now, t, s, pixel, e);
}

// ---- captions

#define CAIRO "libcairo2"

static const ob_caption_part *load_cairo(ob_error *e)
{
	return ob_part_load("cairo", sizeof(ob_caption_part), OB_PART_PROGRAM, CAIRO, e);
}

bool ob_caption_check(ob_error *e)
{
	return ob_part_check("cairo", CAIRO, e);
}

bool ob_caption(uint8_t *rgba, int width, int height, const char *title, const char *time, ob_error *e)
{
	const ob_caption_part *part = load_cairo(e);
	return part && part->caption(rgba, width, height, title, time, e);
}

bool ob_caption_strip(uint8_t *rgba, int width, int height, const ob_strip *s, ob_error *e)
{
	const ob_caption_part *part = load_cairo(e);
	return part && part->strip(rgba, width, height, s, e);
}

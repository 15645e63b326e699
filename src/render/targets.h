// What is drawn into: the picture (multisampled and plain), the shadow map, the contact map.
#ifndef OB_RENDER_TARGETS_H
#define OB_RENDER_TARGETS_H

#include <stdbool.h>

#include <ob/error.h>

#include "render/gl.h"

typedef struct ob_targets {
	int width, height, samples;
	GLuint plain, multi; // framebuffers; multi = 0: draw into plain
	GLuint plain_colour, multi_colour, depth; // renderbuffers
	GLuint sun, sun_depth; // framebuffer and depth texture
	GLuint cover[2], cover_texture[2]; // contact map, and what it is blurred through
} ob_targets;

// samples is lowered to what the driver offers.
bool ob_targets_create(ob_targets *t, int width, int height, int samples, ob_error *e);
void ob_targets_destroy(ob_targets *t);

#endif

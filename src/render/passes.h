// The passes of a frame on the GL side: buffers, and draws from them. A current context is needed.
#ifndef OB_RENDER_PASSES_H
#define OB_RENDER_PASSES_H

#include "render/frame.h"
#include "render/overlay.h"
#include "render/program.h"
#include "render/targets.h"

typedef struct ob_passes {
	GLuint program[OB_PROGRAMS];
	GLuint frame_block;
	GLuint body_array, vertices, indices, instances;
	GLuint segment_array, segments;
	GLuint empty_array; // for what is made from gl_VertexID alone
	ob_mesh mesh[OB_MESHES];
} ob_passes;

bool ob_passes_create(ob_passes *p, ob_error *e);
void ob_passes_destroy(ob_passes *p);

void ob_passes_begin(const ob_passes *p, const ob_frame_block *block);
// The shadow map, from all that casts.
void ob_passes_sun_map(const ob_passes *p, const ob_targets *t, const ob_instances *casters);
// The contact map, from what is near the ground.
void ob_passes_contact_map(const ob_passes *p, const ob_targets *t, const ob_instances *low);
// The picture, without overlays.
void ob_passes_picture(const ob_passes *p, const ob_targets *t, const ob_instances *seen, const ob_bodies *b,
		       const ob_frame *f, const ob_look_def *look);
void ob_passes_overlay(const ob_passes *p, const ob_overlay *o, bool hidden_by_bodies);
// rgba: width * height * 4 bytes, top row first
void ob_passes_read(const ob_targets *t, uint8_t *rgba);

#endif

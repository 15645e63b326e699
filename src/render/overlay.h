// Overlays: bounding boxes and contacts, as lines and dots of constant width on the screen.
#ifndef OB_RENDER_OVERLAY_H
#define OB_RENDER_OVERLAY_H

#include "render/bodies.h"

// As shaders/segment.vert reads it. 44 bytes.
typedef struct ob_segment {
	float from[3], to[3]; // m, relative to the eye; equal: a dot
	float colour[4]; // as shown (sRGB), alpha
	float width; // px
} ob_segment;

typedef struct ob_overlay {
	ob_segment *segment;
	size_t count, capacity;
} ob_overlay;

// Each replaces what o held; false: out of memory. o starts zeroed.
bool ob_overlay_boxes(ob_overlay *o, const ob_bodies *b, const ob_view *v);
bool ob_overlay_contacts(ob_overlay *o, const ob_snapshot *s, const ob_view *v, int height);
void ob_overlay_finish(ob_overlay *o);

#endif

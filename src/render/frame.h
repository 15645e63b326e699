// What all shaders of one frame share, and where it comes from: camera, sun, sky, ground.
#ifndef OB_RENDER_FRAME_H
#define OB_RENDER_FRAME_H

#include "render/light.h"

// std140 layout of the block Frame in shaders/frame.glsl.
typedef struct ob_frame_block {
	float view_projection[16], sun_map[16], contact_map[16];
	float ray_right[4], ray_up[4], ray_forward[4];
	float sun[4], sun_colour[4], sky_top[4], sky_horizon[4], ambient_up[4], ambient_down[4], viewport[4];
	float sun_map_texel[4]; // 2 used
} ob_frame_block;

enum { OB_SUN_TEXELS = 2048, OB_CONTACT_TEXELS = 256 };

typedef struct ob_frame {
	ob_view view;
	ob_map sun; // shadows
	ob_map contact; // on the ground, from above
	int ground; // index of the plane that is the ground; -1 = none
	double level; // m, height of the ground along contact.z
	ob_frame_block block;
} ob_frame;

void ob_frame_set(ob_frame *f, const ob_bodies *b, const ob_look_def *look, const ob_camera_def *c, double t, int width,
		  int height);

#endif

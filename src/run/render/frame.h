// Shared data of all shaders of one frame (camera, sun, sky, ground), and the extents of the shadow map and the
// occlusion map: rectangles fitted to the visible scene. Pure functions.
#ifndef OB_RENDER_FRAME_H
#define OB_RENDER_FRAME_H

#include "render/draw_list.h"

// Orthographic projection of a map: its axes, centre and half sides. Sizes come in steps of 2^(1/6) and the centre in
// whole texels, so that shadows do not crawl while the scene moves.
typedef struct ob_ortho {
	ob_vec3 x, y, z; // unit; z towards the light
	double centre_x, centre_y;
	double half_x, half_y; // m
	double z_low, z_high; // m along z: range of casters
} ob_ortho;

// Fits a map for light from direction z (unit) to the bodies that are visible or cast a visible shadow.
ob_ortho ob_ortho_fit(ob_vec3 z, const ob_draw_list *b, const ob_view *v, int texels);
bool ob_ortho_contains(const ob_ortho *m, const ob_draw_item *body);
// Column-major matrix from positions relative to the eye to 0..1; z grows away from the light.
void ob_ortho_matrix(const ob_ortho *m, ob_vec3 eye, float out[16]);

enum { OB_SHADOW_TEXELS = 1280, OB_OCCLUSION_TEXELS = 128, OB_SKY_MAPS_MAX = 12 };

// std140 layout of the block Frame in shaders/frame.glsl.
typedef struct ob_frame_block {
	float view_projection[16], shadow_map[16], occlusion_map[16];
	float ray_right[4], ray_up[4], ray_forward[4];
	float sun[4], sun_colour[4], sky_top[4], sky_horizon[4], ambient_up[4], ambient_down[4], ground_shine[4];
	float viewport[4], shadow_texel[4];
	float sky_map[OB_SKY_MAPS_MAX][16], sky_ray[OB_SKY_MAPS_MAX][4];
} ob_frame_block;

// One picture of several that are averaged: each has its own offset in the pixel, its own point of the sun, and its own
// directions of the sky. For a single picture, number is 0 and count 1.
typedef struct ob_frame_share {
	int number, count;
	int sky_maps; // number of sampled sky directions, up to OB_SKY_MAPS_MAX
} ob_frame_share;

typedef struct ob_frame {
	ob_view view;
	ob_ortho shadow; // seen from the sun
	ob_ortho sky[OB_SKY_MAPS_MAX];
	int sky_maps;
	ob_ortho occlusion; // occlusion of the ground by near bodies, seen from above
	int ground; // index of the ground plane; -1 = none
	double level; // m, height of the ground along occlusion.z
	ob_frame_block block;
} ob_frame;

void ob_frame_set(ob_frame *f, const ob_draw_list *b, const ob_look_def *look, const ob_view *v, int width, int height,
		  const ob_frame_share *share, int sky_texels);

#endif

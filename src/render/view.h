// What a camera sees at an instant: its frame of axes, its frustum. Double precision; pure functions.
#ifndef OB_RENDER_VIEW_H
#define OB_RENDER_VIEW_H

#include "scene/scene.h"

typedef struct ob_view {
	ob_vec3 eye; // m
	ob_vec3 right, up, forward; // unit
	double tan_x, tan_y; // of half the angles of view
	double near_plane, far_plane; // m
	double range; // m, from the eye to what it looks at: the scale of the picture
} ob_view;

// The camera at time t (s): travelled, panned and tilted since 0.
ob_view ob_view_of_camera(const ob_camera_def *c, double t, int width, int height);
// The ball (centre, radius in m) is at least partly in the frustum.
bool ob_view_sees(const ob_view *v, ob_vec3 centre, double radius);
// Column-major: positions relative to the eye to clip coordinates. y points down the picture, so that the first row
// read back is the top one; triangles that were counter-clockwise come out clockwise.
void ob_view_projection(const ob_view *v, float m[16]);

#endif

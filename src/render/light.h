// Where the shadow map and the contact map lie: rectangles fitted to what is seen. Pure functions.
#ifndef OB_RENDER_LIGHT_H
#define OB_RENDER_LIGHT_H

#include "render/bodies.h"

// An orthographic map: its axes, centre and half sides. Sizes come in steps of 2^(1/4) and the centre in whole
// texels, so that shadows do not crawl while the scene moves.
typedef struct ob_map {
	ob_vec3 x, y, z; // unit; z towards the light
	double centre_x, centre_y;
	double half_x, half_y; // m
	double z_low, z_high; // m along z: what casts lies between
	double fade; // m from the eye: where the map ends
} ob_map;

// For light from direction z (unit), over the bodies that can be seen or whose shadow can be seen.
ob_map ob_map_fit(ob_vec3 z, const ob_bodies *b, const ob_view *v, int texels);
bool ob_map_holds(const ob_map *m, const ob_render_body *body);
// Column-major: positions relative to the eye to 0..1; z grows away from the light.
void ob_map_matrix(const ob_map *m, ob_vec3 eye, float out[16]);

#endif

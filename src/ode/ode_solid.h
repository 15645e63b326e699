// Inside the module ode only: where a point lies with regard to a shape. Pure functions.
#ifndef OB_ODE_SOLID_H
#define OB_ODE_SOLID_H

#include <ob/motion.h>

typedef struct ob_ode_solid {
	ob_shape shape;
	ob_vec3 size;
	ob_vec3 p; // m, centre
	ob_mat3 r; // body to world
} ob_ode_solid;

ob_ode_solid ob_ode_solid_make(ob_shape shape, ob_vec3 size, ob_pose pose);
// The same shape, thicker by m (m) on every side.
ob_vec3 ob_ode_solid_inflate(ob_shape shape, ob_vec3 size, double m);
// Of the sphere round its centre that holds it (m); not for planes.
double ob_ode_solid_radius(const ob_ode_solid *s);
// How far the solid reaches beyond x along the unit direction n (m).
double ob_ode_solid_height(const ob_ode_solid *s, ob_vec3 n, ob_vec3 x);
// x itself, or the point of the solid nearest to it.
ob_vec3 ob_ode_solid_nearest(const ob_ode_solid *s, ob_vec3 x);
// How much the extent along the unit direction n grows (m) when the shape is inflated by m (m).
double ob_ode_solid_growth(const ob_ode_solid *s, ob_vec3 n, double m);
// The part [*from, *to] of the line x + t u over the face that looks along n; false: none.
bool ob_ode_solid_clip(const ob_ode_solid *s, ob_vec3 n, ob_vec3 x, ob_vec3 u, double *from, double *to);

#endif

// Rays against surfaces that several shapes have: first distance t > 0 at which the ray p + t d enters, and the normal
// there; infinity: it does not. d: a unit vector. Pure functions, thread-safe.
#ifndef OB_SHAPE_ENTER_H
#define OB_SHAPE_ENTER_H

#include <ob/vec.h>

static inline double ob_enter_ball(ob_vec3 centre, double radius, ob_vec3 p, ob_vec3 d, ob_vec3 *n)
{
	const ob_vec3 m = ob_sub(p, centre);
	const double b = ob_dot(m, d), c = ob_norm2(m) - radius * radius, root = b * b - c;
	if (c <= 0 || root < 0 || b > 0)
		return INFINITY;
	const double t = -b - sqrt(root);
	*n = ob_scale(ob_madd(m, t, d), 1 / radius);
	return t;
}

// Wall of a cylinder along z with half its length.
static inline double ob_enter_wall(double radius, double half, ob_vec3 p, ob_vec3 d, ob_vec3 *n)
{
	const double a = d.x * d.x + d.y * d.y, b = p.x * d.x + p.y * d.y, c = p.x * p.x + p.y * p.y - radius * radius;
	const double root = b * b - a * c;
	if (a == 0 || c <= 0 || root < 0)
		return INFINITY;
	const double t = (-b - sqrt(root)) / a, z = p.z + t * d.z;
	if (t <= 0 || fabs(z) > half)
		return INFINITY;
	*n = ob_v3((p.x + t * d.x) / radius, (p.y + t * d.y) / radius, 0);
	return t;
}

#endif

// Projects points into the picture of a camera.
#ifndef OB_TESTS_SCENE_PROJECT_H
#define OB_TESTS_SCENE_PROJECT_H

#include "scene/scene.h"

// x: -1 .. 1 across a picture of 16:9, y: -1 .. 1 upwards; false behind the camera
static inline bool project(const ob_camera_def *c, ob_vec3 p, double *x, double *y)
{
	ob_vec3 f = ob_sub(c->target, c->eye);
	f = ob_scale(f, 1 / ob_norm(f));
	ob_vec3 r = ob_cross(f, ob_v3(0, 0, 1));
	r = ob_scale(r, 1 / ob_norm(r));
	ob_vec3 d = ob_sub(p, c->eye);
	double depth = ob_dot(d, f) * tan(.5 * c->fov);
	*x = ob_dot(d, r) / depth * 9 / 16;
	*y = ob_dot(d, ob_cross(r, f)) / depth;
	return depth > 0;
}

// Point k (of 27) round an object: the corners of a box, or of the sphere that holds another shape.
static inline ob_vec3 point_of(const ob_object_def *o, int k)
{
	ob_vec3 h = ob_v3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
	ob_mat3 r = ob_quat_matrix(o->state.pose.q);
	if (o->passport.shape == OB_SHAPE_BOX)
		h = ob_v3(h.x * o->passport.size.x, h.y * o->passport.size.y, h.z * o->passport.size.z);
	else
		h = ob_scale(h, ob_shape_radius((ob_shape)o->passport.shape, o->passport.size) / fmax(ob_norm(h), 1));
	return ob_add(o->state.pose.p, ob_rotate(&r, h));
}

// The largest |x| or |y| of any object's points; infinity where one lies behind the camera.
static inline double reach(const ob_scene *s, const ob_camera_def *c)
{
	double most = 0, x, y;
	for (uint32_t i = 0; i < s->objects; i++) {
		if (s->object[i].passport.shape == OB_SHAPE_PLANE)
			continue;
		for (int k = 0; k < 27; k++) {
			if (!project(c, point_of(&s->object[i], k), &x, &y))
				return INFINITY;
			most = fmax(most, fmax(fabs(x), fabs(y)));
		}
	}
	return most;
}

#endif

// Shapes in space for the tests of contact geometry, and their properties by simple methods.
#ifndef OB_TESTS_CONTACT_PLACED_H
#define OB_TESTS_CONTACT_PLACED_H

#include "contact/manifold.h"

#include "motion/random.h"

static inline ob_placed place(ob_shape shape, ob_vec3 size, ob_vec3 p, ob_quat q)
{
	return (ob_placed){ .shape = shape, .size = size, .p = p, .r = ob_quat_matrix(q) };
}

static inline ob_vec3 random_size(uint64_t *seed)
{
	double x = within(seed, .1, 1), y = within(seed, .1, 1), z = within(seed, .1, 1);
	return ob_v3(x, y, z);
}

static inline ob_vec3 random_direction(uint64_t *seed)
{
	for (;;) {
		ob_vec3 v = random_vector(seed, 1);
		double l = ob_norm(v);
		if (l > .1 && l < 1)
			return ob_scale(v, 1 / l);
	}
}

static inline ob_placed random_placed(uint64_t *seed, ob_shape shape, double spread)
{
	ob_vec3 size = random_size(seed), p = random_vector(seed, spread);
	return place(shape, size, p, random_attitude(seed));
}

// Moves a scene of two shapes as one rigid body, which keeps their relative pose.
typedef struct rigid {
	ob_vec3 p;
	ob_quat q;
} rigid;

static inline rigid random_rigid(uint64_t *seed)
{
	ob_vec3 p = random_vector(seed, 5);
	return (rigid){ p, random_attitude(seed) };
}

static inline ob_vec3 rigid_turn(const rigid *g, ob_vec3 v)
{
	ob_mat3 r = ob_quat_matrix(g->q);
	return ob_rotate(&r, v);
}

static inline ob_vec3 rigid_point(const rigid *g, ob_vec3 x)
{
	return ob_add(g->p, rigid_turn(g, x));
}

static inline ob_placed rigid_place(const rigid *g, ob_shape shape, ob_vec3 size, ob_vec3 p, ob_quat q)
{
	return place(shape, size, rigid_point(g, p), ob_quat_mul(g->q, q));
}

// Distance of x from the shape (m); <= 0 inside. Spheres, boxes, planes. Outside a box's corner: too small.
static inline double outside(const ob_placed *s, ob_vec3 x)
{
	ob_vec3 l = ob_rotate_back(&s->r, ob_sub(x, s->p));
	if (s->shape == OB_SHAPE_SPHERE)
		return ob_norm(l) - s->size.x;
	if (s->shape == OB_SHAPE_PLANE)
		return l.z;
	return fmax(fabs(l.x) - s->size.x, fmax(fabs(l.y) - s->size.y, fabs(l.z) - s->size.z));
}

// Half the width of a box along the unit direction n (m)
static inline double half_width(const ob_placed *box, ob_vec3 n)
{
	ob_vec3 l = ob_rotate_back(&box->r, n);
	return fabs(l.x) * box->size.x + fabs(l.y) * box->size.y + fabs(l.z) * box->size.z;
}

// Distance of two boxes by descent over the points of both, one coordinate at a time: from above, never too small.
static inline double box_distance(const ob_placed *a, const ob_placed *b)
{
	const ob_placed *box[2] = { a, b };
	double s[2][3] = { { 0 } };
	ob_vec3 d = ob_sub(a->p, b->p); // from the point of b to that of a
	for (int round = 0; round < 3000; round++)
		for (int k = 0; k < 6; k++) {
			const ob_placed *x = box[k / 3];
			double sign = k < 3 ? 1 : -1, h[3] = { x->size.x, x->size.y, x->size.z };
			ob_vec3 axis = ob_column(&x->r, k % 3);
			double *at = &s[k / 3][k % 3], next = *at - sign * ob_dot(axis, d);
			next = fmax(-h[k % 3], fmin(h[k % 3], next));
			d = ob_madd(d, sign * (next - *at), axis);
			*at = next;
		}
	return ob_norm(d);
}

#endif

#include "motion/flight.h"

#include <float.h>

static const double near = 1e-11; // m: closer than this counts as touching
static const int most_advances = 200; // a grazing corner takes many; after so many it counts as landing

double ob_spin_bound(ob_quat q, ob_vec3 w, ob_vec3 inertia)
{
	double least = fmin(inertia.x, fmin(inertia.y, inertia.z));
	if (!(least > 0) || (inertia.x == inertia.y && inertia.y == inertia.z))
		return ob_norm(w);
	ob_mat3 r = ob_quat_matrix(q);
	ob_vec3 b = ob_rotate_back(&r, w), l = ob_v3(inertia.x * b.x, inertia.y * b.y, inertia.z * b.z);
	return sqrt(fmin(ob_dot(l, b) / least, ob_norm2(l) / (least * least)));
}

// Euler: dw_i/dt = (I_j - I_k) / I_i w_j w_k, and the squares of the products add up to w^4 / 3 at most.
static double turning_bound(ob_vec3 i, double w)
{
	double k = fmax(fabs(i.y - i.z) / i.x, fmax(fabs(i.z - i.x) / i.y, fabs(i.x - i.y) / i.z));
	return w * w * (1 + (i.x > 0 && i.y > 0 && i.z > 0 ? k / sqrt(3) : 0));
}

// A shape is the points around its centre, grown by a radius: a box its corners, a capsule the ends of its axis.
typedef struct hull {
	ob_vec3 half; // m, of the box of the points
	double radius; // m, of each
	double reach; // m, of a point from the centre
} hull;

static bool hull_of(const ob_flier *f, hull *h)
{
	*h = (hull){ f->size, 0, 0 };
	if (f->shape == OB_SHAPE_SPHERE)
		*h = (hull){ { 0, 0, 0 }, f->size.x, 0 };
	else if (f->shape == OB_SHAPE_CAPSULE)
		*h = (hull){ { 0, 0, f->size.y }, f->size.x, 0 };
	else if (f->shape != OB_SHAPE_BOX)
		return false;
	h->reach = ob_norm(h->half);
	return true;
}

static ob_vec3 component(ob_vec3 half, ob_vec3 n)
{
	return ob_v3(half.x * n.x, half.y * n.y, half.z * n.z);
}

// For how long no point of the hull lands, at least (s); 0: one lands now. height and speed: of the centre over the
// plane. No point falls faster than with the acceleration "most".
static double advance(const ob_flier *f, const hull *h, ob_vec3 n, double s, double height, double speed, double most,
		      double tolerance)
{
	ob_quat q = f->q;
	ob_vec3 w = { 0, 0, 0 };
	if (f->spin)
		ob_spin_at(f->spin, s, &q, &w);
	ob_mat3 r = ob_quat_matrix(q);
	ob_vec3 up = component(h->half, ob_rotate_back(&r, n));
	ob_vec3 rise = component(h->half, ob_rotate_back(&r, ob_cross(n, w)));
	double least = INFINITY;
	for (int k = 0; k < 8; k++) {
		double x = k & 1 ? 1 : -1, y = k & 2 ? 1 : -1, z = k & 4 ? 1 : -1;
		double gap = height + x * up.x + y * up.y + z * up.z;
		double rate = speed + x * rise.x + y * rise.y + z * rise.z;
		if (gap <= tolerance) {
			if (rate < 0)
				return 0;
			gap = 0;
		}
		double root = sqrt(rate * rate + 2 * most * gap);
		double t = rate < 0 ? 2 * gap / (root - rate) : most > 0 ? (rate + root) / most : INFINITY;
		least = fmin(least, t);
	}
	return least;
}

double ob_landing_time(const ob_flier *f, const ob_half_space *plane, double from, double until)
{
	const ob_vec3 n = plane->normal;
	hull h;
	bool known = hull_of(f, &h);
	const double radius = ob_shape_radius(f->shape, f->size);
	const double p = ob_dot(n, f->p) - plane->offset, v = ob_dot(n, f->v), a = ob_dot(n, f->a);
	if (known && h.reach == 0) {
		double first = ob_time_of_closing(p - radius, v, a, until);
		if (first >= from)
			return first;
	}
	double s = from, height = p + s * (v + .5 * s * a), speed = v + s * a;
	if (height > radius)
		s += ob_time_of_closing(height - radius, speed, a, until - s);
	if (!(s <= until) || !known)
		return s <= until ? s : INFINITY;
	double spin = f->spin ? ob_spin_bound(f->q, f->w, f->inertia) : 0;
	double most = fmax(0, -a) + h.reach * turning_bound(f->inertia, spin);
	double tolerance = near + 8 * DBL_EPSILON * (ob_norm(f->p) + fabs(plane->offset));
	for (int k = 0; k < most_advances && s <= until; k++) {
		height = p + s * (v + .5 * s * a) - h.radius, speed = v + s * a;
		double t = advance(f, &h, n, s, height, speed, most, tolerance);
		if (t == 0)
			return s;
		s += fmax(t, DBL_EPSILON * fabs(s));
	}
	return s <= until ? s : INFINITY;
}

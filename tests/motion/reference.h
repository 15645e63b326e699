// Torque-free rotation by brute force, for comparison: Taylor series of order 24 of Euler's equations and of the
// attitude, in long double. Independent of the closed form. Also the measures of error.
#ifndef OB_TESTS_MOTION_REFERENCE_H
#define OB_TESTS_MOTION_REFERENCE_H

#include <ob/vec.h>

enum { TAYLOR_ORDER = 24 };

typedef struct long_rotation {
	long double q[4]; // body to world
	long double w[3]; // rad/s, body frame
} long_rotation;

static inline long_rotation long_of(ob_quat q, ob_vec3 w)
{
	long double s = q.w, x = q.x, y = q.y, z = q.z, a = w.x, b = w.y, c = w.z;
	long double size = sqrtl(s * s + x * x + y * y + z * z);
	s /= size, x /= size, y /= size, z /= size;
	long_rotation r = { .q = { s, x, y, z } };
	r.w[0] = (1 - 2 * (y * y + z * z)) * a + 2 * (x * y + s * z) * b + 2 * (x * z - s * y) * c;
	r.w[1] = 2 * (x * y - s * z) * a + (1 - 2 * (x * x + z * z)) * b + 2 * (y * z + s * x) * c;
	r.w[2] = 2 * (x * z + s * y) * a + 2 * (y * z - s * x) * b + (1 - 2 * (x * x + y * y)) * c;
	return r;
}

// One step h: w' = (I w x w) / I and q' = q w / 2, coefficient by coefficient.
static inline void long_step(long_rotation *r, const long double c[3], long double h)
{
	long double q[TAYLOR_ORDER + 1][4], w[TAYLOR_ORDER + 1][3];
	for (int i = 0; i < 4; i++)
		q[0][i] = r->q[i];
	for (int i = 0; i < 3; i++)
		w[0][i] = r->w[i];
	for (int n = 0; n < TAYLOR_ORDER; n++) {
		long double e[3] = { 0 }, d[4] = { 0 };
		for (int j = 0; j <= n; j++) {
			const long double *a = q[j], *u = w[j], *v = w[n - j];
			for (int i = 0; i < 3; i++)
				e[i] += u[(i + 1) % 3] * v[(i + 2) % 3];
			d[0] -= a[1] * v[0] + a[2] * v[1] + a[3] * v[2];
			d[1] += a[0] * v[0] + a[2] * v[2] - a[3] * v[1];
			d[2] += a[0] * v[1] + a[3] * v[0] - a[1] * v[2];
			d[3] += a[0] * v[2] + a[1] * v[1] - a[2] * v[0];
		}
		for (int i = 0; i < 3; i++)
			w[n + 1][i] = c[i] * e[i] / (n + 1);
		for (int i = 0; i < 4; i++)
			q[n + 1][i] = .5L * d[i] / (n + 1);
	}
	for (int i = 0; i < 4; i++)
		for (int n = TAYLOR_ORDER - 1, first = 1; n >= 0; n--, first = 0)
			r->q[i] = (first ? q[n + 1][i] : r->q[i]) * h + q[n][i];
	for (int i = 0; i < 3; i++)
		for (int n = TAYLOR_ORDER - 1, first = 1; n >= 0; n--, first = 0)
			r->w[i] = (first ? w[n + 1][i] : r->w[i]) * h + w[n][i];
}

static inline void long_advance(long_rotation *r, ob_vec3 inertia, double s)
{
	long double i[3] = { inertia.x, inertia.y, inertia.z };
	long double c[3] = { (i[1] - i[2]) / i[0], (i[2] - i[0]) / i[1], (i[0] - i[1]) / i[2] };
	long double speed = fmaxl(fmaxl(fabsl(r->w[0]), fabsl(r->w[1])), fabsl(r->w[2]));
	long steps = 1 + (long)(5 * fabsl(s * speed)); // .2 rad a step: the 25th term is below 1e-19
	for (long k = 0; k < steps; k++) {
		long_step(r, c, (long double)s / steps);
		long double n = 0;
		for (int j = 0; j < 4; j++)
			n += r->q[j] * r->q[j];
		for (int j = 0; j < 4; j++)
			r->q[j] /= sqrtl(n);
	}
}

// rad, between the attitude of r and q
static inline double attitude_error(const long_rotation *r, ob_quat q)
{
	const long double *a = r->q, v[3] = { q.x, q.y, q.z };
	long double x = a[0] * v[0] - q.w * a[1] + a[3] * v[1] - a[2] * v[2];
	long double y = a[0] * v[1] - q.w * a[2] + a[1] * v[2] - a[3] * v[0];
	long double z = a[0] * v[2] - q.w * a[3] + a[2] * v[0] - a[1] * v[1];
	return 2 * asin(fmin(sqrt(x * x + y * y + z * z), 1));
}

static inline ob_vec3 momentum_of(ob_quat q, ob_vec3 w, ob_vec3 inertia)
{
	ob_mat3 r = ob_quat_matrix(q);
	ob_vec3 b = ob_rotate_back(&r, w);
	return ob_rotate(&r, ob_v3(inertia.x * b.x, inertia.y * b.y, inertia.z * b.z));
}

static inline double energy_of(ob_quat q, ob_vec3 w, ob_vec3 inertia)
{
	return .5 * ob_dot(w, momentum_of(q, w, inertia));
}

#endif

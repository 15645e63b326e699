// Vectors, quaternions and 3x3 matrices in double precision, used by all modules.
//
// Frames: right-handed, z up, SI units. A quaternion (w, x, y, z) of norm 1 turns body coordinates into world
// coordinates. Matrices are row-major. All functions are pure and thread-safe.
#ifndef OB_VEC_H
#define OB_VEC_H

#include <math.h>
#include <stdbool.h>

typedef struct ob_vec3 {
	double x, y, z;
} ob_vec3;

// The smaller, the larger; b if they are equal; if one is NaN, the other. The compiler turns fmin and fmax into library
// calls, as the zero that they return is not specified, and all registers are saved around these calls.
static inline double ob_min(double a, double b)
{
	const double least = a < b ? a : b;
	return b == b ? least : a;
}
static inline double ob_max(double a, double b)
{
	const double most = a > b ? a : b;
	return b == b ? most : a;
}

typedef struct ob_quat {
	double w, x, y, z;
} ob_quat;

typedef struct ob_mat3 {
	double m[3][3];
} ob_mat3;

static inline ob_vec3 ob_v3(double x, double y, double z)
{
	return (ob_vec3){ x, y, z };
}
static inline ob_vec3 ob_add(ob_vec3 a, ob_vec3 b)
{
	return ob_v3(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline ob_vec3 ob_sub(ob_vec3 a, ob_vec3 b)
{
	return ob_v3(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline ob_vec3 ob_scale(ob_vec3 a, double s)
{
	return ob_v3(a.x * s, a.y * s, a.z * s);
}
// a + s b
static inline ob_vec3 ob_madd(ob_vec3 a, double s, ob_vec3 b)
{
	return ob_v3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
static inline double ob_dot(ob_vec3 a, ob_vec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline ob_vec3 ob_cross(ob_vec3 a, ob_vec3 b)
{
	return ob_v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double ob_norm2(ob_vec3 a)
{
	return ob_dot(a, a);
}
static inline bool ob_equal(ob_vec3 a, ob_vec3 b)
{
	return a.x == b.x && a.y == b.y && a.z == b.z;
}
static inline bool ob_is_finite(ob_vec3 a)
{
	return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}
static inline double ob_norm(ob_vec3 a)
{
	return sqrt(ob_dot(a, a));
}

static inline ob_quat ob_quat_identity(void)
{
	return (ob_quat){ 1, 0, 0, 0 };
}
static inline ob_quat ob_quat_mul(ob_quat a, ob_quat b)
{
	return (ob_quat){
		a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
		a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
		a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
		a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
	};
}
// The inverse rotation
static inline ob_quat ob_quat_conjugate(ob_quat q)
{
	return (ob_quat){ q.w, -q.x, -q.y, -q.z };
}
static inline ob_quat ob_quat_normalize(ob_quat q)
{
	double s = 1 / sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
	return (ob_quat){ q.w * s, q.x * s, q.y * s, q.z * s };
}
static inline ob_mat3 ob_quat_matrix(ob_quat q)
{
	double w = q.w, x = q.x, y = q.y, z = q.z;
	return (ob_mat3){ {
		{ 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y) },
		{ 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x) },
		{ 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y) },
	} };
}
// M v: body to world, M the matrix of a pose
static inline ob_vec3 ob_rotate(const ob_mat3 *r, ob_vec3 v)
{
	return ob_v3(r->m[0][0] * v.x + r->m[0][1] * v.y + r->m[0][2] * v.z,
		     r->m[1][0] * v.x + r->m[1][1] * v.y + r->m[1][2] * v.z,
		     r->m[2][0] * v.x + r->m[2][1] * v.y + r->m[2][2] * v.z);
}
// M^T v: world to body
static inline ob_vec3 ob_rotate_back(const ob_mat3 *r, ob_vec3 v)
{
	return ob_v3(r->m[0][0] * v.x + r->m[1][0] * v.y + r->m[2][0] * v.z,
		     r->m[0][1] * v.x + r->m[1][1] * v.y + r->m[2][1] * v.z,
		     r->m[0][2] * v.x + r->m[1][2] * v.y + r->m[2][2] * v.z);
}
// Column i: the body's axis i in world coordinates.
static inline ob_vec3 ob_column(const ob_mat3 *r, int i)
{
	return ob_v3(r->m[0][i], r->m[1][i], r->m[2][i]);
}

#pragma GCC visibility push(default) // libobsim exports the declarations of its installed headers alone

// q turned by the rotation vector th (rad, world frame): exp(th) q, normalised
ob_quat ob_quat_turn(ob_quat q, ob_vec3 th);

#pragma GCC visibility pop

#endif

// Rays against the shapes of objects, in closed form.
#include <math.h>

#include "motion/flight.h"
#include "script/runner.h"

// Object frame: the first t > 0 at which the ray enters, or infinity; and the normal there.
static double enter_sphere(ob_vec3 centre, double radius, ob_vec3 p, ob_vec3 d, ob_vec3 *n)
{
	const ob_vec3 m = ob_sub(p, centre);
	const double b = ob_dot(m, d), c = ob_norm2(m) - radius * radius, root = b * b - c;
	if (c <= 0 || root < 0 || b > 0)
		return INFINITY;
	const double t = -b - sqrt(root);
	*n = ob_scale(ob_madd(m, t, d), 1 / radius);
	return t;
}

static double enter_box(ob_vec3 half, ob_vec3 p, ob_vec3 d, ob_vec3 *n)
{
	const double h[] = { half.x, half.y, half.z }, at[] = { p.x, p.y, p.z }, to[] = { d.x, d.y, d.z };
	double first = -INFINITY, last = INFINITY;
	for (int i = 0; i < 3; i++) {
		double in = (-h[i] - at[i]) / to[i], out = (h[i] - at[i]) / to[i];
		if (to[i] == 0) {
			if (fabs(at[i]) > h[i])
				return INFINITY;
			continue;
		}
		const double sign = in < out ? -1 : 1, near = fmin(in, out);
		if (near > first) {
			first = near;
			*n = ob_v3(i == 0 ? sign : 0, i == 1 ? sign : 0, i == 2 ? sign : 0);
		}
		last = fmin(last, fmax(in, out));
	}
	return first > 0 && first <= last ? first : INFINITY;
}

// Wall of an upright cylinder.
static double enter_wall(double radius, double half, ob_vec3 p, ob_vec3 d, ob_vec3 *n)
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

static double enter_cap(double radius, double half, ob_vec3 p, ob_vec3 d, ob_vec3 *n)
{
	const double side = p.z > 0 ? 1 : -1;
	if (fabs(p.z) <= half || d.z * side >= 0)
		return INFINITY;
	const double t = (side * half - p.z) / d.z, x = p.x + t * d.x, y = p.y + t * d.y;
	if (x * x + y * y > radius * radius)
		return INFINITY;
	*n = ob_v3(0, 0, side);
	return t;
}

static double nearer(double t, double other, ob_vec3 *n, ob_vec3 other_n)
{
	if (!(other < t))
		return t;
	*n = other_n;
	return other;
}

static bool is_inside_capsule(double radius, double half, ob_vec3 p)
{
	const double z = fmax(0, fabs(p.z) - half);
	return p.x * p.x + p.y * p.y + z * z <= radius * radius;
}

static double enter(const ob_passport *o, ob_vec3 p, ob_vec3 d, ob_vec3 *n)
{
	const double r = o->size.x, half = o->size.y;
	ob_vec3 m = { 0 };
	double t;
	switch (o->shape) {
	case OB_SHAPE_SPHERE:
		return enter_sphere(m, r, p, d, n);
	case OB_SHAPE_BOX:
		return enter_box(o->size, p, d, n);
	case OB_SHAPE_PLANE:
		*n = ob_v3(0, 0, 1);
		return p.z > 0 && d.z < 0 ? -p.z / d.z : INFINITY;
	case OB_SHAPE_CAPSULE:
		if (is_inside_capsule(r, half, p))
			return INFINITY;
		t = enter_wall(r, half, p, d, n);
		for (int side = -1; side <= 1; side += 2)
			t = nearer(t, enter_sphere(ob_v3(0, 0, side * half), r, p, d, &m), n, m);
		return t;
	case OB_SHAPE_CYLINDER:
		t = enter_wall(r, half, p, d, n);
		return nearer(t, enter_cap(r, half, p, d, &m), n, m);
	default:
		return INFINITY;
	}
}

// True if the ray intersects the object's fat AABB.
static bool may_meet(const float *b, ob_vec3 p, ob_vec3 d, double length)
{
	const double at[] = { p.x, p.y, p.z }, to[] = { d.x, d.y, d.z };
	double first = 0, last = length;
	for (int i = 0; i < 3; i++) {
		if (to[i] == 0) {
			if (at[i] < b[i] || at[i] > b[i + 3])
				return false;
			continue;
		}
		const double x = (b[i] - at[i]) / to[i], y = (b[i + 3] - at[i]) / to[i];
		first = fmax(first, fmin(x, y));
		last = fmin(last, fmax(x, y));
	}
	return first <= last;
}

bool ob_ray_cast(lua_State *L, const ob_universe *u, ob_vec3 from, ob_vec3 direction, double length, uint32_t but,
		 ob_ray_hit *hit)
{
	enum { LOOKED_AT = 64, SHAPE = 8 }; // objects whose bounds are charged at once; instructions of a shape
	const ob_step_data *data = ob_universe_step_data(u);
	const double time = (double)ob_step_count(u) * ob_universe_settings(u)->step_length;
	*hit = (ob_ray_hit){ .distance = length };
	bool found = false;
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		if (id % LOOKED_AT == 0)
			ob_sandbox_spend(L, LOOKED_AT / 2);
		if (id == but || data->schedule[id].state == OB_SCHEDULE_ABSENT ||
		    !may_meet(data->bounds[id], from, direction, hit->distance))
			continue;
		ob_sandbox_spend(L, SHAPE);
		const ob_passport *o = ob_passport_of(u, id);
		const ob_state s = ob_published_at(ob_newest_motion(u, id), o, time);
		const ob_mat3 r = ob_quat_matrix(s.pose.q);
		ob_vec3 n = { 0 };
		const double t =
			enter(o, ob_rotate_back(&r, ob_sub(from, s.pose.p)), ob_rotate_back(&r, direction), &n);
		if (!(t < hit->distance)) // at equal distances the lower id
			continue;
		*hit = (ob_ray_hit){ id, t, ob_rotate(&r, n) };
		found = true;
	}
	return found;
}

#include "ode/ode_solid.h"

static double clamp(double x, double h)
{
	return fmin(fmax(x, -h), h);
}

static ob_vec3 into(const ob_ode_solid *s, ob_vec3 x)
{
	return ob_rotate_back(&s->r, ob_sub(x, s->p));
}

ob_ode_solid ob_ode_solid_make(ob_shape shape, ob_vec3 size, ob_pose pose)
{
	return (ob_ode_solid){ shape, size, pose.p, ob_quat_matrix(pose.q) };
}

ob_vec3 ob_ode_solid_inflate(ob_shape shape, ob_vec3 size, double m)
{
	switch (shape) {
	case OB_SHAPE_SPHERE:
	case OB_SHAPE_CAPSULE: // a capsule's core stays as long as it is
		return ob_v3(size.x + m, size.y, size.z);
	case OB_SHAPE_BOX:
		return ob_v3(size.x + m, size.y + m, size.z + m);
	case OB_SHAPE_CYLINDER:
		return ob_v3(size.x + m, size.y + m, size.z);
	case OB_SHAPE_PLANE:
	case OB_SHAPE_NONE:
		break;
	}
	return size;
}

double ob_ode_solid_radius(const ob_ode_solid *s)
{
	if (s->shape == OB_SHAPE_BOX)
		return ob_norm(s->size);
	if (s->shape == OB_SHAPE_CYLINDER)
		return hypot(s->size.x, s->size.y);
	return s->shape == OB_SHAPE_CAPSULE ? s->size.x + s->size.y : s->size.x;
}

double ob_ode_solid_height(const ob_ode_solid *s, ob_vec3 n, ob_vec3 x)
{
	ob_vec3 b = ob_rotate_back(&s->r, n), h = s->size;
	double extent = 0;
	switch (s->shape) {
	case OB_SHAPE_SPHERE:
		extent = h.x;
		break;
	case OB_SHAPE_BOX:
		extent = fabs(b.x) * h.x + fabs(b.y) * h.y + fabs(b.z) * h.z;
		break;
	case OB_SHAPE_CAPSULE:
		extent = h.x + fabs(b.z) * h.y;
		break;
	case OB_SHAPE_CYLINDER:
		extent = sqrt(b.x * b.x + b.y * b.y) * h.x + fabs(b.z) * h.y;
		break;
	case OB_SHAPE_PLANE: // along its own normal, the only direction that is asked for
	case OB_SHAPE_NONE:
		break;
	}
	return extent - ob_dot(n, ob_sub(x, s->p));
}

// The nearest point of a ball of radius r round c.
static ob_vec3 into_ball(ob_vec3 b, ob_vec3 c, double r)
{
	double distance = ob_norm(ob_sub(b, c));
	return distance > r ? ob_madd(c, r / distance, ob_sub(b, c)) : b;
}

ob_vec3 ob_ode_solid_nearest(const ob_ode_solid *s, ob_vec3 x)
{
	ob_vec3 b = into(s, x), h = s->size;
	double across = sqrt(b.x * b.x + b.y * b.y);
	switch (s->shape) {
	case OB_SHAPE_SPHERE:
		b = into_ball(b, ob_v3(0, 0, 0), h.x);
		break;
	case OB_SHAPE_CAPSULE:
		b = into_ball(b, ob_v3(0, 0, clamp(b.z, h.y)), h.x);
		break;
	case OB_SHAPE_BOX:
		b = ob_v3(clamp(b.x, h.x), clamp(b.y, h.y), clamp(b.z, h.z));
		break;
	case OB_SHAPE_PLANE:
		b.z = fmin(b.z, 0);
		break;
	case OB_SHAPE_CYLINDER:
		if (across > h.x)
			b = ob_v3(b.x * h.x / across, b.y * h.x / across, b.z);
		b.z = clamp(b.z, h.y);
		break;
	case OB_SHAPE_NONE:
		break;
	}
	return ob_add(s->p, ob_rotate(&s->r, b));
}

double ob_ode_solid_growth(const ob_ode_solid *s, ob_vec3 n, double m)
{
	ob_vec3 b = ob_rotate_back(&s->r, n);
	if (s->shape == OB_SHAPE_BOX)
		return m * (fabs(b.x) + fabs(b.y) + fabs(b.z));
	if (s->shape == OB_SHAPE_CYLINDER)
		return m * (sqrt(b.x * b.x + b.y * b.y) + fabs(b.z));
	return m;
}

static bool clip_slab(double x, double u, double h, double *from, double *to)
{
	if (fabs(u) < 1e-12)
		return fabs(x) <= h;
	double one = (-h - x) / u, other = (h - x) / u;
	*from = fmax(*from, fmin(one, other));
	*to = fmin(*to, fmax(one, other));
	return *from <= *to;
}

static bool clip_disc(ob_vec3 x, ob_vec3 u, double radius, double *from, double *to)
{
	double a = u.x * u.x + u.y * u.y, b = x.x * u.x + x.y * u.y, c = x.x * x.x + x.y * x.y - radius * radius;
	double root2 = b * b - a * c;
	if (a < 1e-12 || root2 < 0)
		return c <= 0;
	*from = fmax(*from, (-b - sqrt(root2)) / a);
	*to = fmin(*to, (-b + sqrt(root2)) / a);
	return *from <= *to;
}

bool ob_ode_solid_clip(const ob_ode_solid *s, ob_vec3 n, ob_vec3 x, ob_vec3 u, double *from, double *to)
{
	ob_vec3 m = ob_rotate_back(&s->r, n), h = s->size;
	x = into(s, x);
	u = ob_rotate_back(&s->r, u);
	if (s->shape == OB_SHAPE_CYLINDER)
		return fabs(m.z) > .7 ? clip_disc(x, u, h.x, from, to) : clip_slab(x.z, u.z, h.y, from, to);
	if (s->shape == OB_SHAPE_CAPSULE)
		return clip_slab(x.z, u.z, h.y, from, to);
	if (s->shape != OB_SHAPE_BOX)
		return true;
	double mx = fabs(m.x), my = fabs(m.y), mz = fabs(m.z), largest = fmax(fmax(mx, my), mz);
	return (mx == largest || clip_slab(x.x, u.x, h.x, from, to)) &&
	       (my == largest || clip_slab(x.y, u.y, h.y, from, to)) &&
	       (mz == largest || clip_slab(x.z, u.z, h.z, from, to));
}

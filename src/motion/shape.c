#include <ob/motion.h>

#include <float.h>

// Half extents of the axis-aligned bounding box of a shape at attitude q.
static ob_vec3 half_extents(ob_shape shape, ob_vec3 size, ob_quat q)
{
	double half[3] = { 0 };
	ob_mat3 r = ob_quat_matrix(q);
	for (int i = 0; i < 3; i++) {
		const double *m = r.m[i];
		switch (shape) {
		case OB_SHAPE_NONE:
			break;
		case OB_SHAPE_SPHERE:
		case OB_SHAPE_HULL: // bounding ball: ob_hull_bounds is tight
			half[i] = size.x;
			break;
		case OB_SHAPE_BOX:
			half[i] = fabs(m[0]) * size.x + fabs(m[1]) * size.y + fabs(m[2]) * size.z;
			break;
		case OB_SHAPE_PLANE:
			half[i] = INFINITY;
			break;
		case OB_SHAPE_CAPSULE:
			half[i] = size.x + fabs(m[2]) * size.y;
			break;
		case OB_SHAPE_CYLINDER: // extent of a disc: by how much its plane leans towards the axis
			half[i] = size.x * sqrt(m[0] * m[0] + m[1] * m[1]) + fabs(m[2]) * size.y;
			break;
		}
	}
	return ob_v3(half[0], half[1], half[2]);
}

void ob_shape_bounds(ob_shape shape, ob_vec3 size, ob_pose pose, double bounds[6])
{
	ob_vec3 half = half_extents(shape, size, pose.q), low = ob_sub(pose.p, half), high = ob_add(pose.p, half);
	bounds[0] = low.x;
	bounds[1] = low.y;
	bounds[2] = low.z;
	bounds[3] = high.x;
	bounds[4] = high.y;
	bounds[5] = high.z;
}

const char *ob_shape_name(ob_shape shape)
{
	static const char *const names[] = {
		[OB_SHAPE_NONE] = "",       [OB_SHAPE_SPHERE] = "sphere",   [OB_SHAPE_BOX] = "box",
		[OB_SHAPE_PLANE] = "plane", [OB_SHAPE_CAPSULE] = "capsule", [OB_SHAPE_CYLINDER] = "cylinder",
		[OB_SHAPE_HULL] = "hull",
	};
	return (size_t)shape < sizeof names / sizeof *names ? names[shape] : "";
}

double ob_shape_radius(ob_shape shape, ob_vec3 size)
{
	switch (shape) {
	case OB_SHAPE_NONE:
		return 0;
	case OB_SHAPE_SPHERE:
	case OB_SHAPE_HULL:
		return size.x;
	case OB_SHAPE_BOX:
		return ob_norm(size);
	case OB_SHAPE_PLANE:
		return INFINITY;
	case OB_SHAPE_CAPSULE:
		return size.x + size.y;
	case OB_SHAPE_CYLINDER:
		return sqrt(size.x * size.x + size.y * size.y);
	}
	return 0;
}

double ob_shape_thickness(ob_shape shape, ob_vec3 size)
{
	switch (shape) {
	case OB_SHAPE_NONE:
		return 0;
	case OB_SHAPE_SPHERE:
	case OB_SHAPE_CAPSULE:
		return 2 * size.x;
	case OB_SHAPE_BOX:
		return 2 * ob_min(size.x, ob_min(size.y, size.z));
	case OB_SHAPE_PLANE:
		return INFINITY;
	case OB_SHAPE_CYLINDER:
		return 2 * ob_min(size.x, size.y);
	case OB_SHAPE_HULL:
		return 2 * size.y;
	}
	return 0;
}

// p + v t + a t^2 / 2, also for infinite t
static double height(double p, double v, double a, double t)
{
	if (isfinite(t))
		return p + v * t + .5 * a * t * t;
	return a != 0 ? copysign(INFINITY, a) : v != 0 ? copysign(INFINITY, v * t) : p;
}

// Extremes of the parabola over [t0, t0 + s], widened by half and by possible rounding errors, also of the instant.
static void sweep(double p, double v, double a, double t0, double s, double half, double *low, double *high)
{
	double end = height(p, v, a, s), turn = a != 0 ? -v / a : 0, slack = 0;
	*low = ob_min(p, end);
	*high = ob_max(p, end);
	if (turn * (turn - s) < 0) { // the vertex lies between
		double top = height(p, v, a, turn);
		*low = ob_min(*low, top);
		*high = ob_max(*high, top);
	}
	if (isfinite(s))
		slack = 4 * DBL_EPSILON * (fabs(p) + half + (fabs(v) + fabs(a * s)) * (fabs(t0) + fabs(s)));
	*low -= half + slack;
	*high += half + slack;
}

// Extremes of the whole ellipse with frequency f, widened as those of the parabola.
static void surround(double p, double v, double a, double f, double half, double *low, double *high)
{
	const double centre = p + a / (f * f), sine = v / f, cosine = a / (f * f),
		     amplitude = sqrt(sine * sine + cosine * cosine),
		     most = amplitude + half + 8 * DBL_EPSILON * (fabs(p) + half + amplitude);
	*low = centre - most;
	*high = centre + most;
}

void ob_motion_swept_bounds(const ob_motion *m, ob_shape shape, ob_vec3 size, double s, double bounds[6])
{
	ob_vec3 half = half_extents(shape, size, m->q);
	if (ob_norm2(m->w) > 0) {
		double radius = ob_shape_radius(shape, size);
		half = ob_v3(radius, radius, radius);
	}
	if (m->flags & OB_MOTION_SWINGS) {
		surround(m->p.x, m->v.x, m->a.x, m->frequency, half.x, &bounds[0], &bounds[3]);
		surround(m->p.y, m->v.y, m->a.y, m->frequency, half.y, &bounds[1], &bounds[4]);
		surround(m->p.z, m->v.z, m->a.z, m->frequency, half.z, &bounds[2], &bounds[5]);
		return;
	}
	sweep(m->p.x, m->v.x, m->a.x, m->t0, s, half.x, &bounds[0], &bounds[3]);
	sweep(m->p.y, m->v.y, m->a.y, m->t0, s, half.y, &bounds[1], &bounds[4]);
	sweep(m->p.z, m->v.z, m->a.z, m->t0, s, half.z, &bounds[2], &bounds[5]);
}

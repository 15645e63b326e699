#include <ob/motion.h>

#include <float.h>

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
	double still[6];
	ob_shape_bounds(shape, size, (ob_pose){ { 0, 0, 0 }, m->q }, still);
	ob_vec3 half = { still[3], still[4], still[5] };
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

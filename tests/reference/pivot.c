#include "reference/pivot.h"

#include <math.h>

#include "reference/integrator.h"

// ---- rocking: angle'^2 / 2 = c (k - cos(alpha - angle)), where c = g R / (moment + R^2)

typedef struct swing {
	double alpha, c, k, from;
} swing;

// Substitutes angle = from (1 - s^2): the rate vanishes like s at a start from rest.
static double time_element(double s, const void *with)
{
	const swing *w = with;
	double angle = w->from * (1 - s * s);
	return 2 * s * w->from / sqrt(2 * w->c * (w->k - cos(w->alpha - angle)));
}

double ob_reference_rocker_time(const ob_reference_rocker *r, double angle, double w)
{
	double arm = hypot(r->half, r->height);
	swing s = { .alpha = atan2(r->half, r->height), .c = r->g * arm / (r->moment + arm * arm), .from = angle };
	s.k = cos(s.alpha - angle) + .5 * w * w / s.c;
	return ob_reference_quadrature(time_element, &s, 0, 1, 64);
}

double ob_reference_rocker_ratio(const ob_reference_rocker *r)
{
	double b2 = r->half * r->half, h2 = r->height * r->height;
	return (r->moment + h2 - b2) / (r->moment + h2 + b2);
}

// ---- toppling

typedef struct toppling {
	double beyond, height, inertia, g;
} toppling;

static void topple_rate(const double *y, double *rate, const void *with)
{
	const toppling *p = with;
	rate[0] = y[1];
	rate[1] = p->g * (p->beyond * cos(y[0]) + p->height * sin(y[0])) / p->inertia;
}

double ob_reference_topple(double beyond, double height, double moment, double g, double t)
{
	toppling p = { beyond, height, moment + beyond * beyond + height * height, g };
	ob_reference_system s = { .states = 2, .rate = topple_rate, .with = &p, .tolerance = 1e-13 };
	double y[2] = { 0, 0 };
	ob_reference_integrate(&s, t, y);
	return y[0];
}

// ---- a disk on its rim

double ob_reference_disk_precession(double a, double h, double tilt, double g)
{
	double across = a * a / 4 + h * h / 3, along = a * a / 2, s = sin(tilt), c = cos(tilt);
	return sqrt(g * (a * c - h * s) / (s * (across * c - along * h / a * s)));
}

double ob_reference_disk_spin(double a, double h, double tilt, double g)
{
	return ob_reference_disk_precession(a, h, tilt, g) * (h / a * sin(tilt) - cos(tilt));
}

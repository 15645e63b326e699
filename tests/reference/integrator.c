#include "reference/integrator.h"

#include <math.h>
#include <string.h>

enum { STAGES = 7, STEPS = 1000000 };

// Dormand and Prince's tableau: the last stage is the solution of order 5; "error" is its difference from the solution
// of order 4.
static const double tableau[STAGES][STAGES - 1] = {
	{ 0 },
	{ 1. / 5 },
	{ 3. / 40, 9. / 40 },
	{ 44. / 45, -56. / 15, 32. / 9 },
	{ 19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729 },
	{ 9017. / 3168, -355. / 33, 46732. / 5247, 49. / 176, -5103. / 18656 },
	{ 35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84 },
};
static const double error_weight[STAGES] = { 71. / 57600,      0,          -71. / 16695, 71. / 1920,
					     -17253. / 339200, 22. / 525., -1. / 40 };

// One step of length h: fills next[]; returns the largest ratio of a component's error to the tolerance.
static double try_step(const ob_reference_system *s, double h, const double *y, double *next)
{
	double rate[STAGES][OB_REFERENCE_STATES], worst = 0;
	for (int stage = 0; stage < STAGES; stage++) {
		memcpy(next, y, s->states * sizeof *y);
		for (int of = 0; of < stage; of++)
			for (size_t i = 0; i < s->states; i++)
				next[i] += h * tableau[stage][of] * rate[of][i];
		s->rate(next, rate[stage], s->with);
	}
	for (size_t i = 0; i < s->states; i++) {
		double error = 0;
		for (int stage = 0; stage < STAGES; stage++)
			error += h * error_weight[stage] * rate[stage][i];
		worst = fmax(worst, fabs(error) / s->tolerance);
	}
	return worst;
}

double ob_reference_integrate(const ob_reference_system *s, double until, double *y)
{
	double t = 0, h = 1e-3 * until, next[OB_REFERENCE_STATES];
	for (int step = 0; step < STEPS && t < until && !(s->ends && s->ends(y, s->with)); step++) {
		bool last = t + h >= until;
		double length = last ? until - t : h, worst = try_step(s, length, y, next);
		if (worst <= 1) {
			memcpy(y, next, s->states * sizeof *y);
			t = last ? until : t + length;
		}
		h = length * fmin(5, fmax(.2, .9 * pow(fmax(worst, 1e-10), -.2)));
		if (h < 1e-12 * until)
			break;
	}
	return t;
}

const double ob_reference_gauss_node[OB_REFERENCE_GAUSS] = { -.96028985649753623168, -.79666647741362673959,
							     -.52553240991632898582, -.18343464249564980494,
							     .18343464249564980494,  .52553240991632898582,
							     .79666647741362673959,  .96028985649753623168 };
const double ob_reference_gauss_weight[OB_REFERENCE_GAUSS] = { .10122853629037625915, .22238103445337447054,
							       .31370664587788728734, .36268378337836198297,
							       .36268378337836198297, .31370664587788728734,
							       .22238103445337447054, .10122853629037625915 };

double ob_reference_quadrature(double (*f)(double x, const void *with), const void *with, double a, double b, int n)
{
	double sum = 0, half = .5 * (b - a) / n;
	for (int part = 0; part < n; part++)
		for (int i = 0; i < OB_REFERENCE_GAUSS; i++)
			sum += ob_reference_gauss_weight[i] *
			       f(a + half * (2 * part + 1 + ob_reference_gauss_node[i]), with);
	return half * sum;
}

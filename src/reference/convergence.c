#include "reference/convergence.h"

#include <math.h>

// (h1^p - h2^p) / (h2^p - h3^p) grows with p: by bisection.
static double order_of(double h1, double h2, double h3, double ratio)
{
	double low = 1e-3, high = 64;
	for (int i = 0; i < 100; i++) {
		double p = .5 * (low + high), a = pow(h1 / h2, p), b = pow(h3 / h2, p);
		if ((a - 1) / (1 - b) < ratio)
			low = p;
		else
			high = p;
	}
	return .5 * (low + high);
}

ob_convergence ob_reference_converge(size_t n, const double *h, const double *value)
{
	ob_convergence c = { NAN, NAN, NAN, NAN, false };
	if (n < 3)
		return c;
	const double *at = h + n - 3, *y = value + n - 3;
	double ratio = (y[0] - y[1]) / (y[1] - y[2]);
	c.limit = y[2];
	c.error = c.agreement = fabs(y[1] - y[2]);
	if (!(ratio > 0) || isinf(ratio))
		return c;
	double order = order_of(at[0], at[1], at[2], ratio);
	if (order < .25 || order > 12)
		return c;
	c.order = order;
	c.limit = y[2] + (y[2] - y[1]) / (pow(at[1] / at[2], order) - 1);
	c.error = fabs(c.limit - y[2]);
	c.valid = true;
	return c;
}

bool ob_reference_serves(size_t n, const double *value, double error)
{
	return n >= 2 && fabs(value[n - 1] - value[n - 2]) <= .1 * error;
}

double ob_reference_order(size_t n, const double *h, const double *error, double floor)
{
	double points = 0, x = 0, y = 0, xx = 0, xy = 0;
	for (size_t i = 0; i < n; i++) {
		if (!(error[i] > floor) || !isfinite(error[i]))
			continue;
		double lh = log(h[i]), le = log(error[i]);
		points++;
		x += lh;
		y += le;
		xx += lh * lh;
		xy += lh * le;
	}
	return points < 2 ? NAN : (points * xy - x * y) / (points * xx - x * x);
}

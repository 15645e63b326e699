#include "reference/line.h"

#include <math.h>

#include "reference/statistics.h"

static const double confidence = .95;

ob_line ob_reference_line(size_t n, const double *x, const double *y)
{
	ob_line l = { n, NAN, NAN, NAN, NAN, NAN, NAN };
	double mean_x = 0, mean_y = 0, xx = 0, xy = 0, squares = 0;
	if (n < 2)
		return l;
	for (size_t i = 0; i < n; i++) {
		mean_x += x[i] / (double)n;
		mean_y += y[i] / (double)n;
	}
	for (size_t i = 0; i < n; i++) {
		xx += (x[i] - mean_x) * (x[i] - mean_x);
		xy += (x[i] - mean_x) * (y[i] - mean_y);
	}
	if (!(xx > 0))
		return l;
	l.mean_y = mean_y;
	l.slope = xy / xx;
	l.intercept = mean_y - l.slope * mean_x;
	for (size_t i = 0; i < n; i++)
		squares += pow(y[i] - l.intercept - l.slope * x[i], 2);
	l.squares = squares;
	if (n < 3)
		return l;
	double half = ob_reference_student((int)n - 2, confidence) * sqrt(squares / (double)(n - 2) / xx);
	l.slope_low = l.slope - half;
	l.slope_high = l.slope + half;
	return l;
}

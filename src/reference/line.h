// A straight line through points, by least squares. Pure functions, thread-safe.
#ifndef OB_REFERENCE_LINE_H
#define OB_REFERENCE_LINE_H

#include <stddef.h>

typedef struct ob_line {
	size_t n;
	double slope, intercept;
	double slope_low, slope_high; // 95 %, Student's t with n - 2 degrees of freedom; NAN for n < 3
	double squares; // what is left over: the sum of the squared distances in y
	double mean_y;
} ob_line;

// NAN everywhere for n < 2, or where all x are the same. (Gauss 1809; the interval as in Draper and Smith 1966.)
ob_line ob_reference_line(size_t n, const double *x, const double *y);

#endif

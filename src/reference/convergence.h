// Self-convergence: what a sequence of runs with ever smaller steps says about its own limit and error. Pure
// functions, thread-safe.
#ifndef OB_REFERENCE_CONVERGENCE_H
#define OB_REFERENCE_CONVERGENCE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct ob_convergence {
	double order; // observed: the error falls as h^order; NAN where the differences do not shrink
	double limit; // extrapolated to h = 0; the finest value where the order is NAN
	double error; // of the finest value against the limit
	double agreement; // difference of the two finest values: the smallest error that can be told by them
	bool valid; // the last differences shrink, at an order between 1/4 and 12
} ob_convergence;

// n >= 3 values at steps h, strictly falling. The order from the three finest, for any ratio of the steps; the limit by
// Richardson's extrapolation (Richardson 1911, Phil. Trans. R. Soc. A 210, 307).
ob_convergence ob_reference_converge(size_t n, const double *h, const double *value);

// May the finest value of such a sequence serve as the reference of an error this large? Its two finest agree ten times
// below it.
bool ob_reference_serves(size_t n, const double *value, double error);

// Order at which errors against a known reference fall: the slope of log error over log h, by least squares over the
// points with error > floor (where rounding rules the order means nothing). NAN with less than two of them.
double ob_reference_order(size_t n, const double *h, const double *error, double floor);

#endif

// Ordinary differential equations with error control, for references without a closed form. Pure functions,
// thread-safe.
#ifndef OB_REFERENCE_INTEGRATOR_H
#define OB_REFERENCE_INTEGRATOR_H

#include <stdbool.h>
#include <stddef.h>

enum { OB_REFERENCE_STATES = 8 };

typedef struct ob_reference_system {
	size_t states; // at most OB_REFERENCE_STATES
	void (*rate)(const double *y, double *rate, const void *with); // dy/dt, of an autonomous system
	bool (*ends)(const double *y, const void *with); // there is no more to integrate; NULL = never
	const void *with;
	double tolerance; // of each component, per step, in its unit
} ob_reference_system;

// Takes y from t = 0 to "until", or to where it ends, and returns that time: the pair of orders 5 and 4 of Dormand and
// Prince (1980, J. Comp. Appl. Math. 6, 19) with steps as long as the tolerance allows. It ends, too, where a step
// would be shorter than 1e-12 of the interval.
double ob_reference_integrate(const ob_reference_system *s, double until, double *y);

// The integral of f over [a, b] by Gauss and Legendre's rule of eight points on each of n equal parts.
double ob_reference_quadrature(double (*f)(double x, const void *with), const void *with, double a, double b, int n);

enum { OB_REFERENCE_GAUSS = 8 };
extern const double ob_reference_gauss_node[OB_REFERENCE_GAUSS]; // on [-1, 1]
extern const double ob_reference_gauss_weight[OB_REFERENCE_GAUSS]; // their sum is 2

#endif

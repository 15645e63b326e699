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
	bool (*ends)(const double *y, const void *with); // the integration is complete; NULL = never
	const void *with;
	double tolerance; // per component and step, in its unit
} ob_reference_system;

// Integrates y from t = 0 to "until", or to its end, and returns that time. Uses the pair of orders 5 and 4 of Dormand
// and Prince (1980, J. Comp. Appl. Math. 6, 19), with steps as long as the tolerance allows. It also ends before a step
// shorter than 1e-12 of the interval.
double ob_reference_integrate(const ob_reference_system *s, double until, double *y);

// Integral of f over [a, b] by Gauss and Legendre's rule of eight points on each of n equal parts.
double ob_reference_quadrature(double (*f)(double x, const void *with), const void *with, double a, double b, int n);

enum { OB_REFERENCE_GAUSS = 8 };
extern const double ob_reference_gauss_node[OB_REFERENCE_GAUSS]; // on [-1, 1]
extern const double ob_reference_gauss_weight[OB_REFERENCE_GAUSS]; // their sum is 2

#endif

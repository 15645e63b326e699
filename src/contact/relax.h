// Projected Gauss-Seidel steps on a small dense system, as impacts take them: impulses x, and the rates of all rows that
// they leave. The matrix lies row by row, so many doubles to a row as there are rows.
#ifndef OB_CONTACT_RELAX_H
#define OB_CONTACT_RELAX_H

#include <math.h>

// Sets one impulse; returns how much that changes its row's velocity (m/s).
static inline double ob_relax_set(const double *a, int rows, int i, double next, double *x, double *rate)
{
	double dx = next - x[i];
	x[i] = next;
	for (int j = 0; j < rows; j++)
		rate[j] += a[j * rows + i] * dx;
	return fabs(dx) * a[i * rows + i];
}

// Friction, rows i and i + 1, projected onto the disc of radius bound (N s); returns the larger change (m/s).
static inline double ob_relax_friction(const double *a, int rows, int i, double bound, double *x, double *rate)
{
	double f1 = x[i] - rate[i] / a[i * rows + i], f2 = x[i + 1] - rate[i + 1] / a[(i + 1) * rows + i + 1];
	double l2 = f1 * f1 + f2 * f2, shrink = l2 > bound * bound ? bound / sqrt(l2) : 1;
	double change = ob_relax_set(a, rows, i, f1 * shrink, x, rate);
	return fmax(change, ob_relax_set(a, rows, i + 1, f2 * shrink, x, rate));
}

#endif

#include "motion/jacobi.h"

#include <math.h>

#include "elementary/elementary.h"

enum { MEAN_STEPS = 12 }; // from b = 1e-300 the mean converges in 10

// One step of Gauss; 0 when a and b agree to the last digits.
static int mean_step(double *a, double *b)
{
	double next = .5 * (*a + *b), apart = fabs(*a - *b);
	*b = sqrt(*a * *b);
	*a = next;
	return apart > 2e-16 * next;
}

// Landen's ascending transformation (Abramowitz and Stegun 1964, 17.6.8): tan(phi' - phi) = (b / a) tan(phi). The
// angle is kept as half turns and a direction with x >= 0, which needs no tangent to be finite.
double ob_jacobi_phase(double x, double y, double kc, double *mean)
{
	double a = 1, b = kc, half_turns = 0, scale = 1;
	if (x < 0) {
		x = -x;
		y = -y;
		half_turns = 1;
	}
	for (int i = 0, on = 1; i < MEAN_STEPS && on; i++) {
		double r = b / a, c = x * x - r * y * y, s = (1 + r) * x * y;
		half_turns *= 2;
		if (c < 0) {
			half_turns += y < 0 ? -1 : 1;
			c = -c;
			s = -s;
		}
		double size = c + fabs(s); // x and y shrink by r: keep them in range
		x = c / size;
		y = s / size;
		scale *= .5;
		on = mean_step(&a, &b);
	}
	*mean = a;
	return (half_turns * M_PI + ob_atan2(y, x)) * scale;
}

void ob_theta_plan(ob_theta *t, double nome, double alpha)
{
	const double less = -ob_expm1(-2 * alpha), small = 1 - less; // small = exp(-2 alpha), less to the last digits
	const double c = .5 * (1 / small + small), s = .5 * less * (1 + small) / small, square = nome * nome;
	double power = square;
	t->real[0] = 1;
	t->even[0] = 1 + small;
	t->odd[0] = less;
	int n = 1;
	for (; n < OB_THETA_TERMS; n++) { // power = q^(2 n)
		t->real[n] = power * t->real[n - 1];
		t->even[n] = power * (c * t->even[n - 1] + s * t->odd[n - 1]);
		t->odd[n] = power * (c * t->odd[n - 1] + s * t->even[n - 1]);
		if (!(t->even[n] > 1e-18))
			break;
		power *= square;
	}
	t->terms = n;
}

ob_theta_value ob_theta_at(const ob_theta *t, double s, double c)
{
	double sign = 1;
	double c2 = c * c - s * s, s2 = 2 * s * c; // of 2 v: each term turns by it
	ob_theta_value sum = { 0 };
	for (int n = 0; n < t->terms; n++) {
		sum.theta1 += sign * t->real[n] * s;
		sum.theta2 += t->real[n] * c;
		sum.re += sign * t->even[n] * s;
		sum.im += sign * t->odd[n] * c;
		double next = s * c2 + c * s2;
		c = c * c2 - s * s2;
		s = next;
		sign = -sign;
	}
	return sum;
}

double ob_theta_slope(const ob_theta *t)
{
	double up = 0, down = 0;
	for (int n = t->terms - 1; n >= 0; n--) {
		up += (2 * n + 1) * t->odd[n];
		down += t->even[n];
	}
	return up / down;
}

// Elliptic integrals by the arithmetic-geometric mean, and the theta series of Jacobi (Fundamenta Nova, 1829).
// Pure functions, thread-safe.
#ifndef OB_MOTION_JACOBI_H
#define OB_MOTION_JACOBI_H

enum { OB_THETA_TERMS = 20 }; // enough for a complementary modulus down to 1e-16, where the nome is .88

// The series of theta_1 and theta_2 at v and of theta_1 at v + i alpha, with their common factor 2 q^(1/4) left out
// (and e^alpha / 2 more for the complex one): every use takes ratios or directions only.
typedef struct ob_theta {
	int terms;
	double real[OB_THETA_TERMS]; // q^(n (n + 1))
	double even[OB_THETA_TERMS]; // q^(n (n + 1)) 2 cosh((2 n + 1) alpha) e^-alpha
	double odd[OB_THETA_TERMS]; // q^(n (n + 1)) 2 sinh((2 n + 1) alpha) e^-alpha
} ob_theta;

typedef struct ob_theta_value {
	double theta1, theta2; // at v
	double re, im; // theta_1 at v + i alpha
} ob_theta_value;

// Incomplete integral F(phi, k) for the angle phi of the direction (x, y), as the phase F M(1, k') = pi F / (2 K):
// phi = pi / 2 gives pi / 2. kc = k' = sqrt(1 - k^2) > 0. The phase lies in [-pi / 2, 3 pi / 2]. mean: M(1, k'), the
// arithmetic-geometric mean that it comes by, with which K(k) = pi / (2 M(1, k')).
double ob_jacobi_phase(double x, double y, double kc, double *mean);

// nome in [0, .9], alpha in [0, -log(nome) / 2]
void ob_theta_plan(ob_theta *t, double nome, double alpha);
// sine, cosine: of v
ob_theta_value ob_theta_at(const ob_theta *t, double sine, double cosine);
// d/dalpha log theta_2(i alpha): a sum of positive terms, so exact to the last digits
double ob_theta_slope(const ob_theta *t);

#endif

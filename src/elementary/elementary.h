// Elementary functions that give the same bits on every processor, with any C library and any compiler: they are made
// of additions, multiplications, divisions and square roots alone, which IEEE 754 rounds exactly, in an order that
// -ffp-contract=off keeps. A C library's own do not: glibc takes fused operations where the processor has them, and the
// last bit is another one then. Whatever enters the state calls these; tests/elementary/ reads from the built modules
// that it does. (sqrt, fma, floor, fmod, ldexp and the like are exact in every library.)
//
// Errors are those of the result before it is rounded to a double, plus that: below .51 units in the last place for
// exp, log, log2, log10, pow, atan2, asin and acos, below .8 for sin and cos, 1.1 for tan and expm1, 2.5 for
// sinh, cosh and tanh, over all of the range (tests/elementary/test_accuracy.c compares with MPFR), in the default
// rounding mode. What is not finite, zeros and their signs are as annex F of C17 has them; floating-point exceptions
// and errno are not.
//
// Sources: Muller, "Elementary Functions" (3rd ed., 2016); Cody and Waite, "Software Manual for the Elementary
// Functions" (1980), for reductions in parts; Payne and Hanek, SIGNUM Newsletter 18 (1983), for large angles; Tang, ACM
// TOMS 15 (1989) and 16 (1990), for exp and log by tables; Dekker, Numer. Math. 18 (1971), for pairs of doubles.
// Polynomials are minimax ones with double coefficients, found by Sollya's fpminimax (Brisebarre and Chevillard, ARITH
// 2007).
//
// Pure functions, thread-safe. Angles in radians.
#ifndef OB_ELEMENTARY_ELEMENTARY_H
#define OB_ELEMENTARY_ELEMENTARY_H

double ob_sin(double x);
double ob_cos(double x);
double ob_tan(double x);
// The bits of ob_sin and ob_cos, for one reduction
void ob_sincos(double x, double *sine, double *cosine);
// The same of two angles, which takes little longer than of one
void ob_sincos_of_two(const double x[2], double sine[2], double cosine[2]);

double ob_asin(double x);
double ob_acos(double x);
double ob_atan2(double y, double x);

double ob_exp(double x);
double ob_expm1(double x);
double ob_sinh(double x);
double ob_cosh(double x);
double ob_tanh(double x);

double ob_log(double x);
double ob_log2(double x);
double ob_log10(double x);
double ob_pow(double x, double y);

#endif

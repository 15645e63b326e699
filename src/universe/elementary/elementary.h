// Elementary functions with the same bits on every processor, with any C library and any compiler. They consist of
// additions, multiplications, divisions and square roots alone, which IEEE 754 rounds exactly; -ffp-contract=off keeps
// their order. A C library's own functions differ: glibc uses fused operations if the processor has them, which changes
// the last bit. All code that computes state calls these; tests/elementary/ checks the built modules for it. (sqrt,
// fma, floor, fmod, ldexp and the like are exact in every library.)
//
// Errors are bounded in units in the last place, over the whole range, in the default rounding mode.
// exp, log, log2, log10, pow, atan2, asin and acos: below .51.
// hypot: below 1.
// sin and cos: below .8.
// tan and expm1: below 1.1.
// sinh, cosh and tanh: below 2.5.
// tests/elementary/test_accuracy.c compares with MPFR. Infinities, NaN, zeros and their signs follow annex F of C17;
// floating-point exceptions and errno do not.
//
// Sources: Muller, "Elementary Functions" (3rd ed., 2016); Cody and Waite, "Software Manual for the Elementary
// Functions" (1980), for reductions in parts; Payne and Hanek, SIGNUM Newsletter 18 (1983), for large angles; Tang, ACM
// TOMS 15 (1989) and 16 (1990), for exp and log by tables; Dekker, Numer. Math. 18 (1971), for pairs of doubles.
// Polynomials are minimax ones with double coefficients, found by Sollya's fpminimax (Brisebarre and Chevillard, ARITH
// 2007). hypot: Borges, "An Improved Algorithm for hypot(a,b)" (ACM TOMS 46, 2020), which glibc has, too.
//
// Pure functions, thread-safe. Angles in radians.
#ifndef OB_ELEMENTARY_ELEMENTARY_H
#define OB_ELEMENTARY_ELEMENTARY_H

double ob_sin(double x);
double ob_cos(double x);
double ob_tan(double x);
// Sine and cosine by one reduction, with the bits of ob_sin and ob_cos.
void ob_sincos(double x, double *sine, double *cosine);
// Same for two angles; takes little longer than for one.
void ob_sincos_of_two(const double x[2], double sine[2], double cosine[2]);

double ob_asin(double x);
double ob_acos(double x);
double ob_atan2(double y, double x);
double ob_hypot(double x, double y);

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

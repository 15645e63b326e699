// The C library's names for these functions. A program linked with this file defines them itself, and the dynamic
// linker prefers a program's definitions to a library's. So Lua (math.sin, x ^ y), ODE and qhull, which call these
// names, get the same bits on every processor, too. tests/elementary/ compares their imports with this file.
#include <math.h>

#include "elementary/elementary.h"

#pragma GCC visibility push(default)

double sin(double x)
{
	return ob_sin(x);
}
double cos(double x)
{
	return ob_cos(x);
}
void sincos(double x, double *sine, double *cosine)
{
	ob_sincos(x, sine, cosine);
}
double tan(double x)
{
	return ob_tan(x);
}
double asin(double x)
{
	return ob_asin(x);
}
double acos(double x)
{
	return ob_acos(x);
}
float asinf(float x)
{
	return (float)ob_asin(x);
}
float acosf(float x)
{
	return (float)ob_acos(x);
}
double atan2(double y, double x)
{
	return ob_atan2(y, x);
}
double exp(double x)
{
	return ob_exp(x);
}
double sinh(double x)
{
	return ob_sinh(x);
}
double cosh(double x)
{
	return ob_cosh(x);
}
double tanh(double x)
{
	return ob_tanh(x);
}
double log(double x)
{
	return ob_log(x);
}
double log2(double x)
{
	return ob_log2(x);
}
double log10(double x)
{
	return ob_log10(x);
}
double pow(double x, double y)
{
	return ob_pow(x, y);
}

#pragma GCC visibility pop

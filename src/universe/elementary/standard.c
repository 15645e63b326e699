// The C library's names for these functions. A program linked with this file defines them itself, and the dynamic
// linker prefers a program's definitions to a library's. So Lua (math.sin, x ^ y), ODE and qhull, which call these
// names, get the same bits on every processor, too. tests/elementary/ compares their imports with this file.
#include <math.h>

#include "elementary/elementary.h"

#pragma GCC visibility push(default)

#define OF_ONE(name) \
	double name(double x) \
	{ \
		return ob_##name(x); \
	}
OF_ONE(sin)
OF_ONE(cos)
OF_ONE(tan)
OF_ONE(asin)
OF_ONE(acos)
OF_ONE(exp)
OF_ONE(sinh)
OF_ONE(cosh)
OF_ONE(tanh)
OF_ONE(log)
OF_ONE(log2)
OF_ONE(log10)
void sincos(double x, double *sine, double *cosine)
{
	ob_sincos(x, sine, cosine);
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
double pow(double x, double y)
{
	return ob_pow(x, y);
}

#pragma GCC visibility pop

// Vectors of six numbers: velocity and rate of a body, or a row of a joint. Two numbers at a time: the sums are those of a loop.
#ifndef OB_SOLVER_SIX_H
#define OB_SOLVER_SIX_H

typedef double ob_six_pair __attribute__((vector_size(16), aligned(8), may_alias));

// y <- y + s x, of the first pairs of numbers
static inline void ob_six_add_pairs(double *y, double s, const double *x, int pairs)
{
	for (int i = 0; i < pairs; i++)
		((ob_six_pair *)y)[i] += s * ((const ob_six_pair *)x)[i];
}

static inline void ob_six_add(double *y, double s, const double *x)
{
	ob_six_add_pairs(y, s, x, 3);
}

static inline double ob_six_dot(const double *x, const double *y)
{
	const ob_six_pair *a = (const ob_six_pair *)x, *b = (const ob_six_pair *)y,
			  sum = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
	return sum[0] + sum[1];
}

static inline void ob_six_scale(double *x, double s)
{
	ob_six_pair *to = (ob_six_pair *)x;
	to[0] *= s;
	to[1] *= s;
	to[2] *= s;
}

#endif

// Vectors of six numbers: velocity and rate of a body, or a row of a joint. Two numbers at a time: the sums are those of a loop.
#ifndef OB_SOLVER_SIX_H
#define OB_SOLVER_SIX_H

typedef double ob_six_pair __attribute__((vector_size(16), aligned(8), may_alias));

// y <- y + s x
static inline void ob_six_add(double *y, double s, const double *x)
{
	ob_six_pair *to = (ob_six_pair *)y;
	const ob_six_pair *from = (const ob_six_pair *)x;
	to[0] += s * from[0];
	to[1] += s * from[1];
	to[2] += s * from[2];
}

static inline void ob_six_scale(double *x, double s)
{
	ob_six_pair *to = (ob_six_pair *)x;
	to[0] *= s;
	to[1] *= s;
	to[2] *= s;
}

#endif

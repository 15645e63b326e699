// der(x0) = x1, der(x1) = mu (1 - x0²) x1 - x0, as the standard's example: 1 x0, 2 x1, 3 mu; 4 x0 as a force.
#include "model.h"

const double model_start[MODEL_VALUES] = { [1] = 2, [3] = 1 };

bool model_step(double v[MODEL_VALUES], double time, double length)
{
	const double h = length / 16;
	for (int i = 0; i < 16; i++) {
		const double x0 = v[1], x1 = v[2];
		v[1] += h * x1;
		v[2] += h * (v[3] * (1 - x0 * x0) * x1 - x0);
	}
	v[4] = v[1];
	return true;
}

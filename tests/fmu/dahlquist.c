// der(x) = -k x, by Euler's method with fixed steps, as the standard's example: 1 x, 2 der(x), 3 k; 4 x as a force.
#include "model.h"

const double model_start[MODEL_VALUES] = { [1] = 1, [3] = 1 };

bool model_step(double v[MODEL_VALUES], double time, double length)
{
	const double h = length / 4;
	for (int i = 0; i < 4; i++) {
		v[2] = -v[3] * v[1];
		v[1] += h * v[2];
	}
	v[4] = v[1];
	return true;
}

// Holds a body at a height, with an integral part: 0 z, 1 vz, 2 mass, 3 height, 4 force, 5 integral of the error.
#include "model.h"

const double model_start[MODEL_VALUES] = { [2] = 1, [3] = 2 };

bool model_step(double v[MODEL_VALUES], double time, double length)
{
	v[5] += (v[3] - v[0]) * length;
	v[4] = v[2] * (9.81 + 20 * (v[3] - v[0]) + 4 * v[5] - 8 * v[1]);
	return true;
}

// A ball that falls and bounces, as the standard's example: 1 h, 2 v, 3 e (restitution); 4 h as a force.
#include "model.h"

const double model_start[MODEL_VALUES] = { [1] = 1, [3] = .7 };

bool model_step(double v[MODEL_VALUES], double time, double length)
{
	const double h = length / 16;
	for (int i = 0; i < 16; i++) {
		v[1] += h * v[2];
		v[2] -= h * 9.81;
		if (v[1] <= 0 && v[2] < 0) {
			v[1] = 0;
			v[2] *= -v[3];
		}
	}
	v[4] = v[1];
	return true;
}

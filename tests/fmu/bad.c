// Fails at time 3 in the way of 1: 0 not, 1 hangs, 2 crashes, 3 NaN, 4 reports an error, 5 leaves by exit, 6 changes how
// numbers are rounded; 4 a force.
#include <fenv.h>
#include <math.h>
#include <stdlib.h>

#include "model.h"

const double model_start[MODEL_VALUES] = { [3] = .2 };

bool model_step(double v[MODEL_VALUES], double time, double length)
{
	v[4] = 1;
	if (time < v[3])
		return true;
	switch ((int)v[1]) {
	case 1:
		for (volatile int i = 0;; i++)
			;
	case 2:
		abort();
	case 3:
		v[4] = NAN;
		return true;
	case 4:
		return false;
	case 5:
		exit(0);
	case 6:
		fesetround(FE_UPWARD);
		return true;
	default:
		return true;
	}
}

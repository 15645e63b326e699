#include "reference/statics.h"

#include <math.h>

double ob_reference_overhang_shift(int k)
{
	return .5 / k;
}

double ob_reference_overhang(int n)
{
	double reach = 0;
	for (int k = n; k >= 1; k--)
		reach += ob_reference_overhang_shift(k);
	return reach;
}

double ob_reference_cards_grip(double angle, double length, double thickness)
{
	return .5 * (tan(angle) - thickness / length);
}

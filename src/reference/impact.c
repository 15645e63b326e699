#include "reference/impact.h"

#include <math.h>

ob_reference_pair ob_reference_impact(double mass_a, double mass_b, ob_reference_pair before, double e)
{
	double share_a = isinf(mass_b) ? 1 : isinf(mass_a) ? 0 : mass_b / (mass_a + mass_b); // of the change
	double share_b = isinf(mass_b) ? 0 : isinf(mass_a) ? 1 : mass_a / (mass_a + mass_b);
	double change = (1 + e) * (before.b - before.a);
	return (ob_reference_pair){ before.a + share_a * change, before.b - share_b * change };
}

void ob_reference_cradle(int n, int k, double v, double *velocity)
{
	for (int i = 0; i < n; i++)
		velocity[i] = i < n - k ? 0 : v;
}

#include "reference/ballistics.h"

ob_vec3 ob_reference_parabola(ob_vec3 p, ob_vec3 v, ob_vec3 a, double t)
{
	return ob_madd(ob_madd(p, t, v), .5 * t * t, a);
}

static double fall_time(double height, double g)
{
	return sqrt(2 * height / g);
}

double ob_reference_apex(double height, double e, int k)
{
	return height * pow(e, 2 * k);
}

double ob_reference_impact_time(double height, double g, double e, int k)
{
	double falls = 1, power = 1; // in times of the first fall
	for (int i = 1; i < k; i++) {
		power *= e;
		falls += 2 * power;
	}
	return falls * fall_time(height, g);
}

double ob_reference_apex_time(double height, double g, double e, int k)
{
	return k > 0 ? ob_reference_impact_time(height, g, e, k) + pow(e, k) * fall_time(height, g) : 0;
}

double ob_reference_bounce(double height, double g, double e, double t)
{
	double first = fall_time(height, g);
	if (t <= first)
		return height - .5 * g * t * t;
	t -= first; // since the last impact, here and below
	double up = e * first; // time from impact to apex
	if (e == 1)
		t = fmod(t, 2 * up);
	else if (t >= 2 * up / (1 - e))
		return 0;
	for (; e < 1 && t > 2 * up && up > 0; up *= e)
		t -= 2 * up;
	return .5 * g * t * (2 * up - t);
}

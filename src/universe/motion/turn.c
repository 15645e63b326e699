#include <ob/vec.h>

#include "elementary/elementary.h"

ob_quat ob_quat_turn(ob_quat q, ob_vec3 th)
{
	const double a2 = ob_norm2(th);
	double sine, cosine;
	if (a2 == 0)
		return q;
	const double a = sqrt(a2);
	ob_sincos(.5 * a, &sine, &cosine);
	const double s = a > 1e-6 ? sine / a : .5 - a2 / 48;
	return ob_quat_normalize(ob_quat_mul((ob_quat){ cosine, th.x * s, th.y * s, th.z * s }, q));
}

#include "motion/magnus.h"

// rad: up to here the truncation error is below rounding. The first: order four; the second: order six with so many
// terms of the rate's series.
static const double longest_of_order_four = 1e-3, longest_of_six_terms = .01;

// Euler's equations as dw/dt = (c.x w.y w.z, c.y w.z w.x, c.z w.x w.y).
static ob_vec3 coupling_of(ob_vec3 j)
{
	const double inverse_all = 1 / (j.x * j.y * j.z);
	return ob_v3((j.y - j.z) * (j.y * j.z) * inverse_all, (j.z - j.x) * (j.z * j.x) * inverse_all,
		     (j.x - j.y) * (j.x * j.y) * inverse_all);
}

// Next coefficient of the rate's series, from the earlier ones, times "terms" (their number).
static inline ob_vec3 next_rate(ob_vec3 coupling, const ob_vec3 *w, int terms)
{
	ob_vec3 sum = ob_v3(0, 0, 0);
	for (int i = 0; i < terms; i++) {
		const ob_vec3 a = w[i], b = w[terms - 1 - i];
		sum = ob_add(sum, ob_v3(a.y * b.z, a.z * b.x, a.x * b.y));
	}
	return ob_v3(coupling.x * sum.x, coupling.y * sum.y, coupling.z * sum.z);
}

// Turn by a small rotation vector: the series of the half angle's cosine and of sin(x) / x end soon.
ob_quat ob_magnus_small_turn(ob_vec3 turn)
{
	const ob_vec3 half = ob_scale(turn, .5);
	const double x = ob_norm2(half), over = 1 - x / 6 * (1 - x / 20 * (1 - x / 42));
	return (ob_quat){ 1 - x / 2 * (1 - x / 12 * (1 - x / 30)), over * half.x, over * half.y, over * half.z };
}

// To order four, from the rate's series.
static ob_vec3 order_four(ob_vec3 w0, ob_vec3 j, double s)
{
	const ob_vec3 coupling = coupling_of(j);
	ob_vec3 w[4] = { ob_scale(w0, s) }; // coefficients of the rate times s, each with its power of s
	w[1] = next_rate(coupling, w, 1);
	w[2] = ob_scale(next_rate(coupling, w, 2), .5);
	w[3] = ob_scale(next_rate(coupling, w, 3), 1. / 3);
	const ob_vec3 mean = ob_madd(ob_madd(ob_madd(w[0], .5, w[1]), 1. / 3, w[2]), .25, w[3]);
	return ob_madd(mean, 1. / 12, ob_cross(w[0], ob_add(w[1], w[2])));
}

// To order six (Blanes, Casas, Oteo and Ros 2009, section 5.4) from the moments of the rate about the middle. Each is
// the sum of its series with so many terms (a constant: the loops are unrolled).
static inline __attribute__((always_inline)) ob_vec3 order_six(ob_vec3 w0, ob_vec3 j, double s, int terms)
{
	enum { MOST = 8 };
	const ob_vec3 coupling = coupling_of(j);
	ob_vec3 w[MOST] = { ob_scale(w0, s) }; // as above
	ob_vec3 mean = w[0], first = ob_v3(0, 0, 0), second = ob_scale(w[0], 1. / 12);
#pragma GCC unroll 8
	for (int k = 1; k < terms; k++) {
		w[k] = ob_scale(next_rate(coupling, w, k), 1. / k);
		mean = ob_madd(mean, 1. / (k + 1), w[k]);
		first = ob_madd(first, 1. / (k + 2) - .5 / (k + 1), w[k]);
		second = ob_madd(second, 1. / (k + 3) - 1. / (k + 2) + .25 / (k + 1), w[k]);
	}
	// The turn's equation has the rate on the right; the inverse has minus the rate on the left.
	const ob_vec3 a1 = ob_madd(ob_scale(mean, -9. / 4), 15, second), a2 = ob_scale(first, -12),
		      a3 = ob_madd(ob_scale(mean, 15), -180, second);
	const ob_vec3 c1 = ob_cross(a1, a2), c2 = ob_scale(ob_cross(a1, ob_madd(c1, 2, a3)), -1. / 60);
	const ob_vec3 left = ob_sub(ob_madd(c1, -20, a1), a3);
	return ob_madd(mean, -1. / 240, ob_cross(left, ob_add(a2, c2)));
}

ob_quat ob_magnus_turn_of_order_four(ob_vec3 w, ob_vec3 inertia, double s)
{
	return ob_magnus_small_turn(order_four(w, inertia, s));
}

ob_quat ob_magnus_turn_of_order_six(ob_vec3 w, ob_vec3 inertia, double s)
{
	return ob_magnus_small_turn(order_six(w, inertia, s, 6));
}

ob_quat ob_magnus_turn(ob_vec3 w, ob_vec3 inertia, double s)
{
	const double turned = ob_norm2(w) * s * s;
	if (turned < longest_of_order_four * longest_of_order_four)
		return ob_magnus_turn_of_order_four(w, inertia, s);
	if (turned < longest_of_six_terms * longest_of_six_terms)
		return ob_magnus_turn_of_order_six(w, inertia, s);
	return ob_magnus_small_turn(order_six(w, inertia, s, 8));
}

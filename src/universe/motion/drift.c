// Euler's equations J dw/dt = (J w) x w and dq/dt = q w / 2 are quadratic. So the coefficients of their power series
// follow from the earlier ones by sums of products (Moore, "Interval Analysis", 1966, section 11.1). The series is
// summed until its terms vanish; if that takes too many terms, the closed form is used.
#include "motion/drift.h"

#include <stdbool.h>

#include "motion/magnus.h"
#include "motion/spin.h"

enum { TERMS = 22 };

static const double negligible = 1e-17; // relative to a unit quaternion
static const double longest_series = .2; // rad: for longer turns the closed form costs no more
// rad: limits of Magnus's expansion, for an error of 1e-11
static const double longest_of_order_four_held = .01, longest_held = .03;

static bool same_moments(ob_vec3 j)
{
	return j.x == j.y && j.y == j.z;
}

// Unit norm, without the bias of one division (spin.c).
static ob_quat unit(ob_quat q)
{
	double e = ob_quat_excess(q);
	double s = e * (.5 - .375 * e);
	return (ob_quat){ q.w - q.w * s, q.x - q.x * s, q.y - q.y * s, q.z - q.z * s };
}

// Returns false if the terms do not vanish soon enough.
static bool series(ob_vec3 w0, ob_vec3 j, double s, ob_quat *out)
{
	// Coefficients of the rate times s, and of the turn; each with its power of s.
	double wx[TERMS], wy[TERMS], wz[TERMS], q0[TERMS], q1[TERMS], q2[TERMS], q3[TERMS];
	wx[0] = s * w0.x, wy[0] = s * w0.y, wz[0] = s * w0.z;
	q0[0] = 1, q1[0] = q2[0] = q3[0] = 0;
	const double cx = (j.y - j.z) / j.x, cy = (j.z - j.x) / j.y, cz = (j.x - j.y) / j.z;
	for (int k = 0; k + 1 < TERMS; k++) {
		double a = 0, b = 0, c = 0, d = 0, x = 0, y = 0, z = 0;
		for (int i = 0; i <= k; i++) {
			const int o = k - i;
			a -= q1[i] * wx[o] + q2[i] * wy[o] + q3[i] * wz[o];
			b += q0[i] * wx[o] + q2[i] * wz[o] - q3[i] * wy[o];
			c += q0[i] * wy[o] + q3[i] * wx[o] - q1[i] * wz[o];
			d += q0[i] * wz[o] + q1[i] * wy[o] - q2[i] * wx[o];
			x += wy[i] * wz[o];
			y += wz[i] * wx[o];
			z += wx[i] * wy[o];
		}
		const double f = 1. / (k + 1), half = .5 * f;
		q0[k + 1] = half * a, q1[k + 1] = half * b, q2[k + 1] = half * c, q3[k + 1] = half * d;
		wx[k + 1] = f * cx * x, wy[k + 1] = f * cy * y, wz[k + 1] = f * cz * z;
		out->w += q0[k + 1], out->x += q1[k + 1], out->y += q2[k + 1], out->z += q3[k + 1];
		double term = fabs(q0[k + 1]) + fabs(q1[k + 1]) + fabs(q2[k + 1]) + fabs(q3[k + 1]);
		double rate = fabs(wx[k + 1]) + fabs(wy[k + 1]) + fabs(wz[k + 1]);
		if (term + rate < negligible)
			return true;
	}
	return false;
}

static bool any_moment(ob_vec3 j)
{
	return !(j.x > 0 && j.y > 0 && j.z > 0);
}

ob_quat ob_drift_short_turn(ob_vec3 w, ob_vec3 inertia, double s)
{
	return same_moments(inertia) || any_moment(inertia) ? ob_magnus_small_turn(ob_scale(w, s))
							    : ob_magnus_turn_of_order_four(w, inertia, s);
}

ob_quat ob_drift_turn(ob_vec3 w, ob_vec3 inertia, double s)
{
	ob_quat turn = ob_quat_identity();
	const double turned = ob_norm2(w) * s * s;
	if (turned == 0)
		return turn;
	if (same_moments(inertia) || any_moment(inertia))
		return ob_quat_turn(turn, ob_scale(w, s));
	if (turned < OB_MAGNUS_LONGEST * OB_MAGNUS_LONGEST)
		return ob_magnus_turn(w, inertia, s);
	if (turned < longest_series * longest_series && series(w, inertia, s, &turn))
		return unit(turn);
	ob_spin spin;
	ob_spin_plan(&spin, ob_quat_identity(), w, inertia);
	ob_spin_at(&spin, s, &turn, &w);
	return turn;
}

// Rate after a turn, from the attitude r and the rate b (all in the body frame): it follows from the momentum, which
// stays.
static ob_vec3 rate_after(const ob_mat3 *r, ob_vec3 b, ob_vec3 j, ob_quat after)
{
	const ob_mat3 now = ob_quat_matrix(after);
	const ob_vec3 l = ob_rotate_back(&now, ob_rotate(r, ob_v3(j.x * b.x, j.y * b.y, j.z * b.z)));
	return ob_rotate(&now, ob_v3(l.x / j.x, l.y / j.y, l.z / j.z));
}

void ob_drift(ob_quat q, ob_vec3 w, ob_vec3 inertia, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	const ob_mat3 r = ob_quat_matrix(q);
	const ob_vec3 b = ob_rotate_back(&r, w), j = inertia;
	*q_out = unit(ob_quat_mul(q, ob_drift_turn(b, j, s)));
	*w_out = same_moments(j) || any_moment(j) ? w : rate_after(&r, b, j, *q_out);
}

void ob_drift_held(ob_quat q, ob_vec3 w, ob_vec3 inertia, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	const double turned = ob_norm2(w) * s * s;
	if (turned >= longest_held * longest_held || same_moments(inertia) || any_moment(inertia)) {
		ob_drift(q, w, inertia, s, q_out, w_out);
		return;
	}
	const ob_mat3 r = ob_quat_matrix(q);
	const ob_vec3 b = ob_rotate_back(&r, w);
	*q_out = unit(ob_quat_mul(q, turned < longest_of_order_four_held * longest_of_order_four_held
					     ? ob_magnus_turn_of_order_four(b, inertia, s)
					     : ob_magnus_turn_of_order_six(b, inertia, s)));
	*w_out = rate_after(&r, b, inertia, *q_out);
}

ob_vec3 ob_small_turn(ob_quat from, ob_quat to)
{
	ob_quat t = ob_quat_mul(to, ob_quat_conjugate(from));
	ob_vec3 v = ob_scale(ob_v3(t.x, t.y, t.z), t.w < 0 ? -2 : 2);
	double x = .25 * ob_norm2(v);
	return ob_scale(v, 1 + x * (1. / 6 + x * (3. / 40 + x * (5. / 112))));
}

double ob_drift_bound(ob_vec3 w, ob_vec3 inertia, double s)
{
	const double slight = .02, inverse_root3 = .57735026918962576;
	const ob_vec3 j = inertia;
	const double rate = ob_norm(w), least = rate * s * inverse_root3;
	if (rate == 0 || same_moments(j) || any_moment(j))
		return rate;
	// Moments of a real body: none exceeds the sum of the others, so k below is at most this.
	if (least < slight && j.x <= j.y + j.z && j.y <= j.z + j.x && j.z <= j.x + j.y)
		return rate * (1 + least / (1 - slight));
	// dw_i/dt = (J_j - J_k) / J_i w_j w_k, and the squares of the products sum to at most w^4 / 3: d(1/w)/dt is
	// bounded.
	double k = ob_max(fabs(j.y - j.z) / j.x, ob_max(fabs(j.z - j.x) / j.y, fabs(j.x - j.y) / j.z)) * inverse_root3;
	double grown = k * rate * s;
	if (grown < slight)
		return rate / (1 - grown);
	double ever = ob_spin_bound(ob_quat_identity(), w, inertia);
	return grown < 1 ? ob_min(ever, rate / (1 - grown)) : ever;
}

// With n the direction of the momentum L in the body and I1, I2, I3 the moments, sorted so that n keeps to one side
// of the third axis (n3 > 0), Jacobi's solution ("Sur la rotation d'un corps", 1849; Whittaker, "Analytical Dynamics",
// 1937, section 69) is
//	n1 = A1 cn(u), n2 = A2 sn(u), n3 = A3 dn(u), u = u0 + u' s.
// The azimuth of the third axis about L turns at L (n1^2 / I1 + n2^2 / I2) / (n1^2 + n2^2), whose integral is
//	lambda s + arg theta_1(v +- i alpha), v = pi u / (2 K),
// alpha from sn(2 K alpha / pi, k') = A1 / |A2| (van Zon and Schofield, J. Comput. Phys. 225, 2007). From theta_1 and
// theta_2 only directions are taken, and n is put on the curve of constant momentum and energy, so both are kept to
// the last digits at any s.
#include "motion/spin.h"

#include <ob/motion.h>

#include "elementary/elementary.h"
#include "motion/magnus.h"

// Moments closer than this are equal: over a thousand radians the difference stays below 1e-12 rad.
static const double SAME = 1e-15;
// A direction this near (sine) to a principal axis is on it.
static const double ON_AXIS = 1e-16;

static double square(double x)
{
	return x * x;
}

static void get(ob_vec3 v, double out[3])
{
	out[0] = v.x;
	out[1] = v.y;
	out[2] = v.z;
}

static void plan_turns(ob_spin *spin, ob_vec3 world, ob_vec3 body)
{
	spin->kind = OB_SPIN_TURNS;
	spin->world = world;
	spin->body = body;
}

// The pair of equal moments decides: L / I of the pair in the world, the rest about the third axis of the body. With
// three equal moments the rest is zero. False: no two are equal.
static int plan_symmetric(ob_spin *spin, ob_vec3 momentum, const double l[3], const double inertia[3])
{
	for (int k = 0; k < 3; k++) {
		double a = inertia[(k + 1) % 3], b = inertia[(k + 2) % 3];
		if (fabs(a - b) > SAME * ob_max(a, b))
			continue;
		double pair = .5 * (a + b), rest = l[k] * (1 / inertia[k] - 1 / pair);
		plan_turns(spin, ob_scale(momentum, 1 / pair),
			   ob_v3(k == 0 ? rest : 0, k == 1 ? rest : 0, k == 2 ? rest : 0));
		return 1;
	}
	return 0;
}

// Sorts the axes: moments ascending, or descending where the momentum circles the axis of the smallest one; signs so
// that the frame is right-handed and n3 >= 0.
static void sort_axes(ob_spin *spin, const double n[3], const double inertia[3])
{
	int o[3] = { 0, 1, 2 };
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2 - i; j++)
			if (inertia[o[j]] > inertia[o[j + 1]]) {
				int swap = o[j];
				o[j] = o[j + 1];
				o[j + 1] = swap;
			}
	double low = inertia[o[0]], mid = inertia[o[1]], high = inertia[o[2]];
	if (square(n[o[0]]) * (mid / low - 1) > square(n[o[2]]) * (1 - mid / high)) {
		int swap = o[0];
		o[0] = o[2];
		o[2] = swap;
	}
	int even = o[1] == (o[0] + 1) % 3;
	for (int i = 0; i < 3; i++)
		spin->axis[i] = o[i];
	spin->sign[0] = 1;
	spin->sign[2] = n[o[2]] < 0 ? -1 : 1;
	spin->sign[1] = even ? spin->sign[2] : -spin->sign[2];
}

// Components of n along the sorted axes at phase v.
static ob_vec3 direction_at(const ob_spin *spin, const ob_theta_value *t)
{
	double c = spin->root_kc * t->theta2, s = t->theta1, r = 1 / sqrt(c * c + s * s);
	c *= r;
	s *= r;
	return ob_v3(spin->amplitude.x * c, spin->amplitude.y * s,
		     spin->amplitude.z * sqrt(spin->mc + spin->m * c * c));
}

// The minimal turn that takes n to the third axis; well defined, for n3 >= 0.
static ob_quat lift_of(ob_vec3 n)
{
	double r = 1 / sqrt(2 * (1 + n.z));
	return (ob_quat){ (1 + n.z) * r, n.y * r, -n.x * r, 0 };
}

// Direction (cos, sin) of the turn about L that follows the lift: arg theta_1(v +- i alpha) + lambda s - arg(n1 + i
// n2). sl, cl: sine and cosine of lambda s
static void azimuth_at(const ob_spin *spin, double sl, double cl, const ob_theta_value *t, ob_vec3 n, double *cos_out,
		       double *sin_out)
{
	double im = spin->side * t->im;
	double a = t->re * cl - im * sl, b = t->re * sl + im * cl;
	double c = a * n.x + b * n.y, d = b * n.x - a * n.y, r = 1 / sqrt(c * c + d * d);
	*cos_out = c * r;
	*sin_out = d * r;
}

// size = |L|; n = its direction along the sorted axes, i1, i2, i3 the moments there.
static void plan_theta(ob_spin *spin, double size, ob_vec3 n, double i1, double i2, double i3)
{
	double s1 = square(n.x), s2 = square(n.y), s3 = square(n.z);
	// Sums of positive terms: the amplitudes are exact to the last digits for any moments.
	double sn2 = i1 * (i2 - i3) / (i2 * (i1 - i3)); // (A1 / A2)^2 = sn^2(2 K alpha / pi, k')
	double cn2 = i3 * (i1 - i2) / (i2 * (i1 - i3)); // 1 - sn2
	double a1 = sqrt(s1 + s2 * sn2), a2 = sqrt(s1 / sn2 + s2),
	       a3 = sqrt(s3 + s2 * i3 * (i2 - i1) / (i2 * (i3 - i1)));
	spin->amplitude = ob_v3(a1, i3 > i2 ? a2 : -a2, a3);
	double bend = i3 * (i2 - i1) / (i1 * (i3 - i2)), outer = s3, inner = s1 * bend;
	spin->m = ob_min(square(a1 / a3) * bend, 1);
	// Where rounding alone decides how near the separatrix is, it is not nearer than the rounding.
	spin->mc = ob_min(ob_max(outer - inner, 1e-17 * (outer + inner)) / square(a3), 1);
	double kc = sqrt(spin->mc), k = sqrt(spin->m), mean, mean_c;
	spin->root_kc = sqrt(kc);
	spin->phase = ob_jacobi_phase(n.x / a1, n.y / spin->amplitude.y, kc, &mean);
	const double shift = ob_jacobi_phase(sqrt(cn2), sqrt(sn2), k, &mean_c);
	spin->speed = mean * size * a3 * sqrt((i3 - i1) / i1 * ((i3 - i2) / i2)) / i3;
	ob_theta_plan(&spin->theta, ob_exp(-M_PI * mean / mean_c), shift * mean / mean_c);
	spin->side = i1 > i2 ? 1 : -1;
	// At v = pi / 2 the azimuth turns at L / I2, of which the theta function has its logarithmic slope.
	spin->precession = size / i2 + spin->side * spin->speed * ob_theta_slope(&spin->theta);
	double sine, cosine;
	ob_sincos(spin->phase, &sine, &cosine);
	ob_theta_value t = ob_theta_at(&spin->theta, sine, cosine);
	ob_vec3 n0 = direction_at(spin, &t);
	azimuth_at(spin, 0, 1, &t, n0, &spin->cos0, &spin->sin0);
	spin->lift0 = lift_of(n0);
}

// Energy and momentum stay, and each bounds the rate b (body frame) by the least moment.
static double fastest_of(ob_vec3 b, ob_vec3 i)
{
	const ob_vec3 l = ob_v3(i.x * b.x, i.y * b.y, i.z * b.z);
	const double least = ob_min(i.x, ob_min(i.y, i.z));
	if (!(least > 0) || (i.x == i.y && i.y == i.z))
		return ob_norm(b);
	return sqrt(ob_min(ob_dot(l, b) / least, ob_norm2(l) / (least * least)));
}

double ob_spin_bound(ob_quat q, ob_vec3 w, ob_vec3 inertia)
{
	const ob_mat3 r = ob_quat_matrix(q);
	return fastest_of(ob_rotate_back(&r, w), inertia);
}

// With k the largest |c_i|, |b'| <= k w^2 / sqrt(3) and |b''| <= 2/3 k^2 w^3, for sums of products of shares that add
// up to 1; in the world the rate's second derivative has b x b' as well, and the arm's third is made of products of
// these.
ob_bending ob_bending_of(ob_vec3 i, double w)
{
	ob_bending x = { .coupling = { 0, 0, 0 } };
	if (i.x > 0 && i.y > 0 && i.z > 0)
		x.coupling = ob_v3((i.y - i.z) / i.x, (i.z - i.x) / i.y, (i.x - i.y) / i.z);
	const double k = ob_max(fabs(x.coupling.x), ob_max(fabs(x.coupling.y), fabs(x.coupling.z))), once = k / sqrt(3);
	x.most = w * w * (1 + once);
	x.jerk = w * w * w * (1 + 4 * once + 2. / 3 * k * k);
	return x;
}

void ob_spin_plan(ob_spin *spin, ob_quat q, ob_vec3 w, ob_vec3 inertia)
{
	const ob_mat3 r = ob_quat_matrix(q);
	spin->q = q;
	spin->w = w;
	spin->rate_0 = ob_rotate_back(&r, w);
	spin->inertia = inertia;
	spin->fastest = fastest_of(spin->rate_0, inertia);
	spin->planned = false;
	spin->last = 0;
	spin->last_q = q;
	spin->last_w = w;
}

// false: its rate is taken to stay.
static bool is_ordinary(const ob_spin *spin)
{
	const ob_vec3 i = spin->inertia;
	return i.x > 0 && i.y > 0 && i.z > 0 && ob_norm2(spin->w) > 1e-280; // squares of less would lose their digits
}

static void plan_long_turns(ob_spin *spin)
{
	const ob_quat q = spin->q;
	const ob_vec3 w = spin->w, body = spin->rate_0;
	double i[3], l[3], n[3];
	get(spin->inertia, i);
	spin->planned = true;
	plan_turns(spin, w, ob_v3(0, 0, 0));
	if (!is_ordinary(spin))
		return;
	ob_mat3 r = ob_quat_matrix(q);
	ob_vec3 momentum = ob_v3(i[0] * body.x, i[1] * body.y, i[2] * body.z);
	get(momentum, l);
	double size = ob_norm(momentum);
	get(ob_scale(momentum, 1 / size), n);
	for (int k = 0; k < 3; k++)
		if (square(n[(k + 1) % 3]) + square(n[(k + 2) % 3]) <= square(ON_AXIS))
			return;
	if (plan_symmetric(spin, ob_rotate(&r, momentum), l, i))
		return;
	spin->kind = OB_SPIN_THETA;
	sort_axes(spin, n, i);
	const int *o = spin->axis;
	spin->rate = ob_v3(size / i[0], size / i[1], size / i[2]);
	ob_vec3 sorted = ob_v3(spin->sign[0] * n[o[0]], spin->sign[1] * n[o[1]], spin->sign[2] * n[o[2]]);
	plan_theta(spin, size, sorted, i[o[0]], i[o[1]], i[o[2]]);
}

static inline __attribute__((always_inline)) double excess(ob_quat q)
{
	return fma(q.w, q.w, fma(q.x, q.x, fma(q.y, q.y, fma(q.z, q.z, -1))));
}

// The same bits in one call, where the processor can: the library has one for each product.
#ifdef __x86_64__
__attribute__((target("fma"))) static double excess_by_processor(ob_quat q)
{
	return excess(q);
}
#endif

double ob_quat_excess(ob_quat q)
{
#ifdef __x86_64__
	if (__builtin_cpu_supports("fma"))
		return excess_by_processor(q);
#endif
	return excess(q);
}

// Unit norm without bias. 1 / sqrt(norm^2) rounds to 1 within two units of the last digit, so that what the product
// adds would stay, and the rates turned by it would gain 2e-16 a call; the linear correction does not round so.
static ob_quat unit(ob_quat q)
{
	q = ob_quat_normalize(q);
	double s = .5 * ob_quat_excess(q);
	return (ob_quat){ q.w - q.w * s, q.x - q.x * s, q.y - q.y * s, q.z - q.z * s };
}

static void turns_at(const ob_spin *spin, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	ob_quat own = ob_quat_turn(ob_quat_identity(), ob_scale(spin->body, s));
	ob_quat q = unit(ob_quat_mul(ob_quat_turn(spin->q, ob_scale(spin->world, s)), own));
	ob_mat3 r = ob_quat_matrix(q);
	*q_out = q;
	*w_out = ob_add(spin->world, ob_rotate(&r, spin->body));
}

// Quaternion about the third axis by the angle whose direction is (c, s).
static ob_quat half_turn(double c, double s)
{
	if (c > 0) {
		double h = sqrt(.5 * (1 + c));
		return (ob_quat){ h, 0, 0, .5 * s / h };
	}
	double h = copysign(sqrt(.5 * (1 - c)), s);
	return (ob_quat){ .5 * s / h, 0, 0, h };
}

// From the sorted frame back to the body's axes.
static ob_vec3 unsort(const ob_spin *spin, double x, double y, double z)
{
	double out[3];
	out[spin->axis[0]] = spin->sign[0] * x;
	out[spin->axis[1]] = spin->sign[1] * y;
	out[spin->axis[2]] = spin->sign[2] * z;
	return ob_v3(out[0], out[1], out[2]);
}

static void theta_at(const ob_spin *spin, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	double c, d, sine[2], cosine[2];
	ob_sincos_of_two((double[2]){ spin->phase + spin->speed * s, spin->precession * s }, sine, cosine);
	ob_theta_value t = ob_theta_at(&spin->theta, sine[0], cosine[0]);
	ob_vec3 n = direction_at(spin, &t);
	azimuth_at(spin, sine[1], cosine[1], &t, n, &c, &d);
	ob_quat back = { spin->lift0.w, -spin->lift0.x, -spin->lift0.y, -spin->lift0.z };
	ob_quat turn = half_turn(c * spin->cos0 + d * spin->sin0, d * spin->cos0 - c * spin->sin0);
	ob_quat sorted = ob_quat_mul(back, ob_quat_mul(turn, lift_of(n)));
	ob_vec3 axis = unsort(spin, sorted.x, sorted.y, sorted.z);
	ob_quat own = { sorted.w, axis.x, axis.y, axis.z };
	ob_quat q = unit(ob_quat_mul(spin->q, own));
	ob_vec3 along = unsort(spin, n.x, n.y, n.z);
	ob_mat3 r = ob_quat_matrix(q);
	*q_out = q;
	*w_out = ob_rotate(&r, ob_v3(spin->rate.x * along.x, spin->rate.y * along.y, spin->rate.z * along.z));
}

// The rate follows from the momentum, which stays.
static void short_turn_at(const ob_spin *spin, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	const ob_vec3 i = spin->inertia, b = spin->rate_0;
	const ob_mat3 before = ob_quat_matrix(spin->q);
	const ob_vec3 momentum = ob_rotate(&before, ob_v3(i.x * b.x, i.y * b.y, i.z * b.z));
	*q_out = unit(ob_quat_mul(spin->q, ob_magnus_turn(b, i, s)));
	const ob_mat3 r = ob_quat_matrix(*q_out);
	const ob_vec3 l = ob_rotate_back(&r, momentum);
	*w_out = ob_rotate(&r, ob_v3(l.x / i.x, l.y / i.y, l.z / i.z));
}

static void find_at(ob_spin *spin, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	if (s == 0) {
		*q_out = spin->q;
		*w_out = spin->w;
		return;
	}
	if (is_ordinary(spin) && ob_norm2(spin->w) * s * s < OB_MAGNUS_LONGEST * OB_MAGNUS_LONGEST) {
		short_turn_at(spin, s, q_out, w_out);
		return;
	}
	if (!spin->planned)
		plan_long_turns(spin);
	if (spin->kind == OB_SPIN_THETA)
		theta_at(spin, s, q_out, w_out);
	else
		turns_at(spin, s, q_out, w_out);
}

void ob_spin_at(ob_spin *spin, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	if (s != spin->last) {
		find_at(spin, s, &spin->last_q, &spin->last_w);
		spin->last = s;
	}
	*q_out = spin->last_q;
	*w_out = spin->last_w;
}

void ob_rotate_free(ob_quat q, ob_vec3 w, ob_vec3 inertia, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	if (s == 0 || ob_norm2(w) == 0) { // exactly what was published, and quickly for all that is at rest
		*q_out = q;
		*w_out = w;
		return;
	}
	ob_spin spin;
	ob_spin_plan(&spin, q, w, inertia);
	ob_spin_at(&spin, s, q_out, w_out);
}

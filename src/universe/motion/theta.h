// Free rotation of a body with three different moments. With n the direction of the momentum L in the body and I1, I2,
// I3 the moments, sorted so that n keeps to one side of the third axis (n3 > 0), Jacobi's solution ("Sur la rotation
// d'un corps", 1849; Whittaker, "Analytical Dynamics", 1937, section 69) is
//      n1 = A1 cn(u), n2 = A2 sn(u), n3 = A3 dn(u), u = u0 + u' s.
// The azimuth of the third axis about L turns at L (n1^2 / I1 + n2^2 / I2) / (n1^2 + n2^2), with the integral
//      lambda s + arg theta_1(v +- i alpha), v = pi u / (2 K), alpha from sn(2 K alpha / pi, k') = A1 / |A2|
// (van Zon and Schofield, J. Comput. Phys. 225, 2007). Only directions are taken from theta_1 and theta_2, and n is put
// on the curve of constant momentum and energy, so both are preserved to the last digits at any s. Elliptic integrals
// use the arithmetic-geometric mean and the theta series of Jacobi (Fundamenta Nova, 1829).
//
// Text compiled for one body (spin.c) and for four side by side (spin_lanes.c), with the same operations in the same
// order: each lane has the bits of a single body. The including file first includes elementary/real.h or
// elementary/real_lanes.h, and defines the functions declared first.
#ifndef OB_MOTION_THETA_H
#define OB_MOTION_THETA_H

#include "motion/spin.h"

static inline real signed_as(real size, real x); // copysign
static inline real angle_of(real y, real x); // atan2
static inline real power_of_e(real x);
static inline real power_of_e_less_1(real x);
static real excess_of(real w, real x, real y, real z); // ob_quat_excess
// of two angles
static inline void sines_of(real a, real b, real *sine_a, real *cosine_a, real *sine_b, real *cosine_b);

typedef struct vector {
	real x, y, z;
} vector;

typedef struct quaternion {
	real w, x, y, z;
} quaternion;

// Series of theta_1 and theta_2 at v and of theta_1 at v + i alpha, as ob_theta_series.
typedef struct series {
	int terms; // longest of all lanes
	const real *even, *odd, *plain;
} series;

typedef struct theta_value {
	real theta1, theta2; // at v
	real re, im; // theta_1 at v + i alpha
} theta_value;

static inline real squared(real x)
{
	return x * x;
}

static inline real least_of(real a, real b)
{
	return chosen(b == b, chosen(a < b, a, b), a);
}

static inline real most_of(real a, real b)
{
	return chosen(b == b, chosen(a > b, a, b), a);
}

static inline quaternion product(quaternion a, quaternion b)
{
	return (quaternion){
		a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
		a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
		a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
		a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
	};
}

// ---- elliptic integrals and theta functions

enum { MEAN_STEPS = 12 }; // from b = 1e-300 the mean converges in 10

// A phase on its way to F(phi, k): see phases.
typedef struct phase {
	real x, y, half_turns, scale;
	real a, b; // arithmetic-geometric mean
	mask on;
} phase;

static inline phase phase_begin(real x, real y, real kc)
{
	const mask left = x < 0;
	return (phase){ chosen(left, -x, x),
			chosen(left, -y, y),
			chosen(left, real_of(1), real_of(0)),
			real_of(1),
			real_of(1),
			kc,
			x == x };
}

// One of Landen's ascending transformations (Abramowitz and Stegun 1964, 17.6.8): tan(phi' - phi) = (b / a) tan(phi).
// The angle is stored as half turns and a direction with x >= 0, so no tangent has to be finite. Also makes a step of
// Gauss towards the mean.
static inline void phase_step(phase *p)
{
	const real r = p->b / p->a, s = (1 + r) * p->x * p->y, c = p->x * p->x - r * p->y * p->y;
	const mask over = c < 0;
	const real twice = p->half_turns * 2,
		   turned = twice + chosen(over, chosen(p->y < 0, real_of(-1), real_of(1)), real_of(0));
	const real cosine = chosen(over, -c, c), sine = chosen(over, -s, s),
		   size = cosine + size_of(sine); // x and y shrink by r: keep them in range
	const real mean = .5 * (p->a + p->b), apart = size_of(p->a - p->b), b = root_of(p->a * p->b);
	p->x = chosen(p->on, cosine / size, p->x);
	p->y = chosen(p->on, sine / size, p->y);
	p->half_turns = chosen(p->on, turned, p->half_turns);
	p->scale = chosen(p->on, p->scale * .5, p->scale);
	p->a = chosen(p->on, mean, p->a);
	p->b = chosen(p->on, b, p->b);
	p->on = both_of(p->on, apart > 2e-16 * mean); // until a and b agree to the last digits
}

static inline real phase_end(const phase *p)
{
	return (p->half_turns * M_PI + angle_of(p->y, p->x)) * p->scale;
}

// Incomplete integrals F(phi, k) for the angles phi of two directions (x, y), as the phases F M(1, k') = pi F / (2 K):
// phi = pi / 2 gives pi / 2. kc = k' = sqrt(1 - k^2) > 0. A phase lies in [-pi / 2, 3 pi / 2]. The arithmetic-geometric
// means M(1, k') stay in "a": K(k) = pi / (2 M(1, k')). Two at once, as each step waits for the one before.
static inline void phases(phase *p, phase *q)
{
	for (int i = 0; i < MEAN_STEPS && (is_any(p->on) || is_any(q->on)); i++) {
		phase_step(p);
		phase_step(q);
	}
}

// Coefficients of the series: nome in [0, .9], alpha in [0, -log(nome) / 2]. Returns their number; count: number for
// each lane, with 0 beyond it.
static inline int series_plan(real nome, real alpha, real *plain, real *even, real *odd, real *count)
{
	const real less = -power_of_e_less_1(-2 * alpha),
		   small = 1 - less; // small = exp(-2 alpha), less = 1 - small to the last digits
	const real c = .5 * (1 / small + small), s = .5 * less * (1 + small) / small, square = nome * nome;
	real power = square; // q^(2 n)
	mask on = power == power;
	plain[0] = real_of(1);
	even[0] = 1 + small;
	odd[0] = less;
	*count = real_of(1);
	int n = 1;
	for (; n < OB_THETA_TERMS; n++) {
		const real next = power * (c * even[n - 1] + s * odd[n - 1]);
		on = both_of(on, next > 1e-18);
		if (!is_any(on))
			break;
		plain[n] = chosen(on, power * plain[n - 1], real_of(0));
		even[n] = chosen(on, next, real_of(0));
		odd[n] = chosen(on, power * (c * odd[n - 1] + s * even[n - 1]), real_of(0));
		*count = chosen(on, *count + 1, *count);
		power *= square;
	}
	return n;
}

// s, c: sine and cosine of v
static inline theta_value theta_at(const series *t, real s, real c)
{
	double sign = 1;
	const real c2 = c * c - s * s, s2 = 2 * s * c; // of 2 v: the turn from a term to the next
	theta_value sum = { real_of(0), real_of(0), real_of(0), real_of(0) };
	for (int n = 0; n < t->terms; n++) {
		sum.theta1 += sign * t->plain[n] * s;
		sum.theta2 += t->plain[n] * c;
		sum.re += sign * t->even[n] * s;
		sum.im += sign * t->odd[n] * c;
		const real next = s * c2 + c * s2;
		c = c * c2 - s * s2;
		s = next;
		sign = -sign;
	}
	return sum;
}

// d/dalpha log theta_2(i alpha): a sum of positive terms, so exact to the last digits
static inline real theta_slope(const series *t)
{
	real up = real_of(0), down = real_of(0);
	for (int n = t->terms - 1; n >= 0; n--) {
		up += (double)(2 * n + 1) * t->odd[n];
		down += t->even[n];
	}
	return up / down;
}

// ---- the rotation. k: its constants, OB_THETA_..

// Components of n along the sorted axes, from the theta functions t.
static inline vector direction_at(const real *k, const theta_value *t)
{
	const real x = k[OB_THETA_ROOT_KC] * t->theta2, y = t->theta1, r = 1 / root_of(x * x + y * y);
	const real c = x * r, s = y * r;
	return (vector){ k[OB_THETA_AMPLITUDE] * c, k[OB_THETA_AMPLITUDE + 1] * s,
			 k[OB_THETA_AMPLITUDE + 2] * root_of(k[OB_THETA_MC] + k[OB_THETA_M] * c * c) };
}

// Minimal turn from n to the third axis; well defined, as n3 >= 0.
static inline quaternion lift_of(vector n)
{
	const real r = 1 / root_of(2 * (1 + n.z));
	return (quaternion){ (1 + n.z) * r, n.y * r, -n.x * r, real_of(0) };
}

// Direction (cos, sin) of the turn about L that follows the lift: arg theta_1(v +- i alpha) + lambda s - arg(n1 + i
// n2). sl, cl: sine and cosine of lambda s
static inline void azimuth_at(const real *k, real sl, real cl, const theta_value *t, vector n, real *cosine, real *sine)
{
	const real im = k[OB_THETA_SIDE] * t->im;
	const real a = t->re * cl - im * sl, b = t->re * sl + im * cl;
	const real c = a * n.x + b * n.y, d = b * n.x - a * n.y, r = 1 / root_of(c * c + d * d);
	*cosine = c * r;
	*sine = d * r;
}

// size = |L|; n = its direction along the sorted axes, i1, i2, i3 the moments there. Sets the constants that follow
// from them, and the series.
static inline int plan_theta(real *k, real *plain, real *even, real *odd, real *count, real size, vector n, real i1,
			     real i2, real i3)
{
	const real s1 = squared(n.x), s2 = squared(n.y), s3 = squared(n.z);
	// Sums of positive terms: the amplitudes are exact to the last digits for any moments.
	const real sn2 = i1 * (i2 - i3) / (i2 * (i1 - i3)); // (A1 / A2)^2 = sn^2(2 K alpha / pi, k')
	const real cn2 = i3 * (i1 - i2) / (i2 * (i1 - i3)); // 1 - sn2
	const real a1 = root_of(s1 + s2 * sn2), a2 = root_of(s1 / sn2 + s2),
		   a3 = root_of(s3 + s2 * i3 * (i2 - i1) / (i2 * (i3 - i1)));
	k[OB_THETA_AMPLITUDE] = a1;
	k[OB_THETA_AMPLITUDE + 1] = chosen(i3 > i2, a2, -a2);
	k[OB_THETA_AMPLITUDE + 2] = a3;
	const real bend = i3 * (i2 - i1) / (i1 * (i3 - i2)), outer = s3, inner = s1 * bend;
	k[OB_THETA_M] = least_of(squared(a1 / a3) * bend, real_of(1));
	// If rounding alone decides the distance to the separatrix, that distance is not below the rounding.
	k[OB_THETA_MC] = least_of(most_of(outer - inner, 1e-17 * (outer + inner)) / squared(a3), real_of(1));
	const real kc = root_of(k[OB_THETA_MC]), modulus = root_of(k[OB_THETA_M]);
	k[OB_THETA_ROOT_KC] = root_of(kc);
	phase p = phase_begin(n.x / a1, n.y / k[OB_THETA_AMPLITUDE + 1], kc),
	      of_shift = phase_begin(root_of(cn2), root_of(sn2), modulus);
	phases(&p, &of_shift);
	const real mean = p.a, mean_c = of_shift.a, shift = phase_end(&of_shift);
	k[OB_THETA_PHASE] = phase_end(&p);
	k[OB_THETA_SPEED] = mean * size * a3 * root_of((i3 - i1) / i1 * ((i3 - i2) / i2)) / i3;
	const series t = { series_plan(power_of_e(-M_PI * mean / mean_c), shift * mean / mean_c, plain, even, odd,
				       count),
			   even, odd, plain };
	k[OB_THETA_SIDE] = chosen(i1 > i2, real_of(1), real_of(-1));
	// At v = pi / 2 the azimuth turns at L / I2, which includes the logarithmic slope of the theta function.
	k[OB_THETA_PRECESSION] = size / i2 + k[OB_THETA_SIDE] * k[OB_THETA_SPEED] * theta_slope(&t);
	real sine, cosine, none, one;
	sines_of(k[OB_THETA_PHASE], k[OB_THETA_PHASE], &sine, &cosine, &none, &one);
	const theta_value at = theta_at(&t, sine, cosine);
	const vector n0 = direction_at(k, &at);
	azimuth_at(k, real_of(0), real_of(1), &at, n0, &k[OB_THETA_COS0], &k[OB_THETA_SIN0]);
	const quaternion lift = lift_of(n0);
	k[OB_THETA_LIFT] = lift.w;
	k[OB_THETA_LIFT + 1] = lift.x;
	k[OB_THETA_LIFT + 2] = lift.y;
	k[OB_THETA_LIFT + 3] = lift.z;
	return t.terms;
}

// Quaternion of the turn about the third axis by the angle with direction (c, s).
static inline quaternion half_turn(real c, real s)
{
	const mask ahead = c > 0;
	const real h = root_of(.5 * (1 + chosen(ahead, c, -c))), larger = chosen(ahead, h, signed_as(h, s)),
		   other = .5 * s / larger;
	return (quaternion){ chosen(ahead, larger, other), real_of(0), real_of(0), chosen(ahead, other, larger) };
}

// Turns from the sorted frame back to the body's axes.
static inline vector unsorted(const real *k, vector v)
{
	const real *f = k + OB_THETA_FRAME;
	return (vector){ f[0] * v.x + f[1] * v.y + f[2] * v.z, f[3] * v.x + f[4] * v.y + f[5] * v.z,
			 f[6] * v.x + f[7] * v.y + f[8] * v.z };
}

// Unit norm without bias. 1 / sqrt(norm^2) rounds to 1 within two units of the last digit. The error of a product would
// then stay, and rates turned by it would gain 2e-16 a call; the linear correction does not round so.
static inline quaternion unit_of(quaternion q)
{
	const real r = 1 / root_of(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
	const quaternion n = { q.w * r, q.x * r, q.y * r, q.z * r };
	const real s = .5 * excess_of(n.w, n.x, n.y, n.z);
	return (quaternion){ n.w - n.w * s, n.x - n.x * s, n.y - n.y * s, n.z - n.z * s };
}

// M v for the matrix of q, as ob_quat_matrix and ob_rotate have it
static inline vector rotated(quaternion q, vector v)
{
	const real w = q.w, x = q.x, y = q.y, z = q.z;
	return (vector){
		(1 - 2 * (y * y + z * z)) * v.x + (2 * (x * y - w * z)) * v.y + (2 * (x * z + w * y)) * v.z,
		(2 * (x * y + w * z)) * v.x + (1 - 2 * (x * x + z * z)) * v.y + (2 * (y * z - w * x)) * v.z,
		(2 * (x * z - w * y)) * v.x + (2 * (y * z + w * x)) * v.y + (1 - 2 * (x * x + y * y)) * v.z,
	};
}

// Attitude and rate (world) at s
static inline void turn_theta(const real *k, const series *t, real s, quaternion *q_out, vector *w_out)
{
	real sine, cosine, sl, cl, c, d;
	sines_of(k[OB_THETA_PHASE] + k[OB_THETA_SPEED] * s, k[OB_THETA_PRECESSION] * s, &sine, &cosine, &sl, &cl);
	const theta_value at = theta_at(t, sine, cosine);
	const vector n = direction_at(k, &at);
	azimuth_at(k, sl, cl, &at, n, &c, &d);
	const real *lift = k + OB_THETA_LIFT, c0 = k[OB_THETA_COS0], d0 = k[OB_THETA_SIN0];
	const quaternion back = { lift[0], -lift[1], -lift[2], -lift[3] },
			 turn = half_turn(c * c0 + d * d0, d * c0 - c * d0),
			 sorted = product(back, product(turn, lift_of(n)));
	const vector axis = unsorted(k, (vector){ sorted.x, sorted.y, sorted.z }), along = unsorted(k, n);
	const quaternion start = { k[OB_THETA_START], k[OB_THETA_START + 1], k[OB_THETA_START + 2],
				   k[OB_THETA_START + 3] };
	*q_out = unit_of(product(start, (quaternion){ sorted.w, axis.x, axis.y, axis.z }));
	*w_out = rotated(*q_out, (vector){ k[OB_THETA_RATE] * along.x, k[OB_THETA_RATE + 1] * along.y,
					   k[OB_THETA_RATE + 2] * along.z });
}

#endif

// Axes sorted so that the momentum circles the third: moments I1, I2, I3 ascending or descending, n = I w / L, n3 > 0.
//      w1 = A1 cn(u), w2 = A2 sn(u), w3 = A3 dn(u), u = u0 + u' t
// The attitude is (turn by chi about L) (smallest turn from n to L). With Euler's angles chi = phi + psi, so
//      chi' = phi' + w3 - phi' cos(theta) = w3 + (I1 w1^2 + I2 w2^2) / (L (1 + n3)),
// an even function of u of period 2 K, without a pole near the real axis.
#include "reference/spin.h"

#include <math.h>

typedef long double real;

static real dot(const real a[3], const real b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void matrix_of(const real q[4], real m[3][3])
{
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		m[i][i] = 1 - 2 * (q[1 + j] * q[1 + j] + q[1 + k] * q[1 + k]);
		m[i][j] = 2 * (q[1 + i] * q[1 + j] - q[0] * q[1 + k]);
		m[j][i] = 2 * (q[1 + i] * q[1 + j] + q[0] * q[1 + k]);
	}
}

// Quaternion from the largest component (Shepperd 1978).
static ob_quat quaternion_of(const real m[3][3])
{
	real trace = m[0][0] + m[1][1] + m[2][2], q[4];
	int most = 0;
	for (int i = 1; i < 3; i++)
		if (m[i][i] > m[most][most])
			most = i;
	if (trace > m[most][most]) {
		q[0] = .5L * sqrtl(1 + trace);
		for (int i = 0; i < 3; i++)
			q[1 + i] = (m[(i + 2) % 3][(i + 1) % 3] - m[(i + 1) % 3][(i + 2) % 3]) / (4 * q[0]);
	} else {
		int j = (most + 1) % 3, k = (most + 2) % 3;
		real own = .5L * sqrtl(1 + 2 * m[most][most] - trace);
		q[1 + most] = own;
		q[0] = (m[k][j] - m[j][k]) / (4 * own);
		q[1 + j] = (m[most][j] + m[j][most]) / (4 * own);
		q[1 + k] = (m[most][k] + m[k][most]) / (4 * own);
	}
	real r = 1 / sqrtl(q[0] * q[0] + dot(q + 1, q + 1));
	return (ob_quat){ (double)(q[0] * r), (double)(q[1] * r), (double)(q[2] * r), (double)(q[3] * r) };
}

// Smallest turn from n to the third axis (Rodrigues 1840); n[2] > -1.
static void lift_of(const real n[3], real m[3][3])
{
	real r = 1 / (1 + n[2]);
	const real out[3][3] = { { 1 - n[0] * n[0] * r, -n[0] * n[1] * r, -n[0] },
				 { -n[0] * n[1] * r, 1 - n[1] * n[1] * r, -n[1] },
				 { n[0], n[1], n[2] } };
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			m[i][j] = out[i][j];
}

static void multiply(const real a[3][3], const real b[3][3], real out[3][3])
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
}

// ---- elliptic functions

// Carlson's symmetric integral of the first kind, by duplication.
static real carlson(real x, real y, real z)
{
	real mean = (x + y + z) / 3, apart = fmaxl(fabsl(mean - x), fmaxl(fabsl(mean - y), fabsl(mean - z)));
	real x0 = mean - x, y0 = mean - y, first = mean, power = 1;
	for (; 3000 * power * apart > fabsl(mean); power *= .25L) {
		real r = sqrtl(x) * sqrtl(y) + sqrtl(x) * sqrtl(z) + sqrtl(y) * sqrtl(z);
		x = .25L * (x + r);
		y = .25L * (y + r);
		z = .25L * (z + r);
		first = .25L * (first + r);
		mean = first;
	}
	real a = x0 * power / mean, b = y0 * power / mean, c = -a - b;
	real e2 = a * b - c * c, e3 = a * b * c;
	return (1 - e2 / 10 + e3 / 14 + e2 * e2 / 24 - 3 * e2 * e3 / 44) / sqrtl(mean);
}

static void plan_means(ob_reference_spin *s, real k)
{
	real a = 1, b = s->kc, c = k;
	int n = 0;
	for (;; n++) {
		s->mean[n] = a;
		s->half[n] = c;
		if (n == OB_REFERENCE_MEANS - 1 || fabsl(c) < 1e-10L * a) // a equals the mean to c^2
			break;
		real next = .5L * (a + b);
		c = .5L * (a - b);
		b = sqrtl(a * b);
		a = next;
	}
	s->means = n;
	s->quarter = acosl(0) / s->mean[n];
}

// Rates at the argument u, in the sorted frame.
static void rates_at(const ob_reference_spin *s, real u, real w[3])
{
	real angle = ldexpl(s->mean[s->means] * fmodl(u, 4 * s->quarter), s->means);
	for (int n = s->means; n > 0; n--)
		angle = .5L * (angle + asinl(s->half[n] / s->mean[n] * sinl(angle)));
	real sn = sinl(angle), cn = cosl(angle), kc2 = s->kc * s->kc;
	w[0] = s->rate[0] * cn;
	w[1] = s->rate[1] * sn;
	w[2] = s->rate[2] * sqrtl(kc2 + (1 - kc2) * cn * cn);
}

static void direction_of(const ob_reference_spin *s, const real w[3], real n[3])
{
	real l[3] = { s->moment[0] * w[0], s->moment[1] * w[1], s->moment[2] * w[2] }, r = 1 / sqrtl(dot(l, l));
	for (int i = 0; i < 3; i++)
		n[i] = l[i] * r;
}

// ---- the turn about the momentum

static real turn_rate(const ob_reference_spin *s, real u)
{
	real w[3], n[3];
	rates_at(s, u, w);
	direction_of(s, w, n);
	return w[2] + (s->moment[0] * w[0] * w[0] + s->moment[1] * w[1] * w[1]) / (s->momentum * (1 + n[2]));
}

// Coefficient k of the cosine series, from samples of half a period, both ends included. cosine: [2 * points], of a
// whole turn.
static real harmonic(const real *sample, const real *cosine, int points, int k)
{
	real sum = .5L * (sample[0] + (k % 2 ? -1 : 1) * sample[points]);
	for (int j = 1; j < points; j++)
		sum += sample[j] * cosine[j * k % (2 * points)];
	return 2 * sum / points;
}

// Doubles the samples until the last harmonics vanish.
static void plan_turn(ob_reference_spin *s)
{
	const real pi = acosl(-1);
	real sample[2 * OB_REFERENCE_HARMONICS + 1], cosine[4 * OB_REFERENCE_HARMONICS];
	int points = 16;
	do {
		points *= 2;
		for (int j = 0; j <= points; j++)
			sample[j] = turn_rate(s, s->quarter * j / points);
		for (int j = 0; j < 2 * points; j++)
			cosine[j] = cosl(pi * j / points);
		s->turn = .5L * harmonic(sample, cosine, points, 0);
	} while (points < 2 * OB_REFERENCE_HARMONICS &&
		 fabsl(harmonic(sample, cosine, points, points / 2)) > 2e-19L * fabsl(s->turn));
	s->harmonics = points / 2;
	for (int k = 1; k < s->harmonics; k++)
		s->wave[k] = harmonic(sample, cosine, points, k) * s->quarter / (k * pi * s->speed);
}

static real turn_at(const ob_reference_spin *s, real t)
{
	const real pi = acosl(-1);
	real u0 = fmodl(s->phase, 2 * s->quarter), u1 = fmodl(s->phase + s->speed * t, 2 * s->quarter);
	real chi = s->turn * t;
	for (int k = s->harmonics - 1; k >= 1; k--)
		chi += s->wave[k] * (sinl(k * pi * u1 / s->quarter) - sinl(k * pi * u0 / s->quarter));
	return chi;
}

// ---- planning

// Converts x from the body's frame to the sorted one.
static void to_sorted(const ob_reference_spin *s, const real x[3], real out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = s->sign[i] * x[s->axis[i]];
}

static void sort_axes(ob_reference_spin *s, const real inertia[3], const real w[3])
{
	int o[3] = { 0, 1, 2 };
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2 - i; j++)
			if (inertia[o[j]] > inertia[o[j + 1]]) {
				int swap = o[j];
				o[j] = o[j + 1];
				o[j + 1] = swap;
			}
	real beyond = 0; // L^2 - 2 E I2
	for (int i = 0; i < 3; i++)
		beyond += inertia[i] * (inertia[i] - inertia[o[1]]) * w[i] * w[i];
	if (beyond < 0) {
		int swap = o[0];
		o[0] = o[2];
		o[2] = swap;
	}
	int parity = o[1] == (o[0] + 1) % 3 ? 1 : -1;
	for (int i = 0; i < 3; i++) {
		s->axis[i] = o[i];
		s->moment[i] = inertia[o[i]];
	}
	s->sign[0] = 1;
	s->sign[2] = w[o[2]] < 0 ? -1 : 1;
	s->sign[1] = parity * s->sign[2];
}

static void plan_rates(ob_reference_spin *s)
{
	const real *w = s->w;
	real i1 = s->moment[0], i2 = s->moment[1], i3 = s->moment[2];
	real d31 = i3 - i1, d32 = i3 - i2, d21 = i2 - i1; // of one sign
	real low = i1 * d31 * w[0] * w[0] + i2 * d32 * w[1] * w[1]; // 2 E I3 - L^2
	real high = i2 * d21 * w[1] * w[1] + i3 * d31 * w[2] * w[2]; // L^2 - 2 E I1
	real beyond = i3 * d32 * w[2] * w[2] - i1 * d21 * w[0] * w[0]; // L^2 - 2 E I2
	s->rate[0] = sqrtl(low / (i1 * d31));
	s->rate[1] = copysignl(sqrtl(low / (i2 * d32)), d32);
	s->rate[2] = sqrtl(high / (i3 * d31));
	real kc2 = fmaxl(fminl(d31 * beyond / (d32 * high), 1), 1e-36L);
	s->kc = sqrtl(kc2);
	plan_means(s, sqrtl(d21 * low / (d32 * high)));
	s->speed = sqrtl(d32 * high / (i1 * i2 * i3));
	real cn = w[0] / s->rate[0], sn = w[1] / s->rate[1], r = 1 / hypotl(cn, sn);
	cn *= r;
	sn *= r;
	s->phase = sn * carlson(cn * cn, kc2 + (1 - kc2) * cn * cn, 1);
	if (cn < 0)
		s->phase = 2 * s->quarter - s->phase;
}

void ob_reference_spin_plan(ob_reference_spin *s, ob_quat q, ob_vec3 w, ob_vec3 inertia)
{
	const real given[4] = { q.w, q.x, q.y, q.z }, world[3] = { w.x, w.y, w.z };
	const real moment[3] = { inertia.x, inertia.y, inertia.z };
	real size = sqrtl(given[0] * given[0] + dot(given + 1, given + 1)), r[3][3], rate[3], apart = 0;
	*s = (ob_reference_spin){ .steady = true };
	for (int i = 0; i < 4; i++)
		s->q[i] = given[i] / size;
	matrix_of(s->q, r);
	for (int i = 0; i < 3; i++) {
		rate[i] = r[0][i] * world[0] + r[1][i] * world[1] + r[2][i] * world[2];
		s->w[i] = world[i];
	}
	for (int i = 0; i < 3; i++) { // w x I w
		int j = (i + 1) % 3, k = (i + 2) % 3;
		real scale = (moment[j] + moment[k]) * dot(rate, rate);
		apart = fmaxl(apart, scale > 0 ? fabsl((moment[j] - moment[k]) * rate[j] * rate[k]) / scale : 0);
	}
	if (apart < 1e-18L)
		return;
	s->steady = false;
	sort_axes(s, moment, rate);
	to_sorted(s, rate, s->w);
	real l[3] = { s->moment[0] * s->w[0], s->moment[1] * s->w[1], s->moment[2] * s->w[2] }, n[3], lift[3][3];
	s->momentum = sqrtl(dot(l, l));
	plan_rates(s);
	plan_turn(s);
	direction_of(s, s->w, n);
	lift_of(n, lift);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) // R0 P^T lift^T
			for (int k = 0; k < 3; k++)
				s->frame[i][j] += r[i][s->axis[k]] * s->sign[k] * lift[j][k];
}

static void turn_steadily(const ob_reference_spin *s, double t, ob_quat *q_out, ob_vec3 *w_out)
{
	real size = sqrtl(dot(s->w, s->w)), half = .5L * size * t, c = cosl(half), v[3] = { 0 }, q[4];
	for (int i = 0; i < 3 && size > 0; i++)
		v[i] = s->w[i] / size * sinl(half);
	q[0] = c * s->q[0] - dot(v, s->q + 1);
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		q[1 + i] = c * s->q[1 + i] + s->q[0] * v[i] + v[j] * s->q[1 + k] - v[k] * s->q[1 + j];
	}
	*q_out = (ob_quat){ (double)q[0], (double)q[1], (double)q[2], (double)q[3] };
	*w_out = ob_v3((double)s->w[0], (double)s->w[1], (double)s->w[2]);
}

void ob_reference_spin_at(const ob_reference_spin *s, double t, ob_quat *q_out, ob_vec3 *w_out)
{
	if (s->steady) {
		turn_steadily(s, t, q_out, w_out);
		return;
	}
	real w[3], n[3], lift[3][3], turned[3][3], sorted[3][3], r[3][3], chi = turn_at(s, t), out[3] = { 0 };
	rates_at(s, s->phase + s->speed * t, w);
	direction_of(s, w, n);
	lift_of(n, lift);
	const real about[3][3] = { { cosl(chi), -sinl(chi), 0 }, { sinl(chi), cosl(chi), 0 }, { 0, 0, 1 } };
	multiply(about, lift, turned);
	multiply(s->frame, turned, sorted);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			r[i][s->axis[j]] = sorted[i][j] * s->sign[j];
			out[i] += sorted[i][j] * w[j];
		}
	*q_out = quaternion_of(r);
	*w_out = ob_v3((double)out[0], (double)out[1], (double)out[2]);
}

double ob_reference_turn_between(ob_quat a, ob_quat b)
{
	ob_quat d = ob_quat_mul(b, ob_quat_conjugate(a));
	return 2 * atan2(sqrt(d.x * d.x + d.y * d.y + d.z * d.z), fabs(d.w));
}

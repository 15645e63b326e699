// Lanes are independent and nothing is contracted, so a body's bits are those of a scalar evaluation.
#include "motion/spin_lanes.h"

#include <math.h>

#include "elementary/elementary.h"

typedef lanes wide;
typedef lane_mask wide_mask;
enum { WIDTH = OB_LANES };
#include "elementary/sincos_wide.h"

#include "elementary/arc_wide.h" // needs the types above

#include "elementary/real_lanes.h"
#include "motion/theta.h"

// ---- interface of theta.h for four bodies

static inline real signed_as(real size, real x)
{
	return (real)(((mask)size & INT64_MAX) | ((mask)x & INT64_MIN));
}

static inline real angle_of(real y, real x)
{
	const real up = lanes_abs(y), most = lanes_max(up, x), least = lanes_min(up, x);
	const mask usual = (least >= 0x1p-120 * most) & (least > 0) & (most < 0x1p300) & (most > 0x1p-300);
	const real one = lanes_of(1);
	real angle = signed_as(angle_wide(chosen(usual, up, one), chosen(usual, x, one)), y);
	const unsigned rare = 15 & ~lanes_bits(usual);
	for (int l = 0; rare && l < OB_LANES; l++)
		if (rare & 1u << l)
			lanes_put(&angle, l, ob_atan2(y[l], x[l]));
	return angle;
}

static inline real power_of_e(real x)
{
	return (real){ ob_exp(x[0]), ob_exp(x[1]), ob_exp(x[2]), ob_exp(x[3]) };
}

static inline real power_of_e_less_1(real x)
{
	return (real){ ob_expm1(x[0]), ob_expm1(x[1]), ob_expm1(x[2]), ob_expm1(x[3]) };
}

// The only place with fused operations.
__attribute__((target("avx2,fma"))) static real excess_of(real w, real x, real y, real z)
{
	const __m256d sum = _mm256_fmadd_pd((__m256d)z, (__m256d)z, (__m256d)lanes_of(-1));
	return (real)_mm256_fmadd_pd(
		(__m256d)w, (__m256d)w,
		_mm256_fmadd_pd((__m256d)x, (__m256d)x, _mm256_fmadd_pd((__m256d)y, (__m256d)y, sum)));
}

static inline void sines_of_lanes(real x, real *sine, real *cosine)
{
	wide whole, square, s, c;
	sincos_wide(x, &whole, &square, &s, &c);
	const mask quarters = (mask)whole, odd = (quarters & 1) != 0;
	const mask sine_below = (quarters & 2) != 0, cosine_below = ((quarters + 1) & 2) != 0;
	*sine = chosen(odd, c, s);
	*cosine = chosen(odd, s, c);
	*sine = chosen(sine_below, -*sine, *sine);
	*cosine = chosen(cosine_below, -*cosine, *cosine);
	const unsigned rare = 15 & ~lanes_bits((lanes_abs(x) < MODERATE) & (square >= LEAST_SQUARE));
	for (int l = 0; rare && l < OB_LANES; l++)
		if (rare & 1u << l) {
			double sine_of_it, cosine_of_it;
			ob_sincos(x[l], &sine_of_it, &cosine_of_it);
			lanes_put(sine, l, sine_of_it);
			lanes_put(cosine, l, cosine_of_it);
		}
}

static inline void sines_of(real a, real b, real *sine_a, real *cosine_a, real *sine_b, real *cosine_b)
{
	sines_of_lanes(a, sine_a, cosine_a);
	sines_of_lanes(b, sine_b, cosine_b);
}

// ---- transposition of four rotations into lanes, and back

enum { BLOCK = 4 };
_Static_assert(OB_THETA_CONSTANTS % BLOCK == 0 && OB_THETA_TERMS % BLOCK == 0,
	       "they are turned over in blocks of four");

static inline void load_blocks(const double *const from[OB_LANES], int numbers, lanes *x)
{
	for (int i = 0; i < numbers; i += BLOCK) {
		for (int l = 0; l < OB_LANES; l++)
			x[i + l] = lanes_load(from[l] + i);
		lanes_transpose(x + i);
	}
}

static inline void store_blocks(const lanes *x, int numbers, double *const to[], int n)
{
	for (int i = 0; i < numbers; i += BLOCK) {
		lanes block[BLOCK] = { x[i], x[i + 1], x[i + 2], x[i + 3] };
		lanes_transpose(block);
		for (int l = 0; l < n; l++)
			lanes_store(to[l] + i, block[l]);
	}
}

void ob_spin_lanes_plan(ob_spin *const *spin, const ob_theta_start *from, int n)
{
	const double *begin[OB_LANES];
	double *to[4][OB_LANES];
	lanes x[8], k[OB_THETA_CONSTANTS], plain[OB_THETA_TERMS], even[OB_THETA_TERMS], odd[OB_THETA_TERMS], count;
	for (int l = 0; l < OB_LANES; l++)
		begin[l] = &from[l < n ? l : 0].size; // an unused lane repeats the first
	load_blocks(begin, 8, x);
	const int terms = plan_theta(k, plain, even, odd, &count, x[0], (vector){ x[1], x[2], x[3] }, x[4], x[5], x[6]);
	for (int i = terms; i % BLOCK; i++)
		plain[i] = even[i] = odd[i] = lanes_of(0);
	for (int l = 0; l < n; l++) {
		to[0][l] = spin[l]->theta + OB_THETA_AMPLITUDE;
		to[1][l] = spin[l]->series.plain, to[2][l] = spin[l]->series.even, to[3][l] = spin[l]->series.odd;
		spin[l]->series.terms = (int)count[l];
	}
	store_blocks(k + OB_THETA_AMPLITUDE, OB_THETA_FRAME - OB_THETA_AMPLITUDE, to[0], n);
	store_blocks(plain, terms, to[1], n);
	store_blocks(even, terms, to[2], n);
	store_blocks(odd, terms, to[3], n);
}

// Loads a series, padded with 0 to the longest of the lanes.
static inline void load_series(const double *const from[OB_LANES], lanes count, int terms, lanes *x)
{
	load_blocks(from, terms, x);
	for (int i = 0; i < terms; i++)
		x[i] = lanes_where(count > i, x[i]);
}

void ob_spin_lanes_turn(ob_spin *const *spin, const double *s, int n)
{
	const double *from[4][OB_LANES];
	lanes k[OB_THETA_CONSTANTS], plain[OB_THETA_TERMS], even[OB_THETA_TERMS], odd[OB_THETA_TERMS], count, when;
	int terms = 0;
	for (int l = 0; l < OB_LANES; l++) {
		const ob_spin *of = spin[l < n ? l : 0];
		from[0][l] = of->theta;
		from[1][l] = of->series.plain, from[2][l] = of->series.even, from[3][l] = of->series.odd;
		terms = of->series.terms > terms ? of->series.terms : terms;
		lanes_put(&count, l, of->series.terms);
		lanes_put(&when, l, s[l < n ? l : 0]);
	}
	load_blocks(from[0], OB_THETA_CONSTANTS, k);
	load_series(from[1], count, terms, plain);
	load_series(from[2], count, terms, even);
	load_series(from[3], count, terms, odd);
	const series t = { terms, even, odd, plain };
	quaternion q;
	vector w;
	turn_theta(k, &t, when, &q, &w);
	for (int l = 0; l < n; l++) {
		spin[l]->last = s[l];
		spin[l]->last_q = (ob_quat){ q.w[l], q.x[l], q.y[l], q.z[l] };
		spin[l]->last_w = ob_v3(w.x[l], w.y[l], w.z[l]);
	}
}

// sin, cos, tan: subtracts the nearest multiple of pi / 2 in two doubles, then evaluates a polynomial on [-pi / 4, pi /
// 4].
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "elementary/double2.h"
#include "elementary/elementary.h"

typedef double wide __attribute__((vector_size(16)));
#include "elementary/sincos_wide.h"

static const double QUARTER = 0x1.921fb54442d18p-1; // pi / 4

// Bits of 2 / pi, behind a word of zeros. The last bit of a double is 2^-52 of 2^1023: 192 bits from there on.
static const uint64_t TWO_OVER_PI[] = {
	0,
	0xa2f9836e4e441529,
	0xfc2757d1f534ddc0,
	0xdb6295993c439041,
	0xfe5163abdebbc561,
	0xb7246e3a424dd2e0,
	0x06492eea09d1921c,
	0xfe1deb1cb129a73e,
	0xe88235f52ebb4484,
	0xe99c7026b45f7e41,
	0x3991d639835339f4,
	0x9c845f8bbdf9283b,
	0x1ff897ffde05980f,
	0xef2f118b5a0a6d1f,
	0x6d367ecf27cb09b7,
	0x4f463f669e5fea2d,
	0x7527bac7ebe5f17b,
	0x3d0739f78a5292ea,
	0x6bfb5fb11f8d5d08,
	0x56033046fc7b6bab,
};

// Returns 64 bits from number `first` on (0: the first).
static uint64_t bits_at(int first)
{
	const int word = first / 64, shift = first % 64;
	return shift ? TWO_OVER_PI[word] << shift | TWO_OVER_PI[word + 1] >> (64 - shift) : TWO_OVER_PI[word];
}

// Multiplies a fraction of 128 bits, f / 2^128, by pi / 2.
static ob_double2 turned(unsigned __int128 f)
{
	int zeros = 0;
	for (; zeros < 127 && !(f >> 127); zeros++)
		f <<= 1;
	const double h = (double)(uint64_t)(f >> 75), l = (double)((uint64_t)(f >> 22) & ((UINT64_C(1) << 53) - 1));
	return ob_double2_times((ob_double2){ ldexp(h, -53 - zeros), ldexp(l, -106 - zeros) },
				(ob_double2){ 0x1.921fb54442d18p0, 0x1.1a62633145c07p-54 });
}

// Multiplies x = m 2^e by 192 bits of 2 / pi (Payne and Hanek 1983). Higher bits make multiples of four quarters; lower
// ones are too small to matter. In the lowest 192 bits of the product, the first two are the quarters, the others the
// fraction of one.
static unsigned reduce_large(double x, ob_double2 *r)
{
	int e;
	const uint64_t m = (uint64_t)ldexp(frexp(fabs(x), &e), 53);
	const int first = 64 + (e - 53) - 2;
	const unsigned __int128 low = (unsigned __int128)m * bits_at(first + 128),
				middle = (unsigned __int128)m * bits_at(first + 64) + (uint64_t)(low >> 64);
	const uint64_t top = m * bits_at(first) + (uint64_t)(middle >> 64);
	unsigned quarters = (unsigned)(top >> 62);
	unsigned __int128 fraction = (unsigned __int128)(top << 2 | (uint64_t)middle >> 62) << 64 |
				     ((uint64_t)middle << 2 | (uint64_t)low >> 62);
	const bool more = fraction >> 127; // than half a quarter: use the distance to the next one
	if (more) {
		fraction = -fraction;
		quarters++;
	}
	*r = turned(fraction);
	if (more != (x < 0))
		*r = (ob_double2){ -r->h, -r->l };
	return x < 0 ? -quarters : quarters;
}

// Subtracts the nearest multiple of pi / 2 from x, and returns that multiple modulo 4. x is finite.
static unsigned reduce(double x, ob_double2 *r)
{
	*r = (ob_double2){ x, 0 };
	if (fabs(x) <= QUARTER)
		return 0;
	if (fabs(x) >= MODERATE)
		return reduce_large(x, r);
	const double n = (x * INVERSE + 0x1.8p52) - 0x1.8p52; // rounded to a whole number
	const ob_double2 b = ob_double2_sum(x - n * PART[0], -n * PART[1]); // the difference is exact
	const ob_double2 c = ob_double2_sum(b.h, -n * PART[2]);
	*r = ob_double2_quick_sum(c.h, c.l + (b.l - n * PART[3]));
	return (unsigned)(int)n;
}

// |r| <= pi / 4; accurate to a quarter of a unit in the last place
static inline ob_double2 sine_of(ob_double2 r)
{
	const double z = r.h * r.h;
	if (z < 0x1p-54)
		return r; // also keeps the sign of a zero
	const double p = 0x1.111111110f75fp-7 +
			 z * (-0x1.a01a019bf28b4p-13 +
			      z * (0x1.71de355f7915bp-19 + z * (-0x1.ae5e54dbfa739p-26 + z * 0x1.5d8e5779a76bbp-33)));
	return ob_double2_quick_sum(r.h, r.h * z * (-0x1.5555555555548p-3 + z * p) + r.l * (1 - .5 * z));
}

static inline ob_double2 cosine_of(ob_double2 r)
{
	const ob_double2 square = ob_double2_square(r.h);
	const double z = square.h, half = .5 * z, w = 1 - half;
	const double p = -0x1.6c16c16c15222p-10 +
			 z * (0x1.a01a019cbfd1ep-16 +
			      z * (-0x1.27e4f81313d05p-22 + z * (0x1.1ee9f19630fedp-29 - z * 0x1.8fb154d070a87p-37)));
	return ob_double2_quick_sum(w, ((1 - w) - half) - .5 * square.l +
					       (z * z * (0x1.555555555554cp-5 + z * p) - r.h * r.l));
}

void ob_sincos(double x, double *sine, double *cosine)
{
	ob_double2 r;
	if (!isfinite(x)) {
		*sine = *cosine = NAN;
		return;
	}
	const unsigned quarters = reduce(x, &r);
	const double s = sine_of(r).h, c = cosine_of(r).h;
	*sine = quarters & 1 ? c : s;
	*cosine = quarters & 1 ? s : c;
	if (quarters & 2)
		*sine = -*sine;
	if ((quarters + 1) & 2)
		*cosine = -*cosine;
}

void ob_sincos_of_two(const double x[2], double sine[2], double cosine[2])
{
	wide whole, square, s, c;
	const bool moderate = fabs(x[0]) < MODERATE && fabs(x[1]) < MODERATE;
	if (moderate)
		sincos_wide((wide){ x[0], x[1] }, &whole, &square, &s, &c);
	if (!moderate || square[0] < LEAST_SQUARE || square[1] < LEAST_SQUARE) {
		ob_sincos(x[0], &sine[0], &cosine[0]);
		ob_sincos(x[1], &sine[1], &cosine[1]);
		return;
	}
	for (int i = 0; i < 2; i++) {
		const unsigned quarters = (unsigned)(int)(whole[i] - WHOLE);
		sine[i] = quarters & 1 ? c[i] : s[i];
		cosine[i] = quarters & 1 ? s[i] : c[i];
		if (quarters & 2)
			sine[i] = -sine[i];
		if ((quarters + 1) & 2)
			cosine[i] = -cosine[i];
	}
}

double ob_sin(double x)
{
	ob_double2 r;
	if (!isfinite(x))
		return NAN;
	const unsigned quarters = reduce(x, &r);
	const double s = quarters & 1 ? cosine_of(r).h : sine_of(r).h;
	return quarters & 2 ? -s : s;
}

double ob_cos(double x)
{
	ob_double2 r;
	if (!isfinite(x))
		return NAN;
	const unsigned quarters = reduce(x, &r);
	const double c = quarters & 1 ? sine_of(r).h : cosine_of(r).h;
	return (quarters + 1) & 2 ? -c : c;
}

double ob_tan(double x)
{
	ob_double2 r;
	if (!isfinite(x))
		return NAN;
	const unsigned quarters = reduce(x, &r);
	const ob_double2 s = sine_of(r), c = cosine_of(r), above = quarters & 1 ? c : s, below = quarters & 1 ? s : c;
	if (above.h == 0 || fabs(above.h) < 0x1p-500)
		return above.h; // x is 0, or so small that it equals its tangent
	const double q = above.h / below.h;
	const ob_double2 back = ob_double2_product(q, below.h);
	const double t = q + ((above.h - back.h) - back.l + above.l - q * below.l) / below.h;
	return quarters & 1 ? -t : t;
}

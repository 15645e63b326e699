// Sine and cosine of several angles side by side, by the operations of ob_sincos in the same order: each lane has the
// bits of ob_sincos. Text for vectors of one width; the including file first names the type: typedef double wide.
#ifndef OB_ELEMENTARY_SINCOS_WIDE_H
#define OB_ELEMENTARY_SINCOS_WIDE_H

static const double INVERSE = 0x1.45f306dc9c883p-1; // 2 / pi
// pi / 2 in parts of 33 bits and a rest: their products with numbers of 20 bits are exact.
static const double PART[4] = { 0x1.921fb544p0, 0x1.0b4611a6p-34, 0x1.3198a2ep-69, 0x1.b839a252049c1p-104 };
static const double MODERATE = 0x1p19; // below it a quotient has 19 bits
static const double LEAST_SQUARE = 0x1p-54; // of an angle: below it, the angle equals its sine
static const double WHOLE = 0x1.8p52; // adding it rounds a number to a whole one, which fills its last bits

static inline wide wide_of(double x)
{
	return x - (wide){ 0 };
}

static inline wide wide_sum(wide a, wide b, wide *rest)
{
	const wide s = a + b, t = s - a;
	*rest = (a - (s - t)) + (b - t);
	return s;
}

// x: moderate. whole: the quarters, as above. square: square of the remainder. sine and cosine: of the remainder; valid
// unless the square is too small.
static inline void sincos_wide(wide x, wide *whole, wide *square, wide *sine, wide *cosine)
{
	wide b_rest, c_rest;
	*whole = x * INVERSE + WHOLE;
	const wide n = *whole - WHOLE;
	const wide b = wide_sum(x - n * PART[0], -n * PART[1], &b_rest), c = wide_sum(b, -n * PART[2], &c_rest);
	const wide more = c_rest + (b_rest - n * PART[3]), h = c + more, l = more - (h - c), z = h * h;
	const wide odd = wide_of(0x1.111111110f75fp-7) +
			 z * (wide_of(-0x1.a01a019bf28b4p-13) +
			      z * (wide_of(0x1.71de355f7915bp-19) +
				   z * (wide_of(-0x1.ae5e54dbfa739p-26) + z * 0x1.5d8e5779a76bbp-33)));
	const wide even = wide_of(-0x1.6c16c16c15222p-10) +
			  z * (wide_of(0x1.a01a019cbfd1ep-16) +
			       z * (wide_of(-0x1.27e4f81313d05p-22) +
				    z * (wide_of(0x1.1ee9f19630fedp-29) - z * 0x1.8fb154d070a87p-37)));
	const wide t = 134217729 * h, upper = t - (t - h), lower = h - upper; // as ob_double2_square
	const wide z_rest = ((upper * upper - z) + 2 * upper * lower) + lower * lower, half = .5 * z, w = 1 - half;
	*square = z;
	*sine = h + (h * z * (wide_of(-0x1.5555555555548p-3) + z * odd) + l * (1 - .5 * z));
	*cosine = w + (((1 - w) - half) - .5 * z_rest + (z * z * (wide_of(0x1.555555555554cp-5) + z * even) - h * l));
}

#endif

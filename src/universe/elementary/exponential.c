// exp, log and functions made of them: a table for the first bits, a short polynomial for the rest, in pairs of
// doubles.
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "elementary/double2.h"
#include "elementary/elementary.h"

// 2^(j / 32)
static const ob_double2 POWER[32] = {
	{ 0x1p0, 0 },
	{ 0x1.059b0d3158574p0, 0x1.d73e2a475b465p-55 },
	{ 0x1.0b5586cf9890fp0, 0x1.8a62e4adc610bp-54 },
	{ 0x1.11301d0125b51p0, -0x1.6c51039449b3ap-54 },
	{ 0x1.172b83c7d517bp0, -0x1.19041b9d78a76p-55 },
	{ 0x1.1d4873168b9aap0, 0x1.e016e00a2643cp-54 },
	{ 0x1.2387a6e756238p0, 0x1.9b07eb6c70573p-54 },
	{ 0x1.29e9df51fdee1p0, 0x1.612e8afad1255p-55 },
	{ 0x1.306fe0a31b715p0, 0x1.6f46ad23182e4p-55 },
	{ 0x1.371a7373aa9cbp0, -0x1.63aeabf42eae2p-54 },
	{ 0x1.3dea64c123422p0, 0x1.ada0911f09ebcp-55 },
	{ 0x1.44e086061892dp0, 0x1.89b7a04ef80dp-59 },
	{ 0x1.4bfdad5362a27p0, 0x1.d4397afec42e2p-56 },
	{ 0x1.5342b569d4f82p0, -0x1.07abe1db13cadp-55 },
	{ 0x1.5ab07dd485429p0, 0x1.6324c054647adp-54 },
	{ 0x1.6247eb03a5585p0, -0x1.383c17e40b497p-54 },
	{ 0x1.6a09e667f3bcdp0, -0x1.bdd3413b26456p-54 },
	{ 0x1.71f75e8ec5f74p0, -0x1.16e4786887a99p-55 },
	{ 0x1.7a11473eb0187p0, -0x1.41577ee04992fp-55 },
	{ 0x1.82589994cce13p0, -0x1.d4c1dd41532d8p-54 },
	{ 0x1.8ace5422aa0dbp0, 0x1.6e9f156864b27p-54 },
	{ 0x1.93737b0cdc5e5p0, -0x1.75fc781b57ebcp-57 },
	{ 0x1.9c49182a3f09p0, 0x1.c7c46b071f2bep-56 },
	{ 0x1.a5503b23e255dp0, -0x1.d2f6edb8d41e1p-54 },
	{ 0x1.ae89f995ad3adp0, 0x1.7a1cd345dcc81p-54 },
	{ 0x1.b7f76f2fb5e47p0, -0x1.5584f7e54ac3bp-56 },
	{ 0x1.c199bdd85529cp0, 0x1.11065895048ddp-55 },
	{ 0x1.cb720dcef9069p0, 0x1.503cbd1e949dbp-56 },
	{ 0x1.d5818dcfba487p0, 0x1.2ed02d75b3707p-55 },
	{ 0x1.dfc97337b9b5fp0, -0x1.1a5cd4f184b5cp-54 },
	{ 0x1.ea4afa2a490dap0, -0x1.e9c23179c2893p-54 },
	{ 0x1.f50765b6e454p0, 0x1.9d3e12dd8a18bp-54 },
};

// Intervals of [2^-.5, 2^.5): the reciprocal c of about the middle, in 9 bits, and -log(c). The first part of -log(c)
// is a multiple of 2^-42.
static const struct {
	double c, h, l;
} INTERVAL[64] = {
	{ 0x1.68p0, -0x1.5d1bdbf581p-2, 0x1.8d6bdc9c7c238p-44 },
	{ 0x1.64p0, -0x1.51aad872ep-2, 0x1.f4bd8db0a7cc1p-44 },
	{ 0x1.6p0, -0x1.4618bc21c6p-2, 0x1.3d82f484c84ccp-46 },
	{ 0x1.5dp0, -0x1.3d54fa5c1fp-2, -0x1.c3e1cd9a395e3p-44 },
	{ 0x1.59p0, -0x1.31871c9544p-2, -0x1.84fab94cecfd9p-46 },
	{ 0x1.55p0, -0x1.2596010df7p-2, -0x1.8e7bc224ea3e3p-44 },
	{ 0x1.52p0, -0x1.1c898c169ap-2, 0x1.81410e5c62affp-44 },
	{ 0x1.4ep0, -0x1.1058bf9ae5p-2, 0x1.4ab9d817d52cdp-44 },
	{ 0x1.4bp0, -0x1.071b85fcd6p-2, 0x1.bcb8ba3e01a11p-44 },
	{ 0x1.48p0, -0x1.fb9186d5e4p-3, 0x1.d572aab993c87p-47 },
	{ 0x1.44p0, -0x1.e27076e2bp-3, 0x1.a342c2af0003cp-44 },
	{ 0x1.41p0, -0x1.cf6354e09cp-3, -0x1.771239a07d55bp-45 },
	{ 0x1.3ep0, -0x1.bc286742d8p-3, -0x1.9ac53f39d121cp-44 },
	{ 0x1.3bp0, -0x1.a8becfc882p-3, -0x1.e3185cf21b9cfp-44 },
	{ 0x1.38p0, -0x1.9525a9cf46p-3, 0x1.297137d9f158fp-44 },
	{ 0x1.35p0, -0x1.815c0a1436p-3, 0x1.02a52f9201ce8p-44 },
	{ 0x1.32p0, -0x1.6d60fe719ep-3, 0x1.bc6e557134767p-44 },
	{ 0x1.2fp0, -0x1.59338d9982p-3, -0x1.0ba68b7555d4ap-48 },
	{ 0x1.2dp0, -0x1.4ba36f39a6p-3, 0x1.4354bb3f219e5p-44 },
	{ 0x1.2ap0, -0x1.371fc201e8p-3, -0x1.ee8779b2d8abcp-44 },
	{ 0x1.27p0, -0x1.2266f190a6p-3, 0x1.4d20ab840e7f6p-45 },
	{ 0x1.25p0, -0x1.1478584674p-3, -0x1.563451027c75p-46 },
	{ 0x1.22p0, -0x1.fec9131dcp-4, 0x1.54555d1ae6607p-44 },
	{ 0x1.1fp0, -0x1.d4313d66ccp-4, 0x1.9454379135713p-45 },
	{ 0x1.1dp0, -0x1.b78c82bb1p-4, 0x1.25ef7bc3987e7p-44 },
	{ 0x1.1ap0, -0x1.8c345d6318p-4, -0x1.b20f5acb42a66p-44 },
	{ 0x1.18p0, -0x1.6f0d28ae58p-4, 0x1.4b4641b664613p-44 },
	{ 0x1.16p0, -0x1.51b073f06p-4, -0x1.83f69278e686ap-44 },
	{ 0x1.13p0, -0x1.253f62f0ap-4, -0x1.416f8fb69a701p-44 },
	{ 0x1.11p0, -0x1.075983599p-4, 0x1.b8ecfe4b59987p-44 },
	{ 0x1.0fp0, -0x1.d276b8adbp-5, -0x1.6a423c78a64bp-46 },
	{ 0x1.0dp0, -0x1.95c830ec9p-5, 0x1.c148297c5feb8p-45 },
	{ 0x1.0ap0, -0x1.39e87b9fe8p-5, -0x1.eafd480ad9015p-44 },
	{ 0x1.08p0, -0x1.f829b0e78p-6, -0x1.980267c7e09e4p-45 },
	{ 0x1.06p0, -0x1.7b91b07d6p-6, 0x1.3b955b602ace4p-44 },
	{ 0x1.04p0, -0x1.fc0a8b0fcp-7, -0x1.f1e7cf6d3a69cp-50 },
	{ 0x1.02p0, -0x1.fe02a6b1p-8, -0x1.9e23f0dda40e4p-46 },
	{ 0x1p0, 0, 0 },
	{ 0x1.f8p-1, 0x1.020565893p-6, 0x1.611d27c8e8417p-44 },
	{ 0x1.fp-1, 0x1.0415d89e78p-5, -0x1.dddc7f461c516p-44 },
	{ 0x1.eap-1, 0x1.67c94f2d48p-5, 0x1.dac20827cca0cp-44 },
	{ 0x1.e2p-1, 0x1.eea31c0068p-5, 0x1.c3dd83606d891p-44 },
	{ 0x1.dap-1, 0x1.3bdf5a7d2p-4, -0x1.19bd0ad125895p-44 },
	{ 0x1.d4p-1, 0x1.700d30aeacp-4, 0x1.c1e8da99ded32p-49 },
	{ 0x1.cep-1, 0x1.a4e7640b1cp-4, -0x1.e42b6b94407c8p-47 },
	{ 0x1.c8p-1, 0x1.da72763844p-4, 0x1.a89401fa71733p-46 },
	{ 0x1.cp-1, 0x1.1178e8227ep-3, 0x1.1ef78ce2d07f2p-45 },
	{ 0x1.bap-1, 0x1.2d1610c868p-3, 0x1.39d6ccb81b4a1p-47 },
	{ 0x1.b4p-1, 0x1.4913d8333cp-3, -0x1.53e43558124c4p-44 },
	{ 0x1.bp-1, 0x1.5bf406b544p-3, -0x1.27023eb68981cp-46 },
	{ 0x1.aap-1, 0x1.7898d85444p-3, 0x1.8e67be3dbaf3fp-44 },
	{ 0x1.a4p-1, 0x1.95a5adcf7p-3, 0x1.7f22858a0ff6fp-47 },
	{ 0x1.9ep-1, 0x1.b31d8575bcp-3, 0x1.c794e562a63cbp-44 },
	{ 0x1.9ap-1, 0x1.c6ffbc6fp-3, 0x1.ee138d3a69d43p-44 },
	{ 0x1.94p-1, 0x1.e530effe72p-3, -0x1.fdbdbb13f7c18p-44 },
	{ 0x1.9p-1, 0x1.f991c6cb3cp-3, -0x1.90d04cd7cc834p-44 },
	{ 0x1.8ap-1, 0x1.0c42d67616p-2, 0x1.7188b163ceae9p-45 },
	{ 0x1.86p-1, 0x1.16b5ccbadp-2, -0x1.23299042d74bfp-44 },
	{ 0x1.82p-1, 0x1.214456d0ecp-2, -0x1.caf0428b728a3p-44 },
	{ 0x1.7ep-1, 0x1.2bef07cdc9p-2, 0x1.a9cfa4a5004f4p-45 },
	{ 0x1.78p-1, 0x1.3c25277333p-2, 0x1.83b54b606bd5cp-46 },
	{ 0x1.74p-1, 0x1.4718dc271cp-2, 0x1.06c18fb4c14c5p-44 },
	{ 0x1.7p-1, 0x1.522ae0738ap-2, 0x1.ebe708164c759p-45 },
	{ 0x1.6cp-1, 0x1.5d5bddf596p-2, -0x1.a0b2a08a465dcp-47 },
};
static const uint64_t FIRST = UINT64_C(0x3fe6a00000000000); // bits of the start of the first interval, 181 / 256

static uint64_t bits_of(double x)
{
	uint64_t bits;
	memcpy(&bits, &x, sizeof bits);
	return bits;
}

static double double_of(uint64_t bits)
{
	double x;
	memcpy(&x, &bits, sizeof x);
	return x;
}

// Returns m 2^n; m from .5 to 4.
static double scaled(double m, int n)
{
	return n > -1000 && n < 1000 ? m * double_of((uint64_t)(n + 1023) << 52) : ldexp(m, n);
}

// Reduces e^x to 2^n (1 + p) t with a power t of the table, p in [-.011, .011]; |x| < 800. Uses x = (32 n + j) log(2) /
// 32 + r.
static int reduce(ob_double2 x, ob_double2 *t, double *p)
{
	const double whole = (x.h * 0x1.71547652b82fep5 + 0x1.8p52) - 0x1.8p52;
	const double r = (x.h - whole * 0x1.62e42fefap-6) - (whole * 0x1.cf79abc9e3b39p-45 - x.l);
	const int k = (int)whole;
	*t = POWER[k & 31];
	*p = r +
	     r * r *
		     (.5 + r * (0x1.5555555548ee7p-3 +
				r * (0x1.555555554bec1p-5 + r * (0x1.11115b9798b66p-7 + r * 0x1.6c171a98e6c6ep-10))));
	return (k - (k & 31)) / 32;
}

static double exp_of(ob_double2 x)
{
	ob_double2 t;
	double p;
	const int n = reduce(x, &t, &p);
	return scaled(t.h + (t.l + t.h * p), n);
}

double ob_exp(double x)
{
	if (isnan(x))
		return NAN;
	if (x > 710)
		return INFINITY;
	return x < -746 ? 0 : exp_of((ob_double2){ x, 0 });
}

double ob_expm1(double x)
{
	ob_double2 t;
	double p;
	if (isnan(x))
		return NAN;
	if (x > 710)
		return INFINITY;
	if (x < -40)
		return -1;
	if (fabs(x) < 0x1p-54)
		return x;
	const int n = reduce((ob_double2){ x, 0 }, &t, &p);
	if (n > 1000)
		return exp_of((ob_double2){ x, 0 });
	const double scale = scaled(1, n);
	const ob_double2 s = ob_double2_sum(scale * t.h, -1);
	return s.h + (s.l + scale * (t.l + t.h * p));
}

double ob_sinh(double x)
{
	if (fabs(x) > 700) { // e^x may overflow although half of it does not
		const double root = ob_exp(.5 * fabs(x));
		return copysign(.5 * root * root, x);
	}
	const double e = ob_expm1(fabs(x));
	return copysign(.5 * (e + e / (e + 1)), x);
}

double ob_cosh(double x)
{
	if (fabs(x) > 700) {
		const double root = ob_exp(.5 * fabs(x));
		return .5 * root * root;
	}
	const double e = ob_exp(fabs(x));
	return .5 * (e + 1 / e);
}

double ob_tanh(double x)
{
	if (fabs(x) > 22)
		return copysign(1, x);
	const double e = ob_expm1(2 * fabs(x));
	return copysign(e / (e + 2), x);
}

// log(x), to a relative 2^-66; x > 0 and finite. Uses log(2^k m) with m c = 1 + r for a c of the table.
static ob_double2 log_of(double x)
{
	int k = 0;
	if (x < DBL_MIN) {
		x *= 0x1p54;
		k = -54;
	}
	const uint64_t past = bits_of(x) - FIRST;
	const unsigned i = (unsigned)(past >> 46) & 63;
	k += (int)((int64_t)past >> 52);
	const double m = double_of(bits_of(x) - (past & UINT64_C(0xfff) << 52)), c = INTERVAL[i].c;
	const double upper =
		double_of(bits_of(m) & ~UINT64_C(0xffffffff)); // its product with c is exact, as is the other's
	const ob_double2 r = ob_double2_sum(upper * c - 1, (m - upper) * c);
	const ob_double2 square = ob_double2_square(r.h);
	const double p = 0x1.555555555553ep-2 +
			 r.h * (-0x1.00000000005dap-2 +
				r.h * (0x1.9999999b1dccbp-3 +
				       r.h * (-0x1.555554f3fd796p-3 +
					      r.h * (0x1.24920a64cda1dp-3 +
						     r.h * (-0x1.000fb0dddb859p-3 + r.h * 0x1.cd95036b37415p-4)))));
	// k log(2) - log(c) + r - r^2 / 2 + r^3 p
	const ob_double2 table =
		ob_double2_quick_sum(k * 0x1.62e42fefa4p-1 + INTERVAL[i].h, k * -0x1.8432a1b0e2634p-43 + INTERVAL[i].l);
	const ob_double2 a = ob_double2_sum(table.h, r.h), b = ob_double2_sum(a.h, -.5 * square.h);
	const double low = (a.l + b.l) + (table.l + r.l * (1 - r.h) - .5 * square.l) + r.h * square.h * p;
	return ob_double2_quick_sum(b.h, low);
}

// Returns NaN or an infinity if the logarithm is not a number, 0 otherwise.
static double without_log(double x)
{
	if (x == 0)
		return -INFINITY;
	if (!(x > 0))
		return NAN;
	return isinf(x) ? INFINITY : 0;
}

double ob_log(double x)
{
	const double special = without_log(x);
	return special != 0 ? special : log_of(x).h;
}

double ob_log2(double x)
{
	const double special = without_log(x);
	const ob_double2 per = { 0x1.71547652b82fep0, 0x1.777d0ffda0d24p-56 }; // 1 / log(2)
	return special != 0 ? special : ob_double2_times(log_of(x), per).h;
}

double ob_log10(double x)
{
	const double special = without_log(x);
	const ob_double2 per = { 0x1.bcb7b1526e50ep-2, 0x1.95355baaafad3p-57 }; // 1 / log(10)
	return special != 0 ? special : ob_double2_times(log_of(x), per).h;
}

// x^y, x > 0 and neither infinite
static double power_of(double x, double y)
{
	const ob_double2 log = log_of(x);
	if (fabs(log.h * y) > 750)
		return (log.h > 0) == (y > 0) ? INFINITY : 0;
	if (fabs(log.h * y) < 0x1p-60)
		return 1;
	const ob_double2 p = ob_double2_product(log.h, y);
	return exp_of(ob_double2_quick_sum(p.h, p.l + log.l * y));
}

double ob_pow(double x, double y)
{
	if (y == 0 || x == 1)
		return 1;
	if (isnan(x) || isnan(y))
		return NAN;
	const double size = fabs(x);
	if (isinf(y)) {
		const bool grows = (size > 1) == (y > 0);
		return size == 1 ? 1 : grows ? INFINITY : 0;
	}
	const bool whole = y == floor(y), odd = whole && fmod(y, 2) != 0;
	const double sign = odd && signbit(x) ? -1 : 1;
	if (size == 0 || isinf(size)) {
		const bool large = (size == 0) == (y < 0);
		return large ? sign * INFINITY : sign * 0;
	}
	return x < 0 && !whole ? NAN : sign * power_of(size, y);
}

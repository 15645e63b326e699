#include "scene/random.h"

#include "base/random.h"

void ob_random_seed(ob_random *r, uint64_t seed)
{
	for (int i = 0; i < 4; i++)
		r->s[i] = ob_splitmix(&seed);
}

static uint64_t rotate(uint64_t x, int n)
{
	return (x << n) | (x >> (64 - n));
}

uint64_t ob_random_next(ob_random *r)
{
	uint64_t *s = r->s, result = rotate(s[1] * 5, 7) * 9, t = s[1] << 17;
	s[2] ^= s[0];
	s[3] ^= s[1];
	s[1] ^= s[2];
	s[0] ^= s[3];
	s[2] ^= t;
	s[3] = rotate(s[3], 45);
	return result;
}

double ob_random_real(ob_random *r)
{
	return (double)(ob_random_next(r) >> 11) * 0x1p-53;
}

// Draws below the next power of two until one fits: at most two draws on average.
uint64_t ob_random_up_to(ob_random *r, uint64_t last)
{
	uint64_t mask = last;
	for (int shift = 1; shift < 64; shift *= 2)
		mask |= mask >> shift;
	uint64_t x;
	do
		x = ob_random_next(r) & mask;
	while (x > last);
	return x;
}

ob_quat ob_random_rotation(ob_random *r)
{
	double u = ob_random_real(r), a = 2 * M_PI * ob_random_real(r), b = 2 * M_PI * ob_random_real(r);
	return (ob_quat){ sqrt(u) * cos(b), sqrt(1 - u) * sin(a), sqrt(1 - u) * cos(a), sqrt(u) * sin(b) };
}

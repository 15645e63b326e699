// Impacts against a stiff spring integrated in small steps, and against the laws of conservation.
#include "reference/impact.h"

#include "check.h"

// Two masses with a spring between them while they overlap, which pushes back e^2 times as hard when it relaxes: the
// work that it gives back is e^2 of what it took. Verlet.
static ob_reference_pair through_a_spring(double a, double b, ob_reference_pair v, double e)
{
	const double stiffness = 1e4, h = 1e-6;
	double gap = 0, force = 0;
	do {
		double closing = v.a - v.b, half = .5 * h;
		v.a -= half * force / a;
		v.b += half * force / b;
		gap += h * (v.b - v.a);
		force = -stiffness * gap * (closing > 0 ? 1 : e * e);
		v.a -= half * force / a;
		v.b += half * force / b;
	} while (gap < 0);
	return v;
}

static void test_spring(void)
{
	const double mass[] = { 1, 2.5, 1000 }, e[] = { 1, .7, .3 };
	for (int i = 0; i < 9; i++) {
		ob_reference_pair v = { 3, -1 }, got = ob_reference_impact(2, mass[i % 3], v, e[i / 3]);
		ob_reference_pair want = through_a_spring(2, mass[i % 3], v, e[i / 3]);
		CHECK_NEAR(got.a, want.a, 5e-3);
		CHECK_NEAR(got.b, want.b, 5e-3);
	}
}

static void test_laws(void)
{
	for (int i = 0; i < 200; i++) {
		double a = 1 + i % 7, b = .001 * (1 + i), e = .01 * (i % 101);
		ob_reference_pair v = { 5 - .1 * i, -2 }, u = ob_reference_impact(a, b, v, e);
		double closing = v.a - v.b, loss = .5 * a * b / (a + b) * (1 - e * e) * closing * closing;
		double before = .5 * (a * v.a * v.a + b * v.b * v.b), after = .5 * (a * u.a * u.a + b * u.b * u.b);
		CHECK_NEAR(a * u.a + b * u.b, a * v.a + b * v.b, 1e-13 * (a * fabs(v.a) + 2 * b));
		CHECK_NEAR(u.b - u.a, e * closing, 1e-13 * (1 + fabs(closing)));
		CHECK_NEAR(after, before - loss, 1e-12 * before);
	}
	ob_reference_pair wall = ob_reference_impact(3, INFINITY, (ob_reference_pair){ 2, 0 }, .5);
	CHECK(wall.a == -1 && wall.b == 0);
	wall = ob_reference_impact(INFINITY, 3, (ob_reference_pair){ 1, 0 }, 1);
	CHECK(wall.a == 1 && wall.b == 2);
	ob_reference_pair swap = ob_reference_impact(1, 1, (ob_reference_pair){ 1, 0 }, 1);
	CHECK(swap.a == 0 && swap.b == 1);
}

// One pair after the other, until none approaches, in either order.
static void settle(int n, double *v, int backwards)
{
	for (int again = 1; again;) {
		again = 0;
		for (int k = 0; k + 1 < n; k++) {
			int i = backwards ? n - 2 - k : k;
			if (v[i] <= v[i + 1])
				continue;
			ob_reference_pair p = ob_reference_impact(1, 1, (ob_reference_pair){ v[i], v[i + 1] }, 1);
			v[i] = p.a;
			v[i + 1] = p.b;
			again = 1;
		}
	}
}

static void test_cradle(void)
{
	for (int n = 2; n <= 7; n++)
		for (int k = 0; k <= n; k++)
			for (int backwards = 0; backwards < 2; backwards++) {
				double want[7], got[7];
				for (int i = 0; i < n; i++)
					want[i] = i < k ? 1.5 : 0;
				settle(n, want, backwards);
				ob_reference_cradle(n, k, 1.5, got);
				for (int i = 0; i < n; i++)
					CHECK(got[i] == want[i]);
			}
}

int main(void)
{
	test_spring();
	test_laws();
	test_cradle();
	return check_end();
}

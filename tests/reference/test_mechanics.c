// Closed forms of mechanics against the equations of motion integrated in small steps, and against conserved
// quantities.
#include "reference/mechanics.h"

#include "check.h"

// ---- free fall and bounces

static const double g = 9.81; // m/s^2

// The second difference of positions is the acceleration, the first one at t = 0 the speed.
static void test_parabola(void)
{
	ob_vec3 p = ob_v3(1, -2, 3), v = ob_v3(4, 5, -6), a = ob_v3(.5, 1, -g);
	for (int i = 0; i < 20; i++) {
		double t = .3 * i, d = 1e-3;
		ob_vec3 before = ob_reference_parabola(p, v, a, t - d), at = ob_reference_parabola(p, v, a, t);
		ob_vec3 after = ob_reference_parabola(p, v, a, t + d);
		ob_vec3 bend = ob_scale(ob_add(ob_sub(after, at), ob_sub(before, at)), 1 / (d * d));
		ob_vec3 slope = ob_scale(ob_sub(after, before), .5 / d);
		CHECK_NEAR(ob_norm(ob_sub(bend, a)), 0, 1e-6);
		CHECK_NEAR(ob_norm(ob_sub(slope, ob_madd(v, t, a))), 0, 1e-9);
		CHECK_NEAR(.5 * ob_norm2(slope) - ob_dot(a, at), .5 * ob_norm2(v) - ob_dot(a, p), 1e-6); // energy
	}
}

// Follows the ball from impact to impact, by v^2 = 2 g h and v -> e v alone.
static void follow(double height, double e, int impacts)
{
	long double speed = sqrtl(2 * (long double)g * height), now = speed / g;
	for (int k = 1; k <= impacts; k++) {
		CHECK_NEAR(ob_reference_impact_time(height, g, e, k), (double)now, 1e-13 * (double)now);
		speed *= e;
		double top = (double)(speed * speed / (2 * g));
		CHECK_NEAR(ob_reference_apex(height, e, k), top, 1e-13 * height);
		now += 2 * speed / g;
	}
}

static void test_bounces(void)
{
	follow(1, 1, 100);
	follow(1, .8, 30);
	follow(3, .5, 12);
	CHECK(ob_reference_apex(1.3, .8, 0) == 1.3);
	CHECK_NEAR(ob_reference_apex(1, .8, 4), .16777216, 1e-15);
}

// Infinitely many impacts in finite time.
static void test_limit_of_bounces(void)
{
	CHECK_NEAR(ob_reference_impact_time(1, g, .5, 60), 3 * sqrt(2 / g), 1e-12);
}

// ---- impacts: against a stiff spring integrated in small steps

// Two masses with a spring between them while they overlap; it pushes back e^2 times as hard when it relaxes. So it
// returns e^2 of the work that it took. Verlet.
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

// Collides one pair after the other, until none approaches, in either order.
static void collide_until_apart(int n, double *v, int backwards)
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
				collide_until_apart(n, want, backwards);
				ob_reference_cradle(n, k, 1.5, got);
				for (int i = 0; i < n; i++)
					CHECK(got[i] == want[i]);
			}
}

// ---- friction: each small step computes the contact's friction anew

static const double r = .37, m = 2.3; // m, kg, of a ball

typedef struct ball {
	double x, v, spin; // m, m/s, rad/s
} ball;

// Friction within h: it stops the slip if it can, otherwise it acts at its limit.
static void rub(ball *b, double pull, double normal, double mu, double h)
{
	double inertia = .4 * m * r * r, slip = b->v + h * pull / m - b->spin * r;
	double need = -slip / (h * (1 / m + r * r / inertia)), most = mu * normal;
	double f = fmin(fmax(need, -most), most), before = b->v;
	b->v += h * (pull + f) / m;
	b->spin -= h * f * r / inertia;
	b->x += .5 * h * (b->v + before);
}

static void test_slip_to_roll(void)
{
	const double h = 1e-5, v = 7, mu = .2;
	ball b = { 0, v, 0 };
	CHECK_NEAR(ob_reference_roll_time(v, mu, g), 1.0194, 5e-5);
	CHECK(ob_reference_roll_speed(v) == 5);
	for (int i = 0; i < 200000; i++) {
		if (i % 5000 == 0) {
			ob_reference_roll at = ob_reference_slip_to_roll(v, mu, g, i * h);
			CHECK_NEAR(b.v, at.speed, 1e-4);
			CHECK_NEAR(b.spin * r, at.surface, 1e-4);
			CHECK_NEAR(b.x, at.distance, 1e-4);
			// angular momentum about the line of contact is conserved
			CHECK_NEAR(at.speed + .4 * at.surface, v, 1e-12);
		}
		rub(&b, 0, m * g, mu, h);
	}
}

static void test_slopes(void)
{
	for (int i = 0; i < 40; i++) {
		double angle = .02 + .03 * i, grip = ob_reference_ball_grip(angle);
		double mu = grip * (i % 2 ? 1.05 : .95), h = 1e-4;
		ball b = { 0, 0, 0 };
		for (int k = 0; k < 10000; k++)
			rub(&b, m * g * sin(angle), m * g * cos(angle), mu, h);
		double a = ob_reference_ball_incline(g, angle, mu);
		CHECK_NEAR(b.v, a, 1e-8 * g);
		CHECK_NEAR(b.spin * r, i % 2 ? a : 2.5 * mu * g * cos(angle), 1e-8 * g);
		// a block: without spin
		double sticks = ob_reference_friction_angle(.5);
		CHECK_NEAR(tan(sticks), .5, 1e-15);
		CHECK(ob_reference_incline(g, sticks * .999, .5) == 0 &&
		      ob_reference_incline(g, sticks * 1.001, .5) > 0);
		CHECK_NEAR(ob_reference_incline(g, angle, 0), g * sin(angle), 1e-12);
	}
	CHECK_NEAR(ob_reference_incline(g, M_PI / 2, .5), g, 1e-12);
	CHECK_NEAR(ob_reference_incline(10, asin(.6), .25), 6 - 2, 1e-14);
}

static void test_stopping(void)
{
	CHECK_NEAR(ob_reference_stop_distance(3, .5, g), .91743, 5e-6);
	CHECK_NEAR(ob_reference_stop_time(3, .5, g), .61162, 5e-6);
	double v = 4.2, x = 0, h = 1e-6, t = 0, mu = .3;
	for (; v > 0; t += h) {
		x += h * (v - .5 * h * mu * g);
		v -= h * mu * g;
	}
	CHECK_NEAR(ob_reference_stop_distance(4.2, mu, g), x, 1e-8);
	CHECK_NEAR(ob_reference_stop_time(4.2, mu, g), t, 2e-6);
}

// The equations of box and spheres, one by one; and the rows of the specification.
static void test_push(void)
{
	ob_reference_rolling p = ob_reference_push(150, .4, 10, 1, 25, g);
	CHECK_NEAR(p.box_a, .7385, 5e-5);
	CHECK_NEAR(p.ball_a, .2110, 5e-5);
	for (int n = 0; n <= 30; n += 3) {
		p = ob_reference_push(200, .3, 8, m, n, g);
		double inertia = .4 * m * r * r;
		CHECK_NEAR(8 * p.box_a, 200 - p.ground - n * p.ball, 1e-11);
		CHECK_NEAR(p.ground, .3 * (8 + n * m) * g, 1e-11);
		CHECK_NEAR(m * p.ball_a, p.ball, 1e-12);
		CHECK_NEAR(p.ball_a + p.ball * r / inertia * r, p.box_a, 1e-12); // the lowest point keeps up
		CHECK_NEAR(p.grip * m * g, p.ball, 1e-12);
	}
	CHECK_NEAR(ob_reference_push(150, .4, 10, 1, 0, g).box_a, 15 - .4 * g, 1e-12);
}

// ---- statics: centres of mass and torques, added up body by body

// The centre of all bricks above an edge lies right over it.
static void test_overhang(void)
{
	CHECK_NEAR(ob_reference_overhang(4), 25. / 24, 1e-15);
	CHECK(ob_reference_overhang(0) == 0);
	for (int n = 1; n <= 50; n++) {
		double left[51], end = 0; // left ends; brick 1 is the top, the table's edge is at 0
		for (int k = n; k >= 1; k--) {
			end += ob_reference_overhang_shift(k);
			left[k] = end - 1;
		}
		CHECK_NEAR(ob_reference_overhang(n), end, 1e-14);
		for (int k = 1; k <= n; k++) {
			double centre = 0, edge = k < n ? left[k + 1] + 1 : 0;
			for (int i = 1; i <= k; i++)
				centre += (left[i] + .5) / k;
			CHECK_NEAR(centre, edge, 1e-14);
		}
	}
}

// Forces and torques of one card from its corners' coordinates: the push that keeps it from turning about its foot,
// over its weight.
static double push_of(double angle, double length, double thickness)
{
	double along[2] = { sin(angle), cos(angle) }, out[2] = { -cos(angle), sin(angle) };
	double top[2], centre[2];
	for (int c = 0; c < 2; c++) {
		top[c] = length * along[c];
		centre[c] = .5 * (top[c] + thickness * out[c]);
	}
	return centre[0] / top[1];
}

static void test_cards(void)
{
	for (int i = 1; i < 30; i++) {
		double angle = .05 * i;
		CHECK_NEAR(ob_reference_cards_grip(angle, 1, 0), .5 * tan(angle), 1e-12);
		CHECK_NEAR(ob_reference_cards_grip(angle, .9, .01), push_of(angle, .9, .01), 1e-12);
		CHECK_NEAR(ob_reference_cards_grip(angle, 2, .3), push_of(angle, 2, .3), 1e-12);
	}
	CHECK(ob_reference_cards_grip(atan(.1), 1, .1) < 1e-15); // the centre stands over the foot
}

// Against small steps: the velocity approaches the table's as fast as friction allows.
static void test_shaken(void)
{
	static const double mu[] = { .05, .2, .35, .5 };
	const double amplitude = .1, f = 6, gravity = 9.81, h = 1e-5;
	for (int i = 0; i < 4; i++) {
		double x = 0, v = .2;
		for (int k = 1; k <= 300000; k++) {
			const double table = amplitude * f * cos(f * h * k), most = mu[i] * gravity * h,
				     change = fmax(-most, fmin(most, table - v));
			x += h * (v + .5 * change);
			v += change;
			if (k % 50000)
				continue;
			const ob_reference_shaken b =
				ob_reference_shaken_block(amplitude, f, mu[i], gravity, .2, h * k);
			CHECK_NEAR(b.x, x, 2e-5);
			CHECK_NEAR(b.v, v, 2e-4);
		}
	}
}

// Only friction acts on the ball, and turns it: m v' = F, I w' = -R z x F, v = R w x z + rate z x p.
static void test_turntable_ball(void)
{
	const double rate = 2, h = 1e-5;
	ob_vec3 p = ob_v3(1, 0, 0), v = ob_v3(.5, .1, 0);
	for (int k = 0; k < 200000; k++) {
		const ob_vec3 half = ob_madd(v, .5 * h * 2 / 7 * rate, ob_v3(-v.y, v.x, 0));
		p = ob_madd(p, h, half);
		v = ob_madd(v, h * 2 / 7 * rate, ob_v3(-half.y, half.x, 0));
	}
	CHECK_NEAR(ob_norm(ob_sub(p, ob_reference_turntable_ball(rate, ob_v3(1, 0, 0), ob_v3(.5, .1, 0), 2))), 0, 1e-8);
	CHECK_NEAR(ob_reference_turntable_radius(3, .6, 9.81), .654, 1e-12);
}

int main(void)
{
	test_parabola();
	test_bounces();
	test_limit_of_bounces();
	test_spring();
	test_laws();
	test_cradle();
	test_slip_to_roll();
	test_slopes();
	test_stopping();
	test_push();
	test_overhang();
	test_cards();
	test_shaken();
	test_turntable_ball();
	return check_end();
}

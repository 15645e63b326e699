// Motions in time: the parabola, states between two publications, and the time at which a gap closes.
#include <string.h>

#include <ob/motion.h>

#include "motion/flight.h"

#include "check.h"
#include "random.h"
#include "reference.h"

static ob_motion random_motion(uint64_t *seed)
{
	ob_motion m = { .t0 = within(seed, 0, 10), .q = random_attitude(seed) };
	m.p = random_vector(seed, 10);
	m.v = random_vector(seed, 10);
	m.w = random_vector(seed, 6);
	m.a = random_vector(seed, 10);
	return m;
}

static ob_motion motion_of(ob_state s, ob_vec3 a, double t)
{
	return (ob_motion){ .t0 = t, .p = s.pose.p, .q = s.pose.q, .v = s.v, .w = s.w, .a = a };
}

static double apart(ob_quat a, ob_quat b)
{
	long_rotation r = long_of(a, ob_v3(0, 0, 0));
	return attitude_error(&r, b);
}

static void test_known_throw(void)
{
	ob_motion m = { .t0 = 2, .p = { 1, 2, 3 }, .q = { 1, 0, 0, 0 }, .v = { 4, 0, 5 }, .w = { 0, 0, 1 } };
	m.a = ob_v3(0, 0, -10);
	ob_state s = ob_motion_at(&m, ob_v3(1, 2, 3), 2.5);
	CHECK_NEAR(s.pose.p.x, 3, 1e-15);
	CHECK_NEAR(s.pose.p.y, 2, 1e-15);
	CHECK_NEAR(s.pose.p.z, 3 + 2.5 - 1.25, 1e-15);
	CHECK_NEAR(s.v.x, 4, 1e-15);
	CHECK_NEAR(s.v.z, 0, 1e-15);
	CHECK_NEAR(s.pose.q.w, cos(.25), 1e-15);
	CHECK_NEAR(s.pose.q.z, sin(.25), 1e-15);
}

// Publishing again on the way changes nothing.
static void test_republishing(void)
{
	uint64_t seed = 6;
	for (int k = 0; k < 500; k++) {
		ob_motion m = random_motion(&seed);
		ob_vec3 inertia = random_inertia(&seed);
		double t1 = m.t0 + within(&seed, -.5, 2), t2 = m.t0 + within(&seed, -.5, 2);
		ob_state direct = ob_motion_at(&m, inertia, t2);
		ob_motion again = motion_of(ob_motion_at(&m, inertia, t1), m.a, t1);
		ob_state via = ob_motion_at(&again, inertia, t2);
		CHECK_NEAR(ob_norm(ob_sub(direct.pose.p, via.pose.p)), 0, 1e-12);
		CHECK_NEAR(ob_norm(ob_sub(direct.v, via.v)), 0, 1e-13);
		CHECK_NEAR(ob_norm(ob_sub(direct.w, via.w)), 0, 1e-9);
		CHECK_NEAR(apart(direct.pose.q, via.pose.q), 0, 1e-9);
	}
}

// States of many have the bits of each: of short turns and long ones, tops, bodies that rest, and absent ones.
static void test_many(void)
{
	enum { N = 100 };
	static ob_motion m[N];
	static ob_passport p[N];
	static ob_state all[N];
	uint64_t seed = 7;
	const double t = 5;
	for (int i = 1; i < N; i++) {
		p[i] = (ob_passport){ .flags = OB_OBJECT_PRESENT, .inertia = random_inertia(&seed) };
		m[i] = random_motion(&seed);
		if (i % 5 == 0)
			p[i].inertia.y = p[i].inertia.x;
		if (i % 7 == 0)
			m[i].flags = OB_MOTION_ASLEEP;
		if (i % 11 == 0)
			m[i].w = ob_v3(0, 0, 0);
		if (i % 13 == 0)
			m[i].t0 = i % 2 ? t : t - 1e-4;
	}
	ob_published_all(m, p, N, t, all);
	for (int i = 0; i < N; i++) {
		const ob_state one = ob_published_at(&m[i], &p[i], t);
		CHECK(memcmp(&one, &all[i], sizeof one) == 0);
	}
}

static void test_between_flights(void)
{
	uint64_t seed = 7;
	for (int k = 0; k < 200; k++) {
		ob_motion prev = random_motion(&seed);
		ob_vec3 inertia = random_inertia(&seed);
		double end = prev.t0 + within(&seed, .01, 2), t = within(&seed, prev.t0, end);
		ob_motion next = motion_of(ob_motion_at(&prev, inertia, end), prev.a, end);
		next.flags = OB_MOTION_FREE;
		ob_pose pose = ob_motion_between(&prev, &next, inertia, t);
		ob_state exact = ob_motion_at(&prev, inertia, t);
		CHECK_NEAR(ob_norm(ob_sub(pose.p, exact.pose.p)), 0, 0);
		CHECK_NEAR(apart(pose.q, exact.pose.q), 0, 1e-15);
	}
}

// Not free: straight from one to the other, turning evenly the shorter way, and never beyond the ends.
static void test_between_contacts(void)
{
	uint64_t seed = 8;
	for (int k = 0; k < 500; k++) {
		ob_motion prev = random_motion(&seed), next = prev;
		double size = pow(10, -within(&seed, 0, 9)), f = within(&seed, 0, 1);
		ob_vec3 turn = random_vector(&seed, 1.7 * size), one = ob_v3(1, 1, 1);
		next.t0 = prev.t0 + .01;
		next.p = ob_add(prev.p, random_vector(&seed, size));
		next.q = ob_quat_turn(prev.q, turn);
		if (k & 1) // the same attitude under its other sign
			next.q = (ob_quat){ -next.q.w, -next.q.x, -next.q.y, -next.q.z };
		ob_pose pose = ob_motion_between(&prev, &next, one, prev.t0 + f * .01);
		CHECK_NEAR(ob_norm(ob_sub(pose.p, ob_add(ob_scale(prev.p, 1 - f), ob_scale(next.p, f)))), 0, 1e-12);
		CHECK_NEAR(apart(pose.q, ob_quat_turn(prev.q, ob_scale(turn, f))), 0, 1e-12);
		pose = ob_motion_between(&prev, &next, one, prev.t0 - 1);
		CHECK(pose.p.x == prev.p.x && pose.q.w == prev.q.w);
		pose = ob_motion_between(&prev, &next, one, next.t0 + 1);
		CHECK(pose.p.x == next.p.x && pose.q.w == next.q.w);
		pose = ob_motion_between(&next, &next, one, next.t0);
		CHECK(pose.p.x == next.p.x && pose.q.w == next.q.w);
	}
}

// The ball lands: between a flying and a resting publication no frame lies below both.
static void test_between_landing(void)
{
	ob_motion prev = { .p = { 0, 0, .51 }, .q = { 1, 0, 0, 0 }, .v = { 0, 0, -10 }, .a = { 0, 0, -9.81 } };
	ob_motion next = { .t0 = .1, .p = { 0, 0, .5 }, .q = { 1, 0, 0, 0 } };
	for (int k = 0; k <= 10; k++)
		CHECK(ob_motion_between(&prev, &next, ob_v3(1, 1, 1), .01 * k).p.z >= .5);
}

static void test_closing_known(void)
{
	CHECK_NEAR(ob_time_of_closing(5, 0, -10, 10), 1, 1e-15);
	CHECK_NEAR(ob_time_of_closing(1, -2, 0, 10), .5, 0);
	CHECK_NEAR(ob_time_of_closing(0, 5, -10, 10), 1, 0); // thrown up from the ground: back at exactly 2 v / g
	CHECK_NEAR(ob_time_of_closing(0, 3.3, -9.81, 10), 6.6 / 9.81, 1e-16);
	CHECK_NEAR(ob_time_of_closing(1, -3, 4, 10), .5, 1e-15); // braking, but not enough
	// v^2 - 2 a gap = 1 exactly, where v^2 alone has 55 binary digits
	CHECK(ob_time_of_closing(0x1p54 + 0x1p28, -(0x1p27 + 1), .5, 1e9) == 0x1p28);
	CHECK(ob_time_of_closing(1, -2, 4, 10) == INFINITY); // stops half way
	CHECK(ob_time_of_closing(1, 1, 0, 10) == INFINITY);
	CHECK(ob_time_of_closing(1, 0, 0, 10) == INFINITY);
	CHECK(ob_time_of_closing(1, 1, 1, 10) == INFINITY);
	CHECK(ob_time_of_closing(5, 0, -10, .999) == INFINITY); // later than s
	CHECK(ob_time_of_closing(0, -1, 5, 10) == 0);
	CHECK(ob_time_of_closing(-.1, -1, 0, 10) == 0);
	CHECK(ob_time_of_closing(0, 0, -9.81, 10) == 0);
	CHECK(ob_time_of_closing(0, 0, 0, 10) == INFINITY);
	CHECK(ob_time_of_closing(-.1, 1, 0, 10) == INFINITY); // overlapping, but separating
	CHECK_NEAR(ob_time_of_closing(-.375, 2, -4, 10), .75, 1e-15); // out at .25, back at .75
	CHECK_NEAR(ob_time_of_closing(-.1, 1, -10, 10), .1, 1e-15); // never out: closes again from the turn on
	CHECK(ob_time_of_closing(INFINITY, -1, 0, 10) == INFINITY);
	CHECK(ob_time_of_closing(NAN, -1, 0, 10) == INFINITY);
	CHECK(ob_time_of_closing(1, NAN, -1, 10) == INFINITY);
}

// Any body that comes back closes the gap, at a closing rate, and no earlier root exists. Gaps down to 1e-15 m and the
// nearly grazing ones must keep their digits.
static void test_closing_random(void)
{
	uint64_t seed = 9;
	int found = 0;
	for (int k = 0; k < 20000; k++) {
		long double gap = pow(10, within(&seed, -15, 2)) * (k % 5 ? 1 : 0);
		long double v = within(&seed, -10, 10) * pow(10, -within(&seed, 0, 6)), a = within(&seed, -12, 12);
		if (k % 7 == 0 && gap > 0) {
			v = -fabsl(v);
			a = (double)(v * v / (2 * gap) * (1 - pow(10, -within(&seed, 1, 14)))); // grazing
			v = (double)v;
		}
		gap = (double)gap;
		v = (double)v;
		double t = ob_time_of_closing((double)gap, (double)v, (double)a, 10);
		if (t == INFINITY) {
			for (int j = 1; j <= 100; j++) {
				long double u = .1L * j;
				CHECK(gap + v * u + .5L * a * u * u > 0 || (gap == 0 && v == 0) || v + a * u >= 0);
			}
			continue;
		}
		found++;
		long double slope = fabsl(v + a * t) + 1e-300L, size = gap + fabsl(v * t) + .5L * fabsl(a) * t * t;
		long double rest = gap + v * t + .5L * a * t * t;
		CHECK(v + a * t <= 1e-15L * (fabsl(v) + fabsl(a * t)));
		CHECK(fabsl(rest) <= 4e-16L * (size + slope * t));
		CHECK(t >= 0 && t <= 10);
		for (int j = 1; j < 20 && k % 5; j++) {
			long double u = t * (j / 20.L);
			CHECK(gap + v * u + .5L * a * u * u >= -1e-15L * size);
		}
	}
	CHECK(found > 5000);
}

int main(void)
{
	test_known_throw();
	test_republishing();
	test_many();
	test_between_flights();
	test_between_contacts();
	test_between_landing();
	test_closing_known();
	test_closing_random();
	return check_end();
}

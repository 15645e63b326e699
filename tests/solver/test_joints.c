// Islands of joined bodies from a literal: closed forms, another solution, conserved quantities, and rows that hold.
#include "mechanism.h"

#include "check.h"

// Period (s) of the pendulum: 4 K(sin(angle / 2)) / rate, by the arithmetic-geometric mean.
static double period(double angle)
{
	double a = 1, g = cos(angle / 2);
	for (int i = 0; i < 40; i++) {
		const double mean = (a + g) / 2;
		g = sqrt(a * g);
		a = mean;
	}
	return 2 * M_PI / a * sqrt((1 + .4 * .1 * .1) / gravity);
}

// Time (s) of the next passage through the lowest point, by a cubic between two steps.
static double passage(mechanism *m)
{
	double before, after, rate_before, rate_after;
	do {
		before = atan2(m->motion[0].p.x, -m->motion[0].p.z), rate_before = -m->motion[0].w.y;
		mechanism_step(m);
		after = atan2(m->motion[0].p.x, -m->motion[0].p.z), rate_after = -m->motion[0].w.y;
	} while (before * after > 0 || fabs(before) > 1);
	double low = 0, high = 1;
	for (int i = 0; i < 60; i++) {
		const double t = (low + high) / 2, u = 1 - t;
		const double x = u * u * (1 + 2 * t) * before + t * t * (3 - 2 * t) * after +
				 step_length * t * u * (u * rate_before - t * rate_after);
		*(x * before > 0 ? &low : &high) = t;
	}
	return ((double)m->steps - 1 + low) * step_length;
}

static void test_period(void)
{
	const double angles[] = { .1, M_PI / 4, M_PI / 2 };
	for (int k = 0; k < 3; k++) {
		mechanism *m = mechanism_pendulum(angles[k]);
		const double first = passage(m), expected = period(angles[k]);
		double last = first;
		for (int i = 0; i < 20; i++)
			last = passage(m);
		CHECK_NEAR((last - first) / 10, expected, 1e-6 * expected);
		mechanism_destroy(m);
	}
}

// Near the top the period depends on the angle very much.
static void test_slow_swing(void)
{
	const double angle = 179. / 180 * M_PI;
	mechanism *m = mechanism_pendulum(angle);
	const double first = passage(m);
	passage(m);
	CHECK_NEAR(passage(m) - first, period(angle), 1e-4 * period(angle));
	mechanism_destroy(m);
}

static void test_energy(void)
{
	mechanism *m = mechanism_pendulum(M_PI / 2);
	const double begin = mechanism_energy(m);
	double most = 0;
	for (int i = 0; i < 20000; i++) {
		mechanism_step(m);
		most = fmax(most, fabs(mechanism_energy(m) - begin));
	}
	CHECK(most < 1e-8 * gravity);
	CHECK(mechanism_parted(m) < 1e-12);
	mechanism_destroy(m);
}

// A body that was put elsewhere is put back, and not thrown.
static void test_misplaced(void)
{
	mechanism *m = mechanism_pendulum(0);
	m->motion[0].p = ob_v3(.3, .1, -1.2);
	mechanism_step(m);
	CHECK(mechanism_parted(m) < 1e-12);
	CHECK(ob_norm(m->motion[0].v) < gravity * step_length);
	mechanism_destroy(m);
}

// ---- in space

// A symmetrical top on a ball, in steady precession: the roots of I Omega^2 cos(tilt) - L Omega + m g l = 0 (Lagrange).
static void test_top(void)
{
	const double l = 1, mass = 1, tilt = .5, fast = 60;
	mechanism *m = mechanism_create(gravity);
	const ob_vec3 up = ob_v3(sin(tilt), 0, cos(tilt));
	const uint32_t top = mechanism_add(m, OB_SHAPE_CYLINDER, ob_v3(.5, .05, 0), mass, ob_scale(up, l));
	const ob_vec3 k = m->passport[top].inertia;
	const double across = k.x + mass * l * l, spin = k.z * fast;
	const double slow =
		(spin - sqrt(spin * spin - 4 * across * cos(tilt) * mass * gravity * l)) / (2 * across * cos(tilt));
	m->motion[top].q = ob_quat_turn(ob_quat_identity(), ob_v3(0, tilt, 0));
	mechanism_join(m, OB_JOINT_BALL, top, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
	// The spin about the axis is `fast` in all, with the part of the precession.
	m->motion[top].w = ob_add(ob_v3(0, 0, slow), ob_scale(up, fast - slow * cos(tilt)));
	m->motion[top].v = ob_cross(m->motion[top].w, m->motion[top].p);
	double turned = 0, last = 0;
	for (int i = 0; i < 300; i++) {
		mechanism_step(m);
		const ob_vec3 at = m->motion[top].p;
		const double azimuth = atan2(at.y, at.x);
		turned += remainder(azimuth - last, 2 * M_PI);
		last = azimuth;
		CHECK_NEAR(at.z, l * cos(tilt), 1e-7); // it does not nod
	}
	CHECK_NEAR(turned, slow * 300 * step_length, 1e-6 * turned);
	mechanism_destroy(m);
}

// A spherical pendulum on a cone goes round at the rate sqrt(g / (l cos)), and keeps its height.
static void test_cone(void)
{
	const double tilt = .6, radius = .1, rate = sqrt(gravity / cos(tilt));
	mechanism *m = mechanism_create(gravity);
	const uint32_t bob = mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(radius, 0, 0), 1, ob_v3(sin(tilt), 0, -cos(tilt)));
	m->joint[m->joints++] =
		(ob_joint_passport){ .object = { bob, OB_JOINT_WORLD },
				     .kind = OB_JOINT_DISTANCE,
				     .frame = { { { 0, 0, 0 }, { 1, 0, 0, 0 } }, { { 0, 0, 0 }, { 1, 0, 0, 0 } } },
				     .length = 1,
				     .breaks_force = INFINITY,
				     .breaks_torque = INFINITY };
	m->motion[bob].v = ob_v3(0, rate * sin(tilt), 0);
	for (int i = 0; i < 600; i++) {
		mechanism_step(m);
		CHECK_NEAR(m->motion[bob].p.z, -cos(tilt), 1e-8);
	}
	const double turn = remainder(rate * 600 * step_length, 2 * M_PI);
	CHECK_NEAR(remainder(atan2(m->motion[bob].p.y, m->motion[bob].p.x) - turn, 2 * M_PI), 0, 1e-6);
	mechanism_destroy(m);
}

// A chain holds a thousand times the weight of a link, and swings.
static void test_chain(void)
{
	enum { LINKS = 100 };
	const double link = .1, mass = .1;
	mechanism *m = mechanism_create(gravity);
	for (uint32_t i = 0; i <= LINKS; i++) {
		const bool last = i == LINKS;
		const double at = last ? -link * LINKS - .25 : -link * (i + .5);
		mechanism_add(m, OB_SHAPE_BOX, last ? ob_v3(.25, .25, .25) : ob_v3(.02, .02, link / 2),
			      last ? 1000 * mass : mass, ob_v3(0, 0, at));
		mechanism_join(m, OB_JOINT_BALL, i, i ? i - 1 : OB_JOINT_WORLD, ob_v3(0, 0, -link * i),
			       ob_quat_identity());
	}
	m->motion[LINKS].v = ob_v3(1, 0, 0);
	mechanism_step(m); // the links take their share
	const double begin = mechanism_energy(m);
	for (int i = 0; i < 20; i++) {
		mechanism_step(m);
		CHECK(mechanism_parted(m) < 1e-12);
	}
	CHECK_NEAR(mechanism_energy(m), begin, 1e-4 * .5 * 1000 * mass);
	CHECK(m->motion[LINKS].p.x > .2);
	mechanism_destroy(m);
}

// ---- double pendulum

typedef struct angles {
	double angle[2], rate[2];
} angles;

static angles rates_of(const angles *x)
{
	const double i = .4 * .1 * .1, c = cos(x->angle[0] - x->angle[1]), s = sin(x->angle[0] - x->angle[1]);
	const double a = i + 2, b = c, d = i + 1;
	const double f0 = -s * x->rate[1] * x->rate[1] - 2 * gravity * sin(x->angle[0]),
		     f1 = s * x->rate[0] * x->rate[0] - gravity * sin(x->angle[1]), det = a * d - b * b;
	return (angles){ { x->rate[0], x->rate[1] }, { (d * f0 - b * f1) / det, (a * f1 - b * f0) / det } };
}

static angles moved(const angles *x, double h, const angles *by)
{
	angles out;
	for (int k = 0; k < 2; k++) {
		out.angle[k] = x->angle[k] + h * by->angle[k];
		out.rate[k] = x->rate[k] + h * by->rate[k];
	}
	return out;
}

// One step of the classical method of Runge and Kutta.
static angles advanced(const angles *x, double h)
{
	const angles a = rates_of(x), xb = moved(x, h / 2, &a), b = rates_of(&xb), xc = moved(x, h / 2, &b),
		     c = rates_of(&xc), xd = moved(x, h, &c), d = rates_of(&xd);
	angles out = moved(x, h / 6, &a);
	out = moved(&out, h / 3, &b);
	out = moved(&out, h / 3, &c);
	return moved(&out, h / 6, &d);
}

static void test_double_pendulum(void)
{
	enum { FINE = 1000, STEPS = 120 };
	mechanism *m = mechanism_create(gravity);
	const ob_vec3 size = ob_v3(.1, 0, 0);
	const uint32_t a = mechanism_add(m, OB_SHAPE_SPHERE, size, 1, ob_v3(1, 0, 0)),
		       b = mechanism_add(m, OB_SHAPE_SPHERE, size, 1, ob_v3(2, 0, 0));
	angles x = { { M_PI / 2, M_PI / 2 }, { 0, 0 } };
	mechanism_join(m, OB_JOINT_HINGE, a, OB_JOINT_WORLD, ob_v3(0, 0, 0), y_axis);
	mechanism_join(m, OB_JOINT_HINGE, a, b, ob_v3(1, 0, 0), y_axis);
	for (int i = 0; i < STEPS; i++) {
		mechanism_step(m);
		for (int k = 0; k < FINE; k++)
			x = advanced(&x, step_length / FINE);
	}
	CHECK_NEAR(m->motion[b].p.x, sin(x.angle[0]) + sin(x.angle[1]), 1e-6);
	CHECK_NEAR(m->motion[b].p.z, -cos(x.angle[0]) - cos(x.angle[1]), 1e-6);
	mechanism_destroy(m);
}

// ---- loops, all kinds

// Place in the middle of two, at which a bar between them has its centre.
static ob_vec3 middle(ob_vec3 a, ob_vec3 b)
{
	return ob_scale(ob_add(a, b), .5);
}

// A crank and a rocker: hinges in a plane, so each of its rows across the plane is there several times.
static void test_loop(void)
{
	mechanism *m = mechanism_create(gravity);
	const ob_vec3 ground = ob_v3(0, 0, 0), size = ob_v3(.1, 0, 0), b = ob_v3(0, 0, 1), d = ob_v3(3, 0, 0);
	const double far = sqrt(10), along = (9 - 6.25 + 10) / (2 * far), above = sqrt(9 - along * along);
	const ob_vec3 c = ob_v3((3 * along + above) / far, 0, 1 + (3 * above - along) / far);
	const uint32_t crank = mechanism_add(m, OB_SHAPE_SPHERE, size, 1, middle(ground, b)),
		       coupler = mechanism_add(m, OB_SHAPE_SPHERE, size, 1, middle(b, c)),
		       rocker = mechanism_add(m, OB_SHAPE_SPHERE, size, 1, middle(c, d));
	mechanism_join(m, OB_JOINT_HINGE, crank, OB_JOINT_WORLD, ground, y_axis);
	mechanism_join(m, OB_JOINT_HINGE, crank, coupler, b, y_axis);
	mechanism_join(m, OB_JOINT_HINGE, coupler, rocker, c, y_axis);
	mechanism_join(m, OB_JOINT_HINGE, rocker, OB_JOINT_WORLD, d, y_axis);
	m->motion[crank].w = ob_v3(0, 50, 0);
	mechanism_step(m); // the others take their share
	const double begin = mechanism_energy(m);
	double lowest = 1;
	for (int i = 0; i < 600; i++) {
		mechanism_step(m);
		lowest = fmin(lowest, m->motion[crank].p.z);
		CHECK(mechanism_parted(m) < 1e-11);
	}
	CHECK_NEAR(mechanism_energy(m), begin, 1e-6 * begin);
	CHECK(lowest < -.4); // the crank goes round
	mechanism_destroy(m);
}

// Two bodies of any kind of joint in free space keep momentum and energy, and the joint holds.
static void test_kinds(void)
{
	for (uint32_t kind = 0; kind < OB_JOINT_APART; kind++) {
		mechanism *m = mechanism_create(0);
		const uint32_t a = mechanism_add(m, OB_SHAPE_BOX, ob_v3(.3, .2, .1), 2, ob_v3(0, 0, 0)),
			       b = mechanism_add(m, OB_SHAPE_BOX, ob_v3(.1, .2, .4), 1, ob_v3(.2, .3, 1));
		ob_joint_passport *j =
			mechanism_join(m, (ob_joint_kind)kind, a, b, ob_v3(.1, .1, .5), ob_quat_identity());
		if (kind == OB_JOINT_DISTANCE) {
			j->frame[0].p = ob_v3(0, 0, 0);
			j->length = ob_norm(ob_v3(.1, .1, .5));
		}
		m->motion[a].w = ob_v3(1, 2, 3);
		m->motion[b].v = ob_v3(.3, -.2, .1);
		mechanism_step(m); // it takes what the joint does not allow
		const double begin = mechanism_energy(m);
		for (int i = 0; i < 300; i++)
			mechanism_step(m);
		const ob_vec3 p = ob_add(ob_scale(m->motion[a].v, 2), m->motion[b].v);
		const ob_vec3 spin = ob_add(ob_add(mechanism_spin(m, a), mechanism_spin(m, b)),
					    ob_add(ob_scale(ob_cross(m->motion[a].p, m->motion[a].v), 2),
						   ob_cross(m->motion[b].p, m->motion[b].v)));
		const ob_vec3 k = m->passport[a].inertia,
			      first = ob_add(ob_v3(k.x, 2 * k.y, 3 * k.z),
					     ob_cross(ob_v3(.2, .3, 1), ob_v3(.3, -.2, .1)));
		CHECK(ob_norm(ob_sub(p, ob_v3(.3, -.2, .1))) < 1e-12);
		CHECK(ob_norm(ob_sub(spin, first)) < 1e-11);
		CHECK_NEAR(mechanism_energy(m), begin, 1e-7 * begin);
		CHECK(mechanism_parted(m) < 1e-12);
		mechanism_destroy(m);
	}
}

int main(void)
{
	test_period();
	test_slow_swing();
	test_energy();
	test_misplaced();
	test_top();
	test_cone();
	test_chain();
	test_double_pendulum();
	test_loop();
	test_kinds();
	return check_end();
}

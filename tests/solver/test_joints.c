// Islands of joined bodies from a literal: closed forms, another solution, conserved quantities, and rows that hold.
#include "solver/solver.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "motion/joint_value.h"
#include "shape/shape.h"

enum { BODIES = 101, JOINTS = 101 };

static const double gravity = 9.81, step_length = 1. / 60;

// A mechanism that its test keeps from step to step.
typedef struct mechanism {
	uint32_t bodies, joints;
	ob_passport passport[BODIES];
	ob_motion motion[BODIES];
	ob_joint_passport joint[JOINTS];
	ob_found_joint load[JOINTS];
	ob_solver solver;
	uint64_t steps;
	ob_run_settings run;
} mechanism;

static bool spend(void *with, uint64_t work)
{
	return false;
}

static void begin_attempt(void *with) {}

static void touch(void *with, uint32_t a, uint32_t b, double impulse, ob_vec3 point)
{
	CHECK(false);
}

static void fail(void *with, uint32_t object)
{
	CHECK(false);
}

static void keep_contact(void *with, const ob_found_contact *c)
{
	CHECK(false);
}

static void keep_joint(void *with, const ob_found_joint *j)
{
	((mechanism *)with)->load[j->joint] = *j;
}

static void keep_motion(void *with, const ob_island_object *object, ob_motion *m, bool free)
{
	((mechanism *)with)->motion[object->id] = *m;
	CHECK(!free);
}

static mechanism *create(double g)
{
	mechanism *m = calloc(1, sizeof *m);
	const ob_island_calls calls = { m,    spend,        NULL,       begin_attempt, touch,
					fail, keep_contact, keep_joint, keep_motion };
	m->run = ob_run_settings_default();
	m->run.gravity = ob_v3(0, 0, -g);
	m->run.step_length = step_length;
	if (!ob_solver_create(&m->solver, &m->run, &calls, BODIES))
		abort();
	return m;
}

static void destroy(mechanism *m)
{
	ob_solver_finish(&m->solver);
	free(m);
}

static uint32_t add_body(mechanism *m, ob_shape shape, ob_vec3 size, double mass, ob_vec3 at)
{
	const uint32_t id = m->bodies++;
	m->passport[id] = (ob_passport){ .id = id,
					 .flags = OB_OBJECT_PRESENT,
					 .shape = (uint8_t)shape,
					 .size = size,
					 .mass = mass,
					 .inertia = ob_shape_inertia(shape, size, NULL, mass) };
	m->motion[id] = (ob_motion){ .p = at, .q = ob_quat_identity() };
	return id;
}

// Joins two bodies, or one and the world, in a frame of the world.
static ob_joint_passport *join(mechanism *m, ob_joint_kind kind, uint32_t a, uint32_t b, ob_vec3 at, ob_quat q)
{
	ob_joint_passport *j = &m->joint[m->joints++];
	*j = (ob_joint_passport){
		.object = { a, b }, .kind = kind, .breaks_force = INFINITY, .breaks_torque = INFINITY
	};
	for (int side = 0; side < 2; side++) {
		const uint32_t id = j->object[side];
		if (id == OB_JOINT_WORLD) {
			j->frame[side] = (ob_pose){ at, q };
			continue;
		}
		const ob_mat3 r = ob_quat_matrix(m->motion[id].q);
		j->frame[side] = (ob_pose){ ob_rotate_back(&r, ob_sub(at, m->motion[id].p)),
					    ob_quat_mul(ob_quat_conjugate(m->motion[id].q), q) };
	}
	return j;
}

static void step(mechanism *m)
{
	ob_island_object object[BODIES];
	ob_island_joint joint[JOINTS];
	const ob_motion *was = m->motion;
	ob_motion before[BODIES];
	memcpy(before, was, sizeof before);
	for (uint32_t k = 0; k < m->bodies; k++)
		object[k] = (ob_island_object){ .id = k,
						.passport = &m->passport[k],
						.motion = &before[k],
						.now = { { before[k].p, before[k].q }, before[k].v, before[k].w },
						.path = before[k].path };
	for (uint32_t k = 0; k < m->joints; k++) {
		joint[k] = (ob_island_joint){ .number = k, .joint = &m->joint[k] };
		for (int side = 0; side < 2; side++)
			joint[k].object[side] =
				m->joint[k].object[side] == OB_JOINT_WORLD ? OB_NO_FIXED : m->joint[k].object[side];
	}
	ob_island_solve(&m->solver, &(ob_island_input){ .step = m->steps++,
							.members = m->bodies,
							.objects = m->bodies,
							.joints = m->joints,
							.object = object,
							.joint = joint });
}

static ob_vec3 spin_of(const mechanism *m, uint32_t id)
{
	const ob_mat3 r = ob_quat_matrix(m->motion[id].q);
	const ob_vec3 k = m->passport[id].inertia, w = ob_rotate_back(&r, m->motion[id].w);
	return ob_rotate(&r, ob_v3(k.x * w.x, k.y * w.y, k.z * w.z));
}

static double energy_of(const mechanism *m)
{
	double sum = 0;
	for (uint32_t id = 0; id < m->bodies; id++) {
		const ob_motion *x = &m->motion[id];
		sum += .5 * m->passport[id].mass * ob_norm2(x->v) + .5 * ob_dot(x->w, spin_of(m, id)) -
		       m->passport[id].mass * ob_dot(m->run.gravity, x->p);
	}
	return sum;
}

// Largest distance by which joints have parted, m, and sine of an angle by which their z axes lean.
static double parted(const mechanism *m)
{
	double most = 0;
	for (uint32_t k = 0; k < m->joints; k++) {
		const ob_joint_passport *j = &m->joint[k];
		ob_vec3 at[2], z[2];
		for (int side = 0; side < 2; side++) {
			const uint32_t id = j->object[side];
			const ob_quat q = id == OB_JOINT_WORLD ? ob_quat_identity() : m->motion[id].q;
			const ob_mat3 r = ob_quat_matrix(q), axes = ob_quat_matrix(ob_quat_mul(q, j->frame[side].q));
			at[side] = ob_rotate(&r, j->frame[side].p);
			if (id != OB_JOINT_WORLD)
				at[side] = ob_add(at[side], m->motion[id].p);
			z[side] = ob_column(&axes, 2);
		}
		const ob_vec3 apart = ob_sub(at[0], at[1]);
		const bool leans = j->kind == OB_JOINT_HINGE || j->kind == OB_JOINT_FIXED || j->kind == OB_JOINT_SLIDER;
		most = fmax(most, j->kind == OB_JOINT_DISTANCE ? fabs(ob_norm(apart) - j->length)
				  : j->kind == OB_JOINT_SLIDER ? ob_norm(ob_cross(apart, z[1]))
							       : ob_norm(apart));
		if (leans)
			most = fmax(most, ob_norm(ob_cross(z[0], z[1])));
	}
	return most;
}

static const ob_quat y_axis = { M_SQRT1_2, -M_SQRT1_2, 0, 0 }; // turns z to y

static mechanism *create_pendulum(double angle)
{
	mechanism *m = create(gravity);
	const uint32_t bob = add_body(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(sin(angle), 0, -cos(angle)));
	join(m, OB_JOINT_HINGE, bob, OB_JOINT_WORLD, ob_v3(0, 0, 0), y_axis);
	return m;
}

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
		step(m);
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
		mechanism *m = create_pendulum(angles[k]);
		const double first = passage(m), expected = period(angles[k]);
		double last = first;
		for (int i = 0; i < 20; i++)
			last = passage(m);
		CHECK_NEAR((last - first) / 10, expected, 1e-6 * expected);
		destroy(m);
	}
}

// Near the top the period depends on the angle very much.
static void test_slow_swing(void)
{
	const double angle = 179. / 180 * M_PI;
	mechanism *m = create_pendulum(angle);
	const double first = passage(m);
	passage(m);
	CHECK_NEAR(passage(m) - first, period(angle), 1e-4 * period(angle));
	destroy(m);
}

static void test_energy(void)
{
	mechanism *m = create_pendulum(M_PI / 2);
	const double begin = energy_of(m);
	double most = 0;
	for (int i = 0; i < 20000; i++) {
		step(m);
		most = fmax(most, fabs(energy_of(m) - begin));
	}
	CHECK(most < 1e-8 * gravity);
	CHECK(parted(m) < 1e-12);
	destroy(m);
}

// A body that was put elsewhere is put back, and not thrown.
static void test_misplaced(void)
{
	mechanism *m = create_pendulum(0);
	m->motion[0].p = ob_v3(.3, .1, -1.2);
	step(m);
	CHECK(parted(m) < 1e-12);
	CHECK(ob_norm(m->motion[0].v) < gravity * step_length);
	destroy(m);
}

// ---- in space

// A symmetrical top on a ball, in steady precession: the roots of I Omega^2 cos(tilt) - L Omega + m g l = 0 (Lagrange).
static void test_top(void)
{
	const double l = 1, mass = 1, tilt = .5, fast = 60;
	mechanism *m = create(gravity);
	const ob_vec3 up = ob_v3(sin(tilt), 0, cos(tilt));
	const uint32_t top = add_body(m, OB_SHAPE_CYLINDER, ob_v3(.5, .05, 0), mass, ob_scale(up, l));
	const ob_vec3 k = m->passport[top].inertia;
	const double across = k.x + mass * l * l, spin = k.z * fast;
	const double slow =
		(spin - sqrt(spin * spin - 4 * across * cos(tilt) * mass * gravity * l)) / (2 * across * cos(tilt));
	m->motion[top].q = ob_quat_turn(ob_quat_identity(), ob_v3(0, tilt, 0));
	join(m, OB_JOINT_BALL, top, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
	// The spin about the axis is `fast` in all, with the part of the precession.
	m->motion[top].w = ob_add(ob_v3(0, 0, slow), ob_scale(up, fast - slow * cos(tilt)));
	m->motion[top].v = ob_cross(m->motion[top].w, m->motion[top].p);
	double turned = 0, last = 0;
	for (int i = 0; i < 300; i++) {
		step(m);
		const ob_vec3 at = m->motion[top].p;
		const double azimuth = atan2(at.y, at.x);
		turned += remainder(azimuth - last, 2 * M_PI);
		last = azimuth;
		CHECK_NEAR(at.z, l * cos(tilt), 1e-7); // it does not nod
	}
	CHECK_NEAR(turned, slow * 300 * step_length, 1e-6 * turned);
	destroy(m);
}

// A spherical pendulum on a cone goes round at the rate sqrt(g / (l cos)), and keeps its height.
static void test_cone(void)
{
	const double tilt = .6, radius = .1, rate = sqrt(gravity / cos(tilt));
	mechanism *m = create(gravity);
	const uint32_t bob = add_body(m, OB_SHAPE_SPHERE, ob_v3(radius, 0, 0), 1, ob_v3(sin(tilt), 0, -cos(tilt)));
	m->joint[m->joints++] =
		(ob_joint_passport){ .object = { bob, OB_JOINT_WORLD },
				     .kind = OB_JOINT_DISTANCE,
				     .frame = { { { 0, 0, 0 }, { 1, 0, 0, 0 } }, { { 0, 0, 0 }, { 1, 0, 0, 0 } } },
				     .length = 1,
				     .breaks_force = INFINITY,
				     .breaks_torque = INFINITY };
	m->motion[bob].v = ob_v3(0, rate * sin(tilt), 0);
	for (int i = 0; i < 600; i++) {
		step(m);
		CHECK_NEAR(m->motion[bob].p.z, -cos(tilt), 1e-8);
	}
	const double turn = remainder(rate * 600 * step_length, 2 * M_PI);
	CHECK_NEAR(remainder(atan2(m->motion[bob].p.y, m->motion[bob].p.x) - turn, 2 * M_PI), 0, 1e-6);
	destroy(m);
}

// A chain holds a thousand times the weight of a link, and swings.
static void test_chain(void)
{
	enum { LINKS = 100 };
	const double link = .1, mass = .1;
	mechanism *m = create(gravity);
	for (uint32_t i = 0; i <= LINKS; i++) {
		const bool last = i == LINKS;
		const double at = last ? -link * LINKS - .25 : -link * (i + .5);
		add_body(m, OB_SHAPE_BOX, last ? ob_v3(.25, .25, .25) : ob_v3(.02, .02, link / 2),
			 last ? 1000 * mass : mass, ob_v3(0, 0, at));
		join(m, OB_JOINT_BALL, i, i ? i - 1 : OB_JOINT_WORLD, ob_v3(0, 0, -link * i), ob_quat_identity());
	}
	m->motion[LINKS].v = ob_v3(1, 0, 0);
	step(m); // the links take their share
	const double begin = energy_of(m);
	for (int i = 0; i < 20; i++) {
		step(m);
		CHECK(parted(m) < 1e-12);
	}
	CHECK_NEAR(energy_of(m), begin, 1e-4 * .5 * 1000 * mass);
	CHECK(m->motion[LINKS].p.x > .2);
	destroy(m);
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
	mechanism *m = create(gravity);
	const ob_vec3 size = ob_v3(.1, 0, 0);
	const uint32_t a = add_body(m, OB_SHAPE_SPHERE, size, 1, ob_v3(1, 0, 0)),
		       b = add_body(m, OB_SHAPE_SPHERE, size, 1, ob_v3(2, 0, 0));
	angles x = { { M_PI / 2, M_PI / 2 }, { 0, 0 } };
	join(m, OB_JOINT_HINGE, a, OB_JOINT_WORLD, ob_v3(0, 0, 0), y_axis);
	join(m, OB_JOINT_HINGE, a, b, ob_v3(1, 0, 0), y_axis);
	for (int i = 0; i < STEPS; i++) {
		step(m);
		for (int k = 0; k < FINE; k++)
			x = advanced(&x, step_length / FINE);
	}
	CHECK_NEAR(m->motion[b].p.x, sin(x.angle[0]) + sin(x.angle[1]), 1e-6);
	CHECK_NEAR(m->motion[b].p.z, -cos(x.angle[0]) - cos(x.angle[1]), 1e-6);
	destroy(m);
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
	mechanism *m = create(gravity);
	const ob_vec3 ground = ob_v3(0, 0, 0), size = ob_v3(.1, 0, 0), b = ob_v3(0, 0, 1), d = ob_v3(3, 0, 0);
	const double far = sqrt(10), along = (9 - 6.25 + 10) / (2 * far), above = sqrt(9 - along * along);
	const ob_vec3 c = ob_v3((3 * along + above) / far, 0, 1 + (3 * above - along) / far);
	const uint32_t crank = add_body(m, OB_SHAPE_SPHERE, size, 1, middle(ground, b)),
		       coupler = add_body(m, OB_SHAPE_SPHERE, size, 1, middle(b, c)),
		       rocker = add_body(m, OB_SHAPE_SPHERE, size, 1, middle(c, d));
	join(m, OB_JOINT_HINGE, crank, OB_JOINT_WORLD, ground, y_axis);
	join(m, OB_JOINT_HINGE, crank, coupler, b, y_axis);
	join(m, OB_JOINT_HINGE, coupler, rocker, c, y_axis);
	join(m, OB_JOINT_HINGE, rocker, OB_JOINT_WORLD, d, y_axis);
	m->motion[crank].w = ob_v3(0, 50, 0);
	step(m); // the others take their share
	const double begin = energy_of(m);
	double lowest = 1;
	for (int i = 0; i < 600; i++) {
		step(m);
		lowest = fmin(lowest, m->motion[crank].p.z);
		CHECK(parted(m) < 1e-11);
	}
	CHECK_NEAR(energy_of(m), begin, 1e-6 * begin);
	CHECK(lowest < -.4); // the crank goes round
	destroy(m);
}

// Two bodies of any kind of joint in free space keep momentum and energy, and the joint holds.
static void test_kinds(void)
{
	for (uint32_t kind = 0; kind < OB_JOINT_APART; kind++) {
		mechanism *m = create(0);
		const uint32_t a = add_body(m, OB_SHAPE_BOX, ob_v3(.3, .2, .1), 2, ob_v3(0, 0, 0)),
			       b = add_body(m, OB_SHAPE_BOX, ob_v3(.1, .2, .4), 1, ob_v3(.2, .3, 1));
		ob_joint_passport *j = join(m, (ob_joint_kind)kind, a, b, ob_v3(.1, .1, .5), ob_quat_identity());
		if (kind == OB_JOINT_DISTANCE) {
			j->frame[0].p = ob_v3(0, 0, 0);
			j->length = ob_norm(ob_v3(.1, .1, .5));
		}
		m->motion[a].w = ob_v3(1, 2, 3);
		m->motion[b].v = ob_v3(.3, -.2, .1);
		step(m); // it takes what the joint does not allow
		const double begin = energy_of(m);
		for (int i = 0; i < 300; i++)
			step(m);
		const ob_vec3 p = ob_add(ob_scale(m->motion[a].v, 2), m->motion[b].v);
		const ob_vec3 spin = ob_add(ob_add(spin_of(m, a), spin_of(m, b)),
					    ob_add(ob_scale(ob_cross(m->motion[a].p, m->motion[a].v), 2),
						   ob_cross(m->motion[b].p, m->motion[b].v)));
		const ob_vec3 k = m->passport[a].inertia,
			      first = ob_add(ob_v3(k.x, 2 * k.y, 3 * k.z),
					     ob_cross(ob_v3(.2, .3, 1), ob_v3(.3, -.2, .1)));
		CHECK(ob_norm(ob_sub(p, ob_v3(.3, -.2, .1))) < 1e-12);
		CHECK(ob_norm(ob_sub(spin, first)) < 1e-11);
		CHECK_NEAR(energy_of(m), begin, 1e-7 * begin);
		CHECK(parted(m) < 1e-12);
		destroy(m);
	}
}

// ---- along axes

// Lets something act along the axis of the last joint.
static ob_joint_axis *drive(mechanism *m)
{
	ob_joint_passport *j = &m->joint[m->joints - 1];
	j->flags |= OB_JOINT_DRIVEN;
	j->axis = (ob_joint_axis){ .low = -INFINITY, .high = INFINITY };
	return &j->axis;
}

// A ball of 2 kg on a slide along x.
static mechanism *create_slide(void)
{
	mechanism *m = create(gravity);
	add_body(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 2, ob_v3(0, 0, 0));
	join(m, OB_JOINT_SLIDER, 0, OB_JOINT_WORLD, ob_v3(0, 0, 0), (ob_quat){ M_SQRT1_2, 0, M_SQRT1_2, 0 });
	return m;
}

static void steps(mechanism *m, int n)
{
	for (int i = 0; i < n; i++)
		step(m);
}

// A pendulum falls on its limit: each hit takes 1 - e^2 of the energy above that of the limit, and in the end it rests.
static void test_limit(void)
{
	const double at = 1.2, e = .5, rest = -gravity * cos(M_PI / 2 - at);
	mechanism *m = create_pendulum(M_PI / 2);
	ob_joint_axis *a = drive(m);
	a->high = at, a->restitution = e;
	double energy = energy_of(m);
	for (int hits = 0; hits < 4;) {
		step(m);
		const double now = energy_of(m);
		if (fabs(now - energy) < 1e-3 * (energy - rest))
			continue;
		CHECK_NEAR(now - rest, e * e * (energy - rest), 1e-7 * (energy - rest));
		energy = now;
		hits++;
	}
	steps(m, 300);
	CHECK_NEAR(atan2(m->motion[0].p.x, -m->motion[0].p.z), M_PI / 2 - at, 1e-10);
	CHECK(ob_norm(m->motion[0].w) < 1e-10);
	destroy(m);
}

// A link between two limits that hits them while its neighbour rests on another one: nothing passes a limit.
static void test_limits_of_links(void)
{
	mechanism *m = create(gravity);
	for (uint32_t i = 0; i < 3; i++) {
		add_body(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(i + 1, 0, 0));
		join(m, OB_JOINT_HINGE, i, i ? i - 1 : OB_JOINT_WORLD, ob_v3(i, 0, 0), y_axis);
		ob_joint_axis *a = drive(m);
		a->low = -.2, a->high = .3, a->restitution = .3;
	}
	const double begin = energy_of(m);
	double last = begin;
	for (int i = 0; i < 600; i++) {
		step(m);
		CHECK(energy_of(m) < last + 1e-7 * begin + 1e-6);
		last = energy_of(m);
	}
	for (int i = 0; i < 3; i++)
		CHECK_NEAR(2 * asin(m->motion[i].q.y), .3 * (i + 1), 1e-9);
	destroy(m);
}

static void test_spring(void)
{
	const double k = 50, stretch = .3, rate = sqrt(k / 2);
	mechanism *m = create_slide();
	ob_joint_axis *a = drive(m);
	a->stiffness = k, a->rest = stretch;
	for (int i = 1; i <= 600; i++) {
		step(m);
		CHECK_NEAR(m->motion[0].p.x, stretch * (1 - cos(rate * i * step_length)), 1e-7);
	}
	destroy(m);
}

// Steps a slide that was let go at rest .3 m from where its spring is, beside the closed form.
static void check_damped(mechanism *m, double decay, double rate)
{
	for (int i = 1; i <= 300; i++) {
		const double t = i * step_length;
		step(m);
		CHECK_NEAR(m->motion[0].p.x, .3 - .3 * exp(-decay * t) * (cos(rate * t) + decay / rate * sin(rate * t)),
			   1e-7);
	}
}

static void test_damped_spring(void)
{
	const double k = 50, c = 3, decay = c / 4, rate = sqrt(k / 2 - decay * decay);
	mechanism *m = create_slide();
	ob_joint_axis *a = drive(m);
	a->stiffness = k, a->damping = c, a->rest = .3;
	check_damped(m, decay, rate);
	destroy(m);
}

// A rotor adds its inertia to that along the axis, with springs and dampers, and where a limit is hit.
static void test_armature(void)
{
	const double k = 50, c = 3, all = 2 + 5, decay = c / (2 * all), rate = sqrt(k / all - decay * decay);
	mechanism *m = create_slide();
	ob_joint_axis *a = drive(m);
	a->stiffness = k, a->damping = c, a->rest = .3, a->armature = 5;
	check_damped(m, decay, rate);
	destroy(m);
	m = create_slide();
	a = drive(m);
	a->high = 1, a->restitution = .5, a->armature = 5, a->stiffness = 7, a->rest = 2;
	double most = 0;
	for (int i = 1; i <= 600; i++) {
		const double t = i * step_length, hit = M_PI / 3;
		step(m);
		if (t < hit) // then its rate is sin(hit) * 2
			CHECK_NEAR(m->motion[0].p.x, 2 - 2 * cos(t), 1e-7);
		else if (t < hit + .5)
			CHECK_NEAR(m->motion[0].p.x, 2 - cos(t - hit) - sin(hit) * sin(t - hit), 1e-6);
		most = ob_max(most, m->motion[0].p.x);
	}
	CHECK(most < 1 + 1e-9);
	destroy(m);
}

// A pendulum with a rotor swings as one with a greater moment, which its period tells.
static void test_armature_of_hinge(void)
{
	const double rotor = .7, amplitude = .5;
	mechanism *m = create_pendulum(amplitude), *heavy = create_pendulum(amplitude);
	drive(m)->armature = rotor;
	heavy->passport[0].inertia.y += rotor;
	steps(m, 300), steps(heavy, 300);
	CHECK(ob_norm(ob_sub(m->motion[0].p, heavy->motion[0].p)) < 1e-7);
	CHECK(ob_norm(ob_sub(m->motion[0].v, heavy->motion[0].v)) < 1e-7);
	destroy(m), destroy(heavy);
}

// Two slides with dampers on one body that is free, alike: they move alike, and as the closed form says.
static void test_dampers(void)
{
	const double c = 20, rate = c * (1 + 2. / 3);
	mechanism *m = create(0);
	add_body(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 3, ob_v3(0, 0, 0));
	for (uint32_t i = 1; i < 3; i++) {
		add_body(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(0, i == 1 ? -1 : 1, 0));
		join(m, OB_JOINT_SLIDER, i, 0, ob_v3(0, i == 1 ? -1 : 1, 0), (ob_quat){ M_SQRT1_2, 0, M_SQRT1_2, 0 });
		drive(m)->damping = c;
		m->motion[i].v = ob_v3(1, 0, 0);
	}
	for (int i = 1; i <= 60; i++) {
		step(m);
		CHECK_NEAR(m->motion[1].p.x, m->motion[2].p.x, 1e-11);
		CHECK_NEAR(m->motion[1].p.x - m->motion[0].p.x, (1 - exp(-rate * i * step_length)) / rate, 1e-7);
	}
	destroy(m);
}

// Two dampers with next to no mass between them are as one of half their strength.
static void test_dampers_in_line(void)
{
	const double c = 30, rate = c / 2 / 2;
	const ob_quat along_x = { M_SQRT1_2, 0, M_SQRT1_2, 0 };
	mechanism *m = create(0);
	add_body(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 2, ob_v3(0, 0, 0));
	add_body(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 2e-6, ob_v3(0, 0, 0));
	join(m, OB_JOINT_SLIDER, 1, OB_JOINT_WORLD, ob_v3(0, 0, 0), along_x);
	drive(m)->damping = c;
	join(m, OB_JOINT_SLIDER, 0, 1, ob_v3(0, 0, 0), along_x);
	drive(m)->damping = c;
	m->motion[0].v = ob_v3(1, 0, 0), m->motion[1].v = ob_v3(.5, 0, 0);
	for (int i = 1; i <= 60; i++) {
		step(m);
		CHECK_NEAR(m->motion[0].p.x, (1 - exp(-rate * i * step_length)) / rate, 1e-4);
	}
	destroy(m);
}

// A spring between two free bodies, along their distance.
static void test_spring_between(void)
{
	mechanism *m = create(0);
	add_body(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(0, 0, 0));
	add_body(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 3, ob_v3(1.2, 0, 0));
	ob_joint_passport *j = join(m, OB_JOINT_DISTANCE, 0, 1, ob_v3(0, 0, 0), ob_quat_identity());
	j->frame[1].p = ob_v3(0, 0, 0), j->length = 1.2;
	ob_joint_axis *a = drive(m);
	a->stiffness = 30, a->rest = 1;
	const double rate = sqrt(30 / .75);
	for (int i = 1; i <= 300; i++) {
		step(m);
		CHECK_NEAR(m->motion[1].p.x - m->motion[0].p.x, 1 + .2 * cos(rate * i * step_length), 1e-7);
	}
	destroy(m);
}

// Dry friction stops a slide where it must, and then holds it.
static void test_friction(void)
{
	mechanism *m = create_slide();
	ob_joint_axis *a = drive(m);
	a->friction = 3;
	m->motion[0].v = ob_v3(2, 0, 0);
	steps(m, 120);
	CHECK_NEAR(m->motion[0].p.x, 2. * 2 / (2 * 3. / 2), 1e-9);
	CHECK(ob_norm(m->motion[0].v) < 1e-12);
	m->passport[0].force = ob_v3(2.9, 0, 0);
	steps(m, 60);
	CHECK_NEAR(m->motion[0].p.x, 4. / 3, 1e-9);
	m->passport[0].force = ob_v3(-3.5, 0, 0);
	steps(m, 60);
	CHECK_NEAR(m->motion[0].p.x, 4. / 3 - .5 * .5 / 2, 1e-8);
	destroy(m);
}

// The work of a motor is the energy gained: while its torque is all that it has, and while it holds a rate.
static void test_motor(void)
{
	mechanism *m = create_pendulum(0);
	ob_joint_axis *a = drive(m);
	const double most = 12, begin = energy_of(m);
	a->motor = OB_MOTOR_RATE, a->target = -20, a->most = most;
	double turned = 0, last = 0;
	for (int i = 0; i < 120; i++) {
		step(m);
		const double angle = atan2(m->motion[0].p.x, -m->motion[0].p.z);
		turned += remainder(angle - last, 2 * M_PI);
		last = angle;
		if (m->motion[0].w.y > -20 + 1e-6)
			CHECK_NEAR(energy_of(m) - begin, most * turned, 1e-6 * most * fabs(turned) + 1e-9);
	}
	CHECK(turned > 4 * M_PI);
	steps(m, 300);
	CHECK_NEAR(m->motion[0].w.y, -20, 1e-9); // it holds the rate
	destroy(m);
}

// A motor pulls to a value against the weight; one that is too weak hangs where its force allows.
static void test_servo(void)
{
	mechanism *m = create_pendulum(0);
	ob_joint_axis *a = drive(m);
	a->motor = OB_MOTOR_VALUE, a->target = -1, a->motor_stiffness = 1000, a->motor_damping = 60, a->most = INFINITY;
	steps(m, 300);
	const double angle = atan2(m->motion[0].p.x, -m->motion[0].p.z);
	CHECK_NEAR(1000 * (1 - angle), gravity * sin(angle), 1e-6);
	a->most = 5;
	steps(m, 3000);
	CHECK(fabs(atan2(m->motion[0].p.x, -m->motion[0].p.z)) < 1.2);
	destroy(m);
}

// A motor that holds a rate against a weight: its mean torque is published, and the energy gained is its work.
static void test_work(void)
{
	mechanism *m = create_pendulum(0);
	ob_joint_axis *a = drive(m);
	a->motor = OB_MOTOR_RATE, a->target = -2, a->most = INFINITY;
	steps(m, 2);
	const double begin = energy_of(m);
	double work = 0, most = 0;
	for (int i = 0; i < 300; i++) {
		step(m);
		work += m->load[0].along * a->target * step_length;
		most = ob_max(most, fabs(work));
		CHECK_NEAR(energy_of(m) - begin, work, 1e-6 * most);
		CHECK_NEAR(m->load[0].torque.y, m->load[0].along, 1e-9 * most);
	}
	CHECK(most > 10);
	destroy(m);
}

// A beam that the world holds at one end: its weight, and the moment of it.
static void test_load(void)
{
	mechanism *m = create(gravity);
	const uint32_t beam = add_body(m, OB_SHAPE_BOX, ob_v3(2, .2, .2), 3, ob_v3(1, 0, 0));
	join(m, OB_JOINT_FIXED, beam, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
	steps(m, 10);
	CHECK(ob_norm(ob_sub(m->load[0].force, ob_v3(0, 0, 3 * gravity))) < 1e-8);
	CHECK(ob_norm(ob_sub(m->load[0].torque, ob_v3(0, -3 * gravity, 0))) < 1e-8);
	CHECK(m->load[0].along == 0 && !m->load[0].broke);
	m->joint[0].breaks_torque = 3 * gravity * (1 + 1e-6);
	steps(m, 10);
	CHECK(!m->load[0].broke);
	m->joint[0].breaks_torque = 3 * gravity * (1 - 1e-6);
	step(m);
	CHECK(m->load[0].broke);
	CHECK_NEAR(m->motion[beam].v.z, -gravity * step_length, 1e-9); // from the step's begin it falls
	CHECK(ob_norm(m->motion[beam].w) < 1e-9);
	destroy(m);
}

// Swing of a bob on a ball joint, let go level: angle below the level, its rate, and the joint's force.
typedef struct swing {
	double angle, rate;
} swing;

static swing swung(swing s, double k, double h)
{
	const double a1 = k * cos(s.angle), r2 = s.rate + .5 * h * a1, a2 = k * cos(s.angle + .5 * h * s.rate),
		     r3 = s.rate + .5 * h * a2, a3 = k * cos(s.angle + .5 * h * r2), r4 = s.rate + h * a3,
		     a4 = k * cos(s.angle + h * r3);
	return (swing){ s.angle + h / 6 * (s.rate + 2 * r2 + 2 * r3 + r4),
			s.rate + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4) };
}

// The joint breaks within a substep of the instant at which its force is reached.
static void test_break(void)
{
	enum { FINE = 1000 };
	const double mass = 2, radius = .1, inertia = .4 * mass * radius * radius + mass, k = mass * gravity / inertia;
	mechanism *m = create(gravity);
	const uint32_t bob = add_body(m, OB_SHAPE_SPHERE, ob_v3(radius, radius, radius), mass, ob_v3(1, 0, 0));
	ob_joint_passport *j = join(m, OB_JOINT_BALL, bob, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
	const double sub = step_length / m->run.substeps, fine = sub / FINE;
	j->breaks_force = 2 * mass * gravity;
	swing now = { 0, 0 };
	double reached = 0, broke = 0;
	for (double force = 0; force < j->breaks_force;) {
		now = swung(now, k, fine);
		reached += fine;
		const double pull = mass * now.rate * now.rate + mass * gravity * sin(now.angle),
			     across = mass * (k - gravity) * cos(now.angle);
		force = sqrt(pull * pull + across * across);
	}
	for (int i = 0; i < 100 && !m->load[0].broke; i++)
		step(m);
	CHECK(m->load[0].broke && ob_norm(m->load[0].force) > j->breaks_force);
	CHECK(ob_norm(m->load[0].force) < 1.1 * j->breaks_force);
	for (now = (swing){ 0, 0 }; now.rate < m->motion[bob].w.y;
	     now = swung(now, k, fine)) // it keeps its spin from then on
		broke += fine;
	CHECK(fabs(broke - reached) < sub);
	destroy(m);
}

// The weakest of three links breaks, and the others hold what is left.
static void test_weakest(void)
{
	mechanism *m = create(gravity);
	for (uint32_t i = 0; i < 3; i++) {
		const uint32_t link = add_body(m, OB_SHAPE_SPHERE, ob_v3(.1, .1, .1), 1, ob_v3(0, 0, -1. - i));
		ob_joint_passport *j = join(m, OB_JOINT_BALL, link, i ? link - 1 : OB_JOINT_WORLD, ob_v3(0, 0, -.0 - i),
					    ob_quat_identity());
		j->breaks_force = (i == 1 ? 1.9 : 2.5) * gravity; // they bear 3, 2 and 1 weights
	}
	m->joint[0].breaks_force = 3.5 * gravity;
	step(m);
	CHECK(!m->load[0].broke && m->load[1].broke && !m->load[2].broke);
	CHECK_NEAR(m->motion[0].p.z, -1, 1e-12);
	CHECK_NEAR(m->load[0].force.z, gravity, 1e-8);
	CHECK_NEAR(ob_norm(m->load[2].force), 0, 1e-8); // they fall together
	destroy(m);
}

// ---- axes of balls and universals

// A ball of 3 kg, whose moment is "moment", that turns about its centre.
static const double moment = .4 * 3 * .2 * .2;

static mechanism *create_gimbal(ob_joint_kind kind)
{
	mechanism *m = create(gravity);
	add_body(m, OB_SHAPE_SPHERE, ob_v3(.2, 0, 0), 3, ob_v3(0, 0, 0));
	join(m, kind, 0, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
	return m;
}

// Value at t (s) of what was at "from", with this rate, on a spring (N m) with a damper (N m s) and so much inertia (kg m^2).
static double swinging(double t, double from, double speed, double spring, double damper, double inertia)
{
	const double decay = damper / (2 * inertia), rate = sqrt(spring / inertia - decay * decay);
	return exp(-decay * t) * (from * cos(rate * t) + (speed + decay * from) / rate * sin(rate * t));
}

static double value_of(const mechanism *m, uint32_t joint)
{
	const ob_joint_passport *j = &m->joint[joint];
	ob_state state[2] = { { .pose.q = ob_quat_identity() }, { .pose.q = ob_quat_identity() } };
	double value = NAN, rate;
	for (int side = 0; side < 2; side++)
		if (j->object[side] != OB_JOINT_WORLD) {
			const ob_motion *x = &m->motion[j->object[side]];
			state[side] = (ob_state){ { x->p, x->q }, x->v, x->w };
		}
	CHECK(ob_joint_value(j, state, &value, &rate));
	return value;
}

// About one axis a ball on a spring is a hinge, also by more than a right angle.
static void test_spring_of_ball(void)
{
	static const struct {
		double damper, rotor;
	} each[] = { { 0, 0 }, { .02, 0 }, { 0, .1 }, { .05, .1 } };
	const double spring = .8, from = 2.2;
	for (size_t k = 0; k < sizeof each / sizeof *each; k++) {
		const double damper = each[k].damper, inertia = moment + each[k].rotor;
		mechanism *m = create_gimbal(OB_JOINT_BALL);
		ob_joint_axis *a = drive(m);
		a->stiffness = spring, a->damping = damper, a->armature = each[k].rotor;
		m->motion[0].q =
			(ob_quat){ cos(from / 2), .48 * sin(from / 2), .64 * sin(from / 2), .6 * sin(from / 2) };
		double most = 0;
		for (int i = 1; i <= 240; i++) {
			step(m);
			const double at = swinging(i * step_length, from, 0, spring, damper, inertia);
			most = fmax(most, fabs(value_of(m, 0) - fabs(at)));
		}
		printf("ball on a spring, damper %g, rotor %g: %.3g rad off\n", damper, each[k].rotor, most);
		CHECK(most < 1e-6);
		destroy(m);
	}
}

// The torque of a ball's spring has a potential, whatever its turns, and its damper takes energy alone.
static void test_energy_of_ball(void)
{
	for (int damped = 0; damped < 2; damped++) {
		mechanism *m = create(gravity);
		const uint32_t arm = add_body(m, OB_SHAPE_BOX, ob_v3(.1, .2, .6), 2, ob_v3(0, 0, .6)),
			       hand = add_body(m, OB_SHAPE_BOX, ob_v3(.1, .05, .3), 1, ob_v3(0, 0, 1.5));
		join(m, OB_JOINT_BALL, arm, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
		drive(m)->stiffness = 30;
		join(m, OB_JOINT_BALL, hand, arm, ob_v3(0, 0, 1.2), ob_quat_identity());
		ob_joint_axis *a = drive(m);
		a->stiffness = 5, a->armature = .2, a->damping = damped ? .3 : 0;
		m->motion[arm].w = ob_v3(1.5, .5, 2), m->motion[hand].w = ob_v3(-1, 3, 1);
		step(m);
		double begin = NAN, last = INFINITY, most = 0;
		for (int i = 0; i < 600; i++) {
			const ob_vec3 relative = ob_sub(m->motion[hand].w, m->motion[arm].w);
			const double now = energy_of(m) + .5 * 30 * value_of(m, 0) * value_of(m, 0) +
					   .5 * 5 * value_of(m, 1) * value_of(m, 1) + .5 * .2 * ob_norm2(relative);
			begin = isnan(begin) ? now : begin;
			most = fmax(most, fabs(now - begin));
			CHECK(!damped || now < last + 1e-7);
			last = now;
			step(m);
		}
		printf("two balls on springs%s: energy within %.3g of %.3g J\n", damped ? " and a damper" : "", most,
		       begin);
		CHECK(damped ? last < begin - .1 : most < 1e-5 * begin);
		CHECK(parted(m) < 1e-12);
		destroy(m);
	}
}

// A rotor that turns with a top adds to each of its moments.
static void test_rotor_of_ball(void)
{
	const double rotor = .05;
	mechanism *m[2];
	for (int k = 0; k < 2; k++) {
		m[k] = create(gravity);
		add_body(m[k], OB_SHAPE_BOX, ob_v3(.3, .2, .05), 1, ob_v3(0, 0, .4));
		join(m[k], OB_JOINT_BALL, 0, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
		if (k)
			m[k]->passport[0].inertia = ob_add(m[k]->passport[0].inertia, ob_v3(rotor, rotor, rotor));
		else
			drive(m[k])->armature = rotor;
		m[k]->motion[0].w = ob_v3(.3, .2, 12);
		steps(m[k], 200);
	}
	const double apart = ob_norm(ob_sub(m[0]->motion[0].p, m[1]->motion[0].p));
	printf("top with a rotor: %.3g m from one with its moments\n", apart);
	CHECK(apart < 1e-6);
	destroy(m[0]), destroy(m[1]);
}

// Springs, dampers and rotors of joints of bodies in free space change no momentum.
static void test_momentum_of_balls(void)
{
	for (int universal = 0; universal < 2; universal++) {
		mechanism *m = create(0);
		for (uint32_t i = 0; i < 2; i++)
			add_body(m, OB_SHAPE_BOX, ob_v3(.1, .2, .4), 1 + i, ob_v3(0, .1 * i, 1. * i));
		join(m, universal ? OB_JOINT_UNIVERSAL : OB_JOINT_BALL, 0, 1, ob_v3(0, .05, .5), ob_quat_identity());
		ob_joint_axis *a = drive(m);
		a->stiffness = 4, a->damping = .2, a->armature = .1, m->joint[0].second = *a;
		m->motion[0].w = ob_v3(1, 2, .3), m->motion[1].w = ob_v3(.3, -1, .2);
		step(m);
		const ob_vec3 first = ob_add(spin_of(m, 0), spin_of(m, 1));
		const ob_vec3 orbit = ob_add(ob_cross(m->motion[0].p, m->motion[0].v),
					     ob_scale(ob_cross(m->motion[1].p, m->motion[1].v), 2));
		const ob_vec3 p = ob_add(m->motion[0].v, ob_scale(m->motion[1].v, 2));
		steps(m, 300);
		const ob_vec3 spin = ob_add(spin_of(m, 0), spin_of(m, 1));
		const ob_vec3 orbits = ob_add(ob_cross(m->motion[0].p, m->motion[0].v),
					      ob_scale(ob_cross(m->motion[1].p, m->motion[1].v), 2));
		CHECK(ob_norm(ob_sub(ob_add(m->motion[0].v, ob_scale(m->motion[1].v, 2)), p)) < 1e-11);
		CHECK(ob_norm(ob_sub(ob_add(spin, orbits), ob_add(first, orbit))) < 1e-11);
		destroy(m);
	}
}

// A pendulum in a ball joint falls on the cone of its greatest turn: hits as those of a hinge, then it rests there.
static void test_limit_of_ball(void)
{
	const double at = .7, e = .5;
	mechanism *m = create(gravity);
	add_body(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(0, 0, 1)); // upside down
	join(m, OB_JOINT_BALL, 0, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
	ob_joint_axis *a = drive(m);
	a->high = at, a->restitution = e;
	m->motion[0].w = ob_v3(.3, .4, 0), m->motion[0].v = ob_v3(.4, -.3, 0);
	const double rest = gravity * cos(at);
	double energy = energy_of(m);
	for (int hits = 0; hits < 4;) {
		step(m);
		const double now = energy_of(m);
		CHECK(value_of(m, 0) < at + 1e-9);
		if (fabs(now - energy) < 1e-3 * (energy - rest))
			continue;
		CHECK_NEAR(now - rest, e * e * (energy - rest), 1e-6 * (energy - rest));
		energy = now;
		hits++;
	}
	steps(m, 300);
	CHECK_NEAR(value_of(m, 0), at, 1e-9);
	printf("w %g %g %g v %g\n", m->motion[0].w.x, m->motion[0].w.y, m->motion[0].w.z, value_of(m, 0) - at);
	destroy(m);
}

// Turn of the second arm of a universal in the world, y.
static double second_value(const mechanism *m)
{
	const ob_mat3 r = ob_quat_matrix(m->motion[0].q);
	return atan2(-r.m[2][0], r.m[0][0]);
}

// The turns of a ball about the arms of a cross are those of two hinges, which know nothing of each other.
static void test_axes_of_universal(void)
{
	mechanism *m = create_gimbal(OB_JOINT_UNIVERSAL);
	ob_joint_axis *a = drive(m), *b = &m->joint[0].second;
	a->stiffness = .6, a->damping = .01, a->armature = .02;
	b->low = -INFINITY, b->high = INFINITY;
	b->stiffness = .9, b->damping = .03;
	m->motion[0].w = ob_v3(5, 4, 0);
	double most = 0;
	for (int i = 1; i <= 300; i++) {
		const double t = i * step_length;
		step(m);
		most = fmax(most, fabs(value_of(m, 0) - swinging(t, 0, 5, .6, .01, moment + .02)));
		most = fmax(most, fabs(second_value(m) - swinging(t, 0, 4, .9, .03, moment)));
	}
	printf("universal on springs: %.3g rad off\n", most);
	CHECK(most < 1e-6);
	destroy(m);
	m = create_gimbal(OB_JOINT_UNIVERSAL);
	a = drive(m), b = &m->joint[0].second;
	a->high = .9, a->restitution = 1, a->low = -.5;
	*b = *a, b->high = .4, b->low = -INFINITY;
	m->motion[0].w = ob_v3(2, 1, 0);
	steps(m, 60); // s: the first turns by 2 rad, to .9 and back to -.2; the second by 1, to .4 and back
	CHECK_NEAR(value_of(m, 0), .9 - (2 - .9), 1e-9);
	CHECK_NEAR(second_value(m), -.2, 1e-9);
	destroy(m);
}

// The action of a universal and a ball has the torques of their springs, and they break by them.
static void test_loads_of_balls(void)
{
	for (int universal = 0; universal < 2; universal++) {
		mechanism *m = create_gimbal(universal ? OB_JOINT_UNIVERSAL : OB_JOINT_BALL);
		ob_joint_axis *a = drive(m);
		a->stiffness = 2;
		m->joint[0].second = (ob_joint_axis){ .low = -INFINITY, .high = INFINITY };
		m->motion[0].q = (ob_quat){ cos(.05), sin(.05), 0, 0 };
		m->run.step_length = 1e-4; // little of a swing
		step(m);
		CHECK_NEAR(m->load[0].torque.x, -.2, 1e-5);
		CHECK_NEAR(m->load[0].along, universal ? -.2 : 0, 1e-5);
		CHECK_NEAR(m->load[0].force.z, 3 * gravity, 1e-6);
		m->joint[0].breaks_torque = .1;
		step(m);
		CHECK(m->load[0].broke);
		destroy(m);
	}
}

int main(void)
{
	test_spring_of_ball();
	test_energy_of_ball();
	test_rotor_of_ball();
	test_momentum_of_balls();
	test_limit_of_ball();
	test_axes_of_universal();
	test_loads_of_balls();
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
	test_armature();
	test_armature_of_hinge();
	test_dampers();
	test_dampers_in_line();
	test_limit();
	test_limits_of_links();
	test_spring();
	test_damped_spring();
	test_spring_between();
	test_friction();
	test_motor();
	test_servo();
	test_work();
	test_load();
	test_break();
	test_weakest();
	return check_end();
}
